//! Actions and options specific to HIPERFACE encoders.

use clap::{Args, ValueEnum};

/// Options of `find`.
#[derive(Args)]
pub(super) struct FindOptions {
    /// hiperface: confirm that only one encoder is connected, so that the broadcast address can also be used.
    #[arg(long)]
    pub(super) one_encoder: bool,
    /// hiperface: wait up to this long for a power cycle, and search in the time after it in which the encoder uses its
    /// default settings.
    #[arg(long, value_name = "SECONDS")]
    pub(super) power_cycle: Option<u64>,
}

/// Options of `do`.
#[derive(Args)]
pub(super) struct DoOptions {
    /// hiperface set-position: set exactly this value, even if it does not match the phase of the sine signal.
    #[arg(long)]
    pub(super) exact: bool,
    /// hiperface synchronise: treat the encoder as a kit encoder if its type does not identify it as one.
    #[arg(long)]
    pub(super) kit: bool,
}

/// Actions of HIPERFACE encoders.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(super) enum HiperfaceAction {
    /// restart the encoder and read its status
    Reset,
    /// run the start-up sequence and report the result of each step; with the argument restart, restart the encoder
    /// first
    Check,
    /// POSITION: set the nearest value that matches the phase of the sine signal
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
    /// NUMBER HEX: change an access code; specify the current one with --code
    ChangeCode,
    /// increment the counter
    IncrementCounter,
    /// clear the counter
    ClearCounter,
    /// SETTINGS: change the interface settings until the next restart
    ConfigureForNow,
}
