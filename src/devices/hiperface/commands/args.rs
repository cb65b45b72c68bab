//! Options that only HIPERFACE encoders have.

use clap::Args;

/// Options of `find`.
#[derive(Args)]
pub(super) struct FindOptions {
    /// hiperface: exactly one encoder is connected: also ask by broadcast.
    #[arg(long)]
    pub(super) one_encoder: bool,
    /// hiperface: wait so long for the encoder to be switched off and on, and ask within its default window.
    #[arg(long, value_name = "SECONDS")]
    pub(super) power_cycle: Option<u64>,
}

/// Options of `do`.
#[derive(Args)]
pub(super) struct DoOptions {
    /// hiperface set-position: exactly this value, also when it breaks the phase to the sine signal.
    #[arg(long)]
    pub(super) exact: bool,
    /// hiperface synchronise: the encoder is a kit, where its type does not tell.
    #[arg(long)]
    pub(super) kit: bool,
}
