//! Two cursors, and statistics of the samples between them. The statistics use all samples, not only those drawn.

use super::{Recorder, Series};
use crate::analysis::SampleTime;
use crate::analysis::history::Sample;

#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Cursor {
    A,
    B,
}

impl Cursor {
    pub const BOTH: [Cursor; 2] = [Cursor::A, Cursor::B];

    pub const fn keyword(self) -> &'static str {
        match self {
            Cursor::A => "A",
            Cursor::B => "B",
        }
    }
}

/// The readings of both cursors on a line, in the line's unit. A reading is `None` if there is no valid sample.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CursorReadings {
    pub a: Option<f64>,
    pub b: Option<f64>,
    pub difference: Option<f64>,
    /// Statistics of the samples between the cursors, including those at the cursors.
    pub between: Option<CursorStatistics>,
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CursorStatistics {
    pub count: u64,
    /// Number of samples without a valid value.
    pub bad: u64,
    pub mean: f64,
    pub min: f64,
    pub max: f64,
    pub deviation: f64,
}

impl Recorder {
    pub fn cursor(&self, cursor: Cursor) -> Option<SampleTime> {
        match cursor {
            Cursor::A => self.cursors[0],
            Cursor::B => self.cursors[1],
        }
    }

    /// Returns the time from cursor A to cursor B in nanoseconds.
    pub fn cursor_distance(&self) -> Option<i64> {
        Some(self.cursor(Cursor::B)?.nanoseconds_since(self.cursor(Cursor::A)?))
    }

    /// Returns the readings of the cursors on a line, or `None` if no cursor is set.
    pub fn readings_at_cursors(&self, line: &Series) -> Option<CursorReadings> {
        let [a, b] = self.cursors;
        if a.is_none() && b.is_none() {
            return None;
        }
        let at = |time: Option<SampleTime>| self.sample_at(line, time?).filter(|sample| line.value(sample).is_finite());
        let good = |time| at(time).filter(|sample| !sample.flags.contains(crate::analysis::history::Flags::BAD));
        let (at_a, at_b) = (good(a), good(b));
        let difference = at_a.zip(at_b).map(|(a, b)| line.difference(&a, &b));
        let between = a.zip(b).and_then(|(a, b)| self.statistics_between(line, a.min(b), a.max(b)));
        Some(CursorReadings {
            a: at_a.map(|sample| line.value(&sample)),
            b: at_b.map(|sample| line.value(&sample)),
            difference,
            between,
        })
    }

    fn statistics_between(&self, line: &Series, from: SampleTime, to: SampleTime) -> Option<CursorStatistics> {
        let history = self.history(line)?;
        let statistics = history.statistics(line.column, history.indices_between(from, to.saturating_add_ns(1)))?;
        let factor = line.factor();
        let (min, max) = (statistics.min.to_f64(), statistics.max.to_f64());
        // If the line wraps between the cursors, the positions have no useful mean.
        let begin = match line.sample_wrap_range().map(|range| range as f64) {
            Some(range) if (min / range).floor() != (max / range).floor() => return None,
            Some(range) => (min / range).floor() * range,
            None => 0.0,
        };
        let ends = ((min - begin) * factor, (max - begin) * factor);
        Some(CursorStatistics {
            count: statistics.count,
            bad: statistics.bad,
            mean: (statistics.mean - begin) * factor,
            // The unit may invert the sign, which swaps minimum and maximum.
            min: ends.0.min(ends.1),
            max: ends.0.max(ends.1),
            deviation: statistics.deviation * factor.abs(),
        })
    }

    /// Returns the sample of a line nearest to a time, or `None` if nothing was recorded around that time.
    pub fn sample_at(&self, line: &Series, time: SampleTime) -> Option<Sample> {
        /// Divisor of the visible range. A cursor that far outside the recording still reads the first or last sample.
        const EDGE_DIVISOR: i64 = 200;
        let history = self.history(line)?;
        let all = history.indices();
        let (first, last) = (history.time(all.start)?, history.time(all.end.checked_sub(1)?)?);
        let beside = self.window_length() / EDGE_DIVISOR;
        (time >= first.saturating_add_ns(-beside) && time <= last.saturating_add_ns(beside))
            .then(|| self.nearest_sample(line, time))
            .flatten()
    }

    /// Moves a cursor to the sample nearest to a time. If nothing was recorded around that time, the cursor is placed
    /// at the time itself.
    pub(super) fn set_cursor(&mut self, cursor: Cursor, time: Option<SampleTime>) {
        let nearest = |time: SampleTime| {
            let samples = self.visible_series().filter_map(|line| self.sample_at(line, time)).map(|sample| sample.time);
            samples.min_by_key(|own| own.nanoseconds_since(time).saturating_abs()).unwrap_or(time)
        };
        let time = time.map(nearest);
        let [a, b] = &mut self.cursors;
        match cursor {
            Cursor::A => *a = time,
            Cursor::B => *b = time,
        }
    }

    /// Places the cursors at one third and two thirds of the visible samples, or hides them.
    pub(super) fn show_cursors(&mut self, shown: bool) {
        if !shown {
            self.cursors = [None; 2];
            return;
        }
        let (mut from, mut to) = self.window_bounds();
        if let Some((first, last)) = self.recorded_span()
            && first.max(from) < last.min(to)
        {
            (from, to) = (first.max(from), last.min(to));
        }
        let third = to.nanoseconds_since(from) / 3;
        self.set_cursor(Cursor::A, Some(from.saturating_add_ns(third)));
        self.set_cursor(Cursor::B, Some(from.saturating_add_ns(2 * third)));
    }
}
