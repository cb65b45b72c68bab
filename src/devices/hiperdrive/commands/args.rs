//! The arguments that only these drives have: `move`, and options of the shared commands.

use clap::builder::PossibleValuesParser;
use clap::{Args, ValueEnum};

use crate::cli::args::DirectionOption;
use crate::devices::hiperdrive::protocol::{ByteOrder, KIND};

/// A drive of a hub: only behind one there are several.
#[derive(Args)]
pub(super) struct OfDrive {
    /// hiperdrive: which drive of a hub, 1 to 8; without it the first, or the one that a parameter's number names.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u8).range(1..=8))]
    pub(super) drive: Option<u8>,
}

/// Options of `do`.
#[derive(Args)]
pub(super) struct DoOptions {
    #[command(flatten)]
    pub(super) of: OfDrive,
    /// hiperdrive factory: everything, the address as well (DHCP), and saved.
    #[arg(long)]
    pub(super) all: bool,
}

/// Options of `decode`.
#[derive(Args)]
pub(super) struct WordOptions {
    #[command(flatten)]
    pub(super) way: DirectionOption,
    /// hiperdrive: which byte of a number comes first in process data; little where it is left out.
    #[arg(long, value_enum)]
    pub(super) order: Option<Order>,
}

/// The option of `simulate` that stands for a setting.
#[derive(Args)]
pub(super) struct HubOption {
    /// hiperdrive: a hub with so many places for drives instead of an adapter.
    #[arg(long, value_name = "PLACES", value_parser = ["4", "8"])]
    hub: Option<String>,
}

#[derive(Args)]
pub(crate) struct Move {
    /// The kind of device: the others do not move.
    #[arg(value_parser = PossibleValuesParser::new([KIND]))]
    pub(crate) device: String,
    /// Target position in steps as the drive is scaled
    #[arg(allow_negative_numbers = true)]
    pub(crate) target: String,
    /// Confirms that the drive may move
    #[arg(long)]
    pub(crate) yes: bool,
    #[command(flatten)]
    pub(crate) of: OfDrive,
    /// Of the drive's greatest speed.
    #[arg(long, value_name = "PERCENT", default_value_t = 100, value_parser = clap::value_parser!(u8).range(..=100))]
    pub(crate) speed: u8,
    /// Of the nominal torque; drives take steps of 25.
    #[arg(long, value_name = "PERCENT", default_value_t = 100, value_parser = clap::value_parser!(u8).range(..=100))]
    pub(crate) torque: u8,
    /// It is stopped after so long.
    #[arg(long, value_name = "SECONDS", default_value_t = 60, value_parser = clap::value_parser!(u16).range(1..))]
    pub(crate) timeout: u16,
}

/// Order of the bytes of a number.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum Order {
    /// The low one.
    Little,
    /// The high one.
    Big,
}

impl From<Order> for ByteOrder {
    fn from(order: Order) -> Self {
        match order {
            Order::Little => ByteOrder::Little,
            Order::Big => ByteOrder::Big,
        }
    }
}

/// The actions of drives.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(super) enum HiperdriveAction {
    /// device, supply, address, and of each drive request, line, errors, range, with a verdict a line
    Check,
    // Brackets in what rustdoc reads would be links.
    #[value(help = "POSITION [--drive N], what the drive's place becomes, rounded to 64 steps and saved")]
    SetPosition,
    /// the fault of a drive (--drive N)
    Acknowledge,
    /// what was written and is not saved yet (47 = 1)
    Save,
    /// the device's own parameters from the factory, not saved (47 = -1); with --all everything, saved (47 = -3)
    Factory,
    /// the device's own parameters as saved last, not those of its drives (47 = -2)
    Recall,
    /// which drives are there; resets them (47 = -4)
    PresenceTest,
}
