//! Search for the layout of recorded frames. Every way to read them as numbers is tried: a turning shaft moves evenly,
//! and misreading a frame causes jumps. Possible layouts are ranked by the information that the frames still require
//! once the layout is known, and by how common they are. Layouts that the frames cannot distinguish form one class,
//! together with the motion that would decide.

mod any_other;
mod code_ends;
mod frame_set;
mod members;
mod motion;
mod of_family;
mod plausible;
mod probe;
mod reading;
#[cfg(test)]
mod tests;
mod verdict;

use std::collections::HashSet;

use frame_set::FrameSet;
use members::{LayoutCandidate, group_members};
use motion::Motion;
use probe::LayoutProbe;
use reading::{Read, readings};

use super::family::{Families, Settings};
use super::layout::Layout;

/// Maximum number of frames analysed, counted from the newest.
const MOST_FRAMES: usize = 4_000;
/// Minimum number of distinct frames. With fewer, the shaft is considered to stand still or jitter.
const LEAST_DIFFERENT: usize = 32;
const CLASSES: usize = 6;
/// Penalty in bits, over all frames, for each setting that makes a class less usual.
const WEIGHT_BITS: f64 = 8.0;
/// Weight beyond that of the most probable member of a class at which other members are left out.
const IMPROBABLE: f64 = 8.0;
/// Minimum number of frames per thousand in which two readings must agree to be considered the same.
const SAME_PERMILLE: usize = 995;
/// Maximum excess in bits over the best reading, for all frames, for families to be searched for a reading.
const NEAR_BITS: f64 = 300.0;

/// Result of a search for layouts.
#[derive(Clone, Debug, PartialEq)]
pub struct Search {
    /// Number of frames.
    pub frames: usize,
    /// Number of different frames.
    pub different: usize,
    /// Reason why the first class is uncertain, or `None` if it is the only one and every bit is explained.
    pub doubt: Option<Uncertainty>,
    /// The possible classes, the best first; may be empty.
    pub classes: Vec<Class>,
}

/// Reason why the result of a search is uncertain.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Uncertainty {
    /// The shaft stood still or hardly moved.
    Standing,
    /// Every bit is 0, or every bit is 1, in all frames.
    Stuck {
        /// Whether it is 1.
        high: bool,
    },
    /// No reading yields an even motion, because the data are not SSI, the line is disturbed, or the shaft turns too
    /// fast.
    Nothing,
    /// Two classes fit equally well.
    Close,
    /// Only one class remains, but some of its bits are unexplained.
    Open,
}

/// Class of layouts that the recorded frames cannot distinguish.
#[derive(Clone, Debug, PartialEq)]
pub struct Class {
    /// Members, most probable first: factory settings before changed ones, usual widths before unusual ones.
    pub members: Vec<Proposal>,
    /// The evidence.
    pub evidence: Evidence,
    /// Motions that would distinguish or confirm the members.
    pub open: Vec<Open>,
}

/// A layout that fits.
#[derive(Clone, Debug, PartialEq)]
pub struct Proposal {
    /// Family key and settings, or `None` for an encoder of no family. Swapped data wires appear only in the layout.
    pub family: Option<(String, Settings)>,
    /// The frame.
    pub layout: Layout,
}

impl Proposal {
    /// Returns the layout as one word for the command line: a family with as few settings as possible, or else a
    /// complete frame specification.
    pub fn spec_text(&self, families: &Families) -> String {
        let descriptor = self.layout.descriptor();
        let named = self.family.as_ref().and_then(|(key, _)| {
            let settings = families.named(key)?.settings_for_frame(descriptor)?;
            Some(settings.emit(key))
        });
        named.unwrap_or_else(|| descriptor.spec_text())
    }
}

/// The evidence for a layout.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Evidence {
    /// Score from 0 to 1 for how well the layout explains the frames and how usual it is.
    pub score: f64,
    /// Frames that follow from their neighbours.
    pub explained: usize,
    /// Median number of steps of the lowest bit between two frames.
    pub steps_a_frame: i64,
    /// Information per frame that the previous frames do not provide, in bits.
    pub bits_a_frame: f64,
    /// Number of frames that jump from the previous one.
    pub jumps: usize,
    /// Number of frames with a deviating constant bit or an invalid code word.
    pub misfits: usize,
    /// Bits from the highest that moved to the lowest.
    pub bits_seen: u8,
}

/// Open question about the members of a class or an unexplained bit, with the motion that answers it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Open {
    /// Boundary between turns and steps: turn exactly once, and note the increase of the position.
    TurnOnce,
    /// Meaning of clocks that never changed: turn until they change or the position wraps.
    TurnFarther {
        /// The first of them.
        from: u8,
        /// The last of them.
        to: u8,
    },
    /// End of the range: turn until the position wraps.
    PassAnEnd,
    /// Swapped wires or reversed counting: turn clockwise, and check whether the position increases.
    Direction,
    /// Lowest bit: turn at another, uneven speed.
    OtherSpeed,
    /// Number of steps: turn slowly across the end of the range.
    PassTheEnd {
        /// The least.
        least: u32,
        /// The most.
        most: u32,
    },
    /// A clock moves without an explanation.
    Unexplained {
        /// The first such clock.
        clock: u8,
    },
    /// Error bits: cause an error (turn too fast, replace the supply).
    SeeAnError,
    /// The family, if two send the same: check the type label.
    TypeLabel,
}

/// Reading of the frames, with all layouts that yield this reading.
struct Group {
    read: Read,
    members: Vec<LayoutCandidate>,
    bits: f64,
}

/// Finds the layouts that fit frames of `clocks` bits, right-justified and sampled consecutively at equal intervals.
pub fn find(frames: &[u64], clocks: u8, families: &Families) -> Search {
    let newest = frames.get(frames.len().saturating_sub(MOST_FRAMES)..).unwrap_or_default();
    let seen = FrameSet::new(newest, clocks);
    let different = seen.distinct_count();
    let search = |doubt, classes| Search { frames: frames.len(), different, doubt, classes };
    if let Some(high) = seen.stuck().filter(|_| !newest.is_empty()) {
        return search(Some(Uncertainty::Stuck { high }), Vec::new());
    }
    if different < 8 || seen.is_standing() {
        return search(Some(Uncertainty::Standing), Vec::new());
    }
    let repeat = seen.repeat();
    let words = repeat.map_or_else(|| FrameSet::new(newest, clocks), |repeat| seen.first_words(repeat));
    let mut groups: Vec<Group> = Vec::new();
    for read in readings(&words) {
        let known = groups.iter().position(|group| same(&group.read.motion, &read.motion));
        if known.is_none() && groups.len() >= CLASSES {
            continue;
        }
        // Families are searched if the motion may be right.
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
    if different < LEAST_DIFFERENT && !groups.first().is_some_and(|group| group.read.closed) {
        return search(Some(Uncertainty::Standing), Vec::new());
    }
    for group in &mut groups {
        // If steps vary, a lowest bit that never changes is not one: it is a parity, or a zero that the code covers.
        if verdict::has_varied_steps(&group.read) && group.members.iter().any(|member| !member.trial.never_odd) {
            group.members.retain(|member| !member.trial.never_odd);
        }
        group.members.sort_by(|a, b| a.weight.total_cmp(&b.weight));
        // The same frame has several names, also within a family.
        let mut known = HashSet::new();
        group.members.retain(|member| {
            let family = member.family.as_ref().map(|(key, _)| key.clone());
            known.insert((family, member.layout.descriptor().spec_text()))
        });
        let most = group.members.first().map_or(0.0, |member| member.weight) + IMPROBABLE;
        group.members.retain(|member| member.weight <= most);
        group.bits += WEIGHT_BITS * group.members.first().map_or(0.0, |member| member.weight);
    }
    groups.sort_by(|a, b| a.bits.total_cmp(&b.bits));
    let doubt = verdict::doubt(&words, &groups);
    search(doubt, verdict::merge_classes(&words, groups))
}

/// Returns whether two layouts yield the same motion, possibly reversed or with steps of half the size.
fn same(one: &Motion, other: &Motion) -> bool {
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
    // If one of them jumps, the other must as well.
    let even = |motion: &Motion| (0..motion.steps.len()).filter(|at| motion.is_even(*at)).count();
    // A disturbed bit may be one that the other ignores.
    let disturbed = one.jumps.min(other.jumps) / 2;
    let most = even(one).max(even(other));
    (all + disturbed) * 1000 >= SAME_PERMILLE * most && forwards.max(backwards) * 1000 >= SAME_PERMILLE * all
}
