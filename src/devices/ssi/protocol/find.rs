//! Search for the layout of recorded frames.
//!
//! The search tries every way to interpret the frames as numbers. A turning shaft moves evenly, whereas a wrong
//! interpretation causes jumps. Layouts are ranked by how common they are, and by the amount of information in the
//! frames that they do not explain. Layouts that the frames cannot distinguish form a class, and the result states the
//! motion that would distinguish them.

mod candidates;
mod custom_frames;
mod family_candidates;
mod frame_set;
mod motion;
mod plausible;
mod probe;
mod reading;
mod step_counts;
#[cfg(test)]
mod tests;
mod verdict;

use std::collections::HashSet;

use candidates::{LayoutCandidate, group_members};
use frame_set::FrameSet;
use motion::Motion;
use probe::LayoutProbe;
use reading::{FrameNumbers, best_readings};

use super::family::{Families, Settings};
use super::layout::Layout;

/// Maximum number of frames analysed. Only the newest frames are used.
const MAX_FRAMES: usize = 4_000;
/// Minimum number of different frames. With fewer frames, the shaft is assumed to be at rest.
const MIN_DIFFERENT_FRAMES: usize = 32;
const CLASSES: usize = 6;
/// Penalty in bits per unit of weight. Less common layouts have a higher weight. The penalty applies once per
/// recording.
const WEIGHT_BITS: f64 = 8.0;
/// Maximum difference in weight between any layout in a class and the most probable one. Less probable layouts are
/// omitted.
const MAX_EXTRA_WEIGHT: f64 = 8.0;
/// Minimum number of frames per thousand in which two interpretations must agree to be considered the same.
const MIN_AGREEING_PERMILLE: usize = 995;
/// Maximum number of bits by which an interpretation may need more information than the best one. Beyond this limit, it
/// is not compared with families.
const NEAR_BITS: f64 = 300.0;

/// The result of a search for the layout of recorded frames.
#[derive(Clone, Debug, PartialEq)]
pub struct Search {
    /// Number of recorded frames.
    pub frames: usize,
    /// Number of different frames.
    pub different: usize,
    /// Reason why the best result is uncertain, or `None` if every bit is explained and no other class fits equally
    /// well.
    pub uncertainty: Option<UncertaintyReason>,
    /// Classes of possible layouts, best first. The list may be empty.
    pub classes: Vec<LayoutClass>,
}

/// The reason why the result of a search is uncertain.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum UncertaintyReason {
    /// The shaft was at rest or hardly moved.
    Standing,
    /// All bits of all frames have the same value.
    Stuck {
        /// Whether all bits are 1, rather than 0.
        high: bool,
    },
    /// No interpretation of the frames yields steady motion. The data are not SSI, the line is disturbed, or the shaft
    /// turns too fast.
    Nothing,
    /// Two classes fit equally well.
    Close,
    /// One class fits best, but some of its properties are not proven.
    Open,
}

/// A class of layouts that the recorded frames cannot distinguish.
#[derive(Clone, Debug, PartialEq)]
pub struct LayoutClass {
    /// Layouts in the class, most probable first. Factory settings come before changed ones, and usual widths before
    /// unusual ones.
    pub members: Vec<LayoutProposal>,
    /// Evidence for the layouts in the class.
    pub evidence: ClassEvidence,
    /// Shaft motions that would distinguish or confirm the layouts.
    pub open: Vec<OpenQuestion>,
}

/// A layout that fits the recorded frames.
#[derive(Clone, Debug, PartialEq)]
pub struct LayoutProposal {
    /// Family key and settings, or `None` for a frame without a family. Swapped data wires are not a setting and appear
    /// only in the layout.
    pub family: Option<(String, Settings)>,
    /// Layout of the frame.
    pub layout: Layout,
}

impl LayoutProposal {
    /// Returns the layout as a single word for the command line. The word names an encoder family with as few settings
    /// as possible. If no family matches, the word describes the complete frame.
    pub fn spec_text(&self, families: &Families) -> String {
        let descriptor = self.layout.descriptor();
        let named = self.family.as_ref().and_then(|(key, _)| {
            let settings = families.find_by_key(key)?.settings_for_frame(descriptor)?;
            Some(settings.emit(key))
        });
        named.unwrap_or_else(|| descriptor.spec_text())
    }
}

/// The evidence for a class of layouts.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ClassEvidence {
    /// Score from 0 to 1, which depends on how well the layout explains the frames and how common it is.
    pub score: f64,
    /// Number of frames that are consistent with the frames next to them.
    pub explained: usize,
    /// Median distance between consecutive frames in steps of the lowest bit.
    pub steps_per_frame: i64,
    /// Bits of information per frame that cannot be predicted from the previous frames.
    pub bits_per_frame: f64,
    /// Number of frames whose position jumps relative to the previous frame.
    pub jumps: usize,
    /// Number of frames in which a constant bit has another value or the code word is invalid.
    pub misfits: usize,
    /// Number of position bits, from the highest bit that changed to the lowest bit.
    pub bits_seen: u8,
}

/// An open question about a class, with the shaft motion that answers it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum OpenQuestion {
    /// The boundary between turns and steps is unknown. Turn the shaft exactly once and note how much the position
    /// increases.
    TurnOnce,
    /// The meaning of clocks that never changed is unknown. Turn the shaft until they change or the position wraps.
    TurnFarther {
        /// First clock that never changed.
        from: u8,
        /// Last clock that never changed.
        to: u8,
    },
    /// The end of the range is unknown. Turn the shaft until the position wraps.
    ReachRangeEnd,
    /// Swapped wires look the same as reversed counting. Turn the shaft clockwise and check whether the position
    /// increases.
    Direction,
    /// The lowest bit of the position is unknown. Turn the shaft at a different and uneven speed.
    OtherSpeed,
    /// The number of steps is unknown. Turn the shaft slowly across the end of the range.
    CrossRangeEnd {
        /// Minimum number of steps that fits the frames.
        least: u32,
        /// Maximum number of steps that fits the frames.
        most: u32,
    },
    /// A bit changes without an explanation.
    Unexplained {
        /// First clock with such a bit.
        clock: u8,
    },
    /// The error bits are unknown. Cause an error, for example by turning the shaft too fast.
    SeeAnError,
    /// Several families send the same frame. Check the type label of the encoder.
    TypeLabel,
}

/// An interpretation of the frames, with all layouts that yield it.
struct Group {
    read: FrameNumbers,
    members: Vec<LayoutCandidate>,
    bits: f64,
}

/// Finds the layouts that fit frames of `clocks` bits. The frames must be right-justified and must have been read
/// consecutively at equal intervals.
pub fn find(frames: &[u64], clocks: u8, families: &Families) -> Search {
    let newest = frames.get(frames.len().saturating_sub(MAX_FRAMES)..).unwrap_or_default();
    let seen = FrameSet::new(newest, clocks);
    let different = seen.distinct_count();
    let search = |uncertainty, classes| Search { frames: frames.len(), different, uncertainty, classes };
    if let Some(high) = seen.stuck_level().filter(|_| !newest.is_empty()) {
        return search(Some(UncertaintyReason::Stuck { high }), Vec::new());
    }
    if different < 8 || seen.is_at_rest() {
        return search(Some(UncertaintyReason::Standing), Vec::new());
    }
    let repeat = seen.detect_repetition();
    let words = repeat.map_or_else(|| FrameSet::new(newest, clocks), |repeat| seen.first_words(repeat));
    let mut groups: Vec<Group> = Vec::new();
    for read in best_readings(&words) {
        let known = groups.iter().position(|group| is_same_motion(&group.read.motion, &read.motion));
        if known.is_none() && groups.len() >= CLASSES {
            continue;
        }
        // Families are searched only if the motion may be correct.
        let near = groups.first().is_none_or(|best| read.bits < best.bits + NEAR_BITS || known == Some(0));
        let best = known.and_then(|known| groups.get(known)).map_or(&read, |group| &group.read);
        let probe = LayoutProbe::new(&seen, &words, repeat, best);
        let mut members = group_members(&probe, &read, &words, repeat, near.then_some(families));
        match known.and_then(|known| groups.get_mut(known)) {
            Some(group) => {
                let worse = (read.bits - group.read.bits).max(0.0) / WEIGHT_BITS;
                members.iter_mut().for_each(|member| member.weight += worse);
                group.members.extend(members);
            }
            None if members.is_empty() => {}
            None => groups.push(Group { bits: read.bits, read, members }),
        }
    }
    if different < MIN_DIFFERENT_FRAMES && !groups.first().is_some_and(|group| group.read.closed) {
        return search(Some(UncertaintyReason::Standing), Vec::new());
    }
    for group in &mut groups {
        // If the step size varies, a lowest bit that never changes is not part of the position. It is a parity bit, or
        // a zero that is covered by the code.
        if verdict::has_varied_steps(&group.read) && group.members.iter().any(|member| !member.trial.never_odd) {
            group.members.retain(|member| !member.trial.never_odd);
        }
        group.members.sort_by(|a, b| a.weight.total_cmp(&b.weight));
        // Different settings can describe the same frame, even within a family.
        let mut known = HashSet::new();
        group.members.retain(|member| {
            let family = member.family.as_ref().map(|(key, _)| key.clone());
            known.insert((family, member.layout.descriptor().spec_text()))
        });
        let most = group.members.first().map_or(0.0, |member| member.weight) + MAX_EXTRA_WEIGHT;
        group.members.retain(|member| member.weight <= most);
        group.bits += WEIGHT_BITS * group.members.first().map_or(0.0, |member| member.weight);
    }
    groups.sort_by(|a, b| a.bits.total_cmp(&b.bits));
    let uncertainty = verdict::uncertainty_reason(&words, &groups);
    search(uncertainty, verdict::merge_classes(&words, groups))
}

/// Returns whether two interpretations of the frames result in the same motion. It may be reversed, or scaled by a
/// small power of two.
fn is_same_motion(one: &Motion, other: &Motion) -> bool {
    let halvings = |motion: &Motion| {
        let steps =
            || motion.steps.iter().enumerate().filter(|(at, _)| motion.is_even(*at)).filter_map(|(_, step)| *step);
        let all = steps().filter(|step| *step != 0).count();
        (1..=3_u32)
            .take_while(|by| steps().filter(|step| step % (1 << by) != 0).count() * 50 <= all)
            .last()
            .unwrap_or(0)
    };
    let (by, other_by) = (halvings(one), halvings(other));
    let both = one.steps.iter().zip(&other.steps).enumerate();
    let both =
        both.filter(|(at, _)| one.is_even(*at) && other.is_even(*at)).filter_map(|(_, (a, b))| Some(((*a)?, (*b)?)));
    let (mut all, mut forwards, mut backwards) = (0, 0, 0);
    for (step, other) in both {
        all += 1;
        forwards += usize::from(step >> by == other >> other_by);
        backwards += usize::from(step >> by == -(other >> other_by));
    }
    // Where one motion jumps, the other one must jump as well.
    let even = |motion: &Motion| (0..motion.steps.len()).filter(|at| motion.is_even(*at)).count();
    // A disturbed bit may affect only one of the two readings.
    let disturbed = one.jumps.min(other.jumps) / 2;
    let most = even(one).max(even(other));
    (all + disturbed) * 1000 >= MIN_AGREEING_PERMILLE * most
        && forwards.max(backwards) * 1000 >= MIN_AGREEING_PERMILLE * all
}
