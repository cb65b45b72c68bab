//! Validates a descriptor, and calculates the shifts and masks of its layout.

use super::{BitSegment, Flags, Layout};
use crate::devices::ssi::protocol::code::{Code, CodeError, PositionCode, low_bits_mask};
use crate::devices::ssi::protocol::descriptor::{BitMeaning, FrameDescriptor, GrayCoverage, Parity, Word};
use crate::devices::ssi::protocol::range::{Range, RangeError};

/// The reason why a frame is invalid.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum LayoutError {
    /// The number of clocks is 0 or above 64.
    #[error("a frame has 1 to 64 clocks, not {0}")]
    Clocks(u8),
    /// The range of positions is invalid.
    #[error(transparent)]
    Range(#[from] RangeError),
    /// The code cannot represent the positions.
    #[error(transparent)]
    Code(#[from] CodeError),
    /// The position area extends beyond the frame.
    #[error("the position extends to clock {area}, but the frame has only {clocks} clocks")]
    Area {
        /// Last clock of the area.
        area: u8,
        /// Number of clocks in the frame.
        clocks: u8,
    },
    /// The position has too many bits to fit between the zeros.
    #[error("{bits} position bits after {lead} zeros need {needed} clocks, but only {area} are available")]
    Wide {
        /// Width of the code word in bits.
        bits: u8,
        /// Number of zeros before and within the position.
        lead: u8,
        /// Required number of clocks.
        needed: u16,
        /// Number of clocks in the position area.
        area: u8,
    },
    /// Zeros are specified between multiturn and singleturn, although these have no separate bits.
    #[error("the position is a single number, so there cannot be zeros between turns and steps")]
    Between,
    /// The same clock is used twice.
    #[error("clock {clock} is used by both {first} and {second}")]
    Overlap {
        /// Number of the clock, starting at 1.
        clock: u8,
        /// First use of this clock.
        first: ClockUse,
        /// Second use of the same clock.
        second: ClockUse,
    },
    /// The bit lies beyond the last clock.
    #[error("{name} is on clock {clock}, but the frame has only {clocks} clocks")]
    Behind {
        /// Use of the bit beyond the last clock.
        name: ClockUse,
        /// Clock number of the bit.
        clock: u8,
        /// Number of clocks in the frame.
        clocks: u8,
    },
    /// The frame has too many error bits or patterns.
    #[error("at most {limit} {what} are supported, not {count}")]
    Many {
        /// Part that occurs too often.
        what: RepeatableElement,
        /// Maximum number in a frame.
        limit: usize,
        /// Number in the description.
        count: usize,
    },
    /// A code other than Gray covers more than the position.
    #[error("zeros and error bits can be included in the code word only if Gray code is used")]
    NotGray,
    /// An error or parity bit lies within the clocks that are coded or shifted as a whole.
    #[error("{name} cannot be on clock {clock}, because the first {area} clocks are {done} together")]
    Inside {
        /// Use of the bit.
        name: ClockUse,
        /// Clock number of the bit.
        clock: u8,
        /// Number of clocks that are coded or shifted.
        area: u8,
        /// Operation that applies to these clocks.
        done: WordOperation,
    },
    /// The shift drops the lowest bit, which is allowed only in binary and Gray code.
    #[error("shifting to the right drops the lowest bit, without which this code cannot be decoded")]
    Lost,
    /// The frame has too few clocks for the repetition.
    #[error("the frame and the repeated frame need {needed} clocks, but there are only {clocks}")]
    Repeat {
        /// Required number of clocks.
        needed: u16,
        /// Available number of clocks.
        clocks: u8,
    },
    /// The pattern has more bits than the frame.
    #[error("the pattern {word:X} has more than {clocks} bits")]
    Pattern {
        /// Bits of the pattern.
        word: u64,
        /// Number of clocks in the frame.
        clocks: u8,
    },
}

/// What a clock is used for.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum ClockUse {
    /// The clock transmits the position.
    #[error("the position")]
    Position,
    /// The clock transmits the parity bit.
    #[error("the parity bit")]
    Parity,
    /// The clock transmits the error bit with this name.
    #[error("{0}")]
    Error(String),
}

/// A part that may occur several times in a frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum RepeatableElement {
    /// Error bits.
    #[error("error bits")]
    ErrorBits,
    /// Patterns.
    #[error("patterns")]
    Patterns,
}

/// An operation that treats several clocks as one word.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum WordOperation {
    /// The clocks form one code word.
    #[error("coded")]
    Coded,
    /// The clocks are shifted to the right.
    #[error("shifted")]
    Shifted,
}

struct Clocks {
    clocks: u8,
    taken: Vec<(u8, ClockUse)>,
}

pub(super) fn build_layout(descriptor: FrameDescriptor) -> Result<Layout, LayoutError> {
    let (clocks, word) = (descriptor.clocks, descriptor.clocks_per_word());
    if clocks == 0 || clocks > 64 {
        return Err(LayoutError::Clocks(clocks));
    }
    if let Some(repeat) = descriptor.repeat {
        let needed = 2 * u16::from(repeat.word) + u16::from(repeat.gap);
        if repeat.word == 0 || needed > u16::from(clocks) {
            return Err(LayoutError::Repeat { needed, clocks });
        }
    }
    if descriptor.area > word {
        return Err(LayoutError::Area { area: descriptor.area, clocks: word });
    }
    let last = descriptor.range.last_position()?;
    let code = match (descriptor.coded, descriptor.code) {
        (GrayCoverage::Position, code) => code,
        (GrayCoverage::Area | GrayCoverage::AreaAndErrors, Code::Gray) => Code::Binary,
        (GrayCoverage::Area | GrayCoverage::AreaAndErrors, _) => return Err(LayoutError::NotGray),
    };
    let coding = PositionCode::new(code, last)?;
    let parts = word_parts(&descriptor, &coding)?;
    let [_, lower] = parts;
    let lost = descriptor.shift_right && lower.in_word == word - descriptor.area;
    if lost && !matches!(code, Code::Binary | Code::Gray) {
        return Err(LayoutError::Lost);
    }

    let mut taken = Clocks { clocks: word, taken: Vec::new() };
    let position = code_bits_to_word(&parts, low_bits_mask(coding.bits()));
    for clock in (1..=word).filter(|clock| position >> (word - clock) & 1 == 1) {
        taken.claim(clock, ClockUse::Position)?;
    }
    for bit in &descriptor.errors {
        taken.claim(bit.clock, ClockUse::Error(bit.name.clone()))?;
        let done = match descriptor.coded {
            GrayCoverage::Area => Some(WordOperation::Coded),
            _ if descriptor.shift_right => Some(WordOperation::Shifted),
            _ => None,
        };
        if let Some(done) = done.filter(|_| bit.clock <= descriptor.area) {
            return Err(LayoutError::Inside {
                name: ClockUse::Error(bit.name.clone()),
                clock: bit.clock,
                area: descriptor.area,
                done,
            });
        }
    }
    let coded_clocks = match descriptor.coded {
        GrayCoverage::Position => 0,
        GrayCoverage::Area => descriptor.area,
        GrayCoverage::AreaAndErrors => {
            descriptor.errors.iter().map(|bit| bit.clock).max().unwrap_or(0).max(descriptor.area)
        }
    };
    if let Some(Parity { clock, .. }) = descriptor.parity {
        taken.claim(clock, ClockUse::Parity)?;
        // The parity is calculated from the bits as sent, after coding and shifting.
        let inside = |done, area| Err(LayoutError::Inside { name: ClockUse::Parity, clock, area, done });
        if clock <= coded_clocks {
            return inside(WordOperation::Coded, coded_clocks);
        }
        if descriptor.shift_right && clock <= descriptor.area {
            return inside(WordOperation::Shifted, descriptor.area);
        }
    }
    let in_word = |clock: u8| 1_u64 << (word - clock);
    let errors: Vec<u64> = descriptor.errors.iter().map(|bit| in_word(bit.clock)).collect();
    let low = descriptor.errors.iter().filter(|bit| bit.active_low).fold(0, |low, bit| low | in_word(bit.clock));
    let parity = descriptor.parity.map_or((0, 0), |parity| {
        let bit = in_word(parity.clock);
        (bit, low_bits_mask(word) & !(bit | (bit - 1)))
    });
    let used = errors.iter().fold(position | parity.0, |used, bit| used | bit);
    check_count(RepeatableElement::ErrorBits, 8, descriptor.errors.len())?;
    check_count(RepeatableElement::Patterns, 4, descriptor.patterns.len())?;
    let patterns = descriptor.patterns.iter().map(|pattern| match pattern.word {
        Word::Ones => Ok(low_bits_mask(clocks)),
        Word::Bits(word) if word > low_bits_mask(clocks) => Err(LayoutError::Pattern { word, clocks }),
        Word::Bits(word) => Ok(word),
    });
    Ok(Layout {
        coding,
        parts,
        lost,
        behind_area: word - descriptor.area,
        gray: (coded_clocks, word - coded_clocks),
        zeros: low_bits_mask(word) & !used,
        errors,
        low,
        parity,
        patterns: patterns.collect::<Result<_, _>>()?,
        invalid: invalid_flags(&descriptor),
        descriptor,
    })
}

/// Returns the locations of the upper and lower part of the code word within a word.
fn word_parts(descriptor: &FrameDescriptor, coding: &PositionCode) -> Result<[BitSegment; 2], LayoutError> {
    let bits = coding.bits();
    let lead = descriptor.lead.saturating_add(descriptor.between);
    let needed = u16::from(descriptor.lead) + u16::from(descriptor.between) + u16::from(bits);
    if needed > u16::from(descriptor.area) {
        return Err(LayoutError::Wide { bits, lead, needed, area: descriptor.area });
    }
    let singleturn = match descriptor.range {
        Range::Bits { multiturn, singleturn } if multiturn > 0 && singleturn > 0 && bits == multiturn + singleturn => {
            Some(singleturn)
        }
        _ => None,
    };
    let lower = match (descriptor.between, singleturn) {
        (0, _) => bits,
        (_, Some(singleturn)) => singleturn,
        (_, None) => return Err(LayoutError::Between),
    };
    let behind = descriptor.clocks_per_word() - descriptor.lead - descriptor.between - bits;
    let low = BitSegment { in_word: behind, in_code: 0, mask: low_bits_mask(lower) };
    // A part without bits has shifts of 0, because a shift by the full width would overflow.
    let high = if lower == bits {
        BitSegment::default()
    } else {
        BitSegment { in_word: behind + lower + descriptor.between, in_code: lower, mask: low_bits_mask(bits - lower) }
    };
    Ok([high, low])
}

/// Moves the bits of a code word to their places in a frame.
fn code_bits_to_word(parts: &[BitSegment; 2], code: u64) -> u64 {
    parts.iter().fold(0, |word, part| word | (code >> part.in_code & part.mask) << part.in_word)
}

fn check_count(what: RepeatableElement, limit: usize, count: usize) -> Result<(), LayoutError> {
    if count > limit { Err(LayoutError::Many { what, limit, count }) } else { Ok(()) }
}

fn invalid_flags(descriptor: &FrameDescriptor) -> Flags {
    let errors = descriptor.errors.iter().map(|bit| bit.meaning).enumerate();
    let patterns = descriptor.patterns.iter().map(|pattern| pattern.meaning).enumerate();
    let raised = errors.map(|(index, meaning)| (Flags::error(index), meaning));
    let met = patterns.map(|(index, meaning)| (Flags::pattern_flag(index), meaning));
    let own = Flags::CODE.union(Flags::PARITY).union(Flags::REPEAT);
    raised.chain(met).filter(|(_, meaning)| *meaning == BitMeaning::Invalid).fold(own, |all, (flag, _)| all.union(flag))
}

impl Clocks {
    fn claim(&mut self, clock: u8, name: ClockUse) -> Result<(), LayoutError> {
        if clock == 0 || clock > self.clocks {
            return Err(LayoutError::Behind { name, clock, clocks: self.clocks });
        }
        if let Some((_, first)) = self.taken.iter().find(|(at, _)| *at == clock) {
            return Err(LayoutError::Overlap { clock, first: first.clone(), second: name });
        }
        self.taken.push((clock, name));
        Ok(())
    }
}
