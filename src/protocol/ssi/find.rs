//! Finds the layout of recorded frames: every frame that a family can send, and any other, is read as if it were the
//! one, and what makes the shaft turn most evenly is proposed. A turning shaft moves evenly; a frame that is read wrong
//! jumps. What these frames cannot tell apart is one class, with what would decide.

mod candidates;
mod cost;
#[cfg(test)]
mod tests;

use std::collections::HashMap;

use candidates::{Candidate, candidates};
use cost::{Motion, Seen};

use super::family::{Families, Settings};
use super::layout::Layout;

/// Fewer different frames say nothing: a shaft that stands, or trembles.
const LEAST_DIFFERENT: usize = 32;
/// A class is only first if the next one needs so many bits more for all frames.
const LEAST_LEAD_BITS: f64 = 64.0;

/// What was found.
#[derive(Clone, Debug, PartialEq)]
pub struct Search {
    /// How many frames there were.
    pub frames: usize,
    /// How many of them were different.
    pub different: usize,
    /// Why the first class is not to be relied on; `None`: it is.
    pub doubt: Option<Doubt>,
    /// What fits, the best first. Empty if nothing does.
    pub classes: Vec<Class>,
}

/// Why nothing can be said for sure.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Doubt {
    /// The shaft stood, or hardly moved.
    Standing,
    /// Every bit is 0 or 1 in all frames.
    Stuck {
        /// It is 1.
        high: bool,
    },
    /// Nothing makes the motion even: not SSI, a disturbed line, or a shaft that turns too fast.
    Nothing,
    /// Two classes fit as well.
    Close,
}

/// Layouts that these frames cannot tell apart.
#[derive(Clone, Debug, PartialEq)]
pub struct Class {
    /// The most probable first: as delivered before what had to be set, families before any other encoder.
    pub members: Vec<Proposal>,
    /// What speaks for it.
    pub evidence: Evidence,
    /// What would tell the members apart.
    pub open: Vec<Open>,
}

/// A layout that fits.
#[derive(Clone, Debug, PartialEq)]
pub struct Proposal {
    /// The family's key with its settings; `None`: any other encoder.
    pub family: Option<(String, Settings)>,
    /// The frame.
    pub layout: Layout,
}

/// What speaks for a layout.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Evidence {
    /// Steps of the lowest bit between two frames, in the middle.
    pub steps_a_frame: i64,
    /// What has to be said of a frame so that its position is known from the one before, in bits.
    pub bits_a_frame: f64,
    /// Frames that jump from the one before.
    pub jumps: usize,
    /// Frames with a 1 where a 0 belongs, or a code word that is none.
    pub misfits: usize,
    /// Frames in which an error bit speaks.
    pub errors: usize,
    /// Bits of the position that changed at all.
    pub bits_seen: u8,
}

/// What would tell the members of a class apart.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Open {
    /// Where turns end and steps begin: turn exactly once, and see by how much the position grows.
    TurnOnce,
    /// How many bits the position has: turn on, until further bits change.
    TurnFarther,
    /// Where error bits are: see one speak (turn too fast, exchange the supply).
    SeeAnError,
    /// Which of two families that send the same: the type label.
    TypeLabel,
}

/// Reads frames of `clocks` bits, right-justified, taken one after the other at even intervals.
pub fn find(frames: &[u64], clocks: u8, families: &Families) -> Search {
    let seen = Seen::new(frames, clocks);
    let nothing =
        |doubt| Search { frames: frames.len(), different: seen.different, doubt: Some(doubt), classes: Vec::new() };
    if frames.is_empty() {
        return nothing(Doubt::Standing);
    }
    if let Some(high) = seen.stuck() {
        return nothing(Doubt::Stuck { high });
    }
    if seen.different < LEAST_DIFFERENT {
        return nothing(Doubt::Standing);
    }
    let mut classes: Vec<(Motion, Vec<Candidate>)> = Vec::new();
    let mut known: HashMap<u64, usize> = HashMap::new();
    for candidate in candidates(families, &seen) {
        let Some(motion) = seen.motion(&candidate.layout) else { continue };
        match known.get(&motion.same).and_then(|index| classes.get_mut(*index)) {
            Some((_, members)) => members.push(candidate),
            None => {
                known.insert(motion.same, classes.len());
                classes.push((motion, vec![candidate]));
            }
        }
    }
    classes.sort_by(|a, b| a.0.evidence.bits_a_frame.total_cmp(&b.0.evidence.bits_a_frame));
    let costs: Vec<f64> = classes.iter().map(|(motion, _)| motion.evidence.bits_a_frame).collect();
    let even = classes.first().is_some_and(|(motion, _)| motion.is_even());
    let doubt = match costs.as_slice() {
        _ if !even => Some(Doubt::Nothing),
        [best, next, ..] if (next - best) * (frames.len() as f64) < LEAST_LEAD_BITS => Some(Doubt::Close),
        _ => None,
    };
    let classes = classes.into_iter().map(|(motion, members)| class(motion, members)).collect();
    Search { frames: frames.len(), different: seen.different, doubt, classes }
}

fn class(motion: Motion, mut members: Vec<Candidate>) -> Class {
    members.sort_by_key(|candidate| candidate.rank);
    let differ = |what: fn(&Candidate) -> Vec<u8>| {
        let mut all = members.iter().filter(|member| member.family.is_some()).map(what);
        all.next().is_some_and(|first| all.any(|other| other != first))
    };
    let open = [
        (Open::TurnOnce, differ(|member| vec![candidates::singleturn(member)])),
        (Open::TurnFarther, differ(|member| vec![member.layout.coding().bits(), member.layout.descriptor().lead])),
        (Open::SeeAnError, differ(|member| member.layout.descriptor().errors.iter().map(|bit| bit.clock).collect())),
        (
            Open::TypeLabel,
            differ(|member| member.family.as_ref().map(|(key, _)| key.clone().into_bytes()).unwrap_or_default()),
        ),
    ];
    Class {
        evidence: motion.evidence,
        open: open.into_iter().filter(|(_, open)| *open).map(|(open, _)| open).collect(),
        members: members.into_iter().map(|Candidate { family, layout, .. }| Proposal { family, layout }).collect(),
    }
}
