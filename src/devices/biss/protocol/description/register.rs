//! A described register, with its address, width, meaning and write cost.

use super::super::address::RegisterAddress;
use super::super::status::Firmware;
use super::name::Name;
use crate::bits::ByteOrder;

/// A register as defined by one row of a description.
#[derive(Clone, Debug, PartialEq)]
pub struct Register {
    /// Address of the first byte.
    pub address: RegisterAddress,
    /// Width in bytes, 1 to 8.
    pub width: u8,
    /// Name in the manual.
    pub name: Name,
    /// What the program uses the register for, if at all.
    pub role: Option<Role>,
    /// Permitted access.
    pub access: Access,
    /// Byte order of the value.
    pub order: ByteOrder,
    /// Factory settings of the bytes. The list is empty if they are unknown.
    pub default: Vec<u8>,
    /// How the value is decoded.
    pub decoding: ValueDecoding,
    /// Unit symbol, which may be empty.
    pub unit: String,
    /// Values that cost a flash write cycle when they are written.
    pub saves: Vec<u8>,
    /// Oldest firmware that has the register.
    pub since: Firmware,
}

/// The purpose of a register that the program uses, whatever its address.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, serde::Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Role {
    /// Selection of the bank visible at 00h to 3Fh.
    BankSelect,
    /// Number of the first bank of the electronic data sheet.
    EdsBank,
    /// Profile ID.
    Profile,
    /// Serial number of the encoder.
    SerialNumber,
    /// Temperature of the encoder.
    Temperature,
    /// Error flags, one bit each.
    Errors,
    /// Warning flags, one bit each.
    Warnings,
    /// Current device mode.
    Mode,
    /// Password that unlocks the device mode.
    Password,
    /// Active position filter.
    Filter,
    /// Firmware version.
    Firmware,
    /// Device ID of the encoder.
    DeviceId,
    /// Manufacturer ID.
    Manufacturer,
}

/// The kind of access that a register permits.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, serde::Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Access {
    /// Read-only.
    R,
    /// Write-only.
    W,
    /// Readable and writable.
    Rw,
}

/// How a register value is decoded.
#[derive(Clone, Debug, Default, PartialEq, serde::Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum ValueDecoding {
    /// Plain number.
    #[default]
    Number,
    /// Code without numerical meaning, shown in hexadecimal.
    Hex,
    /// Linear scaling, which multiplies the number by `factor` and adds `offset`.
    Scaled {
        /// Factor by which the number is multiplied.
        factor: f64,
        /// Value for the number 0.
        offset: f64,
    },
    /// Named bits, numbered from 0 for the lowest bit.
    Bits(Vec<(u8, Name)>),
    /// Named values.
    Choice(Vec<(u64, Name)>),
    /// Version number. Its bytes are shown in order, separated by dots, such as 1.6.0.
    Version,
    /// Text with one character per byte, in ascending order of address.
    Text,
}

/// The decoded value of a register.
#[derive(Clone, Debug, PartialEq)]
pub enum DecodedValue<'a> {
    /// Plain number.
    Number(u64),
    /// Code without numerical meaning.
    Hex(u64),
    /// Value in the register's unit.
    Scaled(f64),
    /// Bits that are set, with their names if known.
    Bits(Vec<(u8, Option<&'a Name>)>),
    /// Value with its name, or `None` if it has no name.
    Choice(u64, Option<&'a Name>),
    /// Character string or version.
    Text(String),
}

/// A range of banks whose registers are not described individually. Each byte is a separate value.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub struct Area {
    /// Name in the manual.
    pub name: Name,
    /// First bank of the area.
    pub first: u8,
    /// Last bank of the area.
    pub last: u8,
    /// Permitted access.
    pub access: Access,
    /// Command of the data write procedure that opens the area for writing, if it must be opened.
    pub open: Option<u8>,
}

impl Access {
    /// Returns whether reading is permitted.
    pub const fn is_readable(self) -> bool {
        matches!(self, Access::R | Access::Rw)
    }

    /// Returns whether writing is permitted.
    pub const fn is_writable(self) -> bool {
        matches!(self, Access::W | Access::Rw)
    }
}

impl Register {
    /// Maximum width of a register in bytes.
    pub const MAX_WIDTH: u8 = 8;

    /// Returns whether the register contains the byte at the given address.
    pub fn contains(&self, address: RegisterAddress) -> bool {
        // Global addresses of a bank are consecutive, and a register lies within one bank.
        let first = self.address.global_number();
        (first..first + u16::from(self.width)).contains(&address.global_number())
    }

    /// Returns the number that the bytes represent. Returns `None` if the number of bytes differs from the register's
    /// width.
    pub fn to_number(&self, bytes: &[u8]) -> Option<u64> {
        let join = |number: u64, byte: &u8| number << 8 | u64::from(*byte);
        (bytes.len() == usize::from(self.width)).then(|| match self.order {
            ByteOrder::HighFirst => bytes.iter().fold(0, join),
            ByteOrder::LowFirst => bytes.iter().rev().fold(0, join),
        })
    }

    /// Returns the bytes that encode a number, or `None` if the number does not fit the register.
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

    /// Decodes the bytes of the register, or returns `None` if their number differs from the width.
    pub fn decode(&self, bytes: &[u8]) -> Option<DecodedValue<'_>> {
        let number = self.to_number(bytes)?;
        Some(match &self.decoding {
            ValueDecoding::Number => DecodedValue::Number(number),
            ValueDecoding::Hex => DecodedValue::Hex(number),
            ValueDecoding::Scaled { factor, offset } => DecodedValue::Scaled(number as f64 * factor + offset),
            ValueDecoding::Bits(names) => {
                let name = |bit: u8| names.iter().find(|(own, _)| *own == bit).map(|(_, name)| name);
                let set = (0..self.width * 8).filter(|bit| number >> bit & 1 == 1);
                DecodedValue::Bits(set.map(|bit| (bit, name(bit))).collect())
            }
            ValueDecoding::Choice(names) => {
                let name = names.iter().find(|(own, _)| *own == number).map(|(_, name)| name);
                DecodedValue::Choice(number, name)
            }
            ValueDecoding::Version => DecodedValue::Text(bytes.iter().map(u8::to_string).collect::<Vec<_>>().join(".")),
            ValueDecoding::Text => DecodedValue::Text(bytes.escape_ascii().to_string()),
        })
    }

    /// Returns whether writing the given value costs a flash write cycle.
    pub fn costs_write_cycle(&self, value: u8) -> bool {
        self.saves.contains(&value)
    }
}

impl Area {
    /// Returns whether the area contains the given bank.
    pub const fn contains(&self, bank: u8) -> bool {
        self.first <= bank && bank <= self.last
    }

    /// Returns the banks of the area.
    pub fn banks(&self) -> std::ops::RangeInclusive<u8> {
        self.first..=self.last
    }

    /// Returns the size of the area in bytes.
    pub fn size(&self) -> usize {
        (usize::from(self.last) + 1).saturating_sub(self.first.into()) * usize::from(RegisterAddress::BANK_SIZE)
    }
}
