//! Actions and options that only HIPERFACE encoders have.

use clap::{Args, ValueEnum};

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

/// The actions of HIPERFACE encoders.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(super) enum HiperfaceAction {
    /// restart the encoder and read its status
    Reset,
    /// the start-up sequence with a verdict a line, with restart behind it after a restart
    Check,
    /// POSITION, the nearest value that keeps the phase to the sine signal
    SetPosition,
    /// POSITION, for kit encoders, aligns the code tracks as well
    Synchronise,
    // Brackets in what rustdoc reads would be links.
    #[value(help = "NUMBER SIZE|STATUS [code=N] [ce=0|1] [we=0|1]")]
    CreateField,
    /// NUMBER SIZE, the last field only
    ResizeField,
    /// NUMBER, write protect
    LockField,
    /// NUMBER, make writable
    UnlockField,
    /// NUMBER, the last field only
    DeleteField,
    /// NUMBER HEX, the present code is given with --code
    ChangeCode,
    /// counter + 1
    IncrementCounter,
    /// counter to 0
    ClearCounter,
    /// SETTINGS, interface settings until the next restart
    ConfigureForNow,
}
