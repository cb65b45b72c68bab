//! Division of a time range into pixel columns, each with the content to draw. A picture contains every extreme, break
//! and flag of the raw samples at any zoom. It does not depend on a screen.

use std::ops::Range;

use super::block::ValueRange;
use super::flags::Flags;
use super::number::Number;
use super::series::Series;
use super::{Column, History, PYRAMID_FACTOR};
use crate::analysis::SampleTime;

/// Grid of equal time steps, one per pixel column. Its edges are multiples of the step, so a picture keeps its pixel
/// columns when it scrolls at constant zoom.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Grid {
    start: SampleTime,
    width: i64,
    pixels: usize,
}

impl Grid {
    /// Creates a grid of `pixels` or `pixels + 1` columns that covers the time from `from` to `to`.
    pub fn new(from: SampleTime, to: SampleTime, pixels: usize) -> Self {
        let span = i128::from(to.as_nanoseconds()) - i128::from(from.as_nanoseconds());
        let width = match i128::try_from(pixels) {
            Ok(pixels @ 1..) if span > 0 => (span + pixels - 1) / pixels,
            _ => return Grid { start: from, width: 1, pixels: 0 },
        };
        let width = i64::try_from(width).unwrap_or(i64::MAX);
        let start = from.as_nanoseconds().saturating_sub(from.as_nanoseconds().rem_euclid(width));
        let covered = i128::from(to.as_nanoseconds()) - i128::from(start);
        let columns = (covered + i128::from(width) - 1) / i128::from(width);
        Grid { start: SampleTime::from_nanoseconds(start), width, pixels: usize::try_from(columns).unwrap_or(0) }
    }

    pub fn pixel_count(&self) -> usize {
        self.pixels
    }

    /// Returns the width of a pixel column in nanoseconds, at least 1.
    pub fn width(&self) -> i64 {
        self.width
    }

    /// Returns the start of pixel column `pixel`, which is also the end of the previous column.
    pub fn pixel_start(&self, pixel: usize) -> SampleTime {
        let edge = i128::from(self.start.as_nanoseconds()) + pixel as i128 * i128::from(self.width);
        SampleTime::from_nanoseconds(i64::try_from(edge).unwrap_or(i64::MAX))
    }
}

/// The samples of a history in each pixel column of a [`Grid`]. They are the same for all columns of the history.
/// Samples appended later are not included, and evicted samples are not drawn.
#[derive(Clone, Debug)]
pub struct GridColumns {
    /// Starts of all pixel columns, followed by the end of the last one.
    edges: Vec<ColumnEdge>,
}

#[derive(Clone, Copy, Debug)]
struct ColumnEdge {
    /// Index of the first sample after the boundary.
    index: u64,
    /// Time of the last sample before the boundary, if any.
    before: Option<SampleTime>,
    /// Time of the first sample after the boundary, if any.
    after: Option<SampleTime>,
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pixel {
    /// Time of the first valid sample, or of the first sample if none is valid.
    pub from: SampleTime,
    /// Time of the last valid sample, or of the last sample if none is valid.
    pub to: SampleTime,
    /// Values of the valid samples, or `None` if no sample is valid.
    pub values: Option<ReducedSamples>,
    /// Union of the samples' flags. Contains [`BREAK`](Flags::BREAK) if the line is broken inside or before the pixel
    /// column.
    pub flags: Flags,
    /// Whether an unbroken line connects the last value of the previous pixel column to the first value of this one.
    pub joined: bool,
}

/// Values of the samples in one pixel column, in the column's unit. An `f64` holds counts below 2⁵³ exactly.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ReducedSamples {
    /// First value, exact.
    pub first: f64,
    /// Lower bound of the minimum. It is below the true value by at most 2⁻²² of the value range of the surrounding
    /// 4096 samples.
    pub min: f64,
    /// Upper bound of the maximum. It is above the true value by at most 2⁻²² of the value range of the surrounding
    /// 4096 samples.
    pub max: f64,
    /// Last value, exact.
    pub last: f64,
}

/// Picture of a history column: the pixel columns that contain samples, in chronological order. Each is drawn through
/// first, min, max and last. The nearest samples to the left and right are included, so the line extends beyond both
/// edges.
#[derive(Clone, Debug, Default)]
pub struct RenderedHistory {
    /// Pixel columns that contain samples, or single samples if `raw` is set.
    pub pixels: Vec<Pixel>,
    /// Whether each sample has a separate pixel with its exact time, because there are only a few samples.
    pub raw: bool,
}

/// Maximum average number of samples per pixel column up to which every sample is drawn. This takes no longer than
/// drawing first, min, max and last.
const UNREDUCED_SAMPLES: u64 = 4;

/// A pixel column may begin before its edge, at the start of a pyramid bucket, by at most its width divided by this
/// number.
const EDGE_SHIFT_DIVISOR: i64 = 16;
/// Bucket sizes in samples, largest first.
const BUCKETS: [u64; 3] = [
    (PYRAMID_FACTOR * PYRAMID_FACTOR * PYRAMID_FACTOR) as u64,
    (PYRAMID_FACTOR * PYRAMID_FACTOR) as u64,
    PYRAMID_FACTOR as u64,
];

impl History {
    /// Finds the samples of each pixel column. A column with many samples starts at a pyramid bucket, up to a sixteenth
    /// of its width before its edge. The result depends only on the samples and the edge.
    pub fn divide_into_pixels(&self, grid: &Grid) -> GridColumns {
        let edge = |pixel: usize| {
            let exact = self.times.search(grid.pixel_start(pixel));
            // The first and last edges stay exact, because they are the edges of the picture.
            let index = if pixel == 0 || pixel == grid.pixel_count() {
                exact
            } else {
                self.round_to_bucket(exact, grid, pixel)
            };
            let before = index.checked_sub(1).and_then(|before| self.times.get(before));
            ColumnEdge { index, before, after: self.times.get(index) }
        };
        GridColumns { edges: (0..=grid.pixel_count()).map(edge).collect() }
    }

    /// Returns the first sample of a bucket if the bucket starts only slightly before an edge, or `exact` otherwise.
    fn round_to_bucket(&self, exact: u64, grid: &Grid, pixel: usize) -> u64 {
        let earliest = grid.pixel_start(pixel).saturating_add_ns(-(grid.width() / EDGE_SHIFT_DIVISOR));
        let is_near = |start: &u64| *start == exact || self.times.get(*start).is_some_and(|time| time >= earliest);
        BUCKETS.iter().map(|size| exact - exact % size).find(is_near).unwrap_or(exact)
    }

    /// Draws a column of the history into `picture`, reusing its memory.
    pub fn render_column(&self, column: usize, cut: &GridColumns, picture: &mut RenderedHistory) {
        picture.pixels.clear();
        match self.columns.get(column) {
            Some(Column::Real(series)) => HistoryRenderer { history: self, series, last: None, picture }.paint(cut),
            Some(Column::Whole(series)) => HistoryRenderer { history: self, series, last: None, picture }.paint(cut),
            None => {}
        }
    }
}

struct HistoryRenderer<'a, T> {
    history: &'a History,
    series: &'a Series<T>,
    /// Index of the last valid sample already painted, if any.
    last: Option<u64>,
    picture: &'a mut RenderedHistory,
}

impl<T: Number> HistoryRenderer<'_, T> {
    fn paint(&mut self, cut: &GridColumns) {
        let all = self.history.indices();
        let (Some(from), Some(to)) = (cut.edges.first(), cut.edges.last()) else { return };
        let (from, to) = (from.index.max(all.start), to.index.min(all.end));
        let pixels = cut.edges.iter().zip(cut.edges.iter().skip(1));
        self.picture.raw = to.saturating_sub(from) <= UNREDUCED_SAMPLES.saturating_mul(pixels.len() as u64);
        if let Some(before) = self.series.last_valid(all.start..from) {
            self.add_sample(before);
        }
        if self.picture.raw {
            (from..to).for_each(|index| self.add_sample(index));
        } else {
            // The end values are far apart in memory. Fetching them together lets the memory accesses overlap.
            let ends: Vec<Option<(T, T)>> =
                pixels.clone().map(|(from, to)| self.series.first_and_last(from.index..to.index)).collect();
            for ((from, to), ends) in pixels.zip(ends) {
                if let Some(ends) = ends {
                    self.paint_pixel(from, to, ends);
                }
            }
        }
        if let Some(after) = self.series.first_valid(to..all.end) {
            self.add_sample(after);
        }
    }

    fn add_sample(&mut self, index: u64) {
        let (Some((value, flags)), Some(time)) = (self.series.get(index), self.history.time(index)) else { return };
        let good = !flags.contains(Flags::BAD);
        let joined = good && self.is_line_continuous(index);
        let value = value.value().to_f64();
        let values = good.then_some(ReducedSamples { first: value, min: value, max: value, last: value });
        if good {
            self.last = Some(index);
        }
        self.picture.pixels.push(Pixel { from: time, to: time, values, flags, joined });
    }

    /// Adds the samples between two edges as one pixel column. `ends` contains the first and last values.
    fn paint_pixel(&mut self, from: &ColumnEdge, to: &ColumnEdge, ends: (T, T)) {
        let range = from.index..to.index;
        let (Some(start), Some(end)) = (from.after, to.before) else { return };
        if self.series.is_plain(range.clone()) {
            let joined = self.is_line_continuous(from.index);
            let values = Some(self.reduce_samples(range, ends));
            self.last = Some(to.index - 1);
            self.picture.pixels.push(Pixel { from: start, to: end, values, flags: Flags::NONE, joined });
            return;
        }
        let flags = self.series.flags_in(range.clone());
        let mut pixel = Pixel { from: start, to: end, values: None, flags, joined: false };
        if let (Some(first), Some(last)) = (self.series.first_valid(range.clone()), self.series.last_valid(range)) {
            let good = first..last + 1;
            pixel.joined = self.is_line_continuous(first);
            // The first and last samples are usually good. Their values are already known and need not be fetched
            // again.
            let ends =
                if good == (from.index..to.index) { Some(ends) } else { self.series.first_and_last(good.clone()) };
            pixel.values = ends.map(|ends| self.reduce_samples(good, ends));
            pixel.from = if first == from.index { start } else { self.history.time(first).unwrap_or(start) };
            pixel.to = if last + 1 == to.index { end } else { self.history.time(last).unwrap_or(end) };
            self.last = Some(last);
        }
        self.picture.pixels.push(pixel);
    }

    /// Returns whether a line connects the last valid sample to sample `index`.
    fn is_line_continuous(&self, index: u64) -> bool {
        self.last.is_some_and(|last| !self.series.flags_in(last + 1..index + 1).contains(Flags::BREAK))
    }

    fn reduce_samples(&self, range: Range<u64>, (first, last): (T, T)) -> ReducedSamples {
        let (first, last) = (first.value().to_f64(), last.value().to_f64());
        let ValueRange { min, max } =
            self.series.widen_range(ValueRange { min: first.min(last), max: first.max(last) }, range);
        ReducedSamples { first, min, max, last }
    }
}
