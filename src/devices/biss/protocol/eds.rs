//! The electronic data sheet of the standard encoder profile BP3: bank 2, common to all BiSS devices, and bank 3 for
//! encoders. Numbers are stored high byte first, and the last byte of each bank is the sum of the others. Bytes that
//! the manual's tables do not name are preserved. See appendix 9.1.4 and 9.1.5 of the manual.

use super::crc::{Crc, CrcError};
use super::single_cycle::{Layout, LayoutError};
use super::status::ProfileId;

/// A bank of the electronic data sheet.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum EdsBank {
    /// Bank 2, common to every BiSS device.
    Common,
    /// Bank 3, specific to encoders.
    Encoder,
}

/// A field of the electronic data sheet, which is a row of the manual's table.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct EdsField {
    /// Offset of the first register, 00h to 3Eh.
    pub offset: u8,
    /// Width in bytes, 1 to 4.
    pub width: u8,
    /// Name in the manual.
    pub name: &'static str,
    /// Factory setting of a kit encoder, or `None` if the manual does not give one.
    pub default: Option<u32>,
    meaning: FieldMeaning,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum FieldMeaning {
    Number(&'static str),
    Bank,
    Ticks { zero: EdsValue },
    Format,
    Profile,
    Feedback,
    EncoderType,
    Polynomial,
    Hex,
    Kelvin,
}

/// The decoded value of a data sheet field.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum EdsValue {
    /// Number with its unit, which may be empty.
    Number(u32, &'static str),
    /// Bank number.
    Bank(u8),
    /// A bank that is not available, which is encoded as FFh.
    NotAvailable,
    /// Time in an unknown unit. The manual does not define the unit, and none fits all values in its tables.
    Ticks(u8),
    /// Adaptive time-out, which is encoded as 0.
    Adaptive,
    /// Unlimited cycle time, which is encoded as 0.
    NoLimit,
    /// Absolute temperature in kelvin.
    Kelvin(u16),
    /// CRC polynomial, including its highest and lowest terms. For example, 43h is x⁶ + x + 1, and 0 means no CRC.
    Polynomial(u64),
    /// Profile ID.
    Profile(ProfileId),
    /// Meaning of a status bit in the position frame.
    Feedback(StatusBitMeaning),
    /// Encoder type. Type 0 is a rotary encoder. The other types are not documented (`U`).
    EncoderType(u8),
    /// Code without numerical meaning.
    Code(u32),
}

/// The meaning of a status bit in the position frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum StatusBitMeaning {
    /// The frame has no such bit (code 0).
    None,
    /// Error bit, active low (code 1).
    Error,
    /// Warning bit, active low (code 2).
    Warning,
    /// Unknown code.
    Unknown(u8),
}

const NUMBER: FieldMeaning = FieldMeaning::Number("");
const TIMEOUT_MEANING: FieldMeaning = FieldMeaning::Ticks { zero: EdsValue::Adaptive };

const fn row(offset: u8, width: u8, default: Option<u32>, meaning: FieldMeaning, name: &'static str) -> EdsField {
    EdsField { offset, width, name, default, meaning }
}

#[rustfmt::skip]
const COMMON: [EdsField; 15] = [
    row(0x00, 1, Some(0x01),   NUMBER,              "EDS version"),
    row(0x01, 1, Some(0x02),   FieldMeaning::Number("banks"), "EDS length"),
    row(0x02, 1, Some(0x04),   FieldMeaning::Bank,       "bank address user start"),
    row(0x03, 1, Some(0x43),   FieldMeaning::Bank,       "bank address user end"),
    row(0x05, 1, Some(0x1C),   TIMEOUT_MEANING,            "minimum BiSS timeout"),
    row(0x06, 1, Some(0x30),   TIMEOUT_MEANING,            "maximum BiSS timeout"),
    row(0x0B, 1, None,         FieldMeaning::Ticks { zero: EdsValue::NoLimit }, "minimum cycle time"),
    row(0x0C, 1, Some(0x20),   FieldMeaning::Ticks { zero: EdsValue::Ticks(0) }, "maximum processing time SCD"),
    row(0x0E, 2, Some(0x01F4), FieldMeaning::Number("ms"), "maximum power-on delay until control communication is available"),
    row(0x10, 1, Some(0x01),   NUMBER,              "number of data channels"),
    row(0x11, 1, Some(0x01),   FieldMeaning::Number("slave addresses"), "area of validity for this EDS"),
    row(0x14, 1, Some(0x03),   FieldMeaning::Bank,       "bank address of the description of data channel 1"),
    row(0x15, 1, Some(0x23),   FieldMeaning::Number("bit"), "data length, data channel 1"),
    row(0x16, 1, Some(0x00),   FieldMeaning::Format,     "data format, data channel 1"),
    row(0x17, 1, Some(0x21),   FieldMeaning::Polynomial, "CRC polynomial (8:1) for data channel 1"),
];

#[rustfmt::skip]
const ENCODER: [EdsField; 17] = [
    row(0x00, 1, Some(0x01),   NUMBER,               "BiSS profile 3 version"),
    row(0x01, 1, Some(0x01),   FieldMeaning::Number("banks"), "length of this profile"),
    row(0x02, 2, Some(0x6129), FieldMeaning::Profile,     "profile identification BP3"),
    row(0x04, 1, Some(0x01),   FieldMeaning::Feedback,    "feedback bit 1"),
    row(0x05, 1, Some(0x02),   FieldMeaning::Feedback,    "feedback bit 2"),
    row(0x06, 1, Some(0xFF),   NUMBER,               "maximum power-on delay until position data is available"),
    row(0x08, 1, Some(0x00),   FieldMeaning::EncoderType, "encoder type"),
    row(0x0A, 1, Some(0x10),   FieldMeaning::Number("bit"), "data length multiturn"),
    row(0x0C, 1, Some(0x11),   FieldMeaning::Number("bit"), "data length coarse"),
    row(0x1C, 4, Some(0x21),   FieldMeaning::Polynomial,  "CRC polynomial (32:1)"),
    row(0x20, 4, Some(0x00),   FieldMeaning::Hex,         "CRC start value"),
    row(0x2C, 2, Some(12_000), FieldMeaning::Number("1/min"), "maximum revolution speed"),
    row(0x30, 2, Some(233),    FieldMeaning::Kelvin,      "minimum operating temperature"),
    row(0x32, 2, Some(378),    FieldMeaning::Kelvin,      "maximum operating temperature"),
    row(0x34, 2, Some(5_000),  FieldMeaning::Number("mV"), "minimum operating voltage"),
    row(0x36, 2, Some(12_000), FieldMeaning::Number("mV"), "maximum operating voltage"),
    row(0x38, 2, Some(70),     FieldMeaning::Number("mA"), "maximum current consumption"),
];

/// The raw contents of an electronic data sheet bank.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Eds {
    bank: EdsBank,
    bytes: [u8; 64],
}

/// Reason why an electronic data sheet is invalid.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum EdsError {
    /// The last byte is not the sum of all other bytes.
    #[error("EDS bank 0x{bank:02X}: checksum {got:02X} instead of {expected:02X}")]
    Checksum {
        /// Number of the bank in the manual.
        bank: u8,
        /// Sum of the other bytes.
        expected: u8,
        /// Checksum received.
        got: u8,
    },
    /// The meaning of a status bit in the position frame is unknown.
    #[error("EDS: feedback bit {number} has the unknown meaning 0x{code:02X}")]
    Feedback {
        /// Number of the bit, 1 or 2.
        number: u8,
        /// Code for the meaning of the bit, as stored in the data sheet.
        code: u8,
    },
    /// The two banks disagree on the data length.
    #[error("EDS: the data length is {common} bits in bank 0x02 but {encoder} bits in bank 0x03")]
    DataLength {
        /// Data length in bank 2 (offset 15h).
        common: u8,
        /// Sum of the multiturn, coarse and feedback bits in bank 3.
        encoder: u8,
    },
    /// The CRC parameters of the position data are invalid.
    #[error("EDS: {0}")]
    Crc(#[from] CrcError),
    /// The field widths do not form a valid frame.
    #[error("EDS: {0}")]
    Layout(#[from] LayoutError),
}

impl EdsBank {
    /// Returns the number of this bank in a kit encoder.
    pub const fn kit_number(self) -> u8 {
        match self {
            EdsBank::Common => 0x02,
            EdsBank::Encoder => 0x03,
        }
    }

    /// Returns the fields of the bank, sorted by address.
    pub const fn fields(self) -> &'static [EdsField] {
        match self {
            EdsBank::Common => &COMMON,
            EdsBank::Encoder => &ENCODER,
        }
    }
}

impl Eds {
    /// Offset of the checksum, which covers all other bytes of the bank.
    pub const CHECKSUM_OFFSET: u8 = 0x3F;

    /// Parses a bank and verifies its checksum.
    ///
    /// # Errors
    /// Returns [`EdsError::Checksum`] if the checksum is wrong.
    pub fn parse(bank: EdsBank, bytes: [u8; 64]) -> Result<Self, EdsError> {
        let expected = sum(&bytes);
        let [.., got] = bytes;
        if got != expected {
            return Err(EdsError::Checksum { bank: bank.kit_number(), expected, got });
        }
        Ok(Eds { bank, bytes })
    }

    /// Returns a bank with the factory settings of a kit encoder. Bytes that the manual does not list are 0.
    pub fn factory_default(bank: EdsBank) -> Self {
        let mut bytes = [0; 64];
        for field in bank.fields() {
            let value = field.default.unwrap_or(0).to_be_bytes();
            let from = value.len() - usize::from(field.width);
            for (byte, at) in value.iter().skip(from).zip(usize::from(field.offset)..) {
                if let Some(place) = bytes.get_mut(at) {
                    *place = *byte;
                }
            }
        }
        let total = sum(&bytes);
        let [.., last] = &mut bytes;
        *last = total;
        Eds { bank, bytes }
    }

    /// Returns the bytes of the bank, with the checksum last.
    pub const fn emit(&self) -> [u8; 64] {
        self.bytes
    }

    /// Returns each field with its value.
    pub fn values(&self) -> impl Iterator<Item = (&'static EdsField, EdsValue)> {
        self.bank.fields().iter().map(|field| (field, field.value(&self.bytes)))
    }

    /// Returns the number of the last bank available to users, or `None` if there is none. Only bank 2 contains this
    /// field.
    pub fn last_user_bank(&self) -> Option<u8> {
        match (self.bank, self.byte(0x03)) {
            (EdsBank::Encoder, _) | (EdsBank::Common, 0xFF) => None,
            (EdsBank::Common, last) => Some(last),
        }
    }

    fn number_at(&self, offset: u8) -> u32 {
        let field = self.bank.fields().iter().find(|field| field.offset == offset);
        field.map_or(0, |field| field.raw_value(&self.bytes))
    }

    fn byte(&self, offset: u8) -> u8 {
        self.bytes.get(usize::from(offset)).copied().unwrap_or(0)
    }
}

/// Returns the position frame layout described by both banks.
///
/// # Errors
/// Returns an error if the banks disagree or describe an invalid layout.
pub fn layout(common: &Eds, encoder: &Eds) -> Result<Layout, EdsError> {
    let feedback =
        |number: u8, offset: u8, expected: StatusBitMeaning| match StatusBitMeaning::from_byte(encoder.byte(offset)) {
            StatusBitMeaning::None => Ok(false),
            meaning if meaning == expected => Ok(true),
            _ => Err(EdsError::Feedback { number, code: encoder.byte(offset) }),
        };
    let error_bit = feedback(1, 0x04, StatusBitMeaning::Error)?;
    let warning_bit = feedback(2, 0x05, StatusBitMeaning::Warning)?;
    let crc = Crc::from_data_sheet(encoder.number_at(0x1C), encoder.number_at(0x20))?;
    let layout = Layout::new(encoder.byte(0x0A), encoder.byte(0x0C), error_bit, warning_bit, crc)?;
    let (common, encoder) = (common.byte(0x15), layout.data_bits());
    if common == encoder { Ok(layout) } else { Err(EdsError::DataLength { common, encoder }) }
}

fn sum(bytes: &[u8; 64]) -> u8 {
    let [content @ .., _] = bytes;
    content.iter().fold(0, |sum: u8, byte| sum.wrapping_add(*byte))
}

impl EdsField {
    /// Returns the number stored in the field, high byte first.
    pub fn raw_value(&self, bank: &[u8; 64]) -> u32 {
        let first = usize::from(self.offset);
        let bytes = bank.get(first..first + usize::from(self.width)).unwrap_or_default();
        bytes.iter().fold(0, |number, byte| number << 8 | u32::from(*byte))
    }

    /// Returns the decoded value of the field. The checksum of the bank is not checked here, but by [`Eds::parse`].
    pub fn value(&self, bank: &[u8; 64]) -> EdsValue {
        let raw = self.raw_value(bank);
        // The conversion is lossless, because fields with these meanings have only one byte.
        let byte = raw as u8;
        match self.meaning {
            FieldMeaning::Number(unit) => EdsValue::Number(raw, unit),
            FieldMeaning::Bank if byte == 0xFF => EdsValue::NotAvailable,
            FieldMeaning::Bank => EdsValue::Bank(byte),
            FieldMeaning::Ticks { zero } if byte == 0 => zero,
            FieldMeaning::Ticks { .. } => EdsValue::Ticks(byte),
            FieldMeaning::Format | FieldMeaning::Hex => EdsValue::Code(raw),
            FieldMeaning::Profile => EdsValue::Profile(ProfileId::new(raw as u16)),
            FieldMeaning::Feedback => EdsValue::Feedback(StatusBitMeaning::from_byte(byte)),
            FieldMeaning::EncoderType => EdsValue::EncoderType(byte),
            FieldMeaning::Polynomial if raw == 0 => EdsValue::Polynomial(0),
            FieldMeaning::Polynomial => EdsValue::Polynomial(u64::from(raw) << 1 | 1),
            FieldMeaning::Kelvin => EdsValue::Kelvin(raw as u16),
        }
    }
}

impl EdsValue {
    /// Returns a temperature in whole degrees Celsius, or `None` if the value is not a temperature.
    pub fn to_celsius(self) -> Option<i32> {
        match self {
            EdsValue::Kelvin(kelvin) => Some(i32::from(kelvin) - 273),
            _ => None,
        }
    }
}

impl StatusBitMeaning {
    const fn from_byte(byte: u8) -> Self {
        match byte {
            0 => StatusBitMeaning::None,
            1 => StatusBitMeaning::Error,
            2 => StatusBitMeaning::Warning,
            _ => StatusBitMeaning::Unknown(byte),
        }
    }
}

#[cfg(test)]
mod tests;
