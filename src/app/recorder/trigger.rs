//! The trigger: waits for an event in a line and shows it together with the samples before it.

use super::{GroupId, Recorder, SeriesId, TimeWindow};
use crate::analysis::SampleTime;
use crate::analysis::history::{Flags, Sample};

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TriggerCondition {
    Above,
    Below,
    Rising,
    Falling,
    /// A sample that the device marks as bad or with a warning.
    Error,
}

impl TriggerCondition {
    pub const ALL: [TriggerCondition; 5] = [
        TriggerCondition::Rising,
        TriggerCondition::Falling,
        TriggerCondition::Above,
        TriggerCondition::Below,
        TriggerCondition::Error,
    ];

    pub const fn has_level(self) -> bool {
        !matches!(self, TriggerCondition::Error)
    }
}

/// A trigger with its condition and the range displayed around the event.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Trigger {
    pub line: SeriesId,
    pub when: TriggerCondition,
    pub level: f64,
    /// Fraction of the view before the event, from 0 to 1.
    pub before: f64,
    /// Whether to wait again after each view instead of holding it.
    pub repeat: bool,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TriggerState {
    /// Waiting for the event.
    Armed,
    /// The event occurred at this time, and later samples are still being recorded.
    Fired(SampleTime),
    /// The event occurred at this time, and the view is complete.
    Held(SampleTime),
    /// The event did not occur in a complete recording.
    Missed,
}

#[derive(Clone, Copy, Debug)]
pub(super) struct Watch {
    trigger: Trigger,
    when: TriggerCondition,
    level: f64,
    state: TriggerState,
    /// Last valid value, required to detect an edge; `None` after a break.
    last: Option<f64>,
    /// Nanoseconds of the picture.
    span: i64,
}

impl Watch {
    pub(super) fn trigger(&self) -> &Trigger {
        &self.trigger
    }

    pub(super) fn again(self) -> Self {
        Watch { state: TriggerState::Armed, last: None, ..self }
    }

    fn window(&self, at: SampleTime) -> (SampleTime, SampleTime) {
        let from = at.plus(-((self.span as f64 * self.trigger.before) as i64));
        (from, from.plus(self.span))
    }

    /// Checks the next sample and returns whether the event has occurred.
    fn check_trigger(&mut self, sample: &Sample) -> bool {
        let bad = sample.flags.contains(Flags::BAD);
        let value = Some(sample.value.to_f64()).filter(|value| !bad && value.is_finite());
        // Across a gap no edge was observed.
        let last = self.last.filter(|_| !sample.flags.contains(Flags::BREAK));
        self.last = value;
        let level = self.level;
        match (self.when, last, value) {
            (TriggerCondition::Error, ..) => bad || sample.flags.contains(Flags::WARNING),
            (TriggerCondition::Above, _, Some(value)) => value >= level,
            (TriggerCondition::Below, _, Some(value)) => value <= level,
            (TriggerCondition::Rising, Some(last), Some(value)) => last < level && value >= level,
            (TriggerCondition::Falling, Some(last), Some(value)) => last > level && value <= level,
            _ => false,
        }
    }
}

impl Recorder {
    pub fn trigger(&self) -> Option<(&Trigger, TriggerState)> {
        self.watch.as_ref().map(|watch| (&watch.trigger, watch.state))
    }

    pub(super) fn arm(&mut self, trigger: Trigger) {
        let Some(factor) = self.line(trigger.line).map(super::Series::factor) else { return };
        let level = trigger.level / factor;
        if trigger.when.has_level() && !level.is_finite() {
            return;
        }
        // In a unit that counts in the opposite direction, rising is falling.
        let when = match trigger.when {
            TriggerCondition::Above if factor < 0.0 => TriggerCondition::Below,
            TriggerCondition::Below if factor < 0.0 => TriggerCondition::Above,
            TriggerCondition::Rising if factor < 0.0 => TriggerCondition::Falling,
            TriggerCondition::Falling if factor < 0.0 => TriggerCondition::Rising,
            when => when,
        };
        let before = if trigger.before.is_finite() { trigger.before.clamp(0.0, 1.0) } else { 0.5 };
        let trigger = Trigger { before, ..trigger };
        let span = self.span();
        self.watch = Some(Watch { trigger, when, level, state: TriggerState::Armed, last: None, span });
        if self.finished {
            self.search();
        } else {
            self.view = TimeWindow::Follow { span };
        }
    }

    /// Searches the recorded samples for the first event.
    fn search(&mut self) {
        let Some(mut watch) = self.watch else { return };
        let Some(line) = self.line(watch.trigger.line) else { return };
        let (Some(history), column) = (self.history(line), line.column) else { return };
        let found = history.all().find_map(|index| {
            let sample = history.sample(column, index)?;
            watch.check_trigger(&sample).then_some(sample.time)
        });
        watch.state = found.map_or(TriggerState::Missed, TriggerState::Held);
        self.watch = Some(watch);
        if let Some(at) = found {
            let (from, to) = watch.window(at);
            self.view = TimeWindow::Fixed { from, to };
        }
    }

    /// Returns whether adding samples to a group would evict samples from a held view.
    pub(super) fn would_discard_picture(&self, group: GroupId, more: usize) -> bool {
        let Some(watch) = self.watch else { return false };
        let (TriggerState::Held(at), Some(group)) = (watch.state, self.groups.get(&group)) else { return false };
        let history = &group.history;
        let Some(oldest) = history.time(history.all().start) else { return false };
        // Samples that are evicted from before the view are not needed.
        let remains = history.oldest_after(more);
        remains != Some(oldest) && remains.is_none_or(|remains| remains > watch.window(at).0)
    }

    pub(super) fn disarm(&mut self) {
        self.watch = None;
    }

    /// Searches the new samples of a group, starting at `from`.
    pub(super) fn find_trigger(&mut self, group: GroupId, from: u64) {
        let Some(mut watch) = self.watch else { return };
        let Some(line) = self.line(watch.trigger.line).filter(|line| line.group == group) else { return };
        let (Some(history), column) = (self.history(line), line.column) else { return };
        let mut shown = None;
        for index in from..history.all().end {
            let Some(sample) = history.sample(column, index) else { continue };
            if let TriggerState::Fired(at) = watch.state
                && sample.time >= watch.window(at).1
            {
                watch.state = if watch.trigger.repeat { TriggerState::Armed } else { TriggerState::Held(at) };
                shown = Some(at);
            }
            // Each sample is checked, so that an edge is also seen in the first one after a view.
            if watch.check_trigger(&sample) && watch.state == TriggerState::Armed {
                watch.state = TriggerState::Fired(sample.time);
                // A repeated one is shown when it is complete: otherwise it would never be seen whole.
                shown = if watch.trigger.repeat { shown } else { Some(sample.time) };
            }
        }
        self.watch = Some(watch);
        if let Some(at) = shown {
            let (from, to) = watch.window(at);
            self.view = TimeWindow::Fixed { from, to };
        }
    }
}
