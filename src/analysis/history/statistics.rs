//! Statistics of a range of samples in one column. They are computed from the raw samples, never from the reduced ones
//! in a picture, and each sample counts once.

use std::ops::Range;

use super::number::{Number, Value};
use super::series::Series;
use super::{Column, History};

/// Statistics of a range of samples. All fields except `bad` refer to samples with a valid value.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Statistics {
    /// Number of samples with a valid value, at least 1.
    pub count: u64,
    /// Number of samples without a valid value.
    pub bad: u64,
    pub mean: f64,
    /// Minimum, as appended.
    pub min: Value,
    /// Maximum, as appended.
    pub max: Value,
    /// Standard deviation in the column's unit, with the divisor count − 1. A single sample has a deviation of 0.
    pub deviation: f64,
}

impl History {
    /// Returns the statistics of a column over the samples `indices`. Returns `None` if no sample has a valid value.
    pub fn statistics(&self, column: usize, indices: Range<u64>) -> Option<Statistics> {
        let all = self.indices();
        let indices = indices.start.max(all.start)..indices.end.min(all.end);
        match self.columns.get(column)? {
            Column::Real(series) => series_statistics(series, indices),
            Column::Whole(series) => series_statistics(series, indices),
        }
    }
}

fn series_statistics<T: Number>(series: &Series<T>, indices: Range<u64>) -> Option<Statistics> {
    let asked = indices.end.saturating_sub(indices.start);
    let spread = series.spread(indices)?;
    Some(Statistics {
        count: spread.count,
        bad: asked - spread.count,
        mean: spread.base.value().to_f64() + spread.mean,
        min: spread.min.value(),
        max: spread.max.value(),
        deviation: (spread.squares / spread.count.saturating_sub(1).max(1) as f64).sqrt(),
    })
}
