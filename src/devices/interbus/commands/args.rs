//! What an INTERBUS encoder has on the command line that no other device has: the modes that `decode` asks for.

use clap::ValueEnum;

use crate::devices::interbus::protocol::Mode;

/// The modes of an encoder.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum WordMode {
    /// It runs.
    Position,
    /// Parameters are being set.
    Parameterisation,
    /// Something is read out.
    ReadOut,
    /// It sends its speed.
    Velocity,
    /// A cam program is selected.
    Cam,
}

impl From<WordMode> for Mode {
    fn from(mode: WordMode) -> Self {
        match mode {
            WordMode::Position => Mode::Position,
            WordMode::Parameterisation => Mode::Parameterisation,
            WordMode::ReadOut => Mode::ReadOut,
            WordMode::Velocity => Mode::Velocity,
            WordMode::Cam => Mode::Cam,
        }
    }
}
