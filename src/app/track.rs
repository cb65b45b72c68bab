//! The recording of a device that is being read: unwrapped position, speed, acceleration and watched values. The kind
//! of device defines what positions and values mean.

use std::time::Duration;

use jiff::{SignedDuration, Zoned};

use crate::analysis::history::{ColumnPart, Flags, Kind, Value};
use crate::analysis::{MotionRates, SampleTime};
use crate::app::closing::LONG_RECORDING_NS;
use crate::app::recorder::{self, GroupId, Recorder, SeriesId};
use crate::app::{Recording, Text};
use crate::units::Moment;

mod follower;
mod meaning;
mod watchable;

use follower::PositionTracker;
pub use meaning::PositionScales;
pub use watchable::{Watchable, WatchedValue};

/// Maximum number of positions, enough for more than a day at the highest rate of a serial line.
const CAPACITY: usize = 4_000_000;
/// Maximum interval in nanoseconds between two positions joined by a line. A longer line would suggest a motion that
/// was not observed.
const MAX_JOINED_GAP_NS: i64 = 5_000_000_000;
/// Tolerated delay of a position, in nanoseconds, on top of four intervals. A lost reply that is requested again causes
/// such a delay.
const TOLERATED_DELAY_NS: i64 = 400_000_000;
/// Maximum interval in nanoseconds between two watched values joined by a line. Watched values arrive less often than
/// positions.
const MAX_WATCHED_GAP_NS: i64 = MAX_JOINED_GAP_NS;
/// Maximum number of samples of a watched value.
const MAX_WATCHED_SAMPLES: usize = 500_000;
/// Initially displayed time span in nanoseconds.
const SPAN: i64 = 30_000_000_000;

/// Types of the columns for position, speed and acceleration.
const COLUMNS: [Kind; 3] = [Kind::Whole, Kind::Real, Kind::Real];

/// A sample that may contain a position.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PositionSample {
    pub at: Moment,
    /// Position in steps, or `None` if the device reports none.
    pub position: Option<i64>,
    /// Whether the device reports the position as invalid.
    pub is_bad: bool,
    pub is_warned: bool,
}

/// The recorder of a device, with the state needed to fill it. `W` is the type of the values that can be watched.
#[derive(Debug)]
pub struct DeviceRecorder<W> {
    pub(crate) recorder: Recorder,
    positions: GroupId,
    lines: [SeriesId; 3],
    watched: Vec<WatchedSeries<W>>,
    /// Tracker of the positions, or `None` until one has been received.
    follower: Option<PositionTracker>,
    dropped: u64,
    /// Start of the first session, from which the current session's clock is offset.
    began: Option<Zoned>,
    shift: i64,
    newest: Option<SampleTime>,
    /// Last received position.
    last: i64,
    /// Maximum interval in nanoseconds between two positions joined by a line.
    apart: i64,
}

#[derive(Clone, Debug)]
struct WatchedSeries<W> {
    value: W,
    group: GroupId,
    line: SeriesId,
    /// Whether the value is being recorded. Otherwise only its earlier samples are kept.
    active: bool,
}

impl<W: Watchable> Recording for DeviceRecorder<W> {
    fn recorder(&self) -> &Recorder {
        &self.recorder
    }

    fn recorder_mut(&mut self) -> &mut Recorder {
        &mut self.recorder
    }

    fn dropped_count(&self) -> u64 {
        self.dropped
    }

    fn poll(&mut self, interval: Option<Duration>, begins: bool) {
        DeviceRecorder::poll(self, interval, begins);
    }
}

#[derive(Debug, Default)]
struct Columns {
    times: Vec<SampleTime>,
    steps: Vec<i64>,
    speed: Vec<f64>,
    acceleration: Vec<f64>,
    flags: Vec<Flags>,
}

impl Columns {
    fn push(&mut self, time: SampleTime, steps: i64, rates: MotionRates, flags: Flags) {
        self.times.push(time);
        self.steps.push(steps);
        // An unknown speed is NaN. It interrupts the line and is excluded from statistics.
        self.speed.push(rates.speed.unwrap_or(f64::NAN));
        self.acceleration.push(rates.acceleration.unwrap_or(f64::NAN));
        self.flags.push(flags);
    }
}

impl<W: Watchable> Default for DeviceRecorder<W> {
    fn default() -> Self {
        DeviceRecorder::new(&PositionScales::for_steps(None))
    }
}

impl<W: Watchable> DeviceRecorder<W> {
    fn new(meaning: &PositionScales) -> Self {
        let mut recorder = Recorder::new(SPAN);
        let positions = recorder.add_group(&COLUMNS, CAPACITY, Some(MAX_JOINED_GAP_NS));
        let lines = meaning.create_series(positions).map(|line| recorder.add_line(line));
        DeviceRecorder {
            recorder,
            positions,
            lines,
            watched: Vec::new(),
            follower: None,
            dropped: 0,
            began: None,
            shift: 0,
            newest: None,
            last: 0,
            apart: MAX_JOINED_GAP_NS,
        }
    }

    /// Begins a session. Earlier recordings are kept, and the times of new samples are shifted to continue them.
    pub fn begin_session(&mut self, began: &Zoned) {
        let since = self.began.get_or_insert_with(|| began.clone()).duration_until(began);
        let later = i64::try_from(since.as_nanos()).unwrap_or(0);
        // The system clock may have been set back.
        let behind = self.newest.map_or(0, |newest| newest.as_nanoseconds().saturating_add(1));
        self.shift = later.max(behind);
        self.mark_gap();
    }

    pub fn scales(&self) -> Option<&PositionScales> {
        self.follower.as_ref().map(|own| &own.meaning)
    }

    /// Sets the polling interval. Positions before and after a start of polling are not joined.
    pub fn poll(&mut self, interval: Option<Duration>, begins: bool) {
        let interval = interval.and_then(|interval| i64::try_from(interval.as_nanos()).ok());
        self.apart = interval.map_or(MAX_JOINED_GAP_NS, |interval| {
            interval.saturating_mul(4).saturating_add(TOLERATED_DELAY_NS).min(MAX_JOINED_GAP_NS)
        });
        if begins {
            self.mark_gap();
        }
    }

    /// Counts dropped samples and marks a gap.
    pub fn record_dropped(&mut self, dropped: u64) {
        self.dropped += dropped;
        if dropped > 0 {
            self.mark_gap();
        }
    }

    pub fn add_positions(&mut self, sightings: &[PositionSample], meaning: &PositionScales) {
        self.set_scales(meaning);
        let mut columns = Columns::default();
        for sighting in sightings {
            self.add_sample(sighting, &mut columns);
        }
        let flags = &columns.flags;
        let parts = [
            ColumnPart::from_integers(&columns.steps).with_flags(flags),
            ColumnPart::from_reals(&columns.speed).with_flags(flags),
            ColumnPart::from_reals(&columns.acceleration).with_flags(flags),
        ];
        // This cannot fail, because the times are in order and none is before the newest one.
        let _ = self.recorder.append(self.positions, &columns.times, &parts);
    }

    fn add_sample(&mut self, sighting: &PositionSample, columns: &mut Columns) {
        let time = SampleTime::from(sighting.at).saturating_add_ns(self.shift);
        if self.newest.is_some_and(|newest| time < newest) {
            // This is a single reading, taken between two samples that are already recorded.
            return;
        }
        self.newest = Some(time);
        let Some(word) = sighting.position else {
            // The frame is damaged. The positions before and after it may still be joined.
            if let Some(follower) = &mut self.follower {
                follower.record_missing_sample();
            }
            return columns.push(time, self.last, MotionRates::default(), Flags::BAD);
        };
        if sighting.is_bad || self.follower.as_ref().is_some_and(|own| !own.is_contiguous_with_last(time, self.apart)) {
            self.reset_tracking();
        }
        self.last = word;
        let Some(follower) = &mut self.follower else { return };
        let Some((next, rates)) = follower.next(time, word).filter(|_| !sighting.is_bad) else {
            self.reset_tracking();
            return columns.push(time, word, MotionRates::default(), Flags::BAD);
        };
        let mut flags = if next.broken { Flags::BREAK } else { Flags::NONE };
        if sighting.is_warned {
            flags |= Flags::WARNING;
        }
        columns.push(time, next.steps, rates, flags);
    }

    /// Selects the values to record in addition to the position. Earlier recordings of other values are kept.
    pub fn set_watched(&mut self, watched: &[W]) {
        let mut kept = Vec::new();
        for mut own in std::mem::take(&mut self.watched) {
            if !own.active || watched.iter().any(|what| own.value.can_continue_as(what)) {
                kept.push(own);
            } else if self.recorder.has_samples(own.line) {
                self.end_series(own.line);
                own.active = false;
                kept.push(own);
            } else {
                self.recorder.remove_line(own.line);
            }
        }
        // The lines of values that are no longer recorded are gone if the recording was cleared.
        kept.retain(|own| self.recorder.series_by_id(own.line).is_some());
        self.watched = kept;
        watched.iter().for_each(|what| self.begin_watching(what));
    }

    fn begin_watching(&mut self, what: &W) {
        let Some(own) = self.watched.iter_mut().find(|own| own.value.can_continue_as(what)) else {
            let kind = if what.is_whole() { Kind::Whole } else { Kind::Real };
            let group = self.recorder.add_group(&[kind], MAX_WATCHED_SAMPLES, Some(MAX_WATCHED_GAP_NS));
            let line = self.recorder.add_line(what.create_series(group));
            return self.watched.push(WatchedSeries { value: what.clone(), group, line, active: true });
        };
        let goes_on = std::mem::replace(&mut own.active, true);
        if goes_on && own.value == *what {
            return;
        }
        own.value = what.clone();
        let line = what.create_series(own.group);
        if !goes_on {
            self.recorder.resume_line(own.line, line.name.clone(), line.heading.clone());
        }
        self.recorder.set_scales(own.line, line.scales().to_vec());
    }

    pub fn watched_values(&self) -> Vec<W> {
        self.watched.iter().filter(|own| own.active).map(|own| own.value.clone()).collect()
    }

    pub fn add_watched(&mut self, what: &W, watching: &WatchedValue) {
        let Some(own) = self.watched.iter().find(|own| own.active && own.value == *what) else { return };
        let (group, line) = (own.group, own.line);
        let mut flags = if watching.value.is_some() { Flags::NONE } else { Flags::BAD };
        if watching.is_warned {
            flags |= Flags::WARNING;
        }
        self.recorder.set_remark(line, watching.never.clone());
        let (time, flags) = (self.time(watching.at), [flags]);
        let (whole, real) = match watching.value {
            Some(Value::Whole(whole)) => ([whole], [whole as f64]),
            Some(Value::Real(real)) => ([real as i64], [real]),
            None => ([0], [f64::NAN]),
        };
        let part = if what.is_whole() { ColumnPart::from_integers(&whole) } else { ColumnPart::from_reals(&real) };
        // This cannot fail. The samples of a value arrive in chronological order, and the clock of a later session
        // starts after the last position.
        let _ = self.recorder.append(group, &[time], &[part.with_flags(&flags)]);
    }

    /// Returns the number of samples that arrived too fast to be recorded.
    pub fn dropped_count(&self) -> u64 {
        self.dropped
    }

    pub fn position_count(&self) -> u64 {
        let [line, ..] = self.lines;
        let all = self
            .recorder
            .series_by_id(line)
            .and_then(|line| self.recorder.history(line))
            .map(|history| history.indices());
        all.map_or(0, |all| all.end - all.start)
    }

    /// Discards the recording of the previous device, unless it contains minutes of unexported data. The selected
    /// values are kept.
    pub fn discard_short_recording(&mut self) {
        let watched = self.watched_values();
        if self.recorder.unexported_duration() >= LONG_RECORDING_NS {
            self.set_watched(&[]);
            self.watched.clear();
            self.replace_series(&PositionScales::for_steps(None));
            self.follower = None;
        } else {
            let (began, shift, apart) = (self.began.take(), self.shift, self.apart);
            *self = DeviceRecorder { began, shift, apart, ..DeviceRecorder::default() };
        }
        self.set_watched(&watched);
    }

    /// Prepares for decoding the last `kept` position words again, with the same times. If older words are no longer
    /// stored, the old recording is kept as well.
    pub fn prepare_redecoding(&mut self, kept: usize) {
        if usize::try_from(self.position_count()).is_ok_and(|own| own > kept) {
            self.replace_series(&PositionScales::for_steps(None));
            (self.follower, self.newest) = (None, None);
            return;
        }
        let (began, shift, apart, span) = (self.began.take(), self.shift, self.apart, self.recorder.window_length());
        *self = DeviceRecorder { began, shift, apart, ..DeviceRecorder::default() };
        self.recorder.handle_action(recorder::RecorderAction::SetSpan(span));
    }

    /// Sets the scales of the following positions. If they no longer apply to the same positions, the lines end.
    fn set_scales(&mut self, meaning: &PositionScales) {
        if let Some(own) = self.follower.as_mut().filter(|own| own.meaning.is_same_location(meaning)) {
            if own.meaning != *meaning {
                own.meaning = meaning.clone();
                let lines = self.lines.into_iter().zip(meaning.scales.clone());
                lines.for_each(|(line, scales)| self.recorder.set_scales(line, scales));
            }
            return;
        }
        self.replace_series(meaning);
        self.follower = Some(PositionTracker::new(meaning.clone()));
    }

    /// Replaces the lines with new ones on the given scales.
    fn replace_series(&mut self, meaning: &PositionScales) {
        let has_samples = self.position_count() > 0;
        let group = self.recorder.add_group(&COLUMNS, CAPACITY, Some(MAX_JOINED_GAP_NS));
        let before = self.lines;
        let mut lines = meaning.create_series(group).into_iter().zip(before);
        self.lines = before.map(|old| {
            let Some((line, _)) = lines.next() else { return old };
            let name = self.ended_line_name(old);
            let new = self.recorder.replace_line(old, line, name);
            if !has_samples {
                self.recorder.remove_line(old);
            }
            new
        });
        self.positions = group;
    }

    fn end_series(&mut self, line: SeriesId) {
        let (name, heading) = self.ended_line_name(line);
        self.recorder.end_line(line, name, heading);
    }

    /// Returns the name and heading of a line that is about to end.
    fn ended_line_name(&self, line: SeriesId) -> (Text, String) {
        let newest = self.newest.map_or(0, SampleTime::as_nanoseconds);
        let until = self.began.as_ref().and_then(|own| own.checked_add(SignedDuration::from_nanos(newest)).ok());
        let until =
            until.map_or_else(|| format!("{:.1} s", newest as f64 / 1e9), |at| at.strftime("%H:%M:%S").to_string());
        let (name, heading) = match self.recorder.series_by_id(line) {
            Some(line) => (line.name.clone(), line.heading.clone()),
            None => (Text::new("recorder.position"), String::new()),
        };
        (Text::new("recorder.until").with_text("name", name).with("time", &until), format!("{heading} until {until}"))
    }

    pub fn mark_gap(&mut self) {
        self.recorder.mark_gap_in_all_groups();
        self.reset_tracking();
    }

    fn reset_tracking(&mut self) {
        if let Some(follower) = &mut self.follower {
            follower.reset_tracking();
        }
    }

    fn time(&self, at: Moment) -> SampleTime {
        SampleTime::from(at).saturating_add_ns(self.shift)
    }
}

#[cfg(test)]
mod tests;
