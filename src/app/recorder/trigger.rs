//! The trigger, which waits for an event in a line and then displays the samples around it.

use super::line::within_range;
use super::{GroupId, Recorder, SeriesId, TimeWindow};
use crate::analysis::SampleTime;
use crate::analysis::history::{Flags, Sample};

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TriggerCondition {
    Above,
    Below,
    Rising,
    Falling,
    /// The device marks a sample as invalid or with a warning.
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

    pub const fn needs_level(self) -> bool {
        !matches!(self, TriggerCondition::Error)
    }
}

/// A trigger: its condition and the range to display around the event.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Trigger {
    pub line: SeriesId,
    pub when: TriggerCondition,
    pub level: f64,
    /// Fraction of the view that lies before the event, from 0 to 1.
    pub before: f64,
    /// Whether the trigger waits for another event after each view. Otherwise the view is held.
    pub repeat: bool,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TriggerState {
    /// The trigger waits for the event.
    Armed,
    /// The event occurred at this time, and the samples after it are still being recorded.
    Fired(SampleTime),
    /// The event occurred at this time, and the view is complete.
    Held(SampleTime),
    /// The recording ended without the event.
    Missed,
}

#[derive(Clone, Copy, Debug)]
pub(super) struct TriggerDetector {
    trigger: Trigger,
    when: TriggerCondition,
    level: f64,
    state: TriggerState,
    /// Range after which the values of the line wrap to 0, if any.
    range: Option<i64>,
    /// Last valid value, which is needed to detect an edge, or `None` after a gap.
    last: Option<f64>,
    /// Duration of the view in nanoseconds.
    span: i64,
}

impl TriggerDetector {
    pub(super) fn trigger(&self) -> &Trigger {
        &self.trigger
    }

    pub(super) fn rearmed(self) -> Self {
        TriggerDetector { state: TriggerState::Armed, last: None, ..self }
    }

    fn event_window(&self, at: SampleTime) -> (SampleTime, SampleTime) {
        let from = at.saturating_add_ns(-((self.span as f64 * self.trigger.before) as i64));
        (from, from.saturating_add_ns(self.span))
    }

    /// Checks the next sample and returns whether the event has occurred.
    fn check_trigger(&mut self, sample: &Sample) -> bool {
        let bad = sample.flags.contains(Flags::BAD);
        let value = Some(sample.value.to_f64()).filter(|value| !bad && value.is_finite());
        // An edge across a gap was not observed.
        let last = self.last.filter(|_| !sample.flags.contains(Flags::BREAK));
        self.last = value;
        let level = self.level;
        let shown = within_range(sample.value, self.range);
        match (self.when, last, value) {
            (TriggerCondition::Error, ..) => bad || sample.flags.contains(Flags::WARNING),
            (TriggerCondition::Above, _, Some(_)) => shown >= level,
            (TriggerCondition::Below, _, Some(_)) => shown <= level,
            (TriggerCondition::Rising, Some(last), Some(value)) => self.passes(last, value),
            (TriggerCondition::Falling, Some(last), Some(value)) => self.passes(-last, -value),
            _ => false,
        }
    }

    /// Returns whether the value reaches or crosses the level between `last` and `value` while rising. For a falling
    /// edge, the caller inverts both signs. Values with a range cross the level once per range. The step from the end
    /// of the range to 0 is not an edge.
    fn passes(&self, last: f64, value: f64) -> bool {
        let level = if self.when == TriggerCondition::Falling { -self.level } else { self.level };
        match self.range {
            None => last < level && value >= level,
            Some(range) => {
                let count = |own: f64| ((own - level) / range as f64).floor();
                count(value) > count(last)
            }
        }
    }
}

impl Recorder {
    pub fn trigger(&self) -> Option<(&Trigger, TriggerState)> {
        self.watch.as_ref().map(|watch| (&watch.trigger, watch.state))
    }

    pub(super) fn arm_trigger(&mut self, trigger: Trigger) {
        let Some(line) = self.series_by_id(trigger.line) else { return };
        let (factor, range) = (line.factor(), line.sample_wrap_range());
        let level = trigger.level / factor;
        if trigger.when.needs_level() && !level.is_finite() {
            return;
        }
        // In a unit that inverts the sign, a rising edge is a falling one.
        let when = match trigger.when {
            TriggerCondition::Above if factor < 0.0 => TriggerCondition::Below,
            TriggerCondition::Below if factor < 0.0 => TriggerCondition::Above,
            TriggerCondition::Rising if factor < 0.0 => TriggerCondition::Falling,
            TriggerCondition::Falling if factor < 0.0 => TriggerCondition::Rising,
            when => when,
        };
        let before = if trigger.before.is_finite() { trigger.before.clamp(0.0, 1.0) } else { 0.5 };
        let trigger = Trigger { before, ..trigger };
        let span = self.window_length();
        self.watch =
            Some(TriggerDetector { trigger, when, level, state: TriggerState::Armed, range, last: None, span });
        if self.finished {
            self.search();
        } else {
            self.view = TimeWindow::Follow { span };
        }
    }

    /// Searches the recorded samples for the first event.
    fn search(&mut self) {
        let Some(mut watch) = self.watch else { return };
        let Some(line) = self.series_by_id(watch.trigger.line) else { return };
        let (Some(history), column) = (self.history(line), line.column) else { return };
        let found = history.indices().find_map(|index| {
            let sample = history.sample(column, index)?;
            watch.check_trigger(&sample).then_some(sample.time)
        });
        watch.state = found.map_or(TriggerState::Missed, TriggerState::Held);
        self.watch = Some(watch);
        if let Some(at) = found {
            let (from, to) = watch.event_window(at);
            self.view = TimeWindow::Fixed { from, to };
        }
    }

    /// Returns whether new samples in a group would displace samples of a held view.
    pub(super) fn would_evict_held_view(&self, group: GroupId, more: usize) -> bool {
        let Some(watch) = self.watch else { return false };
        let (TriggerState::Held(at), Some(group)) = (watch.state, self.groups.get(&group)) else { return false };
        let history = &group.history;
        let Some(oldest) = history.time(history.indices().start) else { return false };
        // Samples before the view may be displaced.
        let remains = history.oldest_remaining_time(more);
        remains != Some(oldest) && remains.is_none_or(|remains| remains > watch.event_window(at).0)
    }

    pub(super) fn disarm(&mut self) {
        self.watch = None;
    }

    /// Searches the new samples of a group, starting at `from`.
    pub(super) fn find_trigger(&mut self, group: GroupId, from: u64) {
        let Some(mut watch) = self.watch else { return };
        let Some(line) = self.series_by_id(watch.trigger.line).filter(|line| line.group == group) else { return };
        let (Some(history), column) = (self.history(line), line.column) else { return };
        let mut shown = None;
        for index in from..history.indices().end {
            let Some(sample) = history.sample(column, index) else { continue };
            if let TriggerState::Fired(at) = watch.state
                && sample.time >= watch.event_window(at).1
            {
                watch.state = if watch.trigger.repeat { TriggerState::Armed } else { TriggerState::Held(at) };
                shown = Some(at);
            }
            // Every sample is checked, so an edge in the first sample after a view is detected as well.
            if watch.check_trigger(&sample) && watch.state == TriggerState::Armed {
                watch.state = TriggerState::Fired(sample.time);
                // A repeating trigger displays its view only when it is complete, because the next event would replace
                // an incomplete one.
                shown = if watch.trigger.repeat { shown } else { Some(sample.time) };
            }
        }
        self.watch = Some(watch);
        if let Some(at) = shown {
            let (from, to) = watch.event_window(at);
            self.view = TimeWindow::Fixed { from, to };
        }
    }
}
