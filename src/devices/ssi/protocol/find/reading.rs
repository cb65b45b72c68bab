//! Possible interpretations of frames as numbers. A reading defines the clocks of the position, its code, whether the
//! wires are swapped, and the number of steps after which positions wrap. The information of bits outside the position
//! is added to that of the motion.

use std::ops::RangeInclusive;

use super::frame_set::{FrameSet, binary_entropy};
use super::motion::Motion;
use super::step_counts::{possible_codes, unusual_step_cost};
use crate::devices::ssi::protocol::code::{Code, PositionCode, gray_to_binary, low_bits_mask};
use crate::devices::ssi::protocol::descriptor::Parity;

/// Number of frames in the first test of each interpretation, taken as runs of consecutive frames.
const FIRST_TEST_FRAMES: usize = 620;
const RUN_LENGTH: usize = 31;
/// Number of the best interpretations, which are tested with all frames.
const BEST_READING_COUNT: usize = 8;
/// Maximum number of bits by which an interpretation may need more information than the best one. Within this limit, it
/// is also tested with other numbers of steps.
const NEAR_BITS: f64 = 400.0;
/// Minimum number of changes per thousand frames for a clock to be considered the lowest bit of the position.
const MIN_LOWEST_BIT_CHANGE_PERMILLE: usize = 10;
/// Minimum percentage of frames with correct parity for a bit to be considered a parity bit.
const MIN_PARITY_MATCH_PERCENT: usize = 85;
const INVERSION_COST: f64 = 2.0;
const BCD_COST: f64 = 6.0;
const PARITY_COST: f64 = 6.0;
const GAP_COST: f64 = 24.0;
const END_COST: f64 = 12.0;
const UNUSUAL_END_COST: f64 = 4.0;
const UNEXPLAINED_BIT_COST: f64 = 24.0;

#[derive(Clone, Debug, PartialEq)]
pub(super) struct Reading {
    /// Whether every bit is inverted.
    pub(super) inverted: bool,
    pub(super) code: Code,
    /// Clock of the highest bit that changed.
    pub(super) first: u8,
    pub(super) last: u8,
    /// First and last clock of the constant bits between turns and steps, if any.
    pub(super) gap: Option<(u8, u8)>,
    pub(super) parity: Option<Parity>,
    /// Minimum and maximum number of steps before positions wrap, or `None` if the full range of the bits is used.
    pub(super) steps: Option<(u64, u64)>,
}

#[derive(Clone, Debug)]
pub(super) struct FrameNumbers {
    pub(super) reading: Reading,
    /// Number in each frame, or `None` if the frame has no valid number. For Gray excess, it is the number in the
    /// complete Gray code.
    pub(super) numbers: Vec<Option<u64>>,
    pub(super) motion: Motion,
    /// Information content in bits of the motion and all other bits.
    pub(super) bits: f64,
    /// Clocks whose bits change without an explanation.
    pub(super) unexplained: Vec<u8>,
    pub(super) closed: bool,
}

impl Reading {
    pub(super) fn width(&self) -> u8 {
        self.last + 1 - self.first - self.gap.map_or(0, |(from, to)| to + 1 - from)
    }

    /// Returns the number after which positions wrap, or 0 for 64 bits.
    pub(super) fn wrap_period(&self) -> u64 {
        match (self.steps, self.code) {
            (Some((least, _)), _) => least,
            (None, Code::Bcd) => self.value_count(),
            (None, _) => 1_u64.checked_shl(self.width().into()).unwrap_or(0),
        }
    }

    /// Returns the number of values that the bits can represent.
    fn value_count(&self) -> u64 {
        match self.code {
            Code::Bcd => 10_u64.saturating_pow(u32::from(self.width().div_ceil(4))),
            _ => low_bits_mask(self.width()).saturating_add(1),
        }
    }

    pub(super) fn allowed_step_counts(&self) -> RangeInclusive<u64> {
        match (self.steps, self.code) {
            (None, _) => 0..=u64::MAX,
            (Some((steps, _)), Code::GrayExcess) => {
                let before = self.value_count().saturating_sub(steps) / 2;
                before..=before + steps - 1
            }
            (Some((steps, _)), _) => 0..=steps - 1,
        }
    }

    /// Returns the number in each word, or `None` if the word has no valid number.
    pub(super) fn read_numbers(&self, words: &[u64], clocks: u8) -> Vec<Option<u64>> {
        let digits = PositionCode::new(Code::Bcd, self.value_count() - 1).ok().filter(|_| self.code == Code::Bcd);
        let all = low_bits_mask(self.last + 1 - self.first);
        let allowed = self.allowed_step_counts();
        let number = |word: &u64| {
            let word = if self.inverted { !word } else { *word };
            let mut bits = word >> (clocks - self.last) & all;
            if let Some((from, to)) = self.gap {
                let behind = self.last - to;
                bits = bits >> (behind + to + 1 - from) << behind | bits & low_bits_mask(behind);
            }
            let number = match (&digits, self.code) {
                (Some(digits), _) => digits.decode(bits),
                (None, Code::Binary) => Some(bits),
                (None, _) => Some(gray_to_binary(bits)),
            };
            number.filter(|number| allowed.contains(number))
        };
        words.iter().map(number).collect()
    }

    pub(super) fn uses_clock(&self, clock: u8) -> bool {
        (self.first..=self.last).contains(&clock) && self.gap.is_none_or(|(from, to)| !(from..=to).contains(&clock))
    }

    /// Returns whether all constant bits outside the position have their usual values in this frame.
    fn has_usual_bits(&self, seen: &FrameSet, index: usize) -> bool {
        let word = seen.words().get(index);
        let usual = |word: &u64, clock: u8| (word >> (seen.clocks - clock) & 1 == 1) == seen.bit(clock).usual;
        let constant = |clock: &u8| !self.uses_clock(*clock) && !seen.bit(*clock).moves;
        word.is_some_and(|word| (1..=seen.clocks).filter(constant).all(|clock| usual(word, clock)))
    }

    /// Returns the last run of constant clocks before the lowest bit.
    pub(super) fn constant_run(&self, seen: &FrameSet) -> Option<(u8, u8)> {
        let to = (1..self.last).rev().find(|clock| !seen.bit(*clock).moves)?;
        let from = (1..=to).rev().take_while(|clock| !seen.bit(*clock).moves).last()?;
        Some((from, to))
    }

    /// Returns the information content in bits of everything except the motion, and the unexplained clocks.
    fn non_motion_information(&self, seen: &FrameSet) -> (f64, Vec<u8>) {
        let frames = seen.words().len();
        let mut bits = 0.0;
        let mut unexplained = Vec::new();
        for (clock, bit) in seen.bits().filter(|(clock, _)| !self.uses_clock(*clock)) {
            if let Some(parity) = self.parity.filter(|parity| parity.clock == clock) {
                bits += PARITY_COST + binary_entropy(frames - parity_matches(seen, parity), frames);
                continue;
            }
            bits += bit.information_bits(frames);
            if bit.moves {
                unexplained.push(clock);
                bits += UNEXPLAINED_BIT_COST;
            }
        }
        let unusual = [
            (self.inverted, INVERSION_COST),
            (self.code == Code::Bcd, BCD_COST),
            (self.gap.is_some(), GAP_COST),
            (
                self.steps.is_some(),
                END_COST + UNUSUAL_END_COST * self.steps.map_or(0.0, |(steps, _)| unusual_step_cost(steps).into()),
            ),
        ];
        (bits + unusual.iter().filter(|(is, _)| *is).map(|(_, bits)| bits).sum::<f64>(), unexplained)
    }

    /// Returns the parity bit after the position, if any.
    fn trailing_parity(&self, seen: &FrameSet) -> Option<Parity> {
        let clock = (self.last + 1..=seen.clocks).find(|clock| seen.bit(*clock).moves)?;
        let frames = seen.words().len();
        let fits = |even| parity_matches(seen, Parity { clock, even }) * 100 >= MIN_PARITY_MATCH_PERCENT * frames;
        [true, false].into_iter().find(|even| fits(*even)).map(|even| Parity { clock, even })
    }
}

impl FrameNumbers {
    pub(super) fn new(seen: &FrameSet, reading: Reading) -> Self {
        let numbers = reading.read_numbers(seen.words(), seen.clocks);
        let motion = Motion::from_numbers(&numbers, reading.wrap_period());
        let (bits, unexplained) = reading.non_motion_information(seen);
        let mut read = FrameNumbers { bits: motion.bits + bits, reading, numbers, motion, unexplained, closed: false };
        // A disturbed frame does not prove that the end of the range was passed. At a real end, no higher bit changes,
        // not even briefly.
        let even = |index: usize| (index - 2..=index + 2).all(|index| read.motion.is_even(index));
        let usual = |index: usize| (index - 1..=index + 2).all(|index| read.reading.has_usual_bits(seen, index));
        read.closed =
            (2..read.motion.steps.len()).any(|index| even(index) && read.wraps_after_frame(index) && usual(index));
        read
    }

    /// Returns the total information content in bits without the penalty for unexplained clocks.
    pub(super) fn total_cost(&self) -> f64 {
        self.bits - UNEXPLAINED_BIT_COST * self.unexplained.len() as f64
    }

    /// Returns whether the numbers wrap after the given frame while the motion continues.
    pub(super) fn wraps_after_frame(&self, index: usize) -> bool {
        let pair = self.numbers.get(index).copied().flatten().zip(self.numbers.get(index + 1).copied().flatten());
        let step = self.motion.steps.get(index).copied().flatten();
        pair.zip(step).is_some_and(|((one, other), step)| (other as i64).wrapping_sub(one as i64) != step)
    }
}

fn parity_matches(seen: &FrameSet, parity: Parity) -> usize {
    seen.words().iter().filter(|word| seen.is_parity_valid(**word, parity)).count()
}

/// Returns the interpretations of the frames with the steadiest motion, best first.
pub(super) fn best_readings(seen: &FrameSet) -> Vec<FrameNumbers> {
    let frames = seen.words().len();
    let sample = sample_runs(seen.words());
    let mut tried: Vec<(f64, Reading)> = Vec::new();
    for reading in possible_readings(seen) {
        // The end of a run and the start of the next one are not consecutive.
        let runs = sample.chunks(RUN_LENGTH).map(|run| reading.read_numbers(run, seen.clocks));
        let numbers: Vec<Option<u64>> = runs.flat_map(|run| run.into_iter().chain([None])).collect();
        let whole =
            Motion::from_numbers(&numbers, reading.wrap_period()).bits * frames as f64 / sample.len().max(1) as f64;
        tried.push((whole + reading.non_motion_information(seen).0, reading));
    }
    tried.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut all: Vec<FrameNumbers> = Vec::new();
    let mut best = f64::INFINITY;
    for (_, reading) in tried.into_iter().take(BEST_READING_COUNT) {
        let plain = FrameNumbers::new(seen, reading);
        if lacks_highest_bit(seen, &plain) {
            continue;
        }
        best = best.min(plain.bits);
        let near = if plain.bits < best + NEAR_BITS { possible_codes(&plain) } else { Vec::new() };
        let other_ends = near.into_iter().map(|(code, steps)| {
            FrameNumbers::new(seen, Reading { code, steps: Some(steps), ..plain.reading.clone() })
        });
        all.extend(other_ends.filter(|read| read.closed && read.bits < plain.bits));
        all.push(plain);
    }
    all.sort_by(|a, b| a.bits.total_cmp(&b.bits));
    all
}

/// Returns whether a bit before the position changes whenever the numbers wrap. Such a bit is the true highest bit.
fn lacks_highest_bit(seen: &FrameSet, read: &FrameNumbers) -> bool {
    let round = read.reading.wrap_period();
    let moving = (1..read.reading.first).rev().find(|clock| seen.bit(*clock).moves);
    let Some(clock) = moving.filter(|_| round != 0) else { return false };
    let near = 2 * read.motion.median.unsigned_abs() + read.motion.limit;
    let bit = |word: &u64| word >> (seen.clocks - clock) & 1;
    let (mut changes, mut at_end) = (0, 0);
    let pairs = seen.words().iter().zip(seen.words().iter().skip(1)).zip(&read.numbers);
    for (_, number) in pairs.filter(|((before, after), _)| bit(before) != bit(after)) {
        changes += 1;
        at_end += usize::from(number.is_some_and(|number| number.min(round - 1 - number) <= near));
    }
    at_end * 2 >= changes && near * 4 < round
}

/// Returns all interpretations that begin at a possible first clock of the position and end at a possible lowest bit.
fn possible_readings(seen: &FrameSet) -> Vec<Reading> {
    let moving: Vec<u8> = seen.bits().filter(|(_, bit)| bit.moves).map(|(clock, _)| clock).collect();
    let often = MIN_LOWEST_BIT_CHANGE_PERMILLE * seen.words().len() / 1000;
    let lowest: Vec<u8> =
        seen.bits().filter(|(_, bit)| bit.moves || bit.changes > often).map(|(clock, _)| clock).collect();
    let mut ways = Vec::new();
    // The first clock that changed may be an error bit that was active for a while.
    let second = moving.get(1).filter(|_| moving.first().is_some_and(|first| seen.bit(*first).changes <= 16));
    for first in moving.first().into_iter().chain(second) {
        for last in lowest.iter().filter(|last| **last > first + 1) {
            for (code, inverted) in
                [(Code::Binary, false), (Code::Gray, false), (Code::Gray, true), (Code::Bcd, false), (Code::Bcd, true)]
            {
                let reading =
                    Reading { inverted, code, first: *first, last: *last, gap: None, parity: None, steps: None };
                if code == Code::Bcd && reading.width() < 8 {
                    continue;
                }
                let parity = reading.trailing_parity(seen);
                let gap = constant_run(seen, *first, *last).filter(|_| code != Code::Bcd);
                ways.extend(gap.map(|gap| Reading { gap: Some(gap), parity, ..reading.clone() }));
                ways.push(Reading { parity, ..reading });
            }
        }
    }
    ways
}

/// Returns the longest run of constant clocks within the position.
fn constant_run(seen: &FrameSet, first: u8, last: u8) -> Option<(u8, u8)> {
    let mut longest: Option<(u8, u8)> = None;
    let mut from = None;
    for clock in first..=last {
        match (seen.bit(clock).moves, from) {
            (false, None) => from = Some(clock),
            (true, Some(begin)) => {
                if longest.is_none_or(|(from, to)| clock - begin > to + 1 - from) {
                    longest = Some((begin, clock - 1));
                }
                from = None;
            }
            _ => {}
        }
    }
    longest
}

/// Returns runs of consecutive frames from all parts of the recording.
fn sample_runs(words: &[u64]) -> Vec<u64> {
    if words.len() <= FIRST_TEST_FRAMES {
        return words.to_vec();
    }
    let runs: Vec<&[u64]> = words.chunks_exact(RUN_LENGTH).collect();
    let count = FIRST_TEST_FRAMES / RUN_LENGTH;
    (0..count).filter_map(|at| runs.get(at * runs.len() / count)).flat_map(|run| run.iter().copied()).collect()
}
