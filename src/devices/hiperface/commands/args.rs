//! Actions and options specific to HIPERFACE encoders.

use clap::{Args, ValueEnum};

/// Options of `find`.
#[derive(Args)]
pub(super) struct FindOptions {
    /// hiperface: only one encoder is connected, so the broadcast address may be used as well.
    #[arg(long)]
    pub(super) one_encoder: bool,
    /// hiperface: wait this long for a power cycle, and search within the encoder's default window after it.
    #[arg(long, value_name = "SECONDS")]
    pub(super) power_cycle: Option<u64>,
}

/// Options of `do`.
#[derive(Args)]
pub(super) struct DoOptions {
    /// hiperface set-position: set exactly this value, even if it breaks the phase to the sine signal.
    #[arg(long)]
    pub(super) exact: bool,
    /// hiperface synchronise: the encoder is a kit encoder, if its type does not show that.
    #[arg(long)]
    pub(super) kit: bool,
}

/// Actions of HIPERFACE encoders.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(super) enum HiperfaceAction {
    /// restart the encoder and read its status
    Reset,
    /// run the start-up sequence and rate each step; with the argument restart, restart the encoder first
    Check,
    /// POSITION: set the nearest value that keeps the phase to the sine signal
    SetPosition,
    /// POSITION: set the position of a kit encoder and align its code tracks
    Synchronise,
    // This is an attribute, because rustdoc would read the brackets as links.
    #[value(help = "NUMBER SIZE|STATUS [code=N] [ce=0|1] [we=0|1]: create a data field")]
    CreateField,
    /// NUMBER SIZE: change the size of the last field
    ResizeField,
    /// NUMBER: write-protect a field
    LockField,
    /// NUMBER: make a field writable
    UnlockField,
    /// NUMBER: delete the last field
    DeleteField,
    /// NUMBER HEX: change an access code; --code gives the present one
    ChangeCode,
    /// increment the counter
    IncrementCounter,
    /// clear the counter
    ClearCounter,
    /// SETTINGS: change the interface settings until the next restart
    ConfigureForNow,
}
