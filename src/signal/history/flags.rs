//! What is remarkable about a sample, and the flags of a block of samples with their summary. Says nothing about values.

use std::ops::{BitOr, BitOrAssign, Range};

use super::BLOCK;

/// What is remarkable about a sample: a set of [`BREAK`](Flags::BREAK), [`BAD`](Flags::BAD) and
/// [`WARNING`](Flags::WARNING).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[repr(transparent)]
pub struct Flags(u8);

impl Flags {
    /// Nothing.
    pub const NONE: Flags = Flags(0);
    /// Something is missing between the sample before and this one: they are not to be joined by a line.
    pub const BREAK: Flags = Flags(1);
    /// The value is not to be believed: it counts nowhere, and the line is broken. Brings [`BREAK`](Flags::BREAK) with it.
    pub const BAD: Flags = Flags(2);
    /// The device warned; the value counts.
    pub const WARNING: Flags = Flags(4);

    /// Every flag of `other` is set here.
    pub const fn contains(self, other: Flags) -> bool {
        self.0 & other.0 == other.0
    }

    /// What follows from these flags, as it is kept.
    pub(super) const fn completed(self) -> Flags {
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

/// Samples that share one summary.
const GROUP: usize = 64;

/// The flags of a block. Takes memory from the first flag on.
#[derive(Debug, Default)]
pub(super) struct FlagBlock {
    /// What the block has.
    any: Flags,
    kept: Option<Box<Kept>>,
}

#[derive(Debug)]
struct Kept {
    samples: [Flags; BLOCK],
    /// What each `GROUP` of samples has.
    groups: [Flags; BLOCK / GROUP],
}

impl FlagBlock {
    pub(super) fn clear(&mut self) {
        *self = FlagBlock::default();
    }

    /// What any sample of the block has.
    pub(super) fn any(&self) -> Flags {
        self.any
    }

    /// Adds to the flags of the sample `at`, which is below `BLOCK`.
    pub(super) fn mark(&mut self, at: usize, flags: Flags) {
        if flags == Flags::NONE {
            return;
        }
        let nothing = || Box::new(Kept { samples: [Flags::NONE; BLOCK], groups: [Flags::NONE; BLOCK / GROUP] });
        let kept = self.kept.get_or_insert_with(nothing);
        let flags = flags.completed();
        for place in [kept.samples.get_mut(at), kept.groups.get_mut(at / GROUP)].into_iter().flatten() {
            *place |= flags;
        }
        self.any |= flags;
    }

    fn samples(&self) -> &[Flags] {
        self.kept.as_ref().map_or(&[], |kept| &kept.samples)
    }

    pub(super) fn get(&self, at: usize) -> Flags {
        self.samples().get(at).copied().unwrap_or_default()
    }

    /// What the samples of `range` have, together.
    pub(super) fn within(&self, range: Range<usize>) -> Flags {
        let Some(kept) = &self.kept else { return Flags::NONE };
        let (from, to) = (range.start.next_multiple_of(GROUP), range.end / GROUP * GROUP);
        if from >= to {
            return union(&kept.samples, range);
        }
        union(&kept.samples, range.start..from)
            | union(&kept.groups, from / GROUP..to / GROUP)
            | union(&kept.samples, to..range.end)
    }

    /// The stretches of `range` whose samples have a value to believe.
    pub(super) fn good(&self, range: Range<usize>) -> Good<'_> {
        let samples = if self.any.contains(Flags::BAD) { self.samples() } else { &[] };
        Good { samples, range }
    }

    /// Bytes on the heap.
    pub(super) fn memory(&self) -> usize {
        self.kept.as_ref().map_or(0, |_| size_of::<Kept>())
    }
}

fn union(flags: &[Flags], range: Range<usize>) -> Flags {
    flags.get(range).unwrap_or_default().iter().fold(Flags::NONE, |all, flags| all | *flags)
}

/// See [`FlagBlock::good`].
pub(super) struct Good<'a> {
    /// None: all of them are good.
    samples: &'a [Flags],
    range: Range<usize>,
}

impl Iterator for Good<'_> {
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
    fn a_bad_sample_breaks_the_line() {
        let mut block = FlagBlock::default();
        assert_eq!(block.memory(), 0);
        block.mark(5, Flags::NONE);
        assert_eq!(block.memory(), 0);
        block.mark(5, Flags::BAD);
        assert!(block.get(5).contains(Flags::BREAK));
        block.clear();
        assert_eq!((block.any(), block.get(5)), (Flags::NONE, Flags::NONE));
    }

    #[test]
    fn a_range_has_the_flags_of_its_samples_and_no_others() {
        let mut block = FlagBlock::default();
        block.mark(63, Flags::WARNING);
        block.mark(64, Flags::BREAK);
        block.mark(BLOCK - 1, Flags::BAD);
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
            assert_eq!(block.within(range.clone()), flags, "{range:?}");
        }
    }

    #[test]
    fn stretches_leave_bad_samples_out() {
        let mut block = FlagBlock::default();
        block.mark(1, Flags::WARNING);
        assert!(block.good(0..9).eq(std::iter::once(0..9)));
        for at in [0, 3, 4, 8] {
            block.mark(at, Flags::BAD);
        }
        assert_eq!(block.good(0..9).collect::<Vec<_>>(), [1..3, 5..8]);
        assert_eq!(block.good(3..5).count(), 0);
        assert_eq!(block.good(2..2).count(), 0);
    }
}
