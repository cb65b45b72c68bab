//! The arguments of `decode`.

use clap::{Args, ValueEnum};

use crate::cli::commands::OwnOptions;

#[derive(Args)]
pub struct Decode {
    /// The kind of device that the bytes came from or went to, or a protocol.
    pub(in crate::cli) protocol: String,
    /// A frame as hex bytes; several frames as one argument each.
    #[arg(required = true)]
    pub(crate) hex: Vec<String>,
    #[command(flatten)]
    pub(crate) own: OwnOptions,
}

/// The way that a word went, for the devices whose words have one meaning each way.
#[derive(Args)]
pub(crate) struct DirectionOption {
    /// From the device (in) or to it (out); both are told without it, where both fit.
    #[arg(long, value_enum)]
    pub(crate) direction: Option<Direction>,
}

/// Direction of a word.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum Direction {
    /// From the encoder.
    In,
    /// To the encoder.
    Out,
}
