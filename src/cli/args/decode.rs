//! What can be written behind `decode`.

use clap::{Args, ValueEnum};

use super::DeviceKind;
use crate::protocol::interbus;

#[derive(Args)]
pub(in crate::cli) struct Decode {
    pub(in crate::cli) protocol: DeviceKind,
    /// A frame as hex bytes; several frames as one argument each.
    ///
    /// biss: UBICOM frames, bridge packets (up to their 00), position frames of the kit encoder (41 bits right-justified:
    /// 16 turns, 17 steps, error, warning, CRC-6; one word of 11 hex digits or with 0x), and position words as "position"
    /// prints them (0x024698000, or raw=610893824 from JSON or a table).
    ///
    /// interbus: words of the process data, 8 hex digits each (a K2 word as a K3 position), or 4 for a K1 encoder. All that
    /// a word may mean is told; --direction and --mode say which it is.
    #[arg(required = true)]
    pub(in crate::cli) hex: Vec<String>,
    #[command(flatten)]
    pub(in crate::cli) words: Words,
}

/// What tells the meaning of an INTERBUS word, where it may have several.
#[derive(Args)]
pub(in crate::cli) struct Words {
    /// interbus: from the encoder (in) or to it (out); both are told without it.
    #[arg(long, value_enum)]
    pub(in crate::cli) direction: Option<Direction>,
    /// interbus: the mode that the encoder was in; with --direction out, a word that is not legal in it is an error.
    #[arg(long, value_enum)]
    pub(in crate::cli) mode: Option<WordMode>,
    /// interbus: what was read out, by name (temperature, operating-time …) or number (0x5D: chip register 5).
    #[arg(long = "read-out", value_name = "NAME|N")]
    pub(in crate::cli) read_out: Option<String>,
    /// interbus: shift_iw, how far the position is shifted under the window of a cam output word.
    #[arg(long, value_name = "0..25", value_parser = clap::value_parser!(u8).range(0..=25))]
    pub(in crate::cli) shift: Option<u8>,
}

/// Which way a word went.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(in crate::cli) enum Direction {
    /// From the encoder.
    In,
    /// To the encoder.
    Out,
}

/// The modes of an encoder.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(in crate::cli) enum WordMode {
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

impl Words {
    /// Which of the options is there.
    pub(in crate::cli) fn given(&self) -> Option<&'static str> {
        [
            ("--direction", self.direction.is_some()),
            ("--mode", self.mode.is_some()),
            ("--read-out", self.read_out.is_some()),
            ("--shift", self.shift.is_some()),
        ]
        .into_iter()
        .find_map(|(name, given)| given.then_some(name))
    }
}

impl From<WordMode> for interbus::Mode {
    fn from(mode: WordMode) -> Self {
        match mode {
            WordMode::Position => interbus::Mode::Position,
            WordMode::Parameterisation => interbus::Mode::Parameterisation,
            WordMode::ReadOut => interbus::Mode::ReadOut,
            WordMode::Velocity => interbus::Mode::Velocity,
            WordMode::Cam => interbus::Mode::Cam,
        }
    }
}
