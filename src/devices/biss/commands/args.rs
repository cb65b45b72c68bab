//! Actions and options that only BiSS encoders have.

use clap::{Args, ValueEnum};

/// Options of `do`.
#[derive(Args)]
pub(super) struct DoOptions {
    /// biss: how long the motor may take to turn, or the shaft to rest, as an action needs it; 30 without a terminal, 300
    /// on one.
    #[arg(long, value_name = "SECONDS", value_parser = clap::value_parser!(u16).range(1..=3600))]
    pub(super) timeout: Option<u16>,
}

/// The actions of BiSS encoders.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(super) enum BissAction {
    /// identity, errors, position, data sheet, limits, wear with a verdict a line
    Check,
    /// calibrate the singleturn; the motor turns counterclockwise, then clockwise, at 500 ± 2 rpm
    Calibrate,
    // Brackets in what rustdoc reads would be links.
    #[value(
        help = "[save], test the Wiegand sensor; the motor turns clockwise, then counterclockwise, at 500 to 2000 rpm"
    )]
    WiegandTest,
    /// balanced|dynamic
    Filter,
    #[value(
        help = "[ST [MT]] [singleturn|multiturn]: store a value (MT 0 if left out), then make the shaft's place that value; without a value the stored one"
    )]
    Preset,
    /// back to operation and the password cleared, after a procedure was cut off; values that were entered and not saved are
    /// lost, which a terminal asks for (--yes)
    LeadBack,
    #[value(
        help = "[calibrate] [wiegand-test] [save] [preset=ST,MT] [data=FILE] in one run; without the first two both are meant"
    )]
    Mounting,
}
