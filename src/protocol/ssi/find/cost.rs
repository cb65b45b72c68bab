//! How evenly a shaft turns if frames are read in a certain way.

use std::collections::{HashSet, hash_map::DefaultHasher};
use std::hash::{Hash, Hasher};

use super::Evidence;
use crate::protocol::ssi::code::ones;
use crate::protocol::ssi::layout::{Flags, Layout};

/// Of a hundred frames, so many may not fit, and so many may tell of errors.
const MISFITS_PERCENT: usize = 10;
const ERRORS_PERCENT: usize = 20;
/// What a frame costs that does not fit or tells of an error, in bits.
const MISFIT_BITS: f64 = 16.0;
const ERROR_BITS: f64 = 4.0;
/// What a jump costs beside its size.
const JUMP_BITS: f64 = 64.0;

/// Recorded frames and what can be seen in them without a layout.
pub(super) struct Seen<'a> {
    frames: &'a [u64],
    pub(super) clocks: u8,
    pub(super) different: usize,
    /// How often the bit on each clock changed, first clock first.
    changes: Vec<usize>,
    any: u64,
    all: u64,
}

/// A way to read the frames.
pub(super) struct Motion {
    pub(super) evidence: Evidence,
    /// Equal where the steps between frames are.
    pub(super) same: u64,
}

impl<'a> Seen<'a> {
    pub(super) fn new(frames: &'a [u64], clocks: u8) -> Self {
        let clocks = clocks.clamp(1, 64);
        let kept = ones(clocks);
        let mut changes = vec![0; usize::from(clocks)];
        for (before, after) in frames.iter().zip(frames.iter().skip(1)) {
            let differs = before ^ after;
            for (clock, count) in (1..=clocks).zip(&mut changes) {
                *count += usize::from(differs >> (clocks - clock) & 1 == 1);
            }
        }
        Seen {
            frames,
            clocks,
            different: frames.iter().map(|frame| frame & kept).collect::<HashSet<_>>().len(),
            changes,
            any: frames.iter().fold(0, |any, frame| any | frame) & kept,
            all: frames.iter().fold(kept, |all, frame| all & frame),
        }
    }

    /// The frames, without bits above their clocks.
    pub(super) fn words(&self) -> impl Iterator<Item = u64> {
        self.frames.iter().map(|frame| frame & ones(self.clocks))
    }

    /// The line stays high or low.
    pub(super) fn stuck(&self) -> Option<bool> {
        if self.any == 0 { Some(false) } else { (self.all == ones(self.clocks)).then_some(true) }
    }

    /// The last clock whose bit changes as often as the lowest bit of a position does.
    pub(super) fn last_moving(&self) -> Option<u8> {
        let often = self.different / 8;
        let last = self.changes.iter().rposition(|count| *count > often)?;
        u8::try_from(last + 1).ok()
    }

    /// How the shaft moved if this is the layout; `None`: it is not.
    pub(super) fn motion(&self, layout: &Layout) -> Option<Motion> {
        let count = self.frames.len();
        let errors_any = (0..layout.descriptor().errors.len()).fold(Flags::NONE, |all, at| all.with(Flags::error(at)));
        let form = Flags::CODE.with(Flags::PADDING).with(Flags::PARITY).with(Flags::REPEAT);
        let (mut misfits, mut errors) = (0, 0);
        let shift = u32::from(layout.loses_lowest_bit());
        let round = (i128::from(layout.coding().last()) + 1) >> shift;
        let mut steps = Vec::with_capacity(count);
        let (mut before, mut any, mut all) = (None, 0, u64::MAX);
        for (index, frame) in self.frames.iter().enumerate() {
            let reading = layout.decode(*frame);
            misfits += usize::from(reading.flags.any(form));
            errors += usize::from(reading.flags.any(errors_any));
            // The first hundreds tell of most layouts that they are none.
            if misfits * 100 > MISFITS_PERCENT * count || (index > 64 && errors * 100 > ERRORS_PERCENT * count) {
                return None;
            }
            if reading.flags.has(Flags::CODE) {
                continue;
            }
            (any, all) = (any | reading.position, all & reading.position);
            let here = i128::from(reading.position >> shift);
            if let Some(before) = before.replace(here) {
                steps.push(nearest(here - before, round));
            }
        }
        if errors * 100 > ERRORS_PERCENT * count {
            return None;
        }
        let mut sorted = steps.clone();
        if sorted.is_empty() {
            return None;
        }
        let middle = sorted.len() / 2;
        let median = *sorted.select_nth_unstable(middle).1;
        let widest = 1.0 + 2.0 * f64::from(layout.coding().bits());
        let uneven = |step: &i64| step.abs_diff(median);
        let bits: f64 = steps.iter().map(|step| (1.0 + 2.0 * (1.0 + uneven(step) as f64).log2()).min(widest)).sum();
        let jumps = steps.iter().filter(|step| uneven(step) > 16 + 2 * median.unsigned_abs()).count();
        let beside = MISFIT_BITS * misfits as f64 + ERROR_BITS * errors as f64 + JUMP_BITS * jumps as f64;
        let mut same = DefaultHasher::new();
        (&steps, misfits).hash(&mut same);
        Some(Motion {
            evidence: Evidence {
                steps_a_frame: median,
                bits_a_frame: (bits + beside) / count as f64,
                jumps,
                misfits,
                errors,
                bits_seen: (any & !all).count_ones() as u8,
            },
            same: same.finish(),
        })
    }
}

impl Motion {
    /// The positions follow from one another for less than half of what they would cost one by one.
    pub(super) fn is_even(&self) -> bool {
        self.evidence.bits_a_frame < 0.5 * (1.0 + 2.0 * f64::from(self.evidence.bits_seen))
    }
}

/// A step around the end of the range is a short one.
fn nearest(step: i128, round: i128) -> i64 {
    let around = step.rem_euclid(round);
    let short = if around * 2 > round { around - round } else { around };
    short.clamp(i64::MIN.into(), i64::MAX.into()) as i64
}
