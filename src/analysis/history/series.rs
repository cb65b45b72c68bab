//! The blocks of one column, in which samples are found by their absolute index. The oldest block is reused when the
//! limit is reached.

use std::collections::VecDeque;
use std::ops::Range;

use super::BLOCK;
use super::block::{SampleBlock, ValueRange};
use super::flags::Flags;
use super::number::Number;
use super::spread::{RunningStatistics, combine_spreads};

#[derive(Debug)]
pub(super) struct Series<T> {
    blocks: VecDeque<SampleBlock<T>>,
    /// Absolute index of the oldest sample, a multiple of `BLOCK`.
    first: u64,
}

impl<T: Number> Series<T> {
    /// Creates a series with room for `blocks` blocks, which are allocated on demand.
    pub(super) fn new(blocks: usize) -> Self {
        Series { blocks: VecDeque::with_capacity(blocks), first: 0 }
    }

    /// Appends `values`, which must fit into the newest block or start a new one. At most `keep` blocks are kept.
    pub(super) fn append(&mut self, values: &[T], flags: &[Flags], keep: usize) {
        if self.blocks.back().is_none_or(|block| block.len() == BLOCK) {
            self.open(keep);
        }
        if let Some(block) = self.blocks.back_mut() {
            block.append(values, flags);
        }
    }

    pub(super) fn break_before(&mut self, index: u64) {
        let (block, at) = self.locate(index);
        if let Some(block) = self.blocks.get_mut(block) {
            block.break_before(at);
        }
    }

    pub(super) fn get(&self, index: u64) -> Option<(T, Flags)> {
        let (block, at) = self.locate(index);
        let block = self.blocks.get(block).filter(|_| index >= self.first)?;
        Some((block.value(at)?, block.flags().get(at)))
    }

    /// Returns the values of the first and last samples in `range`, as appended. Returns `None` if either is not
    /// stored.
    pub(super) fn first_and_last(&self, range: Range<u64>) -> Option<(T, T)> {
        if range.start < self.first || range.is_empty() {
            return None;
        }
        let value = |index| {
            let (block, at) = self.locate(index);
            self.blocks.get(block)?.value(at)
        };
        Some((value(range.start)?, value(range.end - 1)?))
    }

    /// Returns `known`, widened by the samples in `range`, which must all be stored. Whole blocks come first, because
    /// they save most of the work on the rest. See [`SampleBlock::widen_range`].
    pub(super) fn widen_range(&self, known: ValueRange, range: Range<u64>) -> ValueRange {
        let ((first, from), (last, to)) = (self.locate(range.start), self.locate(range.end - 1));
        let widen = |known: ValueRange, block: usize, range: Range<usize>| {
            self.blocks.get(block).map_or(known, |block| block.widen_range(known, range))
        };
        if first == last {
            return widen(known, first, from..to + 1);
        }
        let known = (first + 1..last).fold(known, |known, block| widen(known, block, 0..BLOCK));
        widen(widen(known, first, from..BLOCK), last, 0..to + 1)
    }

    /// Returns whether no sample in or near `range` has a flag. As a quick check on whole blocks, it may return false
    /// although no sample in `range` has a flag.
    pub(super) fn is_plain(&self, range: Range<u64>) -> bool {
        let ((first, _), (last, _)) = (self.locate(range.start), self.locate(range.end.saturating_sub(1)));
        let flagged =
            |block: usize| self.blocks.get(block).is_some_and(|block| block.flags().all_flags() != Flags::NONE);
        !(first..=last).any(flagged)
    }

    pub(super) fn flags_in(&self, range: Range<u64>) -> Flags {
        let ((first, from), (last, to)) = (self.locate(range.start), self.locate(range.end.saturating_sub(1)));
        // The range is usually a single sample, or several samples of one block.
        if first == last && range.start >= self.first && !range.is_empty() {
            return self.blocks.get(first).map_or(Flags::NONE, |block| block.flags().flags_in(from..to + 1));
        }
        self.blocks_in(range).fold(Flags::NONE, |all, (_, block, range)| all | block.flags().flags_in(range))
    }

    pub(super) fn spread(&self, range: Range<u64>) -> Option<RunningStatistics<T>> {
        self.blocks_in(range).map(|(_, block, range)| block.spread(range)).fold(None, combine_spreads)
    }

    /// Returns the first sample in `range` that has a valid value.
    pub(super) fn first_valid(&self, range: Range<u64>) -> Option<u64> {
        if !range.is_empty() && self.is_known_valid(range.start) {
            return Some(range.start);
        }
        self.blocks_in(range).find_map(|(start, block, range)| Some(start + block.first_valid(range)? as u64))
    }

    /// Returns the last sample in `range` that has a valid value.
    pub(super) fn last_valid(&self, range: Range<u64>) -> Option<u64> {
        if !range.is_empty() && self.is_known_valid(range.end - 1) {
            return Some(range.end - 1);
        }
        self.blocks_in(range).rev().find_map(|(start, block, range)| Some(start + block.last_valid(range)? as u64))
    }

    /// Returns whether sample `index` is stored and known to have a valid value. As a quick check, it may return false
    /// although the value is valid.
    fn is_known_valid(&self, index: u64) -> bool {
        let (block, at) = self.locate(index);
        let has_it = |block: &&SampleBlock<T>| index >= self.first && at < block.len();
        self.blocks.get(block).filter(has_it).is_some_and(|block| block.flags().is_known_valid(at))
    }

    pub(super) fn memory(&self) -> usize {
        let blocks: usize = self.blocks.iter().map(SampleBlock::memory).sum();
        blocks + self.blocks.capacity() * size_of::<SampleBlock<T>>()
    }

    fn open(&mut self, keep: usize) {
        let used = if self.blocks.len() >= keep { self.blocks.pop_front() } else { None };
        let block = match used {
            Some(mut block) => {
                self.first += BLOCK as u64;
                block.clear();
                block
            }
            None => SampleBlock::new(),
        };
        self.blocks.push_back(block);
    }

    /// Returns the position of the block that contains sample `index`, and the sample's index within that block.
    fn locate(&self, index: u64) -> (usize, usize) {
        let at = index.saturating_sub(self.first) as usize;
        (at / BLOCK, at % BLOCK)
    }

    /// Returns the blocks that overlap the stored part of `range`, each with the index of its first sample and the
    /// overlapping range within the block.
    fn blocks_in(&self, range: Range<u64>) -> impl DoubleEndedIterator<Item = (u64, &SampleBlock<T>, Range<usize>)> {
        let from = range.start.saturating_sub(self.first) as usize;
        let to = range.end.saturating_sub(self.first) as usize;
        let blocks = (from / BLOCK).min(self.blocks.len())..to.div_ceil(BLOCK).min(self.blocks.len());
        let numbers = blocks.start..blocks.end.max(blocks.start);
        numbers.clone().zip(self.blocks.range(numbers)).map(move |(number, block)| {
            let start = number * BLOCK;
            let end = to.saturating_sub(start).min(block.len());
            (self.first + start as u64, block, from.saturating_sub(start).min(end)..end)
        })
    }
}
