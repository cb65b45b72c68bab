//! The parameters: codes, units and limits in one table (reference 3).

use std::ops::RangeInclusive;

use super::gear::{Gear, TURNS};
use super::value::{Code, Value};

/// A parameter that an encoder is set with.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Parameter {
    /// Steps over all programmed turns.
    Steps,
    /// Turns.
    Turns,
    /// 3 clockwise, 4 counterclockwise.
    Direction,
    /// The position that the encoder is to have when the preset is fired.
    Preset,
    /// Zero point shifting. Unlike in manual 5.4.1, it does not apply the preset (reference 6.2).
    ZeroShift,
    /// Back to factory settings. Only in the appendix of the manual (reference 6.10): experimental.
    Default,
}

/// A row of the table.
#[derive(Clone, Copy, Debug)]
pub struct ParameterRow {
    /// The parameter.
    pub parameter: Parameter,
    /// Bits 28..25 of its word.
    pub code: u8,
    /// Name on the command line.
    pub name: &'static str,
    /// Unit of its number; empty if there is none.
    pub unit: &'static str,
    limit: Limit,
}

/// The limits of a number.
#[derive(Clone, Copy, Debug)]
enum Limit {
    /// Always the same.
    Fixed(u32, u32),
    /// From 1 to the maximum for the turns.
    StepsOfTurns,
    /// From 0 to one step before the range's end.
    WithinRange,
}

/// Error: a parameter's number is outside its limits.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{}: {value} is not within {low} to {high}", parameter.name())]
pub struct OutOfRange {
    /// The parameter.
    pub parameter: Parameter,
    /// The given value.
    pub value: u32,
    /// The least.
    pub low: u32,
    /// The greatest.
    pub high: u32,
}

use Parameter::{Default, Direction, Preset, Steps, Turns, ZeroShift};

/// All parameters, in the manual's order.
pub const PARAMETERS: [ParameterRow; 6] = [
    row(Steps, 1, "steps", "steps", Limit::StepsOfTurns),
    row(Turns, 2, "revolutions", "turns", Limit::Fixed(1, TURNS)),
    row(Direction, 3, "direction", "", Limit::Fixed(3, 4)),
    row(Preset, 4, "preset", "steps", Limit::WithinRange),
    row(ZeroShift, 5, "zero-shift", "steps", Limit::WithinRange),
    row(Default, 7, "default", "", Limit::Fixed(0, 0)),
];

const fn row(parameter: Parameter, code: u8, name: &'static str, unit: &'static str, limit: Limit) -> ParameterRow {
    ParameterRow { parameter, code, name, unit, limit }
}

impl Parameter {
    /// Returns its row of the table.
    pub const fn row(self) -> &'static ParameterRow {
        let [steps, turns, direction, preset, zero_shift, default] = &PARAMETERS;
        match self {
            Steps => steps,
            Turns => turns,
            Direction => direction,
            Preset => preset,
            ZeroShift => zero_shift,
            Default => default,
        }
    }

    /// Returns its name.
    pub const fn name(self) -> &'static str {
        self.row().name
    }

    /// Returns the parameter of a code; `None` for codes that are not in the manual.
    pub fn of_code(code: Code) -> Option<Self> {
        PARAMETERS.iter().find(|row| row.code == code.get()).map(|row| row.parameter)
    }

    /// Returns the allowed numbers in an encoder with this gear.
    pub const fn range(self, gear: Gear) -> RangeInclusive<u32> {
        match self.row().limit {
            Limit::Fixed(low, high) => low..=high,
            Limit::StepsOfTurns => 1..=Gear::most_steps(gear.turns()),
            Limit::WithinRange => 0..=gear.steps() - 1,
        }
    }

    /// Returns the allowed numbers in an encoder with any gear.
    pub const fn widest_range(self) -> RangeInclusive<u32> {
        match self.row().limit {
            Limit::Fixed(low, high) => low..=high,
            Limit::StepsOfTurns => 1..=Value::MAX.get(),
            Limit::WithinRange => 0..=Value::MAX.get() - 1,
        }
    }

    /// Returns a number for this parameter.
    ///
    /// # Errors
    /// [`OutOfRange`] with the limits of this gear.
    pub fn check(self, value: u32, gear: Gear) -> Result<Value, OutOfRange> {
        let range = self.range(gear);
        let (low, high) = (*range.start(), *range.end());
        let refused = OutOfRange { parameter: self, value, low, high };
        Value::new(value).filter(|_| range.contains(&value)).ok_or(refused)
    }
}
