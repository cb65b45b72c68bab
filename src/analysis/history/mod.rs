//! History of the samples received over several hours. Columns of values share one column of times and are stored in
//! blocks of fixed size. A pyramid of minimum and maximum values allows any range to be drawn quickly. Appended samples
//! stay unchanged until they are evicted. Nothing is interpolated, smoothed or thinned out.
//!
//! Each sample has an index counted from the very first one, which it keeps. Blocks and buckets begin at multiples of
//! their size, so a sample is drawn in the same way while others are added or evicted.

mod block;
mod flags;
mod number;
mod picture;
mod series;
mod spread;
mod statistics;
#[cfg(test)]
mod tests;
mod times;
mod wrap;

use std::ops::Range;

pub use flags::Flags;
pub use number::Value;
pub use picture::{Grid, GridColumns, Pixel, ReducedSamples, RenderedHistory};
pub use statistics::Statistics;

use number::Number;
use series::Series;
use times::Times;

use super::SampleTime;

/// Number of samples in a block. Blocks are allocated and evicted as a whole.
const BLOCK: usize = 4096;

/// Number of samples in a bucket of the lowest pyramid level, and of buckets that form one bucket of the next level.
const PYRAMID_FACTOR: usize = 8;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// 64-bit floating-point numbers.
    Real,
    /// 64-bit integers, stored without rounding.
    Whole,
}

#[derive(Clone, Copy, Debug)]
pub struct ColumnPart<'a> {
    values: Values<'a>,
    flags: &'a [Flags],
}

#[derive(Clone, Copy, Debug)]
enum Values<'a> {
    Real(&'a [f64]),
    Whole(&'a [i64]),
}

impl<'a> ColumnPart<'a> {
    /// Creates values for a [`Kind::Real`] column. An infinite or NaN value is kept and marked as [bad](Flags::BAD).
    pub fn from_reals(values: &'a [f64]) -> Self {
        ColumnPart { values: Values::Real(values), flags: &[] }
    }

    /// Creates values for a [`Kind::Whole`] column.
    pub fn from_integers(values: &'a [i64]) -> Self {
        ColumnPart { values: Values::Whole(values), flags: &[] }
    }

    /// Sets the flags, one entry per value.
    #[must_use]
    pub fn with_flags(self, flags: &'a [Flags]) -> Self {
        ColumnPart { flags, ..self }
    }

    fn kind(&self) -> Kind {
        match self.values {
            Values::Real(_) => Kind::Real,
            Values::Whole(_) => Kind::Whole,
        }
    }

    fn matches_length(&self, length: usize) -> bool {
        let values = match self.values {
            Values::Real(values) => values.len(),
            Values::Whole(values) => values.len(),
        };
        values == length && (self.flags.is_empty() || self.flags.len() == length)
    }
}

/// Reason why a batch was rejected as a whole.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum BatchError {
    /// The number of columns, values or flags does not match, or a column has values of the wrong kind.
    #[error("the columns of the batch differ from those of the history")]
    Shape,
    /// A sample is earlier than its predecessor.
    #[error("the time decreases at sample {at} of the batch")]
    TimeGoesBack {
        /// Index of the sample in the batch.
        at: usize,
    },
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sample {
    pub index: u64,
    pub time: SampleTime,
    /// Value as appended.
    pub value: Value,
    pub flags: Flags,
}

/// Columns of simultaneous samples. Each column is identified by its index in the list passed to [`new`](History::new).
#[derive(Debug)]
pub struct History {
    times: Times,
    columns: Vec<Column>,
    /// Number of blocks to keep, including the one being filled.
    keep: usize,
    /// Longest pause in nanoseconds across which samples are joined, or `None` without a limit.
    longest_pause: Option<i64>,
    broken: bool,
}

#[derive(Debug)]
enum Column {
    Real(Series<f64>),
    Whole(Series<i64>),
}

impl History {
    /// Creates a history that keeps the last `capacity` samples, and at most two additional blocks of 4096 samples.
    pub fn new(columns: &[Kind], capacity: usize) -> Self {
        let keep = capacity.div_ceil(BLOCK) + 1;
        let column = |kind: &Kind| match kind {
            Kind::Real => Column::Real(Series::new(keep)),
            Kind::Whole => Column::Whole(Series::new(keep)),
        };
        let columns = columns.iter().map(column).collect();
        History { times: Times::new(keep), columns, keep, longest_pause: None, broken: false }
    }

    /// Sets the longest pause in nanoseconds. A longer one counts as missing samples and breaks the line.
    #[must_use]
    pub fn with_longest_pause(self, nanoseconds: i64) -> Self {
        History { longest_pause: Some(nanoseconds), ..self }
    }

    pub fn break_before_next(&mut self) {
        self.broken = true;
    }

    /// Appends samples. Times must not decrease, and each column requires one part with as many values as there are
    /// times.
    pub fn append(&mut self, times: &[SampleTime], parts: &[ColumnPart<'_>]) -> Result<(), BatchError> {
        let fits = |(column, part): (&Column, &ColumnPart<'_>)| {
            column.kind() == part.kind() && part.matches_length(times.len())
        };
        if parts.len() != self.columns.len() || !self.columns.iter().zip(parts).all(fits) {
            return Err(BatchError::Shape);
        }
        let Some(first) = times.first() else { return Ok(()) };
        let last = self.times.last();
        if last.is_some_and(|last| *first < last) {
            return Err(BatchError::TimeGoesBack { at: 0 });
        }
        if !times.is_sorted() {
            let at = times.iter().zip(times.iter().skip(1)).position(|(before, after)| after < before);
            return Err(BatchError::TimeGoesBack { at: at.map_or(0, |at| at + 1) });
        }
        let index = self.times.end();
        let mut from = 0;
        while from < times.len() {
            let room = if self.times.remaining_capacity() == 0 { BLOCK } else { self.times.remaining_capacity() };
            let range = from..(from + room).min(times.len());
            for (column, part) in self.columns.iter_mut().zip(parts) {
                column.append(part, range.clone(), self.keep);
            }
            self.times.append(times.get(range.clone()).unwrap_or_default(), self.keep);
            self.mark_breaks(times, range.clone(), last, index);
            from = range.end;
        }
        Ok(())
    }

    pub fn indices(&self) -> Range<u64> {
        self.times.first()..self.times.end()
    }

    /// Returns the time of the oldest stored sample that remains after `more` further samples are appended. Returns
    /// `None` if none remains.
    pub fn oldest_remaining_time(&self, more: usize) -> Option<SampleTime> {
        let blocks = self.times.end().saturating_add(more as u64).div_ceil(BLOCK as u64);
        let first = blocks.saturating_sub(self.keep as u64) * BLOCK as u64;
        self.times.get(first.max(self.times.first()))
    }

    /// Returns the index range of the samples from `from` up to but not including `to`.
    pub fn indices_between(&self, from: SampleTime, to: SampleTime) -> Range<u64> {
        let from = self.times.search(from);
        from..self.times.search(to).max(from)
    }

    /// Returns the time of sample `index`. Returns `None` if the sample is not stored.
    pub fn time(&self, index: u64) -> Option<SampleTime> {
        self.times.get(index)
    }

    /// Returns sample `index` of a column. Returns `None` if the sample is not stored.
    pub fn sample(&self, column: usize, index: u64) -> Option<Sample> {
        let time = self.times.get(index)?;
        let (value, flags) = match self.columns.get(column)? {
            Column::Real(series) => series.get(index).map(|(value, flags)| (value.value(), flags)),
            Column::Whole(series) => series.get(index).map(|(value, flags)| (value.value(), flags)),
        }?;
        Some(Sample { index, time, value, flags })
    }

    /// Returns the index of the sample nearest to `time`, or of the earlier sample if two are equally near. Returns
    /// `None` if there are no samples.
    pub fn nearest_index(&self, time: SampleTime) -> Option<u64> {
        let after = self.times.search(time);
        let before = after.checked_sub(1).and_then(|index| Some((index, self.times.get(index)?)));
        let after = self.times.get(after).map(|at| (after, at));
        match (before, after) {
            (Some((before, earlier)), Some((after, later))) => {
                let before_is_nearer = time.nanoseconds_since(earlier) <= later.nanoseconds_since(time);
                Some(if before_is_nearer { before } else { after })
            }
            (before, after) => before.or(after).map(|(index, _)| index),
        }
    }

    pub fn memory(&self) -> usize {
        let columns: usize = self.columns.iter().map(Column::memory).sum();
        self.times.memory() + columns + self.columns.capacity() * size_of::<Column>()
    }

    /// Marks the line in every column as broken at samples in `range` that follow a pause or missing samples.
    fn mark_breaks(&mut self, times: &[SampleTime], range: Range<usize>, last: Option<SampleTime>, index: u64) {
        let pause = self.longest_pause.unwrap_or(i64::MAX);
        let mut before = range.start.checked_sub(1).and_then(|at| times.get(at).copied()).or(last);
        let mut broken = std::mem::take(&mut self.broken);
        if self.longest_pause.is_none() && !broken {
            return;
        }
        for (at, time) in times.iter().enumerate().take(range.end).skip(range.start) {
            if broken || before.is_some_and(|before| time.nanoseconds_since(before) > pause) {
                self.columns.iter_mut().for_each(|column| column.break_before(index + at as u64));
            }
            broken = false;
            before = Some(*time);
        }
    }
}

impl Column {
    fn kind(&self) -> Kind {
        match self {
            Column::Real(_) => Kind::Real,
            Column::Whole(_) => Kind::Whole,
        }
    }

    /// Appends the values of `part` in `range`. Values of the wrong kind have already been rejected by
    /// `History::append` and are ignored here.
    fn append(&mut self, part: &ColumnPart<'_>, range: Range<usize>, keep: usize) {
        let flags = part.flags.get(range.clone()).unwrap_or_default();
        match (self, part.values) {
            (Column::Real(series), Values::Real(values)) => {
                series.append(values.get(range).unwrap_or_default(), flags, keep);
            }
            (Column::Whole(series), Values::Whole(values)) => {
                series.append(values.get(range).unwrap_or_default(), flags, keep);
            }
            _ => {}
        }
    }

    fn break_before(&mut self, index: u64) {
        match self {
            Column::Real(series) => series.break_before(index),
            Column::Whole(series) => series.break_before(index),
        }
    }

    fn memory(&self) -> usize {
        match self {
            Column::Real(series) => series.memory(),
            Column::Whole(series) => series.memory(),
        }
    }
}
