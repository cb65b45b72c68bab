//! A register of a description: its place, width, meaning and write cost.

use super::super::address::RegisterAddress;
use super::super::status::Firmware;
use super::name::Name;
use crate::bits::ByteOrder;

/// One row of a description.
#[derive(Clone, Debug, PartialEq)]
pub struct Register {
    /// First byte.
    pub address: RegisterAddress,
    /// Bytes, 1…8.
    pub width: u8,
    /// The manual's name.
    pub name: Name,
    /// The role, if the program needs to know it.
    pub role: Option<Role>,
    /// The access.
    pub access: Access,
    /// Order of the bytes.
    pub order: ByteOrder,
    /// Bytes with factory settings, as many as its width; empty if not known.
    pub default: Vec<u8>,
    /// Decoding of the number.
    pub decoding: Decoding,
    /// The symbol of its unit; may be empty.
    pub unit: String,
    /// Values the writing of which spends a write cycle of the flash.
    pub saves: Vec<u8>,
    /// Older firmware has no such register.
    pub since: Firmware,
}

/// The role of a register.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, serde::Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Role {
    /// Selects the bank of 00h…3Fh.
    BankSelect,
    /// The first bank of the data sheet.
    EdsBank,
    /// The profile identification.
    Profile,
    /// The serial number.
    SerialNumber,
    /// The temperature.
    Temperature,
    /// Errors, a bit each.
    Errors,
    /// Warnings, a bit each.
    Warnings,
    /// The device mode.
    Mode,
    /// The password of the device mode.
    Password,
    /// The filter in force.
    Filter,
    /// The firmware's release.
    Firmware,
    /// The device ID.
    DeviceId,
    /// The manufacturer.
    Manufacturer,
}

/// The access to a register.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, serde::Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Access {
    /// Read only.
    R,
    /// Write only.
    W,
    /// Read and write.
    Rw,
}

/// The decoding of a register's number.
#[derive(Clone, Debug, Default, PartialEq, serde::Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Decoding {
    /// Itself.
    #[default]
    Number,
    /// A code without order.
    Hex,
    /// `factor` times the number, and `offset`.
    Scaled {
        /// The value of one step.
        factor: f64,
        /// The value at 0.
        offset: f64,
    },
    /// Bits with their names, the lowest bit 0.
    Bits(Vec<(u8, Name)>),
    /// Values with their names.
    Choice(Vec<(u64, Name)>),
    /// Bytes in their order, separated by dots: 1.6.0.
    Version,
    /// Characters in the order of their addresses.
    Text,
}

/// The decoded bytes of a register.
#[derive(Clone, Debug, PartialEq)]
pub enum Decoded<'a> {
    /// A number.
    Number(u64),
    /// A code.
    Hex(u64),
    /// A quantity in the register's unit.
    Scaled(f64),
    /// The bits that are set; one without a name is unknown.
    Bits(Vec<(u8, Option<&'a Name>)>),
    /// The value's name; `None` if it has none.
    Choice(u64, Option<&'a Name>),
    /// A text or a version.
    Text(String),
}

/// Banks of plain data, each byte for itself.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub struct Area {
    /// The manual's name.
    pub name: Name,
    /// First bank.
    pub first: u8,
    /// Last bank.
    pub last: u8,
    /// The access.
    pub access: Access,
    /// The command that opens it for writing, in the procedure for data.
    pub open: Option<u8>,
}

impl Access {
    /// Returns whether it can be read.
    pub const fn reads(self) -> bool {
        matches!(self, Access::R | Access::Rw)
    }

    /// Returns whether it can be written.
    pub const fn writes(self) -> bool {
        matches!(self, Access::W | Access::Rw)
    }
}

impl Register {
    /// Widest register.
    pub const MAX_WIDTH: u8 = 8;

    /// Returns whether it contains a byte at this address.
    pub fn contains(&self, address: RegisterAddress) -> bool {
        // Global addresses of a bank are consecutive, and a register does not leave its bank.
        let first = self.address.global();
        (first..first + u16::from(self.width)).contains(&address.global())
    }

    /// Returns the bytes as a number; `None` unless there are as many as the register has.
    pub fn number(&self, bytes: &[u8]) -> Option<u64> {
        let join = |number: u64, byte: &u8| number << 8 | u64::from(*byte);
        (bytes.len() == usize::from(self.width)).then(|| match self.order {
            ByteOrder::HighFirst => bytes.iter().fold(0, join),
            ByteOrder::LowFirst => bytes.iter().rev().fold(0, join),
        })
    }

    /// Returns the bytes for a number; `None` if it needs more than there are.
    pub fn bytes(&self, number: u64) -> Option<Vec<u8>> {
        let bytes = number.to_be_bytes();
        let (above, own) = bytes.split_at(bytes.len().checked_sub(usize::from(self.width))?);
        if above.iter().any(|byte| *byte != 0) {
            return None;
        }
        Some(match self.order {
            ByteOrder::HighFirst => own.to_vec(),
            ByteOrder::LowFirst => own.iter().rev().copied().collect(),
        })
    }

    /// Decodes its bytes; `None` unless their number equals the width.
    pub fn decode(&self, bytes: &[u8]) -> Option<Decoded<'_>> {
        let number = self.number(bytes)?;
        Some(match &self.decoding {
            Decoding::Number => Decoded::Number(number),
            Decoding::Hex => Decoded::Hex(number),
            Decoding::Scaled { factor, offset } => Decoded::Scaled(number as f64 * factor + offset),
            Decoding::Bits(names) => {
                let name = |bit: u8| names.iter().find(|(own, _)| *own == bit).map(|(_, name)| name);
                let set = (0..self.width * 8).filter(|bit| number >> bit & 1 == 1);
                Decoded::Bits(set.map(|bit| (bit, name(bit))).collect())
            }
            Decoding::Choice(names) => {
                let name = names.iter().find(|(own, _)| *own == number).map(|(_, name)| name);
                Decoded::Choice(number, name)
            }
            Decoding::Version => Decoded::Text(bytes.iter().map(u8::to_string).collect::<Vec<_>>().join(".")),
            Decoding::Text => Decoded::Text(bytes.escape_ascii().to_string()),
        })
    }

    /// Returns whether writing this value spends a write cycle of the flash.
    pub fn is_save(&self, value: u8) -> bool {
        self.saves.contains(&value)
    }
}

impl Area {
    /// Returns whether the bank belongs to it.
    pub const fn contains(&self, bank: u8) -> bool {
        self.first <= bank && bank <= self.last
    }

    /// Returns its banks.
    pub fn banks(&self) -> std::ops::RangeInclusive<u8> {
        self.first..=self.last
    }

    /// Returns the number of its bytes.
    pub fn size(&self) -> usize {
        (usize::from(self.last) + 1).saturating_sub(self.first.into()) * usize::from(RegisterAddress::BANK_SIZE)
    }
}
