//! What is recorded of an encoder while it is polled: its position without the wrap, speed and acceleration.

use std::time::Duration;

use jiff::Zoned;

use crate::app::Text;
use crate::app::recorder::{self, GroupId, Line, LineId, Recorder, Scale};
use crate::device::hiperface::{PositionReading, Sample, Watch, WatchedReading};
use crate::protocol::hiperface::{Geometry, STEPS_PER_PERIOD};
use crate::signal::history::{Flags, Kind, Part};
use crate::signal::{Motion, Rates, Time, Unwrap};
use crate::units::Moment;

/// Positions that are kept: more than a day at the fastest rate.
const CAPACITY: usize = 4_000_000;
/// Nanoseconds between positions from which they are not joined, at any pace: a line would tell of a movement that nobody
/// has seen.
const APART: i64 = 5_000_000_000;
/// What a position may be late beside four intervals: a reply that was lost and asked for again.
const LATE: i64 = 400_000_000;
/// Likewise between watched values, which come more slowly.
const WATCHED_APART: i64 = APART;
/// Nanoseconds over which speed is averaged.
const WINDOW: i64 = 250_000_000;
/// Values of one watched thing that are kept.
const WATCHED: usize = 500_000;
/// Nanoseconds that are shown to begin with.
const SPAN: i64 = 30_000_000_000;

/// The recorder of an encoder, and what is needed to fill it.
#[derive(Debug)]
pub struct Record {
    /// Position, speed and acceleration as lines.
    pub recorder: Recorder,
    positions: GroupId,
    watched: Vec<Watched>,
    /// What the position words mean; `None` until the first position.
    follower: Option<Follower>,
    last: Option<PositionReading>,
    no_position: Option<Sample>,
    dropped: u64,
    /// When the clock of the first session began, and how much later that of the present one did.
    began: Option<Zoned>,
    shift: i64,
    newest: Option<Time>,
    /// Nanoseconds between two positions from which they are not joined.
    apart: i64,
}

/// A watched value and where it is recorded.
#[derive(Clone, Copy, Debug)]
struct Watched {
    what: Watch,
    group: GroupId,
    line: LineId,
}

/// Makes positions that go on from position words.
#[derive(Debug)]
struct Follower {
    geometry: Option<Geometry>,
    unwrap: Unwrap,
    motion: Motion,
}

impl Follower {
    fn new(geometry: Option<Geometry>) -> Self {
        let range = match geometry {
            Some(Geometry::Linear { .. }) => None,
            Some(Geometry::Rotary { .. }) => geometry.and_then(Geometry::range),
            // The whole word, which goes round at its end.
            None => Some(1 << 32),
        };
        let range = range.and_then(|range| i64::try_from(range).ok());
        let unwrap = range.and_then(Unwrap::rotary).unwrap_or_else(Unwrap::linear);
        Follower { geometry, unwrap, motion: Motion::over(WINDOW) }
    }
}

impl Default for Record {
    fn default() -> Self {
        Record::about(None)
    }
}

impl Record {
    /// A recorder for positions that have this meaning.
    fn about(geometry: Option<Geometry>) -> Self {
        let mut recorder = Recorder::new(SPAN);
        let columns = [Kind::Whole, Kind::Real, Kind::Real];
        let positions = recorder.add_group(&columns, CAPACITY, Some(APART));
        let [position, speed, acceleration] = scales(geometry);
        let line = |column, name, heading, scales| Line::of(positions, column, Text::new(name), heading, scales);
        recorder.add_line(line(0, "recorder.position", "position", position));
        let linear = matches!(geometry, Some(Geometry::Linear { .. }));
        let name = if linear { "recorder.speed_linear" } else { "recorder.speed" };
        recorder.add_line(line(1, name, "speed", speed).derived());
        recorder.add_line(line(2, "recorder.acceleration", "acceleration", acceleration).derived().hidden());
        Record {
            recorder,
            positions,
            watched: Vec::new(),
            follower: None,
            last: None,
            no_position: None,
            dropped: 0,
            began: None,
            shift: 0,
            newest: None,
            apart: APART,
        }
    }

    /// A session has begun. What was recorded before stays: its samples are earlier by as much as the clocks say.
    pub(super) fn begin(&mut self, began: &Zoned) {
        self.last = None;
        self.no_position = None;
        let since = self.began.get_or_insert_with(|| began.clone()).duration_until(began);
        let later = i64::try_from(since.as_nanos()).unwrap_or(0);
        // A clock of the wall may be set back.
        let behind = self.newest.map_or(0, |newest| newest.nanoseconds().saturating_add(1));
        self.shift = later.max(behind);
        self.gap();
    }

    /// Positions are wished at this interval from now on; when that begins, what was before is not joined to what comes.
    pub(super) fn poll(&mut self, interval: Option<Duration>, begins: bool) {
        let interval = interval.and_then(|interval| i64::try_from(interval.as_nanos()).ok());
        self.apart = interval.map_or(APART, |interval| interval.saturating_mul(4).saturating_add(LATE).min(APART));
        if begins {
            self.gap();
        }
    }

    pub(super) fn add(&mut self, samples: Vec<Sample>, dropped: u64, geometry: Option<Geometry>) {
        self.dropped += dropped;
        if dropped > 0 {
            self.gap();
        }
        for sample in samples {
            match sample {
                Sample::Position(reading) => {
                    self.see(geometry);
                    self.follow(&reading);
                    self.last = Some(reading);
                    self.no_position = None;
                }
                Sample::NoPosition { at, codes } => {
                    self.see(geometry);
                    let before = self.last.as_ref().map_or(0, |reading| i64::from(reading.raw));
                    self.append(self.time(at), before, Rates::default(), Flags::BAD);
                    self.lose_track();
                    self.no_position = Some(Sample::NoPosition { at, codes });
                }
                Sample::Watched(reading) => self.take_watched(&reading),
            }
        }
    }

    /// Records these values too, and no others beside the position.
    pub(super) fn watch(&mut self, wished: &[Watch]) {
        for own in std::mem::take(&mut self.watched) {
            if wished.contains(&own.what) {
                self.watched.push(own);
            } else {
                self.recorder.remove_line(own.line);
            }
        }
        for what in wished {
            if self.watched.iter().all(|own| own.what != *what) {
                let group = self.recorder.add_group(&[Kind::Whole], WATCHED, Some(WATCHED_APART));
                let line = self.recorder.add_line(line_of(*what, group));
                self.watched.push(Watched { what: *what, group, line });
            }
        }
    }

    /// What is recorded beside the position.
    pub fn watched(&self) -> Vec<Watch> {
        self.watched.iter().map(|own| own.what).collect()
    }

    fn take_watched(&mut self, reading: &WatchedReading) {
        let Some(own) = self.watched.iter().find(|own| own.what == reading.what).copied() else { return };
        let (value, mut flags) = match &reading.value {
            Ok(value) => (*value, Flags::NONE),
            Err(_) => (0, Flags::BAD),
        };
        if !reading.codes.is_empty() {
            flags |= Flags::WARNING;
        }
        let absent = reading.is_refused().then(|| Text::new("recorder.absent"));
        self.recorder.remark(own.line, absent);
        let (value, flags) = ([value], [flags]);
        let time = self.time(reading.at);
        // Each kind of value comes in the order of time; the clock of a later session begins behind the last position.
        let _ = self.recorder.append(own.group, &[time], &[Part::whole(&value).flagged(&flags)]);
    }

    /// The last position, as long as the encoder has one to give.
    pub fn last(&self) -> Option<&PositionReading> {
        self.last.as_ref().filter(|_| self.no_position.is_none())
    }

    /// The encoder has no position to give at the moment.
    pub fn refused(&self) -> bool {
        self.no_position.is_some()
    }

    /// Samples that came too fast to be recorded.
    pub fn dropped(&self) -> u64 {
        self.dropped
    }

    /// Positions that are recorded.
    pub fn positions(&self) -> u64 {
        let line = self.recorder.lines().first();
        let all = line.and_then(|line| self.recorder.history(line)).map(|history| history.all());
        all.map_or(0, |all| all.end - all.start)
    }

    /// Another encoder: nothing of what was recorded is about it.
    pub(super) fn forget(&mut self) {
        let (began, watched) = (self.began.take(), self.watched());
        *self = Record { began, ..Record::default() };
        self.watch(&watched);
    }

    /// Position words mean this from now on. What was recorded with another meaning cannot be seen in the same units.
    fn see(&mut self, geometry: Option<Geometry>) {
        if self.follower.as_ref().is_some_and(|follower| follower.geometry == geometry) {
            return;
        }
        let (began, shift, newest, dropped) = (self.began.take(), self.shift, self.newest, self.dropped);
        let apart = self.apart;
        let (watched, span) = (self.watched(), self.recorder.span());
        *self = Record { began, shift, newest, dropped, apart, ..Record::about(geometry) };
        self.recorder.act(recorder::Action::SetSpan(span));
        self.watch(&watched);
        self.follower = Some(Follower::new(geometry));
    }

    fn follow(&mut self, reading: &PositionReading) {
        let time = self.time(reading.at);
        if self.newest.is_some_and(|newest| time < newest) {
            // Read on its own between two samples that are recorded already.
            return;
        }
        if !reading.valid || self.newest.is_some_and(|newest| time.nanoseconds_since(newest) > self.apart) {
            self.lose_track();
        }
        let word = i64::from(reading.raw);
        let Some(follower) = &mut self.follower else { return };
        let Some(next) = follower.unwrap.next(word).filter(|_| reading.valid) else {
            self.lose_track();
            return self.append(time, word, Rates::default(), Flags::BAD);
        };
        if next.broken {
            follower.motion.reset();
        }
        let rates = follower.motion.next(time, next.steps);
        let mut flags = if next.broken { Flags::BREAK } else { Flags::NONE };
        if !reading.codes.is_empty() {
            flags |= Flags::WARNING;
        }
        self.append(time, next.steps, rates, flags);
    }

    /// At a time that is not before the newest; else it is left out.
    fn append(&mut self, time: Time, steps: i64, rates: Rates, flags: Flags) {
        // What is not known is no number, which breaks the line and counts nowhere.
        let (speed, acceleration) = (rates.speed.unwrap_or(f64::NAN), rates.acceleration.unwrap_or(f64::NAN));
        let (steps, speed, acceleration, flags) = ([steps], [speed], [acceleration], [flags]);
        let parts = [
            Part::whole(&steps).flagged(&flags),
            Part::real(&speed).flagged(&flags),
            Part::real(&acceleration).flagged(&flags),
        ];
        if self.recorder.append(self.positions, &[time], &parts).is_ok() {
            self.newest = Some(time);
        }
    }

    /// Samples are missing before those that come next.
    fn gap(&mut self) {
        self.recorder.break_all();
        self.lose_track();
    }

    /// How the next position goes on from the last is not known.
    fn lose_track(&mut self) {
        if let Some(follower) = &mut self.follower {
            follower.unwrap.gap();
            follower.motion.reset();
        }
    }

    fn time(&self, at: Moment) -> Time {
        Time::from(at).plus(self.shift)
    }
}

/// What a watched value is called.
pub fn watch_name(what: Watch) -> Text {
    match what {
        Watch::TEMPERATURE => Text::new("recorder.temperature"),
        Watch::Analogue(channel) => Text::new("recorder.channel").with("channel", format!("{channel:02X}h")),
        Watch::Counter => Text::new("recorder.counter"),
    }
}

/// A watched value as a line.
fn line_of(what: Watch, group: GroupId) -> Line {
    let (heading, unit) = match what {
        Watch::TEMPERATURE => ("temperature".to_owned(), "unit.celsius"),
        Watch::Analogue(channel) => (format!("analogue {channel:02X}h"), "unit.counts"),
        Watch::Counter => ("counter".to_owned(), "unit.counts"),
    };
    Line::of(group, 0, watch_name(what), heading, vec![Scale::new(unit, 1.0, 0)])
}

/// The units of position, speed and acceleration, whose samples are in steps.
fn scales(geometry: Option<Geometry>) -> [Vec<Scale>; 3] {
    match geometry {
        Some(Geometry::Linear { period_nm, .. }) => {
            let millimetres = f64::from(period_nm) / f64::from(STEPS_PER_PERIOD) * 1e-6;
            [
                vec![Scale::new("unit.millimetres", millimetres, 4), Scale::new("unit.steps", 1.0, 0)],
                vec![
                    Scale::new("unit.millimetres_per_second", millimetres, 3),
                    Scale::new("unit.metres_per_minute", millimetres * 0.06, 4),
                    Scale::new("unit.steps_per_second", 1.0, 0),
                ],
                vec![
                    Scale::new("unit.millimetres_per_second_squared", millimetres, 1),
                    Scale::new("unit.steps_per_second_squared", 1.0, 0),
                ],
            ]
        }
        Some(rotary @ Geometry::Rotary { .. }) => {
            let turns = 1.0 / rotary.steps_per_turn().unwrap_or(1) as f64;
            [
                vec![
                    Scale::new("unit.turns", turns, 5),
                    Scale::new("unit.degrees", 360.0 * turns, 3),
                    Scale::new("unit.steps", 1.0, 0),
                ],
                vec![
                    Scale::new("unit.revolutions_per_minute", 60.0 * turns, 2),
                    Scale::new("unit.degrees_per_second", 360.0 * turns, 1),
                    Scale::new("unit.steps_per_second", 1.0, 0),
                ],
                vec![
                    Scale::new("unit.revolutions_per_second_squared", turns, 3),
                    Scale::new("unit.radians_per_second_squared", std::f64::consts::TAU * turns, 2),
                    Scale::new("unit.steps_per_second_squared", 1.0, 0),
                ],
            ]
        }
        None => [
            vec![Scale::new("unit.steps", 1.0, 0)],
            vec![Scale::new("unit.steps_per_second", 1.0, 0)],
            vec![Scale::new("unit.steps_per_second_squared", 1.0, 0)],
        ],
    }
}

#[cfg(test)]
mod tests;
