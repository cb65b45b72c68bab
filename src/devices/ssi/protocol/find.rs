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
use members::{Member, group_members};
use motion::Motion;
use probe::Probe;
use reading::{Read, readings};

use super::family::{Families, Settings};
use super::layout::Layout;

/// Largest number of frames that are analysed: the newest.
const MOST_FRAMES: usize = 4_000;
/// Least number of different frames: with fewer, the shaft stands still, or trembles.
const LEAST_DIFFERENT: usize = 32;
const CLASSES: usize = 6;
/// Penalty for a class that is less usual by one setting, in bits of all frames.
const WEIGHT_BITS: f64 = 8.0;
/// Classes less probable than the first by this much are left out.
const IMPROBABLE: f64 = 8.0;
/// Of a thousand frames, those in which two readings have to agree to be the same.
const SAME_PERMILLE: usize = 995;
/// Families are searched for readings that need no more bits than this beyond the best, for all frames.
const NEAR_BITS: f64 = 300.0;

/// The result of the search.
#[derive(Clone, Debug, PartialEq)]
pub struct Search {
    /// Number of frames.
    pub frames: usize,
    /// Number of different frames.
    pub different: usize,
    /// The reason why the first class is not certain; `None`: it is the only one, and every bit is explained.
    pub doubt: Option<Uncertainty>,
    /// The possible classes, the best first; may be empty.
    pub classes: Vec<Class>,
}

/// The reason why the result is not certain.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Uncertainty {
    /// The shaft was at standstill, or hardly moved.
    Standing,
    /// Every bit is 0 or 1 in all frames.
    Stuck {
        /// Whether it is 1.
        high: bool,
    },
    /// No reading makes the motion even: not SSI, a disturbed line, or a shaft that turns too fast.
    Nothing,
    /// Two classes fit as well.
    Close,
    /// One class remains, but not every bit of it is explained.
    Open,
}

/// Layouts that these frames cannot distinguish.
#[derive(Clone, Debug, PartialEq)]
pub struct Class {
    /// The most probable first: factory settings before changed ones, usual widths before others.
    pub members: Vec<Proposal>,
    /// The evidence.
    pub evidence: Evidence,
    /// Motions that would separate the members, or prove them.
    pub open: Vec<Open>,
}

/// A layout that fits.
#[derive(Clone, Debug, PartialEq)]
pub struct Proposal {
    /// The family's key with its settings; `None`: any other encoder. Exchanged data wires are only in the layout.
    pub family: Option<(String, Settings)>,
    /// The frame.
    pub layout: Layout,
}

impl Proposal {
    /// Returns the layout in one word, as for the command line: a family with as few settings as possible, or any frame.
    pub fn spec(&self, families: &Families) -> String {
        let descriptor = self.layout.descriptor();
        let named = self.family.as_ref().and_then(|(key, _)| {
            let settings = families.named(key)?.settings_of(descriptor)?;
            Some(settings.emit(key))
        });
        named.unwrap_or_else(|| descriptor.spec())
    }
}

/// The evidence for a layout.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Evidence {
    /// 0…1: the quality of its explanation of the frames, and how usual it is.
    pub score: f64,
    /// Frames that follow from their neighbours.
    pub explained: usize,
    /// Steps of the lowest bit between two frames, in the middle.
    pub steps_a_frame: i64,
    /// Information in a frame beyond the previous ones, in bits.
    pub bits_a_frame: f64,
    /// Frames that jump from the one before.
    pub jumps: usize,
    /// Frames with another value for a constant bit, or an invalid code word.
    pub misfits: usize,
    /// Bits from the highest that moved to the lowest.
    pub bits_seen: u8,
}

/// An open question: how to separate the members of a class, or an unexplained bit.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Open {
    /// The boundary of turns and steps: turn exactly once, and note the increase of the position.
    TurnOnce,
    /// The meaning of clocks that never changed: turn until they do, or the position starts again.
    TurnFarther {
        /// The first of them.
        from: u8,
        /// The last of them.
        to: u8,
    },
    /// The end of the range: turn until the position starts again.
    PassAnEnd,
    /// Exchanged wires or reversed counting: turn clockwise, and check whether the position increases.
    Direction,
    /// The lowest bit: turn at another speed, unevenly.
    OtherSpeed,
    /// The number of steps: turn slowly across the end of the range.
    PassTheEnd {
        /// The least.
        least: u32,
        /// The most.
        most: u32,
    },
    /// This clock moves, and nothing explains it.
    Unexplained {
        /// The first such clock.
        clock: u8,
    },
    /// The error bits: cause one (turn too fast, exchange the supply).
    SeeAnError,
    /// The family, if two send the same: check the type label.
    TypeLabel,
}

/// A reading of the frames with all layouts that result in it.
struct Group {
    read: Read,
    members: Vec<Member>,
    bits: f64,
}

/// Reads frames of `clocks` bits, right-justified, taken one after the other at even intervals.
pub fn find(frames: &[u64], clocks: u8, families: &Families) -> Search {
    let newest = frames.get(frames.len().saturating_sub(MOST_FRAMES)..).unwrap_or_default();
    let seen = FrameSet::new(newest, clocks);
    let different = seen.different();
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
        let probe = Probe::new(&seen, &words, repeat, best);
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
        if verdict::is_varied(&group.read) && group.members.iter().any(|member| !member.trial.never_odd) {
            group.members.retain(|member| !member.trial.never_odd);
        }
        group.members.sort_by(|a, b| a.weight.total_cmp(&b.weight));
        // The same frame has several names, also within a family.
        let mut known = HashSet::new();
        group.members.retain(|member| {
            let family = member.family.as_ref().map(|(key, _)| key.clone());
            known.insert((family, member.layout.descriptor().spec()))
        });
        let most = group.members.first().map_or(0.0, |member| member.weight) + IMPROBABLE;
        group.members.retain(|member| member.weight <= most);
        group.bits += WEIGHT_BITS * group.members.first().map_or(0.0, |member| member.weight);
    }
    groups.sort_by(|a, b| a.bits.total_cmp(&b.bits));
    let doubt = verdict::doubt(&words, &groups);
    search(doubt, verdict::classes(&words, groups))
}

/// Returns whether two layouts result in the same motion: forwards or backwards, in the same steps or in halved ones.
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
