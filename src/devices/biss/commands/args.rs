//! Options that only BiSS encoders have.

use clap::Args;

/// Options of `do`.
#[derive(Args)]
pub(super) struct DoOptions {
    /// biss: how long the motor may take to turn, or the shaft to rest, as an action needs it; 30 without a terminal, 300
    /// on one.
    #[arg(long, value_name = "SECONDS", value_parser = clap::value_parser!(u16).range(1..=3600))]
    pub(super) timeout: Option<u16>,
}
