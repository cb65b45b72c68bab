//! Time column shared by all simultaneously sampled values. Times never go back.

use std::collections::VecDeque;

use super::BLOCK;
use crate::analysis::SampleTime;

/// Times of the samples, in blocks that match those of the values.
#[derive(Debug)]
pub(super) struct Times {
    blocks: VecDeque<Vec<SampleTime>>,
    /// First time of each block. The times are stored contiguously for a fast search.
    starts: VecDeque<SampleTime>,
    /// Absolute index of the oldest sample, a multiple of `BLOCK`.
    first: u64,
}

impl Times {
    /// Creates a time column with room for `blocks` blocks, which are allocated on demand.
    pub(super) fn new(blocks: usize) -> Self {
        Times { blocks: VecDeque::with_capacity(blocks), starts: VecDeque::with_capacity(blocks), first: 0 }
    }

    pub(super) fn first(&self) -> u64 {
        self.first
    }

    pub(super) fn end(&self) -> u64 {
        let last = self.blocks.back().map_or(0, Vec::len);
        self.first + (self.blocks.len().saturating_sub(1) * BLOCK + last) as u64
    }

    /// Returns the number of samples that fit into the newest block.
    pub(super) fn remaining_capacity(&self) -> usize {
        self.blocks.back().map_or(0, |block| BLOCK - block.len())
    }

    pub(super) fn last(&self) -> Option<SampleTime> {
        self.blocks.back()?.last().copied()
    }

    pub(super) fn get(&self, index: u64) -> Option<SampleTime> {
        let at = index.checked_sub(self.first)? as usize;
        self.blocks.get(at / BLOCK)?.get(at % BLOCK).copied()
    }

    /// Appends `times`, which must fit into the newest block or start a new one. At most `keep` blocks are kept.
    pub(super) fn append(&mut self, times: &[SampleTime], keep: usize) {
        let Some(start) = times.first() else { return };
        if self.remaining_capacity() == 0 {
            let used = if self.blocks.len() >= keep { self.blocks.pop_front() } else { None };
            let block = match used {
                Some(mut block) => {
                    self.starts.pop_front();
                    self.first += BLOCK as u64;
                    block.clear();
                    block
                }
                None => Vec::with_capacity(BLOCK),
            };
            self.blocks.push_back(block);
            self.starts.push_back(*start);
        }
        if let Some(block) = self.blocks.back_mut() {
            block.extend_from_slice(times);
        }
    }

    /// Returns the absolute index of the first sample at or after `time`. Returns the end index if no such sample is
    /// stored.
    pub(super) fn search(&self, time: SampleTime) -> u64 {
        let Some(number) = self.starts.partition_point(|start| *start < time).checked_sub(1) else { return self.first };
        let inside = self.blocks.get(number).map_or(0, |block| search_times(block, time));
        self.first + (number * BLOCK + inside) as u64
    }

    pub(super) fn memory(&self) -> usize {
        let blocks: usize = self.blocks.iter().map(Vec::capacity).sum();
        (blocks + self.starts.capacity()) * size_of::<SampleTime>()
            + self.blocks.capacity() * size_of::<Vec<SampleTime>>()
    }
}

/// Returns the index of the first time at or after `time`. The index expected for evenly spaced samples is tried first.
fn search_times(times: &[SampleTime], time: SampleTime) -> usize {
    const NEARBY_SAMPLES: usize = 4;
    let before = |other: &SampleTime| *other < time;
    let (Some(first), Some(last)) = (times.first(), times.last()) else { return 0 };
    let share = time.nanoseconds_since(*first) as f64 / last.nanoseconds_since(*first).max(1) as f64;
    let guess = (share * (times.len() - 1) as f64) as usize;
    let (from, to) = (guess.saturating_sub(NEARBY_SAMPLES), guess.saturating_add(NEARBY_SAMPLES).min(times.len()));
    let near = times.get(from..to).unwrap_or_default();
    if near.first().is_some_and(before) && !near.last().is_none_or(before) {
        return from + near.partition_point(before);
    }
    times.partition_point(before)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn times(nanoseconds: impl Iterator<Item = i64>) -> Vec<SampleTime> {
        nanoseconds.map(SampleTime::from_nanoseconds).collect()
    }

    #[test]
    fn finds_even_and_uneven_times() {
        let cases = [
            ("even", times((0..100).map(|k| k * 1_000))),
            ("uneven", times((0..100).map(|k| k * k * k))),
            ("all at once", times((0..100).map(|_| 7))),
            ("a jump", times((0..100).map(|k| if k < 60 { k } else { 1_000_000 + k }))),
            ("one", times(std::iter::once(7))),
        ];
        for (label, times) in cases {
            for probe in -2..1_000_200 {
                let probe = SampleTime::from_nanoseconds(if label == "even" { probe / 10 } else { probe });
                let naive = times.partition_point(|time| *time < probe);
                assert_eq!(search_times(&times, probe), naive, "{label} {probe:?}");
            }
        }
    }
}
