//! The mode of an encoder: it determines the meaning of an OUT word (reference 6.3).

use std::fmt;

/// A mode of a K3 encoder.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Mode {
    /// Running; IN is the position.
    Position,
    /// A parameter was sent and [`Command::Run`](super::Command::Run) not yet: the outputs are not valid.
    Parameterisation,
    /// A read-out is requested; IN is its value.
    ReadOut,
    /// IN is the speed, in revolutions per minute.
    Velocity,
    /// A cam program is selected; IN is the cam output word.
    Cam,
}

impl Mode {
    /// All of them, in the manual's order.
    pub const ALL: [Mode; 5] = [Mode::Position, Mode::Parameterisation, Mode::ReadOut, Mode::Velocity, Mode::Cam];

    /// Returns its spelling.
    pub const fn name(self) -> &'static str {
        match self {
            Mode::Position => "position",
            Mode::Parameterisation => "parameterisation",
            Mode::ReadOut => "read-out",
            Mode::Velocity => "velocity",
            Mode::Cam => "cam",
        }
    }
}

impl fmt::Display for Mode {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} mode", self.name())
    }
}
