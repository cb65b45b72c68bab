//! The arguments of `decode`.

use clap::{Args, ValueEnum};

use crate::cli::commands::KindOptions;

#[derive(Args)]
pub struct DecodeArgs {
    /// Kind of device that sent or received the bytes, or a protocol.
    pub(in crate::cli) protocol: String,
    /// Frame as hexadecimal bytes; one argument per frame.
    #[arg(required = true)]
    pub(crate) hex: Vec<String>,
    #[command(flatten)]
    pub(crate) own: KindOptions,
}

/// Option for the direction of captured words, whose meaning may depend on it.
#[derive(Args)]
pub(crate) struct DirectionOption {
    /// Direction of the words: from the device (in) or to it (out). Default: explain each direction that is possible.
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
