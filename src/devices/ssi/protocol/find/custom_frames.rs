//! Candidate layouts of common widths for encoders that belong to no known family. Clocks that are always 1, were
//! active at some time, or are unexplained become separate bits.

use super::candidates::{
    GRAY_PADDING_WEIGHT, NO_FAMILY_WEIGHT, SWAPPED_WIRES_WEIGHT, TestCandidateFn, encoder_parity,
    find_ambiguous_parity, sum,
};
use super::frame_set::FrameSet;
use super::plausible::{common_bit_splits, width_penalty};
use super::reading::FrameNumbers;
use super::step_counts::unusual_step_cost;
use crate::devices::ssi::protocol::code::Code;
use crate::devices::ssi::protocol::descriptor::{BitMeaning, ErrorBit, FrameDescriptor, GrayCoverage, Parity, Repeat};
use crate::devices::ssi::protocol::layout::Layout;
use crate::devices::ssi::protocol::range::Range;

/// Number of different position widths to propose.
const WIDTHS: usize = 4;
const MIN_SPLITS: usize = 3;
/// Minimum number of frames per thousand in which a bit must deviate to be considered an error bit.
const ERROR_BIT_PERMILLE: usize = 5;
const ALWAYS_HIGH_WEIGHT: f64 = 0.7;
const PARITY: f64 = 0.5;

/// Tries frames without a family that have the given number of clocks.
pub(super) fn try_custom_frames(
    take: &mut TestCandidateFn<'_>,
    read: &FrameNumbers,
    words: &FrameSet,
    (clocks, repeat): (u8, Option<Repeat>),
    inverted: bool,
) {
    let reading = &read.reading;
    let moved = reading.width();
    // BCD digits have four bits, but the highest digit may not have changed in all of its bits.
    let least = if reading.code == Code::Bcd { moved.next_multiple_of(4) } else { moved };
    let Some(above) = (reading.first - 1).checked_sub(least - moved) else { return };
    let most = if read.closed || reading.code == Code::Bcd { least } else { least + above };
    let mut widths_of: Vec<u8> = (least..=most).collect();
    let rank =
        |bits: &u8| common_bit_splits(*bits, 1).first().map_or(9.0, |(turns, steps)| width_penalty(*turns, *steps));
    // Tries the full width up to the lowest bit, the width of the bits that changed, and the most common widths in
    // between.
    let ends = |bits: &u8| *bits == most || *bits == least;
    widths_of
        .sort_by(|a, b| (!ends(a), rank(a)).partial_cmp(&(!ends(b), rank(b))).unwrap_or(std::cmp::Ordering::Equal));
    for bits in widths_of.into_iter().take(WIDTHS) {
        let lead = above - (bits - least);
        for (range, weight) in possible_ranges(read, bits) {
            let base = FrameDescriptor {
                clocks: words.clocks,
                range,
                code: reading.code,
                area: reading.last,
                lead,
                between: reading.gap.map_or(0, |(from, to)| to + 1 - from),
                parity: encoder_parity(reading, inverted),
                inverted,
                ..FrameDescriptor::binary(0, 0)
            };
            let fixed = bits_outside_position(words, read, lead, inverted);
            let high = fixed.iter().filter(|bit| bit.active_low).count();
            let weights = [(inverted, SWAPPED_WIRES_WEIGHT), (reading.parity.is_some(), PARITY)];
            let weight = NO_FAMILY_WEIGHT + weight + ALWAYS_HIGH_WEIGHT * high as f64 + sum(&weights);
            let base = FrameDescriptor { errors: fixed, ..base };
            let over =
                find_ambiguous_parity(reading, inverted).into_iter().flat_map(|parity| parity_variants(&base, parity));
            let all: Vec<(FrameDescriptor, f64)> =
                over.map(|frame| (frame, GRAY_PADDING_WEIGHT)).chain([(base.clone(), 0.0)]).collect();
            for (frame, more) in all {
                let whole = match repeat {
                    None => frame,
                    Some(repeat) => FrameDescriptor { clocks, repeat: Some(repeat), ..frame },
                };
                if let Ok(layout) = Layout::new(whole) {
                    take(None, layout, weight + more);
                }
            }
        }
    }
}

/// Returns the two frames that could be mistaken for one with this parity bit. In one, the code covers a zero at its
/// end. In the other, it covers an error bit.
fn parity_variants(frame: &FrameDescriptor, parity: Parity) -> [FrameDescriptor; 2] {
    let none = FrameDescriptor { parity: None, ..frame.clone() };
    let mut errors = frame.errors.clone();
    errors.push(error_bit("ERROR", parity.clock, false));
    [
        FrameDescriptor { coded: GrayCoverage::Area, area: parity.clock, ..none.clone() },
        FrameDescriptor { coded: GrayCoverage::AreaAndErrors, errors, ..none },
    ]
}

/// Returns the possible ranges of positions with the given number of bits, each with its weight.
fn possible_ranges(read: &FrameNumbers, bits: u8) -> Vec<(Range, f64)> {
    let reading = &read.reading;
    if let Some((steps, _)) = reading.steps {
        let unusual = f64::from(unusual_step_cost(steps));
        let per_turn = u32::try_from(steps).ok();
        return per_turn.map(|per_turn| (Range::Steps { per_turn, turns: 1 }, unusual)).into_iter().collect();
    }
    if reading.code == Code::Bcd {
        let per_turn = u32::try_from(reading.wrap_period()).ok();
        return per_turn.map(|per_turn| (Range::Steps { per_turn, turns: 1 }, 1.0)).into_iter().collect();
    }
    if let Some((_, to)) = reading.gap {
        let singleturn = reading.last - to;
        let range = Range::Bits { multiturn: bits - singleturn, singleturn };
        return vec![(range, width_penalty(bits - singleturn, singleturn))];
    }
    let shares = common_bit_splits(bits, MIN_SPLITS).into_iter();
    shares
        .map(|(multiturn, singleturn)| (Range::Bits { multiturn, singleturn }, width_penalty(multiturn, singleturn)))
        .collect()
}

/// Returns the bits outside the position that need a name: bits that are always 1, bits that were active, and
/// unexplained bits.
fn bits_outside_position(words: &FrameSet, read: &FrameNumbers, lead: u8, inverted: bool) -> Vec<ErrorBit> {
    let reading = &read.reading;
    let mut bits = Vec::new();
    for (clock, bit) in words.bits() {
        let inside =
            clock > lead && clock <= reading.last && reading.gap.is_none_or(|(from, to)| !(from..=to).contains(&clock));
        if inside || reading.parity.is_some_and(|parity| parity.clock == clock) {
            continue;
        }
        if read.unexplained.contains(&clock) {
            bits.push(error_bit("BIT", clock, false));
        } else if bit.usual != inverted {
            bits.push(error_bit("HIGH", clock, true));
        } else if bit.unusual * 1000 > ERROR_BIT_PERMILLE * words.words().len() {
            bits.push(error_bit("ERROR", clock, false));
        }
    }
    bits
}

fn error_bit(name: &str, clock: u8, active_low: bool) -> ErrorBit {
    let name = format!("{name}{clock}");
    ErrorBit { name, clock, meaning: BitMeaning::Warning, active_low, cleared_by_transfer: false }
}
