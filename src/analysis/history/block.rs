//! A block of samples from one column, with a pyramid of extremes. The pyramid holds the minimum and maximum of every 8
//! samples, of every 8 such buckets, and so on up to the whole block. A block is independent of time and of its
//! position in the history.

use std::ops::Range;

use super::flags::{FlagBlock, Flags};
use super::number::Number;
use super::spread::{RunningStatistics, combine_spreads, min_and_max, min_max_of_eight};
use super::{BLOCK, PYRAMID_FACTOR};

#[derive(Clone, Copy)]
struct BucketLevel {
    size: usize,
    /// Index of the level's first bucket within the block.
    start: usize,
}

/// Pyramid levels between the samples and the whole block, coarsest first, in storage order.
const LEVELS: [BucketLevel; 3] = [
    BucketLevel { size: PYRAMID_FACTOR * PYRAMID_FACTOR * PYRAMID_FACTOR, start: 0 },
    BucketLevel { size: PYRAMID_FACTOR * PYRAMID_FACTOR, start: PYRAMID_FACTOR },
    BucketLevel { size: PYRAMID_FACTOR, start: PYRAMID_FACTOR + PYRAMID_FACTOR * PYRAMID_FACTOR },
];

const BUCKETS: usize =
    PYRAMID_FACTOR + PYRAMID_FACTOR * PYRAMID_FACTOR + PYRAMID_FACTOR * PYRAMID_FACTOR * PYRAMID_FACTOR;

/// Minimum and maximum of several samples, as distances from the block's base, rounded outward. An empty bucket is (∞,
/// −∞).
#[derive(Clone, Copy, Debug, PartialEq)]
struct Bucket {
    low: f32,
    high: f32,
}

impl Bucket {
    const EMPTY: Bucket = Bucket { low: f32::INFINITY, high: f32::NEG_INFINITY };

    fn merge_all(buckets: &[Bucket]) -> Bucket {
        buckets.iter().fold(Bucket::EMPTY, |all, bucket| all.merge(*bucket))
    }

    fn from_extremes<T: Number>(extremes: Option<(T, T)>, base: T) -> Bucket {
        extremes
            .map_or(Bucket::EMPTY, |(min, max)| Bucket { low: min.distance_down(base), high: max.distance_up(base) })
    }

    fn merge(self, other: Bucket) -> Bucket {
        Bucket {
            low: if other.low < self.low { other.low } else { self.low },
            high: if other.high > self.high { other.high } else { self.high },
        }
    }

    fn is_empty(self) -> bool {
        self.low > self.high
    }

    fn contains(self, other: Bucket) -> bool {
        other.low >= self.low && other.high <= self.high
    }

    /// Returns whether the distance of a value from the block's base exceeds the range of `f32`.
    fn is_beyond(self) -> bool {
        self.low == f32::NEG_INFINITY || self.high == f32::INFINITY
    }
}

/// Range that contains the values of all merged samples and buckets. An empty range is (∞, −∞).
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct ValueRange {
    pub(super) min: f64,
    pub(super) max: f64,
}

impl ValueRange {
    pub(super) const EMPTY: ValueRange = ValueRange { min: f64::INFINITY, max: f64::NEG_INFINITY };

    pub(super) fn union(self, other: ValueRange) -> ValueRange {
        ValueRange {
            min: if other.min < self.min { other.min } else { self.min },
            max: if other.max > self.max { other.max } else { self.max },
        }
    }
}

/// Block of up to `BLOCK` samples. All memory except for the flags is allocated at once, and is reused after
/// [`clear`](SampleBlock::clear). A block has few fields, which makes scans of many blocks fast.
#[derive(Debug)]
pub(super) struct SampleBlock<T> {
    values: Vec<T>,
    /// Buckets of all levels. A bucket is valid once all of its samples have been appended.
    buckets: Box<[Bucket]>,
    /// Bucket for the whole block, valid once the block is full.
    top: Bucket,
    /// Value to which the buckets are relative, or `None` until a bucket contains a value. It is the median of the
    /// first few values, because an outlier would make all other distances coarse.
    base: Option<T>,
    flags: FlagBlock,
    /// Statistics of the whole block, present if the block is full and contains a value.
    spread: Option<Box<RunningStatistics<T>>>,
}

impl<T: Number> SampleBlock<T> {
    pub(super) fn new() -> Self {
        let values = Vec::with_capacity(BLOCK);
        let buckets = vec![Bucket::EMPTY; BUCKETS].into_boxed_slice();
        SampleBlock { values, buckets, top: Bucket::EMPTY, base: None, flags: FlagBlock::default(), spread: None }
    }

    pub(super) fn clear(&mut self) {
        self.values.clear();
        self.top = Bucket::EMPTY;
        self.base = None;
        self.flags.clear();
        self.spread = None;
    }

    pub(super) fn len(&self) -> usize {
        self.values.len()
    }

    /// Appends `values` with their flags. The values must fit into the block. Empty flags mean that no flag is set. A
    /// value that is not a finite number is marked as bad.
    pub(super) fn append(&mut self, values: &[T], flags: &[Flags]) {
        let start = self.values.len();
        self.values.extend_from_slice(values);
        if flags.iter().any(|flags| *flags != Flags::NONE) {
            for (at, flags) in flags.iter().enumerate().take(values.len()) {
                self.flags.add_flags(start + at, *flags);
            }
        }
        if !values.iter().fold(true, |all, value| all & value.is_number()) {
            for (at, _) in values.iter().enumerate().filter(|(_, value)| !value.is_number()) {
                self.flags.add_flags(start + at, Flags::BAD);
            }
        }
        self.fill_complete_buckets(start);
    }

    /// Marks the line as broken before the sample `at`.
    pub(super) fn break_before(&mut self, at: usize) {
        self.flags.add_flags(at, Flags::BREAK);
    }

    pub(super) fn value(&self, at: usize) -> Option<T> {
        self.values.get(at).copied()
    }

    pub(super) fn flags(&self) -> &FlagBlock {
        &self.flags
    }

    /// Returns `known`, widened to include the values in `range`. Values from samples are exact, and those from buckets
    /// are rounded outward. Parts that cannot widen the result are skipped.
    pub(super) fn widen_range(&self, known: ValueRange, range: Range<usize>) -> ValueRange {
        let Some(base) = self.base else { return known.union(self.scan_range(range)) };
        let mut search = BucketSearch {
            samples: ValueRange::EMPTY,
            found: Bucket::EMPTY,
            enough: Bucket { low: base.distance_rounded_up(known.min), high: base.distance_rounded_down(known.max) },
        };
        if range == (0..BLOCK) {
            search.find(self.top);
        } else if self.len() < BLOCK || !search.enough.contains(self.top) {
            self.search(&LEVELS, range.clone(), &mut search);
        }
        if search.found.is_beyond() {
            return known.union(self.scan_range(range));
        }
        let known = known.union(search.samples);
        if search.found.is_empty() {
            return known;
        }
        known.union(ValueRange { min: base.at_most(search.found.low), max: base.at_least(search.found.high) })
    }

    /// Returns the statistics of the samples in `range`, calculated from the samples themselves.
    pub(super) fn spread(&self, range: Range<usize>) -> Option<RunningStatistics<T>> {
        if range == (0..BLOCK) {
            return self.spread.as_deref().copied();
        }
        self.range_statistics(range)
    }

    pub(super) fn first_valid(&self, range: Range<usize>) -> Option<usize> {
        if self.flags.is_known_valid(range.start) {
            return (!range.is_empty()).then_some(range.start);
        }
        if self.len() == BLOCK && self.top.is_empty() {
            return None;
        }
        let mut at = range.start;
        while at < range.end {
            match self.gap_length(at, range.end) {
                0 => return Some(at),
                skipped => at += skipped,
            }
        }
        None
    }

    pub(super) fn last_valid(&self, range: Range<usize>) -> Option<usize> {
        if self.flags.is_known_valid(range.end.saturating_sub(1)) {
            return range.end.checked_sub(1).filter(|last| *last >= range.start);
        }
        if self.len() == BLOCK && self.top.is_empty() {
            return None;
        }
        let mut end = range.end;
        while end > range.start {
            match self.previous_gap(end, range.start) {
                0 => return end.checked_sub(1),
                skipped => end -= skipped,
            }
        }
        None
    }

    pub(super) fn memory(&self) -> usize {
        let spread = self.spread.as_ref().map_or(0, |_| size_of::<RunningStatistics<T>>());
        let buckets = self.buckets.len() * size_of::<Bucket>();
        self.values.capacity() * size_of::<T>() + buckets + self.flags.memory() + spread
    }

    /// Fills the buckets completed since the block held `before` samples.
    fn fill_complete_buckets(&mut self, before: usize) {
        let first = before / PYRAMID_FACTOR;
        let (groups, _) = self.values.get(first * PYRAMID_FACTOR..).unwrap_or_default().as_chunks::<PYRAMID_FACTOR>();
        let (values, flags) = (self.values.as_slice(), &self.flags);
        let ranges = (first..first + groups.len()).map(|group| group * PYRAMID_FACTOR..(group + 1) * PYRAMID_FACTOR);
        if self.base.is_none() {
            self.base = ranges.clone().find_map(|range| {
                median(flags.valid_ranges(range).filter_map(|good| values.get(good)).flatten().copied())
            });
        }
        let [third, second, finest] = LEVELS;
        let buckets = self.buckets.iter_mut().skip(finest.start + first);
        match self.base {
            None => buckets.zip(groups).for_each(|(bucket, _)| *bucket = Bucket::EMPTY),
            Some(base) if flags.all_flags().contains(Flags::BAD) => {
                for (bucket, range) in buckets.zip(ranges) {
                    *bucket = Bucket::from_extremes(valid_min_max(values, flags, range), base);
                }
            }
            Some(base) => {
                for (bucket, group) in buckets.zip(groups) {
                    *bucket = Bucket::from_extremes(Some(min_max_of_eight(group)), base);
                }
            }
        }
        self.fill_level(finest, second, before);
        self.fill_level(second, third, before);
        if self.values.len() == BLOCK {
            self.top = Bucket::merge_all(self.buckets.get(..PYRAMID_FACTOR).unwrap_or_default());
            self.spread = self.range_statistics(0..BLOCK).map(Box::new);
        }
    }

    /// Fills the newly completed buckets of the level `upper` from the buckets of the level `lower`.
    fn fill_level(&mut self, lower: BucketLevel, upper: BucketLevel, before: usize) {
        let (first, end) = (before / upper.size, self.values.len() / upper.size);
        let (uppers, lowers) = self.buckets.split_at_mut(lower.start);
        let (groups, _) =
            lowers.get(first * PYRAMID_FACTOR..end * PYRAMID_FACTOR).unwrap_or_default().as_chunks::<PYRAMID_FACTOR>();
        for (bucket, group) in uppers.iter_mut().skip(upper.start + first).zip(groups) {
            *bucket = Bucket::merge_all(group);
        }
    }

    /// Returns the bucket of a level that contains the sample `at`. Returns `None` if the bucket is incomplete.
    fn bucket_containing(&self, level: BucketLevel, at: usize) -> Option<Bucket> {
        let number = at / level.size;
        let complete = (number + 1) * level.size <= self.len();
        self.buckets.get(level.start + number).copied().filter(|_| complete)
    }

    /// Searches `range` for values that widen the result. The coarsest buckets inside the range are searched first,
    /// then the remainder on each side unless a single bucket rules it out.
    fn search(&self, levels: &[BucketLevel], range: Range<usize>, search: &mut BucketSearch) {
        let Some((level, finer)) = levels.split_first() else {
            search.samples = search.samples.union(self.scan_range(range));
            return;
        };
        let (from, to) = (range.start.div_ceil(level.size), range.end / level.size);
        if from < to {
            search.find(Bucket::merge_all(self.buckets.get(level.start + from..level.start + to).unwrap_or_default()));
        }
        let sides =
            if from > to { [range, 0..0] } else { [range.start..from * level.size, to * level.size..range.end] };
        for side in sides.into_iter().filter(|side| !side.is_empty()) {
            if self.bucket_containing(*level, side.start).is_none_or(|bucket| !search.enough.contains(bucket)) {
                self.search(finer, side, search);
            }
        }
    }

    fn range_statistics(&self, range: Range<usize>) -> Option<RunningStatistics<T>> {
        self.flags
            .valid_ranges(range)
            .map(|good| RunningStatistics::from_values(self.values.get(good)?))
            .fold(None, combine_spreads)
    }

    fn scan_range(&self, range: Range<usize>) -> ValueRange {
        let extremes = valid_min_max(&self.values, &self.flags, range);
        extremes.map_or(ValueRange::EMPTY, |(min, max)| ValueRange { min: min.to_f64_floor(), max: max.to_f64_ceil() })
    }

    /// Returns the length of a run of samples without a value that starts at `at` and does not go beyond `end`. Only
    /// one check is made, so the actual run may be longer.
    fn gap_length(&self, at: usize, end: usize) -> usize {
        let empty = |level: &&BucketLevel| {
            let inside = at.is_multiple_of(level.size) && at + level.size <= end;
            inside && self.bucket_containing(**level, at).is_some_and(Bucket::is_empty)
        };
        LEVELS.iter().find(empty).map_or(usize::from(self.flags.get(at).contains(Flags::BAD)), |level| level.size)
    }

    /// Returns the length of a run of samples without a value that ends just before `end` and does not start before
    /// `start`. Only one check is made, so the actual run may be longer.
    fn previous_gap(&self, end: usize, start: usize) -> usize {
        let empty = |level: &&BucketLevel| {
            let inside = end.is_multiple_of(level.size) && start + level.size <= end;
            inside && self.bucket_containing(**level, end - level.size).is_some_and(Bucket::is_empty)
        };
        let last = end.saturating_sub(1);
        LEVELS.iter().find(empty).map_or(usize::from(self.flags.get(last).contains(Flags::BAD)), |level| level.size)
    }
}

struct BucketSearch {
    samples: ValueRange,
    found: Bucket,
    /// Range already covered by the result. Buckets within it need not be searched.
    enough: Bucket,
}

impl BucketSearch {
    fn find(&mut self, bucket: Bucket) {
        self.found = self.found.merge(bucket);
        self.enough = self.enough.merge(bucket);
    }
}

/// Returns the minimum and maximum of the valid samples in `range`. Returns `None` if no sample is valid.
fn valid_min_max<T: Number>(values: &[T], flags: &FlagBlock, range: Range<usize>) -> Option<(T, T)> {
    flags.valid_ranges(range).filter_map(|good| min_and_max(values.get(good)?)).reduce(|one, other| {
        (if other.0 < one.0 { other.0 } else { one.0 }, if other.1 > one.1 { other.1 } else { one.1 })
    })
}

fn median<T: Number>(values: impl Iterator<Item = T>) -> Option<T> {
    let mut values: Vec<T> = values.collect();
    values.sort_unstable_by(|one, other| one.partial_cmp(other).unwrap_or(std::cmp::Ordering::Equal));
    values.get(values.len() / 2).copied()
}
