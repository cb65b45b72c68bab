//! Information content of the motion that an interpretation of the frames yields. It measures how badly each number is
//! predicted by the previous ones. A wrong interpretation causes jumps, which cannot be predicted.

/// Number of steps over which each median is taken.
const BLOCK: usize = 16;
/// Cost in bits of each group of similar differences, in addition to the differences themselves.
const MODEL_BITS: f64 = 8.0;
/// Cost in bits of a frame without a valid number.
const INVALID_FRAME_BITS: f64 = 16.0;

#[derive(Clone, Debug, Default)]
pub(super) struct Motion {
    /// Information content in bits of all steps.
    pub(super) bits: f64,
    pub(super) median: i64,
    /// Number of steps from each frame to the next, or `None` if either frame has no valid number.
    pub(super) steps: Vec<Option<i64>>,
    /// Deviation of each step from the median of the steps around it.
    pub(super) uneven: Vec<i64>,
    pub(super) limit: u64,
    pub(super) jumps: usize,
    /// Number of frames without a valid number.
    pub(super) nones: usize,
}

impl Motion {
    /// Analyses numbers that wrap after `round`, or after 64 bits if `round` is 0.
    pub(super) fn from_numbers(numbers: &[Option<u64>], round: u64) -> Self {
        let steps: Vec<Option<i64>> = numbers
            .iter()
            .zip(numbers.iter().skip(1))
            .map(|(before, after)| Some(shortest_step(after.as_ref()?.wrapping_sub(*before.as_ref()?), round)))
            .collect();
        let mut uneven = Vec::with_capacity(steps.len());
        let mut block: Vec<i64> = Vec::with_capacity(BLOCK);
        for steps in steps.chunks(BLOCK) {
            block.clear();
            block.extend(steps.iter().flatten());
            let median = median(&mut block);
            uneven.extend(
                steps.iter().map(|step| step.map_or(0, |step| shortest_step(step.wrapping_sub(median) as u64, round))),
            );
        }
        let mut sizes: Vec<i64> = uneven.iter().map(|uneven| uneven.saturating_abs()).collect();
        let spread = median(&mut sizes);
        let limit = 8 + 6 * spread.unsigned_abs();
        let mut known: Vec<i64> = steps.iter().flatten().copied().collect();
        let nones = numbers.iter().filter(|number| number.is_none()).count();
        Motion {
            bits: information_bits(&uneven) + INVALID_FRAME_BITS * nones as f64,
            median: median(&mut known),
            jumps: uneven.iter().filter(|uneven| uneven.unsigned_abs() > limit).count(),
            limit,
            nones,
            steps,
            uneven,
        }
    }

    /// Returns whether a step is not a jump. Index 0 is the step from the first frame to the second.
    pub(super) fn is_even(&self, index: usize) -> bool {
        let within = self.uneven.get(index).is_some_and(|uneven| uneven.unsigned_abs() <= self.limit);
        within && self.steps.get(index).is_some_and(Option::is_some)
    }

    /// Returns the number of frames that are consistent with the previous or the next frame.
    pub(super) fn consistent_frame_count(&self) -> usize {
        let frames = self.steps.len() + 1;
        (0..frames).filter(|index| self.is_good(*index)).count()
    }

    /// Returns whether the frame is consistent with the previous or the next frame.
    pub(super) fn is_good(&self, frame: usize) -> bool {
        frame.checked_sub(1).is_some_and(|before| self.is_even(before)) || self.is_even(frame)
    }
}

/// Returns the information content in bits of all differences. Each difference is encoded as a group of similar sizes
/// and an index within the group. The more frequent a group is, the fewer bits it needs.
fn information_bits(uneven: &[i64]) -> f64 {
    // Groups by the number of bits, separately for differences below and above 0.
    let mut groups = [0_usize; 130];
    let mut within = 0;
    for uneven in uneven {
        let size = 64 - uneven.unsigned_abs().leading_zeros();
        within += u64::from(size.saturating_sub(1));
        let group = size as usize + if *uneven < 0 { 65 } else { 0 };
        if let Some(count) = groups.get_mut(group) {
            *count += 1;
        }
    }
    let all = uneven.len() as f64;
    let met = || groups.iter().filter(|count| **count > 0);
    let which: f64 = met().map(|count| -(*count as f64) * (*count as f64 / all).log2()).sum();
    which + within as f64 + MODEL_BITS * met().count() as f64
}

/// Returns the step as the shortest distance in either direction, given that positions wrap after `round`.
pub(super) fn shortest_step(step: u64, round: u64) -> i64 {
    if round == 0 {
        return step as i64;
    }
    let around = i128::from(step as i64).rem_euclid(i128::from(round));
    let short = if around * 2 > i128::from(round) { around - i128::from(round) } else { around };
    i64::try_from(short).unwrap_or(0)
}

/// Returns the median, or 0 if the slice is empty.
pub(super) fn median(values: &mut [i64]) -> i64 {
    let middle = values.len() / 2;
    if values.is_empty() { 0 } else { *values.select_nth_unstable(middle).1 }
}
