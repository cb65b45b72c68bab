//! Test of a candidate layout, which must yield the same motion as the reading of the frames.

use super::frame_set::FrameSet;
use super::motion::shortest_step;
use super::reading::FrameNumbers;
use crate::devices::ssi::protocol::descriptor::{BitMeaning, Repeat};
use crate::devices::ssi::protocol::layout::{Flags, Layout};

const TRIAL_FRAMES: usize = 96;
/// Maximum percentage of tested frames that do not fit the layout.
const MAX_MISFIT_PERCENT: usize = 4;

#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct TrialReading {
    pub(super) positions: Vec<u64>,
    /// Whether the positions of the layout decrease while the numbers found in the frames increase.
    pub(super) backwards: bool,
    pub(super) never_odd: bool,
}

/// Pairs of frames with the steps between them, used to test layouts.
pub(super) struct LayoutProbe<'a> {
    seen: &'a FrameSet,
    read: &'a FrameNumbers,
    /// Indices of frames from which the motion to the next frame is steady. The flag is set if the position wraps
    /// between the two frames.
    pairs: Vec<(usize, bool)>,
}

impl<'a> LayoutProbe<'a> {
    /// Creates a probe. `read` must be a reading of `words`, which are the frames of `seen` or the first words of these
    /// frames.
    pub(super) fn new(seen: &'a FrameSet, words: &FrameSet, repeat: Option<Repeat>, read: &'a FrameNumbers) -> Self {
        let again = |frame: u64| repeat.is_none_or(|repeat| seen.is_repeated(frame, repeat));
        let usual = |word: u64| {
            words.bits().all(|(clock, bit)| {
                bit.moves || read.reading.uses_clock(clock) || (word >> (words.clocks - clock) & 1 == 1) == bit.usual
            })
        };
        let right = |word: u64| read.reading.parity.is_none_or(|parity| words.is_parity_valid(word, parity));
        let undisturbed: Vec<bool> = seen
            .words()
            .iter()
            .zip(words.words())
            .map(|(frame, word)| again(*frame) && usual(*word) && right(*word))
            .collect();
        let fits = |index: &usize| {
            let both = undisturbed.get(*index..index + 2).is_some_and(|both| both == [true, true]);
            both && read.motion.is_even(*index)
        };
        let even: Vec<usize> = (0..read.motion.steps.len()).filter(fits).collect();
        let ends = even
            .iter()
            .filter(|index| read.wraps_after_frame(**index))
            .take(TRIAL_FRAMES / 4)
            .map(|index| (*index, true));
        let every = (even.len() / TRIAL_FRAMES).max(1);
        let mut pairs: Vec<(usize, bool)> =
            even.iter().step_by(every).map(|index| (*index, read.wraps_after_frame(*index))).chain(ends).collect();
        pairs.sort_unstable();
        pairs.dedup();
        LayoutProbe { seen, read, pairs }
    }

    pub(super) fn clock_count(&self) -> u8 {
        self.seen.clocks
    }

    /// Tests whether the steps of a layout match those found in the frames, in either direction and up to a power of
    /// two. Returns `None` if they do not match.
    pub(super) fn try_layout(&self, layout: &Layout) -> Option<TrialReading> {
        let form = Flags::CODE.union(Flags::PADDING).union(Flags::PARITY).union(Flags::REPEAT);
        let invalid =
            layout.descriptor().errors.iter().enumerate().filter(|(_, bit)| bit.meaning == BitMeaning::Invalid);
        let wrong = invalid.fold(form, |all, (at, _)| all.union(Flags::error(at)));
        let lost = u32::from(layout.loses_lowest_bit());
        let round = layout.position_code().last_position().wrapping_add(1) >> lost;
        let most = self.pairs.len() * MAX_MISFIT_PERCENT / 100;
        let most_ends = self.pairs.iter().filter(|(_, end)| *end).count() / 5;
        let (mut misfits, mut at_ends, mut scale) = (0, 0, None);
        let mut positions = Vec::with_capacity(self.pairs.len());
        let (mut moved, mut odd) = (0, 0);
        for (index, end) in &self.pairs {
            let frames = self.seen.words().get(*index).zip(self.seen.words().get(index + 1));
            let step = self.read.motion.steps.get(*index).copied().flatten();
            let Some(((one, other), step)) = frames.zip(step) else { continue };
            let (one, other) = (layout.decode(*one), layout.decode(*other));
            positions.push(one.position >> lost);
            let own = shortest_step((other.position >> lost).wrapping_sub(one.position >> lost), round);
            moved += usize::from(own != 0);
            odd += usize::from(own % 2 != 0);
            let is_wrong = one.flags.intersects(wrong) || other.flags.intersects(wrong);
            let fits = !is_wrong
                && match scale {
                    None if step == 0 || own == 0 => step == own,
                    None => Scale::from_steps(step, own).inspect(|found| scale = Some(*found)).is_some(),
                    Some(scale) => scale.fits_step(step, own, round),
                };
            misfits += usize::from(!fits);
            at_ends += usize::from(!fits && *end);
            if misfits > most || at_ends > most_ends {
                return None;
            }
        }
        scale.map(|scale| TrialReading { positions, backwards: scale.backwards, never_odd: odd * 50 <= moved })
    }
}

#[derive(Clone, Copy, Debug, PartialEq)]
struct Scale {
    backwards: bool,
    /// Power of two by which the layout's steps are larger than those found in the frames.
    twice: i8,
}

impl Scale {
    fn from_steps(step: i64, own: i64) -> Option<Self> {
        (-3..=3).find_map(|twice: i8| {
            let scale = |backwards| Scale { backwards, twice };
            [scale(false), scale(true)].into_iter().find(|scale| scale.fits_step(step, own, 0))
        })
    }

    fn fits_step(self, step: i64, own: i64, round: u64) -> bool {
        let step = if self.backwards { step.wrapping_neg() } else { step };
        let (left, right) = if self.twice >= 0 {
            (own, step.wrapping_shl(u32::from(self.twice.unsigned_abs())))
        } else {
            (own.wrapping_shl(u32::from(self.twice.unsigned_abs())), step)
        };
        left == right || shortest_step(left.wrapping_sub(right) as u64, round) == 0 && round != 0
    }
}
