//! The number after which positions start again, if it is not a power of two, determined from codes that never occur
//! and from the size of backward jumps.

use super::motion::{Motion, median};
use super::reading::{Read, Reading};
use crate::devices::ssi::protocol::code::Code;

const TRIED: usize = 40;
/// Tolerance in bits within which a range end fits as well as the best one.
const AS_WELL_BITS: f64 = 10.0;

/// Returns the candidate codes, each with the most usual and the last possible number of steps.
pub(super) fn ends(read: &Read) -> Vec<(Code, (u64, u64))> {
    let whole = read.reading.round();
    if whole == 0 || read.reading.steps.is_some() {
        return Vec::new();
    }
    let mut found = Vec::new();
    let mut add = |code, least: Vec<u64>| {
        let reading = Reading { code, ..read.reading.clone() };
        found.extend(best_step_counts(read, &reading, &least, whole).map(|steps| (code, steps)));
    };
    let extremes = extremes(read);
    // At least the positions from 0 to the highest that occurred.
    add(read.reading.code, extremes.iter().map(|(_, highest)| highest + 1).collect());
    if read.reading.code == Code::Gray {
        // As many codes are left out before the positions as after them.
        let unseen = |(lowest, highest): &(u64, u64)| whole - 2 * (*lowest).min(whole - 1 - highest);
        add(Code::GrayExcess, extremes.iter().map(unseen).collect());
    }
    found
}

/// Returns the lowest and highest number, once for all frames that follow from others and once for nearly all of them,
/// because a disturbed frame may seem to follow.
fn extremes(read: &Read) -> Vec<(u64, u64)> {
    let good = |frame: &usize| read.motion.is_good(*frame);
    let frames = (0..read.numbers.len()).filter(good);
    let mut numbers: Vec<u64> = frames.filter_map(|frame| read.numbers.get(frame).copied().flatten()).collect();
    numbers.sort_unstable();
    let few = numbers.len() / 50;
    let pair = |few: usize| Some((*numbers.get(few)?, *numbers.iter().rev().nth(few)?));
    [0, few].into_iter().filter_map(pair).collect()
}

/// Returns the numbers of steps with the most even motion: the most usual candidate and the last. `None` if no
/// candidate beats the full range of the bits.
fn best_step_counts(read: &Read, reading: &Reading, least: &[u64], whole: u64) -> Option<(u64, u64)> {
    let lowest = *least.iter().min()?;
    let fits = |steps: &u64| {
        (lowest.max(2)..whole).contains(steps) && (reading.code != Code::GrayExcess || steps.is_multiple_of(2))
    };
    let numbers = |steps| {
        let allowed = Reading { steps: Some((steps, steps)), ..reading.clone() }.allowed();
        read.numbers.iter().map(|number| number.filter(|number| allowed.contains(number))).collect::<Vec<_>>()
    };
    let mut costs: Vec<(f64, u64)> = Vec::new();
    let mut add = |all: Vec<u64>| {
        for steps in all.iter().filter(|steps| fits(steps)) {
            if costs.len() < TRIED && costs.iter().all(|(_, known)| known != steps) {
                costs.push((Motion::of(&numbers(*steps), *steps).bits, *steps));
            }
        }
        costs.iter().copied().min_by(|a, b| a.0.total_cmp(&b.0))
    };
    let reach = 4 + 2 * read.motion.median.unsigned_abs();
    let near =
        |steps: u64| (1..=4).flat_map(|by| [steps.saturating_add(by), steps.saturating_sub(by)]).collect::<Vec<_>>();
    if let Some(steps) = jump_size(&read.motion, whole) {
        add(usual(steps.saturating_sub(8)..=steps.saturating_add(8)));
        add([vec![steps], near(steps)].concat());
    }
    for least in least {
        add((*least..=least + 1).collect());
        add(usual(*least..=least.saturating_add(reach)));
    }
    // From the best to the last that is equally good.
    let mut best = add(Vec::new())?;
    loop {
        let next = add(near(best.1))?;
        if next.1 == best.1 {
            break;
        }
        best = next;
    }
    let (lowest, steps) = best;
    add(usual(steps.saturating_sub(8)..=steps.saturating_add(8)));
    if lowest + AS_WELL_BITS > read.motion.bits {
        return None;
    }
    let mut as_well: Vec<u64> =
        costs.into_iter().filter(|(cost, _)| *cost <= lowest + AS_WELL_BITS).map(|(_, steps)| steps).collect();
    as_well.sort_by_key(|steps| (unusual_step_cost(*steps), *steps));
    let first = as_well.first().copied()?;
    let others = as_well.iter().filter(|steps| **steps != first).max();
    Some((first, others.copied().unwrap_or(first)))
}

/// Returns the number of steps that the most frequent jump size implies.
fn jump_size(motion: &Motion, whole: u64) -> Option<u64> {
    let mut jumps: Vec<u64> = motion.uneven.iter().map(|uneven| uneven.unsigned_abs()).collect();
    jumps.retain(|size| *size > motion.limit);
    jumps.sort_unstable();
    let within = |from: &u64| jumps.iter().filter(|size| (*from..=from + motion.limit).contains(size)).count();
    let densest = jumps.iter().copied().max_by_key(within)?;
    let mut alike: Vec<i64> = jumps
        .iter()
        .filter(|size| (densest..=densest + motion.limit).contains(size))
        .map(|size| *size as i64)
        .collect();
    Some(whole.saturating_sub(median(&mut alike).unsigned_abs()))
}

/// Returns the numbers of steps with which encoders are usually ordered.
fn usual(within: std::ops::RangeInclusive<u64>) -> Vec<u64> {
    let mut all: Vec<u64> = Vec::new();
    for step in [1, 2, 5, 25] {
        for unit in [36_u64, 10] {
            for scale in [1_u64, 10, 100, 1000, 10_000] {
                for times in 1..=4 {
                    all.push(step * unit * scale * times);
                }
            }
        }
    }
    all.retain(|steps| within.contains(steps));
    all.sort_unstable();
    all.dedup();
    all
}

/// Ranks how unusual a number of steps is: 0 for a usual one, up to 5.
pub(super) fn unusual_step_cost(steps: u64) -> u8 {
    if !usual(steps..=steps).is_empty() || steps.is_power_of_two() {
        return 0;
    }
    [100, 10, 4, 2].iter().zip(1..).find(|(unit, _)| steps.is_multiple_of(**unit)).map_or(5, |(_, rank)| rank)
}
