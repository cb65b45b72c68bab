//! Options of `decode` that only words of INTERBUS encoders have.

use clap::{Args, ValueEnum};

use crate::cli::args::DirectionOption;
use crate::devices::interbus::protocol::Mode;

/// Options that select the meaning of an ambiguous word
#[derive(Args)]
pub(super) struct WordOptions {
    #[command(flatten)]
    pub(super) way: DirectionOption,
    /// interbus: the mode that the encoder was in; with --direction out, a word that is not legal in it is an error.
    #[arg(long, value_enum)]
    pub(super) mode: Option<WordMode>,
    /// interbus: what was read out, by name (temperature, operating-time …) or number (0x5D: chip register 5).
    #[arg(long = "read-out", value_name = "NAME|N")]
    pub(super) read_out: Option<String>,
    /// interbus: shift_iw, how far the position is shifted under the window of a cam output word.
    #[arg(long, value_name = "0..25", value_parser = clap::value_parser!(u8).range(0..=25))]
    pub(super) shift: Option<u8>,
}

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

/// The actions of INTERBUS encoders.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(super) enum InterbusAction {
    /// gateway, word order, handshake, identity with a verdict a line
    Check,
    // Brackets in what rustdoc reads would be links.
    #[value(
        help = "[POSITION]: store a value, then make the place that value, at standstill; without a value the stored one"
    )]
    Preset,
    /// out of a parameterisation that was left, to run
    LeadBack,
    /// back to what was delivered; experimental, since only the manual's appendix has it
    Default,
}
