//! The role of every bit in a frame, and findings about the frame as a whole.

use super::descriptor::{BitMeaning, Word};
use super::layout::{Flags, FrameReading, Layout};
use super::range::Range;

/// The role of a bit in a frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Role {
    /// The bit is always 0.
    Zero,
    /// Multiturn bit with the given number, where 0 is the lowest.
    Multiturn(u8),
    /// Singleturn bit with the given number, where 0 is the lowest.
    Singleturn(u8),
    /// Bit of the code word with the given number, where 0 is the lowest. It is used if multiturn and singleturn have
    /// no separate bits.
    Position(u8),
    /// Error bit, given by its index in the descriptor's list.
    Error(usize),
    /// The bit is the parity bit.
    Parity,
    /// Repetition of the bit sent at this earlier clock.
    Repetition(u8),
}

/// A bit of a frame, with its clock and role.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Cell {
    /// Clock number, starting at 1.
    pub clock: u8,
    /// Role of the bit.
    pub role: Role,
    /// Value of the transmitted bit.
    pub bit: bool,
}

/// A finding about a frame, such as an active error bit.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum FrameFinding {
    /// An error bit is active.
    Error {
        /// Name of the error bit.
        name: String,
        /// Effect of the error bit on the position.
        meaning: BitMeaning,
        /// Whether the bit covers the time since the previous transfer.
        cleared_by_transfer: bool,
    },
    /// The frame is a word with a special meaning.
    Pattern {
        /// Name of the special meaning.
        name: String,
        /// Effect of the special meaning on the position.
        meaning: BitMeaning,
    },
    /// All bits are 1, so the line may be stuck high.
    StuckHigh {
        /// Whether another flag confirms that the frame is not a position.
        sure: bool,
    },
    /// All bits are 0, so the line may be stuck low.
    StuckLow {
        /// Whether another flag confirms that the frame is not a position.
        sure: bool,
    },
    /// The code word does not represent a position.
    Code,
    /// A bit that should be 0 is 1.
    Padding,
    /// The parity bit does not match the other bits.
    Parity,
    /// The repetition differs from the first transmission.
    Repeat,
}

impl FrameFinding {
    /// Returns the effect of the finding on the position.
    pub const fn meaning(&self) -> BitMeaning {
        match self {
            FrameFinding::Error { meaning, .. } | FrameFinding::Pattern { meaning, .. } => *meaning,
            FrameFinding::StuckHigh { sure: true } | FrameFinding::StuckLow { sure: true } => BitMeaning::Invalid,
            FrameFinding::Code | FrameFinding::Parity | FrameFinding::Repeat => BitMeaning::Invalid,
            FrameFinding::StuckHigh { .. } | FrameFinding::StuckLow { .. } | FrameFinding::Padding => {
                BitMeaning::Warning
            }
        }
    }
}

impl Layout {
    /// Returns the role of the bit at each clock, first to last.
    pub fn clock_roles(&self) -> Vec<Role> {
        let descriptor = self.descriptor();
        let word = descriptor.clocks_per_word();
        let mut roles = vec![Role::Zero; usize::from(descriptor.clocks)];
        let late = u8::from(descriptor.shift_right);
        let bits = self.position_code().bits();
        for bit in 0..bits {
            let from_top = bits - 1 - bit;
            let (role, gap) = match descriptor.range {
                Range::Bits { multiturn, singleturn } if bits == multiturn + singleturn => {
                    if bit >= singleturn {
                        (Role::Multiturn(bit - singleturn), 0)
                    } else {
                        (Role::Singleturn(bit), descriptor.between)
                    }
                }
                _ => (Role::Position(bit), 0),
            };
            let clock = descriptor.lead + gap + from_top + 1 + late;
            if clock <= descriptor.area {
                set_role(&mut roles, clock, role);
            }
        }
        for (index, bit) in descriptor.errors.iter().enumerate() {
            set_role(&mut roles, bit.clock, Role::Error(index));
        }
        if let Some(parity) = descriptor.parity {
            set_role(&mut roles, parity.clock, Role::Parity);
        }
        if let Some(repeat) = descriptor.repeat {
            for clock in 1..=word {
                set_role(&mut roles, clock + word + repeat.gap, Role::Repetition(clock));
            }
        }
        roles
    }

    /// Returns every bit of a frame with its role.
    pub fn to_cells(&self, frame: u64) -> Vec<Cell> {
        let clocks = self.clock_count();
        let numbered = (1..=clocks).zip(self.clock_roles());
        numbered.map(|(clock, role)| Cell { clock, role, bit: frame >> (clocks - clock) & 1 == 1 }).collect()
    }

    /// Returns the findings about a decoded frame. Findings that make the position invalid come first.
    pub fn to_findings(&self, reading: FrameReading) -> Vec<FrameFinding> {
        let descriptor = self.descriptor();
        let flags = reading.flags;
        let mut findings = Vec::new();
        for (index, pattern) in descriptor.patterns.iter().enumerate() {
            if flags.contains(Flags::pattern_flag(index)) {
                findings.push(FrameFinding::Pattern { name: pattern.name.clone(), meaning: pattern.meaning });
            }
        }
        let has_ones_pattern = descriptor.patterns.iter().any(|pattern| pattern.word == Word::Ones);
        if flags.contains(Flags::ALL_ONES) && !has_ones_pattern {
            findings.push(FrameFinding::StuckHigh { sure: self.is_position_invalid(reading) });
        }
        if flags.contains(Flags::ALL_ZEROS) {
            findings.push(FrameFinding::StuckLow { sure: self.is_position_invalid(reading) });
        }
        for (index, bit) in descriptor.errors.iter().enumerate() {
            if flags.contains(Flags::error(index)) {
                let (name, meaning) = (bit.name.clone(), bit.meaning);
                findings.push(FrameFinding::Error { name, meaning, cleared_by_transfer: bit.cleared_by_transfer });
            }
        }
        let of_the_form = [
            (Flags::CODE, FrameFinding::Code),
            (Flags::PARITY, FrameFinding::Parity),
            (Flags::REPEAT, FrameFinding::Repeat),
            (Flags::PADDING, FrameFinding::Padding),
        ];
        findings.extend(of_the_form.into_iter().filter(|(flag, _)| flags.contains(*flag)).map(|(_, finding)| finding));
        findings.sort_by_key(|finding| finding.meaning() == BitMeaning::Warning);
        findings
    }

    /// Returns whether the position in the frame is valid.
    pub fn is_valid(&self, reading: FrameReading) -> bool {
        let stuck =
            reading.flags.intersects(Flags::ALL_ONES.union(Flags::ALL_ZEROS)) && self.is_position_invalid(reading);
        !reading.flags.intersects(self.invalid_flags()) && !stuck
    }

    /// Returns whether the frame has a flag that a fault-free encoder never causes.
    fn is_position_invalid(&self, reading: FrameReading) -> bool {
        let form = Flags::CODE.union(Flags::PADDING).union(Flags::PARITY).union(Flags::REPEAT);
        let errors = (0..self.descriptor().errors.len()).fold(form, |all, index| all.union(Flags::error(index)));
        reading.flags.intersects(errors)
    }
}

fn set_role(roles: &mut [Role], clock: u8, role: Role) {
    if let Some(place) = usize::from(clock).checked_sub(1).and_then(|index| roles.get_mut(index)) {
        *place = role;
    }
}
