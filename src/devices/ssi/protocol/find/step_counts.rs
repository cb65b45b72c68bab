//! Search for a number of steps that is not a power of two, after which positions wrap. It is derived from numbers that
//! never occur and from the size of backward jumps.

use super::motion::{Motion, median};
use super::reading::{FrameNumbers, Reading};
use crate::devices::ssi::protocol::code::Code;

const MAX_STEP_COUNT_CANDIDATES: usize = 40;
/// Maximum number of additional bits with which another number of steps is considered as good as the best one.
const ALTERNATIVE_MARGIN_BITS: f64 = 10.0;

/// Returns the possible codes, each with two possible numbers of steps: the most common one and the largest one that
/// fits.
pub(super) fn possible_codes(read: &FrameNumbers) -> Vec<(Code, (u64, u64))> {
    let whole = read.reading.wrap_period();
    if whole == 0 || read.reading.steps.is_some() {
        return Vec::new();
    }
    let mut found = Vec::new();
    let mut add = |code, least: Vec<u64>| {
        let reading = Reading { code, ..read.reading.clone() };
        found.extend(best_step_counts(read, &reading, &least, whole).map(|steps| (code, steps)));
    };
    let extremes = number_extremes(read);
    // The range contains at least the positions from 0 to the highest one that occurred.
    add(read.reading.code, extremes.iter().map(|(_, highest)| highest + 1).collect());
    if read.reading.code == Code::Gray {
        // Gray excess omits as many words before the positions as after them.
        let unseen = |(lowest, highest): &(u64, u64)| whole - 2 * (*lowest).min(whole - 1 - highest);
        add(Code::GrayExcess, extremes.iter().map(unseen).collect());
    }
    found
}

/// Returns the lowest and the highest number, first in all consistent frames, then in nearly all of them. A disturbed
/// frame can be consistent by chance.
fn number_extremes(read: &FrameNumbers) -> Vec<(u64, u64)> {
    let good = |frame: &usize| read.motion.is_good(*frame);
    let frames = (0..read.numbers.len()).filter(good);
    let mut numbers: Vec<u64> = frames.filter_map(|frame| read.numbers.get(frame).copied().flatten()).collect();
    numbers.sort_unstable();
    let few = numbers.len() / 50;
    let pair = |few: usize| Some((*numbers.get(few)?, *numbers.iter().rev().nth(few)?));
    [0, few].into_iter().filter_map(pair).collect()
}

/// Returns two numbers of steps that make the motion most even: the most common one and the largest one. Returns `None`
/// if neither is better than the full range of the bits.
fn best_step_counts(read: &FrameNumbers, reading: &Reading, least: &[u64], whole: u64) -> Option<(u64, u64)> {
    let lowest = *least.iter().min()?;
    let fits = |steps: &u64| {
        (lowest.max(2)..whole).contains(steps) && (reading.code != Code::GrayExcess || steps.is_multiple_of(2))
    };
    let numbers = |steps| {
        let allowed = Reading { steps: Some((steps, steps)), ..reading.clone() }.allowed_step_counts();
        read.numbers.iter().map(|number| number.filter(|number| allowed.contains(number))).collect::<Vec<_>>()
    };
    let mut costs: Vec<(f64, u64)> = Vec::new();
    let mut add = |all: Vec<u64>| {
        for steps in all.iter().filter(|steps| fits(steps)) {
            if costs.len() < MAX_STEP_COUNT_CANDIDATES && costs.iter().all(|(_, known)| known != steps) {
                costs.push((Motion::from_numbers(&numbers(*steps), *steps).bits, *steps));
            }
        }
        costs.iter().copied().min_by(|a, b| a.0.total_cmp(&b.0))
    };
    let reach = 4 + 2 * read.motion.median.unsigned_abs();
    let near =
        |steps: u64| (1..=4).flat_map(|by| [steps.saturating_add(by), steps.saturating_sub(by)]).collect::<Vec<_>>();
    if let Some(steps) = step_count_from_jumps(&read.motion, whole) {
        add(common_step_counts(steps.saturating_sub(8)..=steps.saturating_add(8)));
        add([vec![steps], near(steps)].concat());
    }
    for least in least {
        add((*least..=least + 1).collect());
        add(common_step_counts(*least..=least.saturating_add(reach)));
    }
    // Continues from the best number to the last one that fits as well.
    let mut best = add(Vec::new())?;
    loop {
        let next = add(near(best.1))?;
        if next.1 == best.1 {
            break;
        }
        best = next;
    }
    let (lowest, steps) = best;
    add(common_step_counts(steps.saturating_sub(8)..=steps.saturating_add(8)));
    if lowest + ALTERNATIVE_MARGIN_BITS > read.motion.bits {
        return None;
    }
    let mut as_well: Vec<u64> = costs
        .into_iter()
        .filter(|(cost, _)| *cost <= lowest + ALTERNATIVE_MARGIN_BITS)
        .map(|(_, steps)| steps)
        .collect();
    as_well.sort_by_key(|steps| (unusual_step_cost(*steps), *steps));
    let first = as_well.first().copied()?;
    let others = as_well.iter().filter(|steps| **steps != first).max();
    Some((first, others.copied().unwrap_or(first)))
}

/// Returns the number of steps derived from the most frequent jump size.
fn step_count_from_jumps(motion: &Motion, whole: u64) -> Option<u64> {
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

/// Returns the common numbers of steps in a range.
fn common_step_counts(within: std::ops::RangeInclusive<u64>) -> Vec<u64> {
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

/// Returns the cost of a number of steps, from 0 for a common number or a power of two to 5 for any other odd number.
pub(super) fn unusual_step_cost(steps: u64) -> u8 {
    if !common_step_counts(steps..=steps).is_empty() || steps.is_power_of_two() {
        return 0;
    }
    [100, 10, 4, 2].iter().zip(1..).find(|(unit, _)| steps.is_multiple_of(**unit)).map_or(5, |(_, rank)| rank)
}
