//! Assessment of the layout classes: how certain the result is, how well each class fits, and which motion would
//! distinguish them.

use super::candidates::{LayoutCandidate, has_only_even_steps};
use super::frame_set::FrameSet;
use super::probe::TrialReading;
use super::reading::FrameNumbers;
use super::{CLASSES, ClassEvidence, Group, LayoutClass, LayoutProposal, OpenQuestion, UncertaintyReason, WEIGHT_BITS};
use crate::devices::ssi::protocol::range::Range;

/// Minimum lead of the best class over the next one, in bits.
const MIN_LEAD_BITS: f64 = 100.0;
/// Maximum information content of steady motion, as a fraction of the bits in the position values.
const STEADY_MOTION_INFORMATION: f64 = 0.7;
/// Maximum information content of motion in a certain result, as a fraction of the bits in the position values.
const MAX_INFORMATION_FOR_CERTAINTY: f64 = 0.35;
/// Maximum percentage of frames that jump or have no valid number.
const MAX_DISTURBED_PERCENT: usize = 15;
/// Minimum number of frames before a result can be reported as certain.
const MIN_FRAMES_FOR_CERTAINTY: usize = 200;
const MIN_WIDTH_FOR_CERTAINTY: u8 = 5;
/// Minimum number of different frames before a result can be reported as certain.
const MIN_DISTINCT_FRAMES_FOR_CERTAINTY: usize = 64;
const MEMBERS: usize = 200;

pub(super) fn uncertainty_reason(words: &FrameSet, groups: &[Group]) -> Option<UncertaintyReason> {
    let Some(first) = groups.first() else { return Some(UncertaintyReason::Nothing) };
    let frames = words.words().len();
    if !is_even(&first.read, frames, STEADY_MOTION_INFORMATION) {
        return Some(UncertaintyReason::Nothing);
    }
    if groups.get(1).is_some_and(|next| next.bits - first.bits < MIN_LEAD_BITS) {
        return Some(UncertaintyReason::Close);
    }
    let sure = frames >= MIN_FRAMES_FOR_CERTAINTY && first.read.reading.width() >= MIN_WIDTH_FOR_CERTAINTY;
    let sure = sure && !has_uniform_jumps(&first.read) && words.distinct_count() >= MIN_DISTINCT_FRAMES_FOR_CERTAINTY;
    // The readings are compared here without the penalties for uncommon layouts.
    let sure =
        sure && groups.iter().skip(1).all(|next| next.read.total_cost() - first.read.total_cost() >= MIN_LEAD_BITS);
    let proven = sure
        && is_even(&first.read, frames, MAX_INFORMATION_FOR_CERTAINTY)
        && unproven_properties(words, first).is_empty();
    (!proven).then_some(UncertaintyReason::Open)
}

/// Returns whether many jumps have the same size, which indicates a wrong code rather than disturbances.
fn has_uniform_jumps(read: &FrameNumbers) -> bool {
    let mut sizes: Vec<u64> = read.motion.uneven.iter().map(|uneven| uneven.unsigned_abs()).collect();
    sizes.retain(|size| *size > read.motion.limit);
    sizes.sort_unstable();
    // A single disturbed bit already causes two jumps of the same size.
    let alike = sizes.chunk_by(|one, other| one.abs_diff(*other) <= read.motion.limit / 4).map(<[u64]>::len).max();
    alike.is_some_and(|alike| alike > 4 && alike * 4 > sizes.len())
}

/// Returns whether the motion is steady and few frames are disturbed. Steady motion has less information than the given
/// fraction of the position bits.
fn is_even(read: &FrameNumbers, frames: usize, part: f64) -> bool {
    let disturbed = read.motion.jumps / 2 + read.motion.nones;
    read.motion.bits < part * f64::from(read.reading.width()) * frames as f64
        && disturbed * 100 <= MAX_DISTURBED_PERCENT * frames
}

fn unproven_properties(words: &FrameSet, group: &Group) -> Vec<OpenQuestion> {
    let Group { read, members, .. } = group;
    let reading = &read.reading;
    let mut open = Vec::new();
    let constant_run = reading.constant_run(words);
    // A constant bit within the position can have any meaning. If the end of the range was passed, a constant bit
    // before the position does not belong to it.
    match constant_run.filter(|(from, _)| !read.closed || *from > reading.first) {
        Some((from, to)) => open.push(OpenQuestion::TurnFarther { from, to }),
        None if !read.closed => open.push(OpenQuestion::ReachRangeEnd),
        None => {}
    }
    if let Some((least, most)) = step_count_bounds(read).filter(|(least, most)| least != most && read.closed) {
        let small = |steps: u64| u32::try_from(steps).unwrap_or(u32::MAX);
        open.push(OpenQuestion::CrossRangeEnd { least: small(least), most: small(most) });
    }
    if has_only_even_steps(read) || !has_varied_steps(read) {
        open.push(OpenQuestion::OtherSpeed);
    }
    if let Some(clock) = read.unexplained.first() {
        open.push(OpenQuestion::Unexplained { clock: *clock });
    }
    let differ = |other: fn(&TrialReading, &TrialReading) -> bool| {
        members.first().is_some_and(|first| members.iter().any(|member| other(&first.trial, &member.trial)))
    };
    if differ(|one, other| one.backwards != other.backwards) {
        open.push(OpenQuestion::Direction);
    }
    if open.is_empty() && differ(|one, other| one.positions != other.positions) {
        open.push(OpenQuestion::ReachRangeEnd);
    }
    open
}

/// Returns the minimum and maximum number of steps. They differ if the first or the last position never occurred.
fn step_count_bounds(read: &FrameNumbers) -> Option<(u64, u64)> {
    let allowed = read.reading.allowed_step_counts();
    let (first, last) = match read.reading.steps {
        Some(_) => (*allowed.start(), *allowed.end()),
        None => (0, read.reading.wrap_period().checked_sub(1)?),
    };
    let good = (0..read.numbers.len()).filter(|frame| read.motion.is_good(*frame));
    let mut seen =
        good.filter_map(|frame| read.numbers.get(frame).copied().flatten()).filter(|number| allowed.contains(number));
    let any = seen.next()?;
    let (lowest, highest) = seen.fold((any, any), |(low, high), number| (low.min(number), high.max(number)));
    let unseen = (lowest - first).max(last.saturating_sub(highest));
    let (one, other) = read.reading.steps.unwrap_or((last + 1, last + 1));
    // Gray excess omits the same number of words on both sides.
    Some((one.min(other).min((last + 1 - first).saturating_sub(2 * unseen)), one.max(other)))
}

/// Returns whether the step sizes vary so much that a missing lower bit would show.
pub(super) fn has_varied_steps(read: &FrameNumbers) -> bool {
    let even = read.motion.uneven.iter().filter(|uneven| uneven.unsigned_abs() <= read.motion.limit);
    let (mut all, mut other) = (0, 0);
    for uneven in even {
        all += 1;
        other += usize::from(*uneven != 0);
    }
    other * 50 >= all
}

pub(super) fn merge_classes(words: &FrameSet, groups: Vec<Group>) -> Vec<LayoutClass> {
    let mut last = 1.0_f64;
    let mut classes = Vec::new();
    for group in groups.into_iter().take(CLASSES) {
        let evidence = evidence_for(words, &group, last);
        last = evidence.score;
        let open = open_questions(words, &group);
        let members = group.members.into_iter().take(MEMBERS);
        let members = members.map(|LayoutCandidate { family, layout, .. }| LayoutProposal { family, layout }).collect();
        classes.push(LayoutClass { members, evidence, open });
    }
    classes
}

fn evidence_for(words: &FrameSet, group: &Group, most: f64) -> ClassEvidence {
    let Group { read, members, .. } = group;
    let frames = words.words().len();
    let random = f64::from(read.reading.width()) * frames as f64;
    let weight = members.first().map_or(0.0, |member| member.weight);
    let fit =
        1.0 - (read.bits + WEIGHT_BITS * weight) / (random + read.unexplained.len() as f64 * frames as f64).max(1.0);
    let explained = read.motion.consistent_frame_count();
    let outside = words.bits().filter(|(clock, bit)| !read.reading.uses_clock(*clock) && !bit.moves);
    let misfits = outside.map(|(_, bit)| bit.unusual).max().unwrap_or(0).max(read.motion.nones);
    ClassEvidence {
        score: (fit.clamp(0.0, 1.0) * explained as f64 / frames.max(1) as f64).min(most),
        explained,
        steps_per_frame: read.motion.median,
        bits_per_frame: read.bits / frames.max(1) as f64,
        jumps: read.motion.jumps,
        misfits,
        bits_seen: read.reading.width(),
    }
}

/// Returns the shaft motions that are still needed to distinguish or confirm the layouts in a group.
fn open_questions(words: &FrameSet, group: &Group) -> Vec<OpenQuestion> {
    let mut open = unproven_properties(words, group);
    let members = &group.members;
    let differ = |what: fn(&LayoutCandidate) -> Vec<u8>| {
        let mut all = members.iter().map(what);
        all.next().is_some_and(|first| all.any(|other| other != first))
    };
    let turns = |member: &LayoutCandidate| match member.layout.descriptor().range {
        Range::Bits { multiturn, singleturn } => vec![u8::from(multiturn > 0), singleturn],
        _ => Vec::new(),
    };
    if differ(turns) {
        open.push(OpenQuestion::TurnOnce);
    }
    if differ(|member| member.layout.descriptor().errors.iter().map(|bit| bit.clock).collect()) {
        open.push(OpenQuestion::SeeAnError);
    }
    let families = || members.iter().filter_map(|member| member.family.as_ref().map(|(key, _)| key));
    if families().any(|key| families().next().is_some_and(|first| first != key)) {
        open.push(OpenQuestion::TypeLabel);
    }
    open
}
