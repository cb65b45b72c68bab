//! Options of the `decode` command for INTERBUS words.

use clap::{Args, ValueEnum};

use crate::cli::args::DirectionOption;
use crate::devices::interbus::protocol::EncoderMode;

/// Options that select the meaning of an ambiguous word
#[derive(Args)]
pub(super) struct WordOptions {
    #[command(flatten)]
    pub(super) way: DirectionOption,
    /// interbus: mode of the encoder. With --direction out, a word not allowed in this mode is an error.
    #[arg(long, value_enum)]
    pub(super) mode: Option<EncoderModeArg>,
    /// interbus: value read out, as a name (temperature, operating-time …) or a number (0x5D: chip register 5).
    #[arg(long = "read-out", value_name = "NAME|N")]
    pub(super) read_out: Option<String>,
    /// interbus: window shift (shift_iw) of a cam output word.
    #[arg(long, value_name = "0..25", value_parser = clap::value_parser!(u8).range(0..=25))]
    pub(super) shift: Option<u8>,
}

/// The modes of an encoder.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum EncoderModeArg {
    /// Operation.
    Position,
    /// Parameterisation.
    Parameterisation,
    /// Read-out.
    ReadOut,
    /// Velocity output.
    Velocity,
    /// Selection of a cam program.
    Cam,
}

impl From<EncoderModeArg> for EncoderMode {
    fn from(mode: EncoderModeArg) -> Self {
        match mode {
            EncoderModeArg::Position => EncoderMode::Position,
            EncoderModeArg::Parameterisation => EncoderMode::Parameterisation,
            EncoderModeArg::ReadOut => EncoderMode::ReadOut,
            EncoderModeArg::Velocity => EncoderMode::Velocity,
            EncoderModeArg::Cam => EncoderMode::Cam,
        }
    }
}

/// The actions of INTERBUS encoders.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(super) enum InterbusAction {
    /// check the gateway, word order, handshake and identity
    Check,
    // Rustdoc would read brackets in a doc comment as links.
    #[value(
        help = "[POSITION]: store a preset value and, at standstill, set the current position to it; without a value, use the stored one"
    )]
    Preset,
    /// leave an unfinished parameterisation and return to operation
    LeadBack,
    /// load the factory settings; experimental, because only the appendix of the manual describes this
    Default,
}
