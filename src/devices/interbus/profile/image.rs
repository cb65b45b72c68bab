//! The readable part of a K3 encoder's EEPROM.

use std::fmt;
use std::str::FromStr;

use crate::devices::interbus::protocol::{Gear, GearError, Parameter, Program, ProgramNumber, WindowShift};

/// The values of an encoder that can be written and read back. A value is `None` if it was not read or is not in a
/// profile.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub struct Image {
    /// Position parameters.
    pub parameters: Parameters,
    /// Window shift in cam mode, shared by all programs.
    pub shift: Option<WindowShift>,
    /// Cam programs, with program 1 at index 0. A program read from an encoder contains all cams, including inactive
    /// ones.
    pub programs: [Option<Program>; ProgramNumber::COUNT],
}

/// Position parameters of an encoder.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Parameters {
    /// Steps over all programmed turns, which is the measuring range. See [`Gear`].
    pub steps: u32,
    /// Number of turns after which the position repeats.
    pub revolutions: u32,
    /// Counting direction.
    pub direction: Direction,
    /// Preset: the position assigned to the current shaft angle when it is executed. It depends on the mounting.
    pub preset: u32,
    /// Zero shift, which depends on the mounting.
    pub zero_shift: u32,
}

/// Counting direction, as seen when looking at the shaft.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Direction {
    /// Value 3: the position increases when the shaft turns clockwise.
    Clockwise,
    /// Value 4: the position increases when the shaft turns counterclockwise.
    Counterclockwise,
}

impl Direction {
    /// Returns the value of the parameter, 3 or 4.
    pub const fn code(self) -> u32 {
        match self {
            Direction::Clockwise => 3,
            Direction::Counterclockwise => 4,
        }
    }

    /// Returns the direction for a parameter value, or `None` if it is neither 3 nor 4.
    pub const fn from_code(code: u32) -> Option<Self> {
        match code {
            3 => Some(Direction::Clockwise),
            4 => Some(Direction::Counterclockwise),
            _ => None,
        }
    }

    /// Returns the keyword used on the command line and in profiles.
    pub const fn keyword(self) -> &'static str {
        match self {
            Direction::Clockwise => "cw",
            Direction::Counterclockwise => "ccw",
        }
    }
}

impl fmt::Display for Direction {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.keyword())
    }
}

/// Error for a text that is not a direction keyword.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("the direction must be cw (3) or ccw (4)")]
pub struct DirectionError;

impl FromStr for Direction {
    type Err = DirectionError;

    fn from_str(text: &str) -> Result<Self, DirectionError> {
        match text {
            "cw" | "3" => Ok(Direction::Clockwise),
            "ccw" | "4" => Ok(Direction::Counterclockwise),
            _ => Err(DirectionError),
        }
    }
}

impl Parameters {
    /// Returns the value of a parameter, or `None` if it is not a setting.
    pub const fn value(&self, parameter: Parameter) -> Option<u32> {
        match parameter {
            Parameter::Steps => Some(self.steps),
            Parameter::Turns => Some(self.revolutions),
            Parameter::Direction => Some(self.direction.code()),
            Parameter::Preset => Some(self.preset),
            Parameter::ZeroShift => Some(self.zero_shift),
            Parameter::Default => None,
        }
    }

    /// Returns the gear with these steps and turns.
    ///
    /// # Errors
    /// Returns a [`GearError`] if the steps or turns are out of range.
    pub const fn gear(&self) -> Result<Gear, GearError> {
        Gear::new(self.steps, self.revolutions)
    }
}

impl Image {
    /// Creates the content of an encoder with parameters only.
    pub const fn from_parameters(parameters: Parameters) -> Self {
        Image { parameters, shift: None, programs: [None; ProgramNumber::COUNT] }
    }

    /// Returns a program, or `None` if it is unknown.
    pub fn program(&self, number: ProgramNumber) -> Option<&Program> {
        self.programs.get(usize::from(number.get() - 1)).and_then(Option::as_ref)
    }

    /// Returns a mutable program entry, which is `None` while the program is unknown.
    pub fn program_mut(&mut self, number: ProgramNumber) -> Option<&mut Option<Program>> {
        self.programs.get_mut(usize::from(number.get() - 1))
    }

    /// Returns the known programs with their numbers.
    pub fn known_programs(&self) -> impl Iterator<Item = (ProgramNumber, &Program)> {
        ProgramNumber::all().filter_map(|number| Some((number, self.program(number)?)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn direction_codes_match_manual() {
        for (text, code) in [("cw", 3), ("3", 3), ("ccw", 4), ("4", 4)] {
            let direction: Direction = text.parse().unwrap();
            assert_eq!((direction.code(), Direction::from_code(code)), (code, Some(direction)), "{text}");
        }
        assert_eq!("left".parse::<Direction>(), Err(DirectionError));
        assert_eq!(Direction::from_code(5), None);
    }

    #[test]
    fn stores_program_by_number() {
        let parameters =
            Parameters { steps: 255, revolutions: 1, direction: Direction::Clockwise, preset: 0, zero_shift: 0 };
        let mut image = Image::from_parameters(parameters);
        let last = ProgramNumber::new(8).unwrap();
        *image.program_mut(last).unwrap() = Some(Program { mask: 0x93, ..Program::default() });
        assert_eq!(
            image.known_programs().map(|(number, own)| (number.get(), own.mask)).collect::<Vec<_>>(),
            [(8, 0x93)]
        );
        assert_eq!(image.programs.iter().position(Option::is_some), Some(7));
    }
}
