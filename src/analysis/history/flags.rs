//! Flags of single samples, and the flags of a block with a summary for each group of samples.

use std::ops::{BitOr, BitOrAssign, Range};

use super::BLOCK;

/// Flags of a sample: a set of [`BREAK`](Flags::BREAK), [`BAD`](Flags::BAD) and [`WARNING`](Flags::WARNING).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[repr(transparent)]
pub struct Flags(u8);

impl Flags {
    pub const NONE: Flags = Flags(0);
    /// Samples are missing before the flagged sample, so no line may join it to the previous sample.
    pub const BREAK: Flags = Flags(1);
    /// The value is invalid and ignored everywhere, and the line is broken. Implies [`BREAK`](Flags::BREAK).
    pub const BAD: Flags = Flags(2);
    /// The device has issued a warning, but the value is valid.
    pub const WARNING: Flags = Flags(4);

    pub const fn contains(self, other: Flags) -> bool {
        self.0 & other.0 == other.0
    }

    /// Returns the flags with all implied flags added. Flags are stored in this form.
    pub(super) const fn with_implied_flags(self) -> Flags {
        if self.contains(Flags::BAD) { Flags(self.0 | Flags::BREAK.0) } else { self }
    }
}

impl BitOr for Flags {
    type Output = Flags;
    fn bitor(self, other: Flags) -> Flags {
        Flags(self.0 | other.0)
    }
}

impl BitOrAssign for Flags {
    fn bitor_assign(&mut self, other: Flags) {
        *self = *self | other;
    }
}

/// Number of samples that share one summary. A block has as many groups as a `u64` has bits.
const SAMPLES_PER_GROUP: usize = BLOCK / u64::BITS as usize;

const KINDS: [Flags; 3] = [Flags::BREAK, Flags::BAD, Flags::WARNING];

/// Flags of a block. The flags of single samples are allocated separately when the first one is set. They are read only
/// if the summary of their group, which is stored inline, contains a flag.
#[derive(Debug, Default)]
pub(super) struct FlagBlock {
    any: Flags,
    /// One bitmap for each kind of flag. A bit is set if its group contains the flag.
    groups: [u64; KINDS.len()],
    kept: Option<Box<[Flags; BLOCK]>>,
}

impl FlagBlock {
    pub(super) fn clear(&mut self) {
        *self = FlagBlock::default();
    }

    pub(super) fn all_flags(&self) -> Flags {
        self.any
    }

    /// Adds flags to the sample `at`, which must be below `BLOCK`.
    pub(super) fn add_flags(&mut self, at: usize, flags: Flags) {
        if flags == Flags::NONE {
            return;
        }
        let flags = flags.with_implied_flags();
        let kept = self.kept.get_or_insert_with(|| Box::new([Flags::NONE; BLOCK]));
        if let Some(place) = kept.get_mut(at) {
            *place |= flags;
        }
        for (groups, kind) in self.groups.iter_mut().zip(KINDS) {
            *groups |= u64::from(flags.contains(kind)) << (at / SAMPLES_PER_GROUP);
        }
        self.any |= flags;
    }

    fn samples(&self, range: Range<usize>) -> &[Flags] {
        self.kept.as_ref().and_then(|kept| kept.get(range)).unwrap_or_default()
    }

    pub(super) fn get(&self, at: usize) -> Flags {
        match self.flags_in_groups(at / SAMPLES_PER_GROUP..at / SAMPLES_PER_GROUP + 1) {
            Flags::NONE => Flags::NONE,
            _ => self.kept.as_ref().and_then(|kept| kept.get(at)).copied().unwrap_or_default(),
        }
    }

    pub(super) fn flags_in(&self, range: Range<usize>) -> Flags {
        if self.any == Flags::NONE || range.is_empty() {
            return Flags::NONE;
        }
        let (from, to) = (range.start.div_ceil(SAMPLES_PER_GROUP), range.end / SAMPLES_PER_GROUP);
        let mut found = self.flags_in_groups(from..to.max(from));
        let edges = if from > to {
            [range, 0..0]
        } else {
            [range.start..from * SAMPLES_PER_GROUP, to * SAMPLES_PER_GROUP..range.end]
        };
        for edge in edges.into_iter().filter(|edge| !edge.is_empty()) {
            // The edge is part of a group and may add no new flags.
            let group = edge.start / SAMPLES_PER_GROUP;
            if !found.contains(self.flags_in_groups(group..group + 1)) {
                found |= merge_flags(self.samples(edge));
            }
        }
        found
    }

    /// Returns whether the group summary is enough to prove that sample `at` has a valid value.
    pub(super) fn is_known_valid(&self, at: usize) -> bool {
        !self.flags_in_groups(at / SAMPLES_PER_GROUP..at / SAMPLES_PER_GROUP + 1).contains(Flags::BAD)
    }

    /// Returns the parts of `range` in which all samples have a valid value.
    pub(super) fn valid_ranges(&self, range: Range<usize>) -> ValidRanges<'_> {
        let bad = self
            .flags_in_groups(range.start / SAMPLES_PER_GROUP..range.end.div_ceil(SAMPLES_PER_GROUP))
            .contains(Flags::BAD);
        let samples = self.kept.as_ref().filter(|_| bad).map_or(&[][..], |kept| kept.as_slice());
        ValidRanges { samples, range }
    }

    pub(super) fn memory(&self) -> usize {
        self.kept.as_ref().map_or(0, |_| size_of::<[Flags; BLOCK]>())
    }

    fn flags_in_groups(&self, groups: Range<usize>) -> Flags {
        if groups.is_empty() || self.any == Flags::NONE {
            return Flags::NONE;
        }
        let count = groups.len().min(u64::BITS as usize);
        let mask = (u64::MAX >> (u64::BITS as usize - count)) << groups.start.min(u64::BITS as usize - 1);
        let has = |(bits, kind): (&u64, Flags)| if bits & mask == 0 { Flags::NONE } else { kind };
        self.groups.iter().zip(KINDS).map(has).fold(Flags::NONE, |all, flags| all | flags)
    }
}

fn merge_flags(flags: &[Flags]) -> Flags {
    flags.iter().fold(Flags::NONE, |all, flags| all | *flags)
}

/// Iterator over ranges of valid samples; see [`FlagBlock::valid_ranges`].
pub(super) struct ValidRanges<'a> {
    /// Flags of the samples. Empty if all samples are valid.
    samples: &'a [Flags],
    range: Range<usize>,
}

impl Iterator for ValidRanges<'_> {
    type Item = Range<usize>;

    fn next(&mut self) -> Option<Range<usize>> {
        if self.range.is_empty() {
            return None;
        }
        let Some(rest) = self.samples.get(self.range.clone()) else {
            let all = self.range.clone();
            self.range.start = self.range.end;
            return Some(all);
        };
        let bad = |flags: &Flags| flags.contains(Flags::BAD);
        let Some(skipped) = rest.iter().position(|flags| !bad(flags)) else {
            self.range.start = self.range.end;
            return None;
        };
        let length = rest.iter().skip(skipped).position(bad).unwrap_or(rest.len() - skipped);
        let start = self.range.start + skipped;
        self.range.start = start + length;
        Some(start..start + length)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bad_sample_breaks_line() {
        let mut block = FlagBlock::default();
        assert_eq!(block.memory(), 0);
        block.add_flags(5, Flags::NONE);
        assert_eq!(block.memory(), 0);
        block.add_flags(5, Flags::BAD);
        assert!(block.get(5).contains(Flags::BREAK));
        block.clear();
        assert_eq!((block.all_flags(), block.get(5)), (Flags::NONE, Flags::NONE));
    }

    #[test]
    fn range_combines_sample_flags() {
        let mut block = FlagBlock::default();
        block.add_flags(63, Flags::WARNING);
        block.add_flags(64, Flags::BREAK);
        block.add_flags(BLOCK - 1, Flags::BAD);
        let cases = [
            (0..63, Flags::NONE),
            (0..64, Flags::WARNING),
            (0..65, Flags::WARNING | Flags::BREAK),
            (64..128, Flags::BREAK),
            (65..BLOCK - 1, Flags::NONE),
            (65..BLOCK, Flags::BAD | Flags::BREAK),
            (63..63, Flags::NONE),
        ];
        for (range, flags) in cases {
            assert_eq!(block.flags_in(range.clone()), flags, "{range:?}");
        }
    }

    #[test]
    fn range_flags_match_full_scan() {
        let mut random = fastrand::Rng::with_seed(4);
        for flagged in [1, 3, 40, 2_000] {
            let mut block = FlagBlock::default();
            let mut plain = vec![Flags::NONE; BLOCK];
            for _ in 0..flagged {
                let (at, flags) = (random.usize(..BLOCK), KINDS[random.usize(..3)]);
                block.add_flags(at, flags);
                plain[at] |= flags.with_implied_flags();
            }
            for _ in 0..2_000 {
                let (one, other) = (random.usize(..=BLOCK), random.usize(..=BLOCK));
                // Covers short ranges as well as long ones.
                let other = if random.bool() { other } else { (one + other % 70).min(BLOCK) };
                let range = one.min(other)..one.max(other);
                assert_eq!(block.flags_in(range.clone()), merge_flags(&plain[range.clone()]), "{range:?}");
                let good: usize = block.valid_ranges(range.clone()).map(|stretch| stretch.len()).sum();
                assert_eq!(good, plain[range].iter().filter(|flags| !flags.contains(Flags::BAD)).count());
            }
            for (at, flags) in plain.iter().enumerate() {
                assert_eq!(block.get(at), *flags);
                assert!(!block.is_known_valid(at) || !flags.contains(Flags::BAD));
            }
            assert_eq!(block.all_flags(), merge_flags(&plain));
        }
    }

    #[test]
    fn valid_ranges_exclude_bad_samples() {
        let mut block = FlagBlock::default();
        block.add_flags(1, Flags::WARNING);
        assert!(block.valid_ranges(0..9).eq(std::iter::once(0..9)));
        for at in [0, 3, 4, 8] {
            block.add_flags(at, Flags::BAD);
        }
        assert_eq!(block.valid_ranges(0..9).collect::<Vec<_>>(), [1..3, 5..8]);
        assert_eq!(block.valid_ranges(3..5).count(), 0);
        assert_eq!(block.valid_ranges(2..2).count(), 0);
    }
}
