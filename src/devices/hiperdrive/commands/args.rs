//! Arguments specific to HIPERDRIVE drives: the `move` command and options of shared commands.

use clap::builder::PossibleValuesParser;
use clap::{Args, ValueEnum};

use crate::cli::args::DirectionOption;
use crate::devices::hiperdrive::protocol::{ByteOrder, KIND};

/// Option that selects a drive behind a hub.
#[derive(Args)]
pub(super) struct DriveOption {
    /// hiperdrive: number of the drive behind a hub, 1 to 8. Default: the first drive, or the one in the parameter
    /// number.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u8).range(1..=8))]
    pub(super) drive: Option<u8>,
}

/// Options of the `do` command.
#[derive(Args)]
pub(super) struct DoOptions {
    #[command(flatten)]
    pub(super) of: DriveOption,
    /// hiperdrive factory: reset everything, including the address (to DHCP), and save.
    #[arg(long)]
    pub(super) all: bool,
}

/// Options of the `decode` command.
#[derive(Args)]
pub(super) struct WordOptions {
    #[command(flatten)]
    pub(super) way: DirectionOption,
    /// hiperdrive: byte order of numbers in process data. Default: little.
    #[arg(long, value_enum)]
    pub(super) order: Option<ByteOrderArg>,
}

/// Hub option of the `simulate` command.
#[derive(Args)]
pub(super) struct HubOption {
    /// hiperdrive: serve a hub with this number of ports instead of an adapter.
    #[arg(long, value_name = "PLACES", value_parser = ["4", "8"])]
    hub: Option<String>,
}

#[derive(Args)]
pub(crate) struct MoveArgs {
    /// Kind of device.
    #[arg(value_parser = PossibleValuesParser::new([KIND]))]
    pub(crate) device: String,
    /// Target position in scaled steps.
    #[arg(allow_negative_numbers = true)]
    pub(crate) target: String,
    /// Confirm that the drive may move.
    #[arg(long)]
    pub(crate) yes: bool,
    #[command(flatten)]
    pub(crate) of: DriveOption,
    /// Speed as a percentage of the drive's maximum.
    #[arg(long, value_name = "PERCENT", default_value_t = 100, value_parser = clap::value_parser!(u8).range(..=100))]
    pub(crate) speed: u8,
    /// Torque as a percentage of the nominal torque, in steps of 25.
    #[arg(long, value_name = "PERCENT", default_value_t = 100, value_parser = clap::value_parser!(u8).range(..=100))]
    pub(crate) torque: u8,
    /// Stop the drive after this time.
    #[arg(long, value_name = "SECONDS", default_value_t = 60, value_parser = clap::value_parser!(u16).range(1..))]
    pub(crate) timeout: u16,
}

/// Byte order of a number.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum ByteOrderArg {
    /// Low byte first.
    Little,
    /// High byte first.
    Big,
}

impl From<ByteOrderArg> for ByteOrder {
    fn from(order: ByteOrderArg) -> Self {
        match order {
            ByteOrderArg::Little => ByteOrder::Little,
            ByteOrderArg::Big => ByteOrder::Big,
        }
    }
}

/// Actions of an adapter or a hub and its drives.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(super) enum HiperdriveAction {
    /// check the device, supply and address, and for each drive the request, line, errors and range
    Check,
    // Brackets in a doc comment would be read as links by rustdoc.
    #[value(help = "POSITION [--drive N]: set the actual position, rounded to a multiple of 64 steps, and save it")]
    SetPosition,
    /// acknowledge the fault of a drive (--drive N)
    Acknowledge,
    /// save written parameters (47 = 1)
    Save,
    /// load the device's factory parameters without saving them (47 = -1); with --all, load and save everything
    /// (47 = -3)
    Factory,
    /// load the saved parameters of the device, but not those of its drives (47 = -2)
    Recall,
    /// detect the connected drives, which resets them (47 = -4)
    PresenceTest,
}
