//! Progress of the set-up: how it responds to buttons, completed writes and data from the drive.

use super::entries::{LengthEntries, format_steps};
use super::standstill::PositionChange;
use super::supply::Power;
use super::{
    Axis, AxisChange, AxisStep, ConfirmedLimits, DriveFacts, DriveRequest, JogTravel, Outcome, RunSummary, SetupEnd,
    TestTarget,
};
use crate::devices::hiperdrive::protocol::drive_parameter::{LOWER_LIMIT, REFERENCE, UPPER_LIMIT};

impl Axis {
    pub(crate) fn set_entries(&mut self, entries: LengthEntries) {
        if self.over.is_none() {
            self.entries = entries;
        }
    }

    /// Takes the current position as the limit that this step sets.
    pub(crate) fn adopt_limit(&mut self, seen: &DriveFacts) {
        if self.check_can_adopt_position(seen).is_err() {
            return;
        }
        let Some((ruler, position)) = seen.ruler().zip(seen.position) else { return };
        let Some(text) = format_steps(ruler, position) else { return };
        match self.step {
            AxisStep::Lower => self.entries.lower = text,
            AxisStep::Upper => self.entries.upper = text,
            _ => {}
        }
    }

    /// Goes to the next step if the current step is complete. `when` is the date and time for the report.
    pub(crate) fn next_step(&mut self, seen: &DriveFacts, when: &str) {
        if self.over.is_none() && self.check_can_continue(seen).is_ok() {
            self.leave_step(seen, false, when);
        }
    }

    pub(crate) fn skip_step(&mut self, seen: &DriveFacts, when: &str) {
        if self.over.is_none() && self.can_skip(seen) {
            self.leave_step(seen, true, when);
        }
    }

    fn leave_step(&mut self, seen: &DriveFacts, skipped: bool, when: &str) {
        // The value that was just confirmed may differ from the earlier one.
        self.reconcile_results(seen);
        if self.invalidated_step().is_some() {
            return;
        }
        if self.step == AxisStep::Reference {
            // The user has set or confirmed the reference.
            self.unexplained = None;
        }
        let next = self.step.step_by(1);
        if self.chain.record(self.step, self.preconditions(seen), skipped)
            && let Some(next) = next
        {
            self.discard_results_since(next, next == AxisStep::Upper);
        }
        match next {
            Some(step) => self.enter(step, seen),
            None => self.record_end(SetupEnd::Done, seen, when),
        }
    }

    /// Goes to the previous step or, if a step must be repeated, to that step. Written values are kept.
    pub(crate) fn go_back(&mut self, seen: &DriveFacts) {
        if self.over.is_some() || !self.can_go_back(seen) {
            return;
        }
        if let Some(step) = self.invalidated_step().or_else(|| self.step.step_by(-1)) {
            self.enter(step, seen);
        }
    }

    fn enter(&mut self, step: AxisStep, seen: &DriveFacts) {
        self.step = step;
        if step == AxisStep::PowerCycle {
            self.power = Some(Power::from_facts(seen));
        }
    }

    pub(crate) fn cancel(&mut self, seen: &DriveFacts, when: &str) {
        if self.over.is_none() {
            self.going = None;
            self.record_end(SetupEnd::Cancelled, seen, when);
        }
    }

    fn record_end(&mut self, end: SetupEnd, seen: &DriveFacts, when: &str) {
        self.over = Some(RunSummary { end, when: when.to_owned(), seen: Box::new(seen.clone()) });
    }

    pub(crate) fn begin_request(&mut self, ask: DriveRequest, seen: &DriveFacts) {
        match ask {
            DriveRequest::Try(_) | DriveRequest::SetPosition(_) | DriveRequest::Save | DriveRequest::Restore(_) => {
                self.asked = Some(ask)
            }
            DriveRequest::ConfirmLimits => {
                let confirmed =
                    |limits| ConfirmedLimits { scale: seen.scale, seen: limits, agreed: limits, begun: None };
                self.confirmed = seen.limits.map(confirmed);
            }
            DriveRequest::PowerCycle => self.handle_connection_loss(),
            DriveRequest::BelieveRestart => self.power = self.power.map(Power::confirmed_by_user),
            DriveRequest::Move(_) | DriveRequest::Take | DriveRequest::Give | DriveRequest::Acknowledge => {}
        }
    }

    /// Records that the given action has started a test move.
    pub(crate) fn record_test_move_start(&mut self, place: TestTarget, target: i32, act: u64) {
        if let Some(outcome) = self.outcomes.get_mut(place as usize) {
            *outcome = None;
        }
        self.going = Some((place, target, act));
    }

    pub(crate) fn mark_written(&mut self) {
        match self.asked.take() {
            Some(DriveRequest::Try(values)) => {
                self.record_confirmed_limits(&values, true);
                self.changes.extend(values.into_iter().map(|(number, value)| AxisChange::Parameter(number, value)));
                // The value that marks the restart is never saved.
                self.saved &= self.step == AxisStep::PowerCycle;
                self.returned.clear();
            }
            Some(DriveRequest::SetPosition(position)) => {
                self.sets = Some(position);
                self.changes.push(AxisChange::Position(position));
                self.saved = false;
                self.returned.clear();
            }
            Some(DriveRequest::Save) => (self.saved, self.partly) = (true, false),
            Some(DriveRequest::Restore(values)) => {
                self.changes.retain(|change| matches!(change, AxisChange::Position(_)));
                (self.partly, self.returned) = (false, values);
            }
            _ => {}
        }
    }

    /// Records that the user has confirmed the limits by approving a plan that writes them.
    fn record_confirmed_limits(&mut self, values: &[(u16, i64)], whole: bool) {
        let value = |own: u16| {
            let (_, value) = values.iter().find(|(number, _)| *number == own)?;
            i32::try_from(*value).ok()
        };
        match (&mut self.confirmed, value(LOWER_LIMIT).zip(value(UPPER_LIMIT))) {
            (Some(confirmed), Some(limits)) if self.step == AxisStep::Upper => match whole {
                true => (confirmed.agreed, confirmed.begun) = (limits, None),
                false => confirmed.begun = Some(limits),
            },
            (confirmed, Some(_)) => *confirmed = None,
            _ => {}
        }
    }

    /// Records that a request was not completed. If `begun` is set, part of it may have been written.
    pub(crate) fn handle_write_failure(&mut self, begun: bool) {
        match self.asked.take() {
            Some(DriveRequest::Try(values)) if begun => {
                self.record_confirmed_limits(&values, false);
                self.changes.extend(values.into_iter().map(|(number, value)| AxisChange::Parameter(number, value)));
                // The value that marks the restart is never saved. All other values are as saved.
                if self.step != AxisStep::PowerCycle {
                    (self.partly, self.saved) = (true, false);
                }
            }
            Some(DriveRequest::SetPosition(position)) if begun => {
                self.changes.push(AxisChange::Position(position));
                (self.partly, self.saved) = (true, false);
            }
            Some(DriveRequest::Restore(_) | DriveRequest::Save) if begun => self.partly = true,
            _ => {}
        }
    }

    pub(crate) fn handle_connection_loss(&mut self) {
        self.handle_write_failure(true);
        self.going = None;
        match self.power {
            Some(_) => self.standstill.discard(),
            None => self.standstill.interrupt(),
        }
        self.power = self.power.map(Power::after_power_off);
    }

    /// Records that all parameters were read. `switched` is set if the virtual supply has been switched since the last
    /// reading.
    pub(crate) fn on_survey(&mut self, seen: &DriveFacts, switched: bool) {
        self.power = self.power.map(|power| power.after_survey(seen, switched));
    }

    /// Processes current data from the drive: updates the jogged distance, ends a test move, and checks the validity of
    /// all results.
    pub(crate) fn update(&mut self, seen: &DriveFacts) {
        if self.over.is_some() {
            return;
        }
        if self.step == AxisStep::Jog {
            self.travel.add_position(seen);
        }
        self.power = self.power.map(|power| power.with_latest_values(seen));
        if let (Some((place, target, act)), Some((ended_act, ended))) = (self.going, seen.ended)
            && act == ended_act
            && let (Some(position), Some(scale)) = (seen.position, seen.scale)
        {
            let allowed = scale.degrees_to_steps(1.0).into();
            let outcome = Outcome { target, position, ended, allowed };
            if let Some(place) = self.outcomes.get_mut(place as usize) {
                *place = Some(outcome);
            }
            self.going = None;
        }
        self.reconcile_results(seen);
    }

    /// Discards results that no longer match the drive, and records a new reference once the drive reports it.
    fn reconcile_results(&mut self, seen: &DriveFacts) {
        if !seen.is_settled() || self.asked.is_some() {
            return;
        }
        match self.standstill.check_reading(seen, self.position_origin(seen)) {
            Some(PositionChange::Jump) => self.jumps += 1,
            Some(PositionChange::Unexplained(way)) if self.chain.is_complete(AxisStep::Reference) => {
                self.unexplained = Some(self.unexplained.unwrap_or_default() + way);
            }
            _ => {}
        }
        if let Some(step) = self.chain.discard_outdated(&self.preconditions(seen)) {
            self.discard_results_since(step, false);
        }
        let is_set = |position: &i32| seen.values.get(&REFERENCE) == Some(&i64::from(*position));
        if let Some(position) = self.sets.filter(is_set) {
            (self.sets, self.reference) = (None, Some((position, self.position_origin(seen))));
        }
    }

    /// Discards the results of this step and all later ones. Taught limits are kept if `taught` is set.
    fn discard_results_since(&mut self, step: AxisStep, taught: bool) {
        if step <= AxisStep::Confirm {
            self.confirmed = None;
        }
        if step <= AxisStep::Jog {
            self.travel = JogTravel::default();
        }
        if step <= AxisStep::Reference {
            (self.reference, self.unexplained) = (None, None);
        }
        if step <= AxisStep::Lower && !taught {
            (self.entries.lower, self.entries.upper) = (String::new(), String::new());
        }
        (self.outcomes, self.going) = ([None; 3], None);
        self.saved = false;
        if self.step != AxisStep::PowerCycle {
            self.power = None;
        }
    }
}
