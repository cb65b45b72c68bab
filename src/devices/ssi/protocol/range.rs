//! Range of positions and their meaning as turns and steps, as a round axis, or as a length. See reference section 5.

use std::fmt;
use std::str::FromStr;

use super::code::{bit_width, low_bits_mask};
use crate::expected::AllowedValues;

/// Range of positions from 0 up to a maximum.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Range {
    /// Separate bits for whole turns and for steps within a turn. Singleturn encoders have no multiturn bits.
    Bits {
        /// Width of the multiturn field, 0 to 32 bits.
        multiturn: u8,
        /// Width of the singleturn field, 0 to 32 bits.
        singleturn: u8,
    },
    /// Any number of steps per turn, and any number of turns.
    Steps {
        /// Steps per turn, at least 2.
        per_turn: u32,
        /// Number of turns, at least 1.
        turns: u32,
    },
    /// Round axis: steps that are distributed evenly over a fractional number of turns, after which positions wrap.
    RoundAxis {
        /// Total number of steps, at least 2.
        steps: u32,
        /// Number of turns that the round axis covers.
        revolutions: Fraction,
    },
    /// A linear encoder, whose positions are lengths.
    Length {
        /// Width of the position, 1 to 64 bits.
        bits: u8,
        /// Step length in nanometres.
        step_nanometres: u32,
    },
}

/// A positive fractional number of turns.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Fraction {
    /// Numerator, at least 1.
    pub numerator: u32,
    /// Denominator, at least 1.
    pub denominator: u32,
}

/// Direction of rotation in which positions increase, as seen facing the shaft. For a linear encoder, `Clockwise` is
/// its normal direction.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Direction {
    /// Clockwise, the factory setting.
    #[default]
    Clockwise,
    /// Counterclockwise.
    CounterClockwise,
}

/// The reason why a range is invalid.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum RangeError {
    /// A part of the position exceeds the maximum width.
    #[error("{field} must have at most {limit} bits, not {bits}")]
    Wide {
        /// `multiturn`, `singleturn` or `position`.
        field: &'static str,
        /// Requested width of this part in bits.
        bits: u8,
        /// Maximum width of this part in bits.
        limit: u8,
    },
    /// The range has only one position.
    #[error("the range has only a single position: specify bits or steps")]
    Empty,
    /// The numerator or denominator of the revolutions is zero.
    #[error("the numerator and denominator of revolutions must be greater than 0, not {0}/{1}")]
    Fraction(u32, u32),
}

/// Location of a position on the shaft or scale.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Location {
    /// Location on the shaft of a rotary encoder.
    Shaft {
        /// Whole turns.
        turns: u64,
        /// Steps within the turn.
        steps: u64,
        /// Angle within the turn in degrees, 0 to 360.
        degrees: f64,
    },
    /// Location on the scale of a linear encoder.
    Length {
        /// Distance from the zero of the scale, in millimetres.
        millimetres: f64,
    },
}

impl Range {
    /// Returns the last position.
    ///
    /// # Errors
    /// Returns a [`RangeError`] if the range is invalid.
    pub fn last_position(&self) -> Result<u64, RangeError> {
        match *self {
            Range::Bits { multiturn, singleturn } => {
                for (field, bits) in [("multiturn", multiturn), ("singleturn", singleturn)] {
                    if bits > 32 {
                        return Err(RangeError::Wide { field, bits, limit: 32 });
                    }
                }
                match multiturn + singleturn {
                    0 => Err(RangeError::Empty),
                    bits => Ok(low_bits_mask(bits)),
                }
            }
            Range::Steps { per_turn, turns } => {
                let steps = u64::from(per_turn) * u64::from(turns);
                if steps < 2 { Err(RangeError::Empty) } else { Ok(steps - 1) }
            }
            Range::RoundAxis { revolutions: Fraction { numerator, denominator }, .. }
                if numerator == 0 || denominator == 0 =>
            {
                Err(RangeError::Fraction(numerator, denominator))
            }
            Range::RoundAxis { steps, .. } if steps < 2 => Err(RangeError::Empty),
            Range::RoundAxis { steps, .. } => Ok(u64::from(steps) - 1),
            Range::Length { bits: 0, .. } => Err(RangeError::Empty),
            Range::Length { bits, .. } if bits > 64 => Err(RangeError::Wide { field: "position", bits, limit: 64 }),
            Range::Length { bits, .. } => Ok(low_bits_mask(bits)),
        }
    }

    /// Returns the location of a position. A position after the last one is not wrapped.
    pub fn locate(&self, position: u64) -> Location {
        match *self {
            Range::Bits { singleturn, .. } => {
                let steps = position & low_bits_mask(singleturn);
                let turns = position.checked_shr(u32::from(singleturn)).unwrap_or(0);
                Location::Shaft { turns, steps, degrees: angle_degrees(steps, power_of_two(singleturn)) }
            }
            Range::Steps { per_turn, .. } => {
                let per_turn = u64::from(per_turn.max(1));
                let steps = position % per_turn;
                Location::Shaft { turns: position / per_turn, steps, degrees: angle_degrees(steps, per_turn as f64) }
            }
            Range::RoundAxis { steps, revolutions: Fraction { numerator, denominator } } => {
                let around = u128::from(position) * u128::from(numerator);
                let turn = (u128::from(steps) * u128::from(denominator)).max(1);
                let turns = around / turn;
                let first = (turns * turn).div_ceil(u128::from(numerator).max(1));
                Location::Shaft {
                    turns: turns as u64,
                    steps: u128::from(position).saturating_sub(first) as u64,
                    degrees: (around % turn) as f64 * 360.0 / turn as f64,
                }
            }
            Range::Length { step_nanometres, .. } => {
                Location::Length { millimetres: position as f64 * f64::from(step_nanometres) * 1e-6 }
            }
        }
    }

    /// Returns the position for a turn and a step within the turn. Returns `None` if the range has no such turn or
    /// step, and for a length.
    pub fn position(&self, turns: u64, steps: u64) -> Option<u64> {
        let last = self.last_position().ok()?;
        let position = match *self {
            Range::Bits { singleturn, .. } if steps <= low_bits_mask(singleturn) => {
                turns.checked_mul(1 << singleturn)? | steps
            }
            Range::Steps { per_turn, .. } if steps < u64::from(per_turn) => {
                turns.checked_mul(u64::from(per_turn))?.checked_add(steps)?
            }
            Range::RoundAxis { steps: all, revolutions: Fraction { numerator, denominator } } => {
                let turn = u128::from(all) * u128::from(denominator);
                let first = (u128::from(turns) * turn).div_ceil(u128::from(numerator));
                let next = (u128::from(turns) + 1).checked_mul(turn)?.div_ceil(u128::from(numerator));
                let position = first + u128::from(steps);
                u64::try_from(position).ok().filter(|_| position < next)?
            }
            Range::Bits { .. } | Range::Steps { .. } | Range::Length { .. } => return None,
        };
        (position <= last).then_some(position)
    }

    /// Returns the position of a shaft that has turned by `raw` steps from its zero point.
    ///
    /// The shaft has `per_turn` steps per turn, at least 1. Positions wrap after the last one. For a length, `raw` is
    /// the number of steps along it. See reference section 5, "position = floor(…)".
    pub fn position_from_shaft(&self, raw: u64, per_turn: u64) -> u64 {
        self.count_from_zero(raw, per_turn, Direction::Clockwise)
    }

    /// Returns the position for a counting direction and a preset. The preset is the position at the zero point of the
    /// shaft, and wraps if it is beyond the last position. See reference section 5, "Direction" and "preset".
    pub fn position_with_preset(&self, raw: u64, per_turn: u64, direction: Direction, preset: u64) -> u64 {
        let last = self.last_position().unwrap_or(0);
        let position = u128::from(self.count_from_zero(raw, per_turn, direction)) + u128::from(preset);
        u64::try_from(position % (u128::from(last) + 1)).unwrap_or(last)
    }

    /// Returns the position relative to the zero point of the shaft. All positions are equally wide in both directions.
    fn count_from_zero(&self, raw: u64, per_turn: u64, direction: Direction) -> u64 {
        let (turned, per_turn) = (u128::from(raw), u128::from(per_turn.max(1)));
        let last = self.last_position().unwrap_or(0);
        let (steps, numerator, denominator) = match *self {
            Range::Bits { multiturn, .. } => (u128::from(last) + 1, 1_u128 << multiturn, 1),
            Range::Steps { turns, .. } => (u128::from(last) + 1, u128::from(turns), 1),
            Range::RoundAxis { steps, revolutions: Fraction { numerator, denominator } } => {
                (u128::from(steps), u128::from(numerator), u128::from(denominator).max(1))
            }
            Range::Length { .. } if direction == Direction::CounterClockwise => return raw.wrapping_neg() & last,
            Range::Length { .. } => return raw & last,
        };
        // Number of shaft steps until positions wrap, multiplied by `denominator`.
        let round = (per_turn * numerator).max(1);
        let around = match direction {
            Direction::Clockwise => (turned * denominator) % round,
            Direction::CounterClockwise => (round - (turned * denominator) % round) % round,
        };
        u64::try_from(around * steps / round).unwrap_or(last)
    }

    /// Returns the width of the multiturn field in bits, or 0 if the range has no such field.
    pub const fn multiturn_bits(&self) -> u8 {
        match self {
            Range::Bits { multiturn, .. } => *multiturn,
            _ => 0,
        }
    }

    /// Returns the number of bits required for positions in binary.
    ///
    /// # Errors
    /// Returns a [`RangeError`] if the range is invalid.
    pub fn bits(&self) -> Result<u8, RangeError> {
        self.last_position().map(bit_width)
    }
}

impl fmt::Display for Fraction {
    /// Writes a fraction such as `25/2`, or a whole number.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.denominator {
            1 => write!(f, "{}", self.numerator),
            denominator => write!(f, "{}/{denominator}", self.numerator),
        }
    }
}

impl FromStr for Fraction {
    type Err = AllowedValues;

    /// Parses a fraction such as `25/2`, or a whole number.
    fn from_str(text: &str) -> Result<Self, AllowedValues> {
        let (above, below) = text.split_once('/').unwrap_or((text, "1"));
        let part = |text: &str| text.trim().parse().map_err(|_| AllowedValues::Fraction);
        Ok(Fraction { numerator: part(above)?, denominator: part(below)? })
    }
}

fn power_of_two(bits: u8) -> f64 {
    f64::from(bits).exp2()
}

fn angle_degrees(steps: u64, per_turn: f64) -> f64 {
    steps as f64 * 360.0 / per_turn
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The ranges are 100 steps over 12.5 turns of 8192 steps each, and 3600 steps over one turn (reference section 5).
    #[test]
    fn positions_convert_to_turns_and_degrees() {
        let axis = Range::RoundAxis { steps: 100, revolutions: Fraction { numerator: 25, denominator: 2 } };
        for (raw, position) in [(0, 0), (49152, 48), (102_399, 99), (102_400, 0)] {
            assert_eq!(axis.position_from_shaft(raw, 8192), position, "{raw}");
        }
        assert_eq!(Range::Steps { per_turn: 3600, turns: 1 }.position_from_shaft(4096, 8192), 1800);
        // The shaft is at 270° of turn 1234h and has 2^17 steps per turn. The position contains the lowest 12 bits of
        // the turns and three quarters of 2^13 steps.
        let bits = Range::Bits { multiturn: 12, singleturn: 13 };
        assert_eq!(bits.position_from_shaft(0x1234 << 17 | 0x18000, 1 << 17), 0x234 << 13 | 0x1800);
        assert_eq!(Range::Bits { multiturn: 0, singleturn: 18 }.position_from_shaft(0x18000, 1 << 17), 0x30000);
        assert_eq!(Range::Length { bits: 24, step_nanometres: 1000 }.position_from_shaft(0x100_0007, 1 << 17), 7);
        let most = Range::Bits { multiturn: 32, singleturn: 32 };
        assert_eq!(most.position_from_shaft(u64::MAX, 1 << 32), u64::MAX);
    }

    /// The expected values were calculated by hand for 360 steps on a shaft with 4096 steps, and for the round axis of
    /// the reference.
    #[test]
    fn direction_and_preset_transform_positions() {
        use Direction::{Clockwise, CounterClockwise};
        let degrees = Range::Steps { per_turn: 360, turns: 1 };
        let axis = Range::RoundAxis { steps: 100, revolutions: Fraction { numerator: 25, denominator: 2 } };
        let bits = Range::Bits { multiturn: 4, singleturn: 8 };
        let length = Range::Length { bits: 24, step_nanometres: 1000 };
        let all = Range::Length { bits: 64, step_nanometres: 1 };
        let cases = [
            ("the preset at zero", degrees, 0, 4096, Clockwise, 100, 100),
            ("the preset at zero", degrees, 0, 4096, CounterClockwise, 100, 100),
            ("a quarter turn", degrees, 1024, 4096, Clockwise, 100, 190),
            ("a quarter turn", degrees, 1024, 4096, CounterClockwise, 100, 10),
            ("over the end", degrees, 3072, 4096, Clockwise, 100, 10),
            ("over the end", degrees, 2048, 4096, CounterClockwise, 100, 280),
            ("one step of the shaft back", degrees, 4095, 4096, CounterClockwise, 0, 0),
            ("a degree back", degrees, 4096 - 12, 4096, CounterClockwise, 0, 1),
            ("12.5 turns", axis, 102_400, 8192, CounterClockwise, 7, 7),
            ("6 turns of 12.5 back", axis, 102_400 - 49_152, 8192, CounterClockwise, 0, 48),
            ("turns too", bits, 3 << 10 | 512, 1024, CounterClockwise, 0, 12 << 8 | 128),
            ("a length", length, 7, 1024, CounterClockwise, 3, 0xFF_FFFC),
            ("a preset behind the end", bits, 0, 1024, Clockwise, 0x1005, 5),
            ("64 bits", all, u64::MAX, 1, Clockwise, 2, 1),
        ];
        for (what, range, raw, per_turn, direction, preset, position) in cases {
            assert_eq!(range.position_with_preset(raw, per_turn, direction, preset), position, "{what}, {direction:?}");
        }
    }
}
