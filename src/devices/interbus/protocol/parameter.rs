//! Parameters with their codes, units and limits (reference 3).

use std::ops::RangeInclusive;

use super::gear::{Gear, TURNS};
use super::value::{Code, Value};

/// A parameter of an encoder.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Parameter {
    /// Steps over all programmed turns.
    Steps,
    /// Number of turns.
    Turns,
    /// Counting direction: 3 clockwise, 4 counterclockwise.
    Direction,
    /// Position to which the encoder is set when the preset is executed.
    Preset,
    /// Zero shift. Contrary to manual 5.4.1, it does not execute the preset (reference 6.2).
    ZeroShift,
    /// Restores the factory settings. This is experimental, since only the appendix of the manual mentions it
    /// (reference 6.10).
    Default,
}

/// A row of the parameter table.
#[derive(Clone, Copy, Debug)]
pub struct ParameterRow {
    /// The parameter.
    pub parameter: Parameter,
    /// Code in bits 28..25 of the word.
    pub code: u8,
    /// Name on the command line.
    pub name: &'static str,
    /// Unit of the value, or an empty string if there is none.
    pub unit: &'static str,
    limit: Limit,
}

#[derive(Clone, Copy, Debug)]
enum Limit {
    /// Constant limits.
    Fixed(u32, u32),
    /// From 1 to the number of disc steps over the programmed turns.
    StepsOfTurns,
    /// From 0 to the last position of the measuring range.
    WithinRange,
}

/// Error for a parameter value outside its limits.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{}: {value} is outside the range {low} to {high}", parameter.name())]
pub struct OutOfRange {
    /// The parameter.
    pub parameter: Parameter,
    /// The rejected value.
    pub value: u32,
    /// Lower limit.
    pub low: u32,
    /// Upper limit.
    pub high: u32,
}

use Parameter::{Default, Direction, Preset, Steps, Turns, ZeroShift};

/// All parameters in the order of the manual.
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
    /// Returns the table row of the parameter.
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

    /// Returns the name of the parameter on the command line.
    pub const fn name(self) -> &'static str {
        self.row().name
    }

    /// Returns the parameter with the given code, or `None` if the manual does not define the code.
    pub fn from_code(code: Code) -> Option<Self> {
        PARAMETERS.iter().find(|row| row.code == code.get()).map(|row| row.parameter)
    }

    /// Returns the valid values for an encoder with the given gear.
    pub const fn valid_range(self, gear: Gear) -> RangeInclusive<u32> {
        match self.row().limit {
            Limit::Fixed(low, high) => low..=high,
            Limit::StepsOfTurns => 1..=Gear::max_steps(gear.turns()),
            Limit::WithinRange => 0..=gear.total_steps() - 1,
        }
    }

    /// Returns the values that are valid with at least one gear.
    pub const fn range_with_any_gear(self) -> RangeInclusive<u32> {
        match self.row().limit {
            Limit::Fixed(low, high) => low..=high,
            Limit::StepsOfTurns => 1..=Value::MAX.get(),
            Limit::WithinRange => 0..=Value::MAX.get() - 1,
        }
    }

    /// Checks a value of this parameter.
    ///
    /// # Errors
    /// Returns [`OutOfRange`] with the limits for this gear if the value exceeds them.
    pub fn check_value(self, value: u32, gear: Gear) -> Result<Value, OutOfRange> {
        let range = self.valid_range(gear);
        let (low, high) = (*range.start(), *range.end());
        let refused = OutOfRange { parameter: self, value, low, high };
        Value::new(value).filter(|_| range.contains(&value)).ok_or(refused)
    }
}
