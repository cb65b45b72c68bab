//! A naive history that keeps its samples in plain vectors and answers each query with a full scan.

use std::ops::Range;

use super::super::{BLOCK, Flags, Grid, Pixel, ReducedSamples, Value};
use crate::analysis::SampleTime;

/// One column with its times, and the range that is still stored.
#[derive(Default)]
pub(super) struct Model {
    pub(super) times: Vec<i64>,
    pub(super) values: Vec<Value>,
    pub(super) flags: Vec<Flags>,
}

impl Model {
    /// Adds a sample in the way that `History` stores it. NaN is a bad sample, and the line breaks at a bad sample or a
    /// pause.
    pub(super) fn push(&mut self, time: i64, value: Value, mut flags: Flags, broken: bool, pause: i64) {
        if !value.to_f64().is_finite() {
            flags |= Flags::BAD;
        }
        if flags.contains(Flags::BAD) || broken || self.times.last().is_some_and(|last| time - last > pause) {
            flags |= Flags::BREAK;
        }
        self.times.push(time);
        self.values.push(value);
        self.flags.push(flags);
    }

    pub(super) fn first(&self, capacity: usize) -> usize {
        let blocks = self.times.len().div_ceil(BLOCK);
        blocks.saturating_sub(capacity.div_ceil(BLOCK) + 1) * BLOCK
    }

    pub(super) fn between(&self, first: usize, from: SampleTime, to: SampleTime) -> Range<usize> {
        let at = |time: SampleTime| first + self.times[first..].partition_point(|at| *at < time.as_nanoseconds());
        at(from)..at(to)
    }

    pub(super) fn good(&self, range: Range<usize>) -> impl DoubleEndedIterator<Item = usize> {
        range.filter(|at| !self.flags[*at].contains(Flags::BAD))
    }

    pub(super) fn flags(&self, range: Range<usize>) -> Flags {
        self.flags[range].iter().fold(Flags::NONE, |all, flags| all | *flags)
    }

    /// Returns the picture without any rounding, and whether it consists of single samples.
    pub(super) fn picture(&self, first: usize, grid: &Grid) -> (Vec<Pixel>, bool) {
        let mut edges: Vec<usize> = (0..=grid.pixel_count()).map(|pixel| self.edge(first, grid, pixel)).collect();
        let (from, to) = (edges[0], edges[grid.pixel_count()]);
        let raw = to - from <= 4 * grid.pixel_count();
        if raw {
            edges = (from..=to).collect();
        }
        let mut ranges: Vec<Range<usize>> = edges.windows(2).map(|edges| edges[0]..edges[1]).collect();
        ranges.retain(|range| !range.is_empty());
        ranges.splice(0..0, self.good(first..from).next_back().map(|at| at..at + 1));
        ranges.extend(self.good(to..self.times.len()).next().map(|at| at..at + 1));
        let mut last: Option<usize> = None;
        let pixel = |range: Range<usize>| {
            let good: Vec<usize> = self.good(range.clone()).collect();
            let value = |at: &usize| self.values[*at].to_f64();
            let values = good.first().zip(good.last()).map(|(first, last)| ReducedSamples {
                first: value(first),
                min: good.iter().map(value).fold(f64::INFINITY, f64::min),
                max: good.iter().map(value).fold(f64::NEG_INFINITY, f64::max),
                last: value(last),
            });
            let joined = good
                .first()
                .zip(last)
                .is_some_and(|(first, last)| !self.flags(last + 1..first + 1).contains(Flags::BREAK));
            last = good.last().copied().or(last);
            let time =
                |at: Option<&usize>, other: usize| SampleTime::from_nanoseconds(self.times[*at.unwrap_or(&other)]);
            Pixel {
                from: time(good.first(), range.start),
                to: time(good.last(), range.end - 1),
                values,
                flags: self.flags(range),
                joined,
            }
        };
        (ranges.into_iter().map(pixel).collect(), raw)
    }

    /// Returns the first sample of a pixel column. This is the first sample after its edge, or the start of a bucket of
    /// 512, 64 or 8 samples, at most a sixteenth of a column before the edge.
    fn edge(&self, first: usize, grid: &Grid, pixel: usize) -> usize {
        let edge = grid.pixel_start(pixel);
        let exact = self.between(first, edge, edge).start;
        let earliest = edge.as_nanoseconds() - grid.width() / 16;
        let starts = [512, 64, 8].map(|size| exact / size * size);
        let near = |start: &usize| *start >= first && (*start == exact || self.times[*start] >= earliest);
        let inner = pixel > 0 && pixel < grid.pixel_count();
        starts.into_iter().find(near).filter(|_| inner).unwrap_or(exact)
    }

    /// Returns the value range of the blocks between two times. The permitted rounding is relative to this range.
    pub(super) fn around(&self, first: usize, from: SampleTime, to: SampleTime) -> f64 {
        let range = self.between(first, from, to.saturating_add_ns(1));
        let blocks = range.start / BLOCK * BLOCK..range.end.next_multiple_of(BLOCK).min(self.times.len());
        let values = || self.good(blocks.clone()).map(|at| self.values[at].to_f64());
        values().fold(f64::NEG_INFINITY, f64::max) - values().fold(f64::INFINITY, f64::min)
    }
}
