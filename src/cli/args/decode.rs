//! What can be written behind `decode`.

use clap::{Args, ValueEnum};

use super::DeviceKind;
use crate::devices::hiperdrive::commands::Order;
use crate::devices::hiperdrive::protocol as hiperdrive;
use crate::devices::interbus::commands::WordMode;
use crate::devices::interbus::protocol as interbus;

#[derive(Args)]
pub(crate) struct Decode {
    /// The kind of device that the bytes came from or went to, or a protocol.
    pub(in crate::cli) protocol: Protocol,
    /// A frame as hex bytes; several frames as one argument each.
    ///
    /// biss: UBICOM frames, bridge packets (up to their 00), position frames of the kit encoder (41 bits right-justified:
    /// 16 turns, 17 steps, error, warning, CRC-6; one word of 11 hex digits or with 0x), and position words as "position"
    /// prints them (0x024698000, or raw=610893824 from JSON or a table).
    ///
    /// interbus: words of the process data, 8 hex digits each (a K2 word as a K3 position), or 4 for a K1 encoder. All that
    /// a word may mean is told; --direction and --mode say which it is.
    ///
    /// hiperdrive: control and status words, 4 hex digits each (0439); process data as they are sent (8, 16, 32, 40, 64 or 72
    /// bytes); parameter words (8 bytes); EtherNet/IP packets with the parameters that they are about.
    ///
    /// ethernet-ip: frames of a TCP stream, one or several behind each other, cyclic packets (UDP), CIP messages alone.
    #[arg(required = true)]
    pub(crate) hex: Vec<String>,
    #[command(flatten)]
    pub(crate) words: Words,
}

/// What bytes are captured of.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum Protocol {
    /// HIPERFACE motor-feedback encoder.
    Hiperface,
    /// Kit encoder with BiSS C: UBICOM frames, bridge packets, position frames.
    Biss,
    /// SSI encoder.
    Ssi,
    /// INTERBUS encoder (K1, K2, K3).
    Interbus,
    /// HIPERDRIVE with EtherNet/IP.
    Hiperdrive,
    /// EtherNet/IP of any device.
    EthernetIp,
}

/// What tells the meaning of a word, where it may have several.
#[derive(Args)]
pub(crate) struct Words {
    /// interbus, hiperdrive: from the device (in) or to it (out); both are told without it, where both fit.
    #[arg(long, value_enum)]
    pub(crate) direction: Option<Direction>,
    /// interbus: the mode that the encoder was in; with --direction out, a word that is not legal in it is an error.
    #[arg(long, value_enum)]
    pub(crate) mode: Option<WordMode>,
    /// interbus: what was read out, by name (temperature, operating-time …) or number (0x5D: chip register 5).
    #[arg(long = "read-out", value_name = "NAME|N")]
    pub(crate) read_out: Option<String>,
    /// interbus: shift_iw, how far the position is shifted under the window of a cam output word.
    #[arg(long, value_name = "0..25", value_parser = clap::value_parser!(u8).range(0..=25))]
    pub(crate) shift: Option<u8>,
    /// hiperdrive: which byte of a number comes first in process data; little where it is left out.
    #[arg(long, value_enum)]
    pub(crate) order: Option<Order>,
}

/// Which way a word went.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum Direction {
    /// From the encoder.
    In,
    /// To the encoder.
    Out,
}

impl Protocol {
    /// Whose it is; `None` where it is any device's.
    pub(in crate::cli) const fn device(self) -> Option<DeviceKind> {
        match self {
            Protocol::Hiperface => Some(DeviceKind::Hiperface),
            Protocol::Biss => Some(DeviceKind::Biss),
            Protocol::Ssi => Some(DeviceKind::Ssi),
            Protocol::Interbus => Some(DeviceKind::Interbus),
            Protocol::Hiperdrive => Some(DeviceKind::Hiperdrive),
            Protocol::EthernetIp => None,
        }
    }
}

impl Words {
    /// An option that is there and says nothing of this protocol, with whose it is.
    pub(in crate::cli) fn foreign_to(&self, protocol: Protocol) -> Option<(&'static str, &'static str)> {
        let interbus = protocol == Protocol::Interbus;
        let hiperdrive = protocol == Protocol::Hiperdrive;
        let both = "interbus and hiperdrive";
        [
            ("--direction", self.direction.is_some() && !interbus && !hiperdrive, both),
            ("--mode", self.mode.is_some() && !interbus, interbus::KIND),
            ("--read-out", self.read_out.is_some() && !interbus, interbus::KIND),
            ("--shift", self.shift.is_some() && !interbus, interbus::KIND),
            ("--order", self.order.is_some() && !hiperdrive, hiperdrive::KIND),
        ]
        .into_iter()
        .find_map(|(option, foreign, of)| foreign.then_some((option, of)))
    }
}
