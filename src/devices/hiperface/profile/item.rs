//! Items of an encoder and their names, such as `field:1@3+2`, `status:1`, `analogue:0x48`, `counter`, `address` and
//! `settings`.

use std::fmt;
use std::str::FromStr;

use crate::devices::hiperface::protocol::AccessCodeNumber;

/// An item of an encoder that can be read.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Item {
    /// A data field or a part of one.
    Field(FieldRange),
    /// Status byte of a data field.
    Status(u8),
    /// Analogue channel with this number.
    Analogue(u8),
    /// The 24-bit counter.
    Counter,
    /// Address of the encoder.
    Address,
    /// Stored interface settings.
    Settings,
}

/// A data field or a part of one.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct FieldRange {
    /// Field number. FFh is the extended label.
    pub field: u8,
    /// Index of the first byte.
    pub start: usize,
    /// Number of bytes, or `None` for all bytes up to the end of the field.
    pub count: Option<usize>,
}

/// An item that a plan checks, changes and reads back.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum PlanItem {
    /// A readable item.
    #[error("{0}")]
    Item(Item),
    /// Identity of the encoder.
    #[error("the encoder itself")]
    Encoder,
    /// Number of data fields.
    #[error("number of data fields")]
    FieldCount,
    /// Position of the shaft.
    #[error("position")]
    Position,
    /// Access code with this number.
    #[error("code {0}")]
    Code(AccessCodeNumber),
}

/// Error for a string that is not the name of an item.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error(
    "{0:?} is not an item; items are field:N, field:N@ADDR+COUNT, status:N, analogue:CH, counter, address, settings"
)]
pub struct ItemError(pub String);

impl FromStr for Item {
    type Err = ItemError;

    fn from_str(text: &str) -> Result<Self, ItemError> {
        let error = || ItemError(text.to_owned());
        let item = match text.split_once(':') {
            Some(("field", range)) => Item::Field(read_range(range).ok_or_else(error)?),
            Some(("status", field)) => Item::Status(read_byte(field).ok_or_else(error)?),
            Some(("analogue", channel)) => Item::Analogue(read_byte(channel).ok_or_else(error)?),
            None if text == "counter" => Item::Counter,
            None if text == "address" => Item::Address,
            None if text == "settings" => Item::Settings,
            _ => return Err(error()),
        };
        Ok(item)
    }
}

impl fmt::Display for Item {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Item::Field(range) => range.fmt(f),
            Item::Status(field) => write!(f, "status:{field}"),
            Item::Analogue(channel) => write!(f, "analogue:0x{channel:02X}"),
            Item::Counter => f.write_str("counter"),
            Item::Address => f.write_str("address"),
            Item::Settings => f.write_str("settings"),
        }
    }
}

impl FieldRange {
    /// Creates a range that covers a whole field.
    pub fn whole_field(field: u8) -> Self {
        FieldRange { field, start: 0, count: None }
    }

    /// Creates a range that covers part of a field.
    pub fn new(field: u8, start: usize, count: usize) -> Self {
        FieldRange { field, start, count: Some(count) }
    }

    /// Returns whether the range includes byte `address` of the given field.
    pub fn contains(&self, field: u8, address: usize) -> bool {
        self.field == field
            && address >= self.start
            && self.count.is_none_or(|count| address < self.start.saturating_add(count))
    }
}

impl fmt::Display for FieldRange {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match (self.start, self.count) {
            (0, None) => write!(f, "field:{}", self.field),
            (start, None) => write!(f, "field:{}@{start}", self.field),
            (start, Some(count)) => write!(f, "field:{}@{start}+{count}", self.field),
        }
    }
}

fn read_range(text: &str) -> Option<FieldRange> {
    let Some((field, place)) = text.split_once('@') else {
        return Some(FieldRange { field: read_byte(text)?, start: 0, count: None });
    };
    let (start, count) = match place.split_once('+') {
        Some((start, count)) => (read_number(start)?, Some(read_number(count).filter(|count| *count > 0)?)),
        None => (read_number(place)?, None),
    };
    Some(FieldRange { field: read_byte(field)?, start, count })
}

fn read_byte(text: &str) -> Option<u8> {
    u8::try_from(read_number(text)?).ok()
}

fn read_number(text: &str) -> Option<usize> {
    match text.strip_prefix("0x").or_else(|| text.strip_prefix("0X")) {
        Some(hex) => usize::from_str_radix(hex, 16).ok(),
        None => text.parse().ok(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn items_parse_and_print() {
        for text in
            ["field:0", "field:1@3+2", "field:255@16", "status:1", "analogue:0x48", "counter", "address", "settings"]
        {
            assert_eq!(text.parse::<Item>().unwrap().to_string(), text);
        }
        assert_eq!("field:0x1@0x10+0x2".parse::<Item>().unwrap().to_string(), "field:1@16+2");
        assert_eq!("analogue:72".parse::<Item>().unwrap(), Item::Analogue(0x48));
    }

    #[test]
    fn reports_invalid_items() {
        for text in
            ["", "field", "field:", "field:256", "field:1@", "field:1@0+0", "field:1@+2", "counter:1", "Field:1"]
        {
            assert_eq!(text.parse::<Item>(), Err(ItemError(text.to_owned())), "{text}");
        }
    }
}
