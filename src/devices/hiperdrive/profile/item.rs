//! Parameter names as accepted by `read`, such as `158` for the device or drive 1, and `158 drive 2` or `258` for
//! another drive.

use std::fmt;
use std::str::FromStr;

use crate::devices::hiperdrive::protocol::{DriveNumber, ParameterNumber};

/// A parameter, displayed by its name.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Item(pub ParameterNumber);

/// Reason why a string does not name a parameter.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum ItemError {
    /// The string is not in the form of a parameter name.
    #[error(
        "{0:?} is not a parameter; enter a number such as 47 or 158 (for another drive, use \"158 drive 2\" or 258)"
    )]
    Unknown(String),
    /// The manual does not list a parameter with this number.
    #[error("parameter {0} does not exist")]
    NoParameter(u16),
    /// The parameter does not belong to a drive, or the drive number is not in the range 1 to 8.
    #[error(
        "parameter {number} does not belong to drive {drive}: drives are numbered 1 to 8, and parameters below 100 \
         belong to the device"
    )]
    NoDrive {
        /// Parameter number in the string.
        number: u16,
        /// Drive number in the string.
        drive: u8,
    },
}

impl Item {
    /// Creates an item from a parameter number and an optional drive. A number that already contains the drive, such as
    /// 258, is kept.
    ///
    /// # Errors
    /// Returns [`ItemError`] if the parameter does not exist, or if the drive does not have it.
    pub fn new(number: u16, drive: Option<u8>) -> Result<Self, ItemError> {
        let own = ParameterNumber::new(number).ok_or(ItemError::NoParameter(number))?;
        let own = match drive {
            None => own,
            Some(drive) => {
                let no_drive = ItemError::NoDrive { number, drive };
                let drive = DriveNumber::new(drive).ok_or_else(|| no_drive.clone())?;
                // A number such as 258 already names drive 2.
                match own.drive() {
                    Some(named) if named == drive => own,
                    Some(DriveNumber::FIRST) => ParameterNumber::for_drive(number, drive).ok_or(no_drive)?,
                    _ => return Err(no_drive),
                }
            }
        };
        own.row().map(|_| Item(own)).ok_or(ItemError::NoParameter(number))
    }

    /// Returns the name from the parameter table, or an empty string if the parameter is not in the table.
    pub fn name(self) -> &'static str {
        self.0.row().map_or("", |row| row.name)
    }
}

impl fmt::Display for Item {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.0.drive() {
            None | Some(DriveNumber::FIRST) => write!(f, "{}", self.0),
            Some(drive) => write!(f, "{} drive {}", self.0.drive1_number(), drive.get()),
        }
    }
}

impl FromStr for Item {
    type Err = ItemError;

    fn from_str(text: &str) -> Result<Self, ItemError> {
        let unknown = || ItemError::Unknown(text.to_owned());
        let (number, drive) = match text.split_once(" drive ") {
            Some((number, drive)) => (number, Some(drive.parse().map_err(|_| unknown())?)),
            None => (text, None),
        };
        Item::new(Item::parse_number(number).ok_or_else(unknown)?, drive)
    }
}

impl Item {
    /// Parses a parameter number without a sign, in decimal or, with the prefix `0x`, in hexadecimal.
    pub fn parse_number(text: &str) -> Option<u16> {
        let (digits, radix) = match text.strip_prefix("0x").or_else(|| text.strip_prefix("0X")) {
            Some(digits) => (digits, 16),
            None => (text, 10),
        };
        let is_plain = digits.bytes().all(|byte| byte.is_ascii_hexdigit());
        u16::from_str_radix(digits, radix).ok().filter(|_| is_plain)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_parse_and_print() {
        for (text, number, written) in [
            ("47", 47, "47"),
            ("158", 158, "158"),
            ("158 drive 1", 158, "158"),
            ("0x9E", 158, "158"),
            ("0X9e drive 2", 258, "158 drive 2"),
            ("158 drive 2", 258, "158 drive 2"),
            ("258", 258, "158 drive 2"),
            ("258 drive 2", 258, "158 drive 2"),
            ("898", 898, "198 drive 8"),
        ] {
            let item: Item = text.parse().unwrap();
            assert_eq!((item.0.get(), item.to_string().as_str()), (number, written), "{text}");
        }
    }

    #[test]
    fn rejects_invalid_names() {
        for (text, why) in [
            ("limit", "\"limit\" is not a parameter"),
            ("-158", "\"-158\" is not a parameter"),
            ("0x", "\"0x\" is not a parameter"),
            ("0x-9E", "\"0x-9E\" is not a parameter"),
            ("9E", "\"9E\" is not a parameter"),
            ("+158", "\"+158\" is not a parameter"),
            ("", "\"\" is not a parameter"),
            ("158 drive", "\"158 drive\" is not a parameter"),
            ("158 drive x", "\"158 drive x\" is not a parameter"),
            ("155", "parameter 155 does not exist"),
            ("0", "parameter 0 does not exist"),
            ("900", "parameter 900 does not exist"),
            ("158 drive 9", "parameter 158 does not belong to drive 9"),
            ("158 drive 0", "parameter 158 does not belong to drive 0"),
            ("47 drive 2", "parameter 47 does not belong to drive 2"),
            ("258 drive 3", "parameter 258 does not belong to drive 3"),
        ] {
            let error = text.parse::<Item>().unwrap_err().to_string();
            assert!(error.starts_with(why), "{text}: {error}");
        }
    }
}
