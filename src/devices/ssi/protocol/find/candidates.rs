//! Candidate layouts for an interpretation of recorded frames: encoder families with possible settings, and other
//! layouts of common widths.

use super::custom_frames::try_custom_frames;
use super::family_candidates::try_families;
use super::frame_set::FrameSet;
use super::probe::{LayoutProbe, TrialReading};
use super::reading::{FrameNumbers, Reading};
use crate::devices::ssi::protocol::code::Code;
use crate::devices::ssi::protocol::descriptor::{Parity, Repeat};
use crate::devices::ssi::protocol::family::{Families, Settings};
use crate::devices::ssi::protocol::layout::Layout;

/// Weight of a frame that belongs to no family. A changed setting of a family, in comparison, has a weight of 0.8.
pub(super) const NO_FAMILY_WEIGHT: f64 = 2.0;
pub(super) const SWAPPED_WIRES_WEIGHT: f64 = 2.0;
pub(super) const GRAY_PADDING_WEIGHT: f64 = 1.5;
const EVEN_ONLY_WEIGHT: f64 = 8.0;

#[derive(Clone, Debug)]
pub(super) struct LayoutCandidate {
    pub(super) family: Option<(String, Settings)>,
    pub(super) layout: Layout,
    pub(super) weight: f64,
    pub(super) trial: TrialReading,
}

/// Callback that tests a candidate layout with its weight, and keeps the layout if it fits.
pub(super) type TestCandidateFn<'a> = dyn FnMut(Option<(String, Settings)>, Layout, f64) + 'a;

/// Returns the layouts that fit the interpretation of the frames and yield the motion of the probe, in no particular
/// order.
pub(super) fn group_members(
    probe: &LayoutProbe<'_>,
    read: &FrameNumbers,
    words: &FrameSet,
    repeat: Option<Repeat>,
    families: Option<&Families>,
) -> Vec<LayoutCandidate> {
    let mut found = Vec::new();
    let mut take = |family: Option<(String, Settings)>, layout: Layout, weight: f64| {
        if let Some(trial) = probe.try_layout(&layout) {
            let weight = weight + if trial.never_odd { EVEN_ONLY_WEIGHT } else { 0.0 };
            found.push(LayoutCandidate { family, layout, weight, trial });
        }
    };
    let inverted = possible_inversions(read);
    if let Some(families) = families.filter(|_| repeat.is_none()) {
        for (place, family) in families.iter().enumerate() {
            for inverted in inverted {
                try_families(&mut take, read, words, (place, family), *inverted);
            }
        }
    }
    for inverted in inverted {
        try_custom_frames(&mut take, read, words, (probe.clock_count(), repeat), *inverted);
    }
    found
}

/// Returns whether to try the frames as received, inverted, or both. In binary, swapped wires only reverse the
/// direction.
fn possible_inversions(read: &FrameNumbers) -> &'static [bool] {
    match (read.reading.code, read.reading.inverted) {
        (Code::Binary, _) if read.reading.steps.is_none() => &[false, true],
        (_, true) => &[true],
        (_, false) => &[false],
    }
}

/// Returns the parity as sent by the encoder. Swapped wires invert the parity if it covers an odd number of bits.
pub(super) fn encoder_parity(reading: &Reading, inverted: bool) -> Option<Parity> {
    let turned = |parity: Parity| inverted && parity.clock % 2 == 1;
    reading.parity.map(|parity| Parity { even: parity.even != turned(parity), ..parity })
}

/// Returns the even parity bit after a Gray code, if any. Both this bit and a zero that is covered by the code look
/// like the lowest position bit.
pub(super) fn find_ambiguous_parity(reading: &Reading, inverted: bool) -> Option<Parity> {
    encoder_parity(reading, inverted).filter(|parity| reading.code == Code::Gray && parity.even)
}

/// Returns whether nearly all steps are even, so that the lowest bit carries no information.
pub(super) fn has_only_even_steps(read: &FrameNumbers) -> bool {
    let steps = read.motion.steps.iter().zip(&read.motion.uneven);
    let steps = steps.filter(|(_, uneven)| uneven.unsigned_abs() <= read.motion.limit).filter_map(|(step, _)| *step);
    let (mut all, mut odd) = (0, 0);
    for step in steps.filter(|step| *step != 0) {
        all += 1;
        odd += usize::from(step % 2 != 0);
    }
    odd * 50 <= all
}

pub(super) fn sum(weights: &[(bool, f64)]) -> f64 {
    weights.iter().filter(|(counts, _)| *counts).map(|(_, weight)| weight).sum()
}
