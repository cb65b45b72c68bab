//! What these drives have on the command line that no other device has: `move`, and the order of the bytes in `decode`.

use clap::builder::{PossibleValuesParser, TypedValueParser};
use clap::{Args, ValueEnum};

use crate::cli::args::{DeviceKind, OfDrive};
use crate::devices::hiperdrive::protocol::ByteOrder;

#[derive(Args)]
pub(crate) struct Move {
    /// The kind of device: the others do not move.
    #[arg(value_parser = PossibleValuesParser::new(["hiperdrive"]).map(|_| DeviceKind::Hiperdrive))]
    pub(crate) device: DeviceKind,
    /// Where to, in steps as the drive is scaled.
    #[arg(allow_negative_numbers = true)]
    pub(crate) target: String,
    /// Something moves: somebody has looked that it may.
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

/// Which byte of a number comes first.
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
