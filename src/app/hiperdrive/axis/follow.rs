//! How the run goes on: what a person presses, what was written, what the drive says.

use super::entries::{Entries, typed};
use super::{Ask, Axis, Before, Change, End, Outcome, Place, Power, Seen, Step, Travel};

impl Axis {
    /// What is typed has changed.
    pub(in crate::app) fn edit(&mut self, entries: Entries) {
        if self.end.is_none() {
            self.entries = entries;
        }
    }

    /// The position where the axis stands becomes the limit of this step.
    pub(in crate::app) fn take_limit(&mut self, seen: &Seen) {
        let Some((ruler, actual)) = self.ruler(seen).zip(seen.actual) else { return };
        let Some(text) = typed(ruler, actual.position) else { return };
        match self.step {
            Step::Lower => self.entries.lower = text,
            Step::Upper => self.entries.upper = text,
            _ => {}
        }
    }

    /// To the next step, where this one is done.
    pub(in crate::app) fn go_on(&mut self, seen: &Seen) {
        if self.end.is_some() || self.may_go_on(seen).is_err() {
            return;
        }
        self.skipped.retain(|step| *step != self.step);
        self.enter_next(seen);
    }

    /// To the next step without this one, where that may be left out.
    pub(in crate::app) fn skip(&mut self, seen: &Seen) {
        if self.end.is_some() || !self.step.may_be_skipped() || self.asked.is_some() || seen.moves {
            return;
        }
        if !self.skipped.contains(&self.step) {
            self.skipped.push(self.step);
        }
        self.enter_next(seen);
    }

    fn enter_next(&mut self, seen: &Seen) {
        self.fell_back = false;
        match self.step.beside(1) {
            Some(step) => self.enter(step, seen),
            None => self.end = Some(End::Done),
        }
    }

    /// To the step before. What was written stays.
    pub(in crate::app) fn back(&mut self, seen: &Seen) {
        if self.end.is_some() || self.asked.is_some() || seen.moves {
            return;
        }
        if let Some(step) = self.step.beside(-1) {
            self.fell_back = false;
            self.enter(step, seen);
        }
    }

    fn enter(&mut self, step: Step, seen: &Seen) {
        self.step = step;
        match step {
            Step::Jog => self.travel = Travel::default(),
            Step::PowerCycle => {
                let position = seen.actual.map(|actual| actual.position);
                self.power = Some(Power::On(Before { scale: seen.scale, limits: seen.limits, position }));
            }
            _ => {}
        }
    }

    /// It is over before its end. Whoever calls this stops the drive.
    pub(in crate::app) fn cancel(&mut self) {
        if self.end.is_none() {
            self.going = None;
            self.end = Some(End::Cancelled);
        }
    }

    /// What was asked for is under way.
    pub(in crate::app) fn begin(&mut self, ask: Ask, seen: &Seen) {
        match ask {
            Ask::Try(_) | Ask::SetPosition(_) | Ask::Save | Ask::Recall => self.asked = Some(ask),
            Ask::ConfirmLimits => self.confirmed = seen.scale.zip(seen.limits),
            Ask::PowerCycle => self.lose(),
            Ask::Move(_) | Ask::Take | Ask::Give => {}
        }
    }

    /// A test move was begun by this act.
    pub(in crate::app) fn went(&mut self, place: Place, target: i32, act: u64) {
        if let Some(outcome) = self.outcomes.get_mut(place as usize) {
            *outcome = None;
        }
        self.going = Some((place, target, act));
    }

    /// What was asked for is written and read back.
    pub(in crate::app) fn written(&mut self) {
        match self.asked.take() {
            Some(Ask::Try(values)) => {
                let scales = values.iter().any(|(number, _)| matches!(number, 154 | 156));
                if scales {
                    // Every place has another number.
                    (self.confirmed, self.reference, self.outcomes) = (None, None, [None; 3]);
                }
                self.changes.extend(values.into_iter().map(|(number, value)| Change::Parameter(number, value)));
                self.saved = false;
            }
            Some(Ask::SetPosition(position)) => {
                self.reference = Some(position);
                self.travel.forget_places();
                self.changes.push(Change::Position(position));
                self.saved = false;
            }
            Some(Ask::Save) => self.saved = true,
            Some(Ask::Recall) => {
                self.changes.clear();
                self.partly = false;
            }
            _ => {}
        }
    }

    /// What was asked for was not written; `begun`: a part of it may have been.
    pub(in crate::app) fn not_written(&mut self, begun: bool) {
        match self.asked.take() {
            Some(Ask::Try(values)) if begun => {
                self.changes.extend(values.into_iter().map(|(number, value)| Change::Parameter(number, value)));
                (self.partly, self.saved) = (true, false);
            }
            Some(Ask::SetPosition(position)) if begun => {
                self.changes.push(Change::Position(position));
                (self.partly, self.saved) = (true, false);
            }
            _ => {}
        }
    }

    /// The device has stopped answering.
    pub(in crate::app) fn lose(&mut self) {
        self.not_written(true);
        self.going = None;
        if let Some(Power::On(before)) = self.power {
            self.power = Some(Power::Gone(before));
        }
    }

    /// All parameters were read.
    pub(in crate::app) fn surveyed(&mut self, seen: &Seen) {
        if let (Some(Power::Gone(before)), Some(actual), Some(scale)) = (self.power, seen.actual, seen.scale) {
            let kept = before.scale == seen.scale && before.limits == seen.limits && seen.requested == Some(true);
            let moved = before.position.map(|own| i64::from(actual.position) - i64::from(own));
            self.power = Some(Power::Back { kept, moved, allowed: degrees(scale.steps_per_turn(), 5.0) });
        }
    }

    /// What the drive says now: how far it went, how a test move ended, whether all still holds that was made sure of.
    pub(in crate::app) fn look(&mut self, seen: &Seen) {
        if self.end.is_some() {
            return;
        }
        if self.step == Step::Jog {
            self.travel.note(seen);
        }
        if let (Some((place, target, act)), Some((ended_act, ended))) = (self.going, seen.ended)
            && act == ended_act
            && let (Some(actual), Some(scale)) = (seen.actual, seen.scale)
        {
            let allowed = degrees(scale.steps_per_turn(), 1.0);
            let outcome = Outcome { target, position: actual.position, ended, allowed };
            if let Some(place) = self.outcomes.get_mut(place as usize) {
                *place = Some(outcome);
            }
            self.going = None;
        }
        self.fall_back(seen);
    }

    /// To the first step whose result the drive does not have any more.
    fn fall_back(&mut self, seen: &Seen) {
        if !seen.connected || seen.busy || seen.stale || self.asked.is_some() || self.step == Step::PowerCycle {
            return;
        }
        let lost = |step: Step| match step {
            Step::Request => seen.requested == Some(false),
            Step::Scale => {
                let wanted = self.entries.preview(seen).ok().map(|own| own.scale);
                seen.scale.is_some() && wanted != seen.scale
            }
            Step::Confirm => seen.scale.is_some() && !self.is_confirmed(seen),
            Step::Upper => match (self.taught_limits(seen), seen.limits) {
                (Some(taught), Some(limits)) => taught != limits,
                _ => false,
            },
            _ => false,
        };
        if let Some(step) = Step::ALL.into_iter().find(|step| *step < self.step && lost(*step)) {
            self.fell_back = true;
            self.step = step;
        }
    }

    fn taught_limits(&self, seen: &Seen) -> Option<(i32, i32)> {
        let ruler = self.ruler(seen);
        Some((self.entries.lower(ruler).ok()?, self.entries.upper(ruler).ok()?))
    }
}

/// Steps of so many degrees, at least one.
fn degrees(steps_per_turn: f64, degrees: f64) -> i64 {
    (steps_per_turn * degrees / 360.0).ceil().max(1.0) as i64
}
