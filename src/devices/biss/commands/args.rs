//! Actions and options specific to BiSS encoders.

use clap::{Args, ValueEnum};

/// Options of `do`.
#[derive(Args)]
pub(super) struct DoOptions {
    /// biss: how long to wait for the motor to turn or the shaft to stop. Default: 300 on a terminal, otherwise 30.
    #[arg(long, value_name = "SECONDS", value_parser = clap::value_parser!(u16).range(1..=3600))]
    pub(super) timeout: Option<u16>,
}

/// Actions of BiSS encoders.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(super) enum BissAction {
    /// check the identity, errors, position, data sheet, limits and write cycles
    Check,
    /// run the singleturn calibration while the motor turns at 500 ± 2 rpm, first counterclockwise, then clockwise
    Calibrate,
    // Rustdoc would read brackets in a doc comment as links.
    #[value(
        help = "[save]: test the Wiegand sensor while the motor turns at 500 to 2000 rpm, first clockwise, then counterclockwise"
    )]
    WiegandTest,
    /// balanced|dynamic: choose the position filter
    Filter,
    #[value(
        help = "[ST [MT]] [singleturn|multiturn]: store a preset value (MT default 0) and set the current position to it; without a value, use the stored one"
    )]
    Preset,
    /// return to operation and clear the password after an interrupted procedure; values not yet saved are lost (asks
    /// first, unless --yes is given)
    LeadBack,
    #[value(
        help = "[calibrate] [wiegand-test] [save] [preset=ST,MT] [data=FILE]: run these steps after mounting; default: calibrate and wiegand-test"
    )]
    Mounting,
}
