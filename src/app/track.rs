//! What is recorded of a device while it is read: its position without the wrap, speed and acceleration, and the values
//! that are watched beside it. It knows no device: what a position means, and what a watched value is, is said by its kind.

use std::time::Duration;

use jiff::Zoned;

use crate::app::Text;
use crate::app::recorder::{self, GroupId, Line, LineId, Recorder, Scale};
use crate::signal::history::{Flags, Kind, Part, Value};
use crate::signal::{Motion, Rates, Time, Unwrap};
use crate::units::Moment;

/// Positions that are kept: more than a day at the fastest rate of a serial line.
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

/// What the positions of a device are.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Meaning {
    /// Positions from one zero to the next, after which they go round; `None` for a linear one.
    pub(super) range: Option<i64>,
    /// The units of position, speed and acceleration, whose samples are in steps.
    pub(super) scales: [Vec<Scale>; 3],
    /// It does not turn.
    pub(super) is_linear: bool,
}

/// A position, or that there is none.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Sighting {
    /// When.
    pub(super) at: Moment,
    /// Steps, within the range; `None`: the device has none to give.
    pub(super) position: Option<i64>,
    /// The device says that it is invalid.
    pub(super) is_bad: bool,
    /// The device warned with it.
    pub(super) is_warned: bool,
}

/// What can be watched.
pub(super) trait Watchable: Clone + PartialEq {
    /// Its values are whole numbers.
    fn is_whole(&self) -> bool;

    /// What it is called, and in which units it is seen.
    fn line(&self, group: GroupId) -> Line;
}

/// A watched value, or that there is none at the moment.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Watching {
    /// When.
    pub(super) at: Moment,
    /// In the unit of its line.
    pub(super) value: Option<Value>,
    /// The device warned with it.
    pub(super) is_warned: bool,
    /// Why there will be none, however long one waits.
    pub(super) never: Option<Text>,
}

/// The recorder of a device, and what is needed to fill it; `W` is what can be watched.
#[derive(Debug)]
pub(super) struct Track<W> {
    /// Position, speed and acceleration as lines.
    pub(super) recorder: Recorder,
    positions: GroupId,
    watched: Vec<Watched<W>>,
    /// What positions mean; `None` until the first.
    follower: Option<Follower>,
    dropped: u64,
    /// When the clock of the first session began, and how much later that of the present one did.
    began: Option<Zoned>,
    shift: i64,
    newest: Option<Time>,
    /// The position that came last, as it came.
    last: i64,
    /// Nanoseconds between two positions from which they are not joined.
    apart: i64,
}

/// A watched value and where it is recorded.
#[derive(Clone, Debug)]
struct Watched<W> {
    what: W,
    group: GroupId,
    line: LineId,
}

/// Makes positions that go on from positions that go round.
#[derive(Debug)]
struct Follower {
    meaning: Meaning,
    unwrap: Unwrap,
    motion: Motion,
}

/// Positions on their way into the recorder.
#[derive(Debug, Default)]
struct Columns {
    times: Vec<Time>,
    steps: Vec<i64>,
    speed: Vec<f64>,
    acceleration: Vec<f64>,
    flags: Vec<Flags>,
}

impl Columns {
    fn push(&mut self, time: Time, steps: i64, rates: Rates, flags: Flags) {
        self.times.push(time);
        self.steps.push(steps);
        // What is not known is no number, which breaks the line and counts nowhere.
        self.speed.push(rates.speed.unwrap_or(f64::NAN));
        self.acceleration.push(rates.acceleration.unwrap_or(f64::NAN));
        self.flags.push(flags);
    }
}

impl Follower {
    fn new(meaning: Meaning) -> Self {
        let unwrap = meaning.range.and_then(Unwrap::rotary).unwrap_or_else(Unwrap::linear);
        Follower { meaning, unwrap, motion: Motion::over(WINDOW) }
    }
}

impl Meaning {
    /// Of steps whose place in a revolution nobody knows.
    pub(super) fn of_steps(range: Option<i64>) -> Self {
        let scales = [
            vec![Scale::new("unit.steps", 1.0, 0)],
            vec![Scale::new("unit.steps_per_second", 1.0, 0)],
            vec![Scale::new("unit.steps_per_second_squared", 1.0, 0)],
        ];
        Meaning { range, scales, is_linear: false }
    }

    /// Of a shaft with so many steps in a revolution, at least a part of one.
    pub(super) fn of_turns(range: Option<i64>, steps_per_turn: f64) -> Self {
        let turns = 1.0 / steps_per_turn.max(f64::MIN_POSITIVE);
        let scales = [
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
        ];
        Meaning { range, scales, is_linear: false }
    }

    /// Of a linear encoder with steps of so many millimetres.
    pub(super) fn of_millimetres(millimetres: f64) -> Self {
        let scales = [
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
        ];
        Meaning { range: None, scales, is_linear: true }
    }
}

impl<W: Watchable> Default for Track<W> {
    fn default() -> Self {
        Track::about(&Meaning::of_steps(None))
    }
}

impl<W: Watchable> Track<W> {
    /// A recorder for positions that have this meaning.
    fn about(meaning: &Meaning) -> Self {
        let mut recorder = Recorder::new(SPAN);
        let columns = [Kind::Whole, Kind::Real, Kind::Real];
        let positions = recorder.add_group(&columns, CAPACITY, Some(APART));
        let [position, speed, acceleration] = meaning.scales.clone();
        let line = |column, name, heading, scales| Line::of(positions, column, Text::new(name), heading, scales);
        recorder.add_line(line(0, "recorder.position", "position", position));
        let name = if meaning.is_linear { "recorder.speed_linear" } else { "recorder.speed" };
        recorder.add_line(line(1, name, "speed", speed).derived());
        recorder.add_line(line(2, "recorder.acceleration", "acceleration", acceleration).derived().hidden());
        Track {
            recorder,
            positions,
            watched: Vec::new(),
            follower: None,
            dropped: 0,
            began: None,
            shift: 0,
            newest: None,
            last: 0,
            apart: APART,
        }
    }

    /// A session has begun. What was recorded before stays: its samples are earlier by as much as the clocks say.
    pub(super) fn begin(&mut self, began: &Zoned) {
        let since = self.began.get_or_insert_with(|| began.clone()).duration_until(began);
        let later = i64::try_from(since.as_nanos()).unwrap_or(0);
        // A clock of the wall may be set back.
        let behind = self.newest.map_or(0, |newest| newest.nanoseconds().saturating_add(1));
        self.shift = later.max(behind);
        self.gap();
    }

    /// What positions mean; `None` until the first.
    pub(super) fn meaning(&self) -> Option<&Meaning> {
        self.follower.as_ref().map(|own| &own.meaning)
    }

    /// Positions are wished at this interval from now on; when that begins, what was before is not joined to what comes.
    pub(super) fn poll(&mut self, interval: Option<Duration>, begins: bool) {
        let interval = interval.and_then(|interval| i64::try_from(interval.as_nanos()).ok());
        self.apart = interval.map_or(APART, |interval| interval.saturating_mul(4).saturating_add(LATE).min(APART));
        if begins {
            self.gap();
        }
    }

    /// So many samples were dropped before those that come next.
    pub(super) fn lose(&mut self, dropped: u64) {
        self.dropped += dropped;
        if dropped > 0 {
            self.gap();
        }
    }

    /// Records positions, one after the other.
    pub(super) fn add(&mut self, sightings: &[Sighting], meaning: &Meaning) {
        self.see(meaning);
        let mut columns = Columns::default();
        for sighting in sightings {
            self.sight(sighting, &mut columns);
        }
        let flags = &columns.flags;
        let parts = [
            Part::whole(&columns.steps).flagged(flags),
            Part::real(&columns.speed).flagged(flags),
            Part::real(&columns.acceleration).flagged(flags),
        ];
        // Their times are in order: none of them is before the newest.
        let _ = self.recorder.append(self.positions, &columns.times, &parts);
    }

    fn sight(&mut self, sighting: &Sighting, columns: &mut Columns) {
        let time = Time::from(sighting.at).plus(self.shift);
        if self.newest.is_some_and(|newest| time < newest) {
            // Read on its own between two samples that are recorded already.
            return;
        }
        if sighting.is_bad || self.newest.is_some_and(|newest| time.nanoseconds_since(newest) > self.apart) {
            self.lose_track();
        }
        self.newest = Some(time);
        let Some(word) = sighting.position else {
            self.lose_track();
            return columns.push(time, self.last, Rates::default(), Flags::BAD);
        };
        self.last = word;
        let Some(follower) = &mut self.follower else { return };
        let Some(next) = follower.unwrap.next(word).filter(|_| !sighting.is_bad) else {
            self.lose_track();
            return columns.push(time, word, Rates::default(), Flags::BAD);
        };
        if next.broken {
            follower.motion.reset();
        }
        let rates = follower.motion.next(time, next.steps);
        let mut flags = if next.broken { Flags::BREAK } else { Flags::NONE };
        if sighting.is_warned {
            flags |= Flags::WARNING;
        }
        columns.push(time, next.steps, rates, flags);
    }

    /// Records these values too, and no others beside the position.
    pub(super) fn watch(&mut self, wished: &[W]) {
        for own in std::mem::take(&mut self.watched) {
            if wished.contains(&own.what) {
                self.watched.push(own);
            } else {
                self.recorder.remove_line(own.line);
            }
        }
        for what in wished {
            if self.watched.iter().all(|own| own.what != *what) {
                let kind = if what.is_whole() { Kind::Whole } else { Kind::Real };
                let group = self.recorder.add_group(&[kind], WATCHED, Some(WATCHED_APART));
                let line = self.recorder.add_line(what.line(group));
                self.watched.push(Watched { what: what.clone(), group, line });
            }
        }
    }

    /// What is recorded beside the position.
    pub(super) fn watched(&self) -> Vec<W> {
        self.watched.iter().map(|own| own.what.clone()).collect()
    }

    /// Records a watched value.
    pub(super) fn add_watched(&mut self, what: &W, watching: &Watching) {
        let Some(own) = self.watched.iter().find(|own| own.what == *what) else { return };
        let (group, line) = (own.group, own.line);
        let mut flags = if watching.value.is_some() { Flags::NONE } else { Flags::BAD };
        if watching.is_warned {
            flags |= Flags::WARNING;
        }
        self.recorder.remark(line, watching.never.clone());
        let (time, flags) = (self.time(watching.at), [flags]);
        let (whole, real) = match watching.value {
            Some(Value::Whole(whole)) => ([whole], [whole as f64]),
            Some(Value::Real(real)) => ([real as i64], [real]),
            None => ([0], [f64::NAN]),
        };
        let part = if what.is_whole() { Part::whole(&whole) } else { Part::real(&real) };
        // Each kind of value comes in the order of time; the clock of a later session begins behind the last position.
        let _ = self.recorder.append(group, &[time], &[part.flagged(&flags)]);
    }

    /// Samples that came too fast to be recorded.
    pub(super) fn dropped(&self) -> u64 {
        self.dropped
    }

    /// Positions that are recorded.
    pub(super) fn positions(&self) -> u64 {
        let line = self.recorder.lines().first();
        let all = line.and_then(|line| self.recorder.history(line)).map(|history| history.all());
        all.map_or(0, |all| all.end - all.start)
    }

    /// Another device: nothing of what was recorded is about it. What is watched stays.
    pub(super) fn forget(&mut self) {
        let (began, watched) = (self.began.take(), self.watched());
        *self = Track { began, ..Track::default() };
        self.watch(&watched);
    }

    /// Everything that was recorded is read anew: the clocks stay as they are.
    pub(super) fn begin_again(&mut self) {
        let (began, shift, apart, span) = (self.began.take(), self.shift, self.apart, self.recorder.span());
        *self = Track { began, shift, apart, ..Track::default() };
        self.recorder.act(recorder::Action::SetSpan(span));
    }

    /// Positions mean this from now on. What was recorded with another meaning cannot be seen in the same units.
    fn see(&mut self, meaning: &Meaning) {
        if self.follower.as_ref().is_some_and(|follower| follower.meaning == *meaning) {
            return;
        }
        let watched = self.watched();
        let before = std::mem::replace(self, Track::about(meaning));
        self.recorder.act(recorder::Action::SetSpan(before.recorder.span()));
        self.watch(&watched);
        let Track { began, shift, newest, dropped, last, apart, .. } = before;
        (self.began, self.shift, self.newest, self.dropped) = (began, shift, newest, dropped);
        (self.last, self.apart) = (last, apart);
        self.follower = Some(Follower::new(meaning.clone()));
    }

    /// Samples are missing before those that come next.
    pub(super) fn gap(&mut self) {
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

#[cfg(test)]
mod tests;
