//! Notation for the registers of an encoder, such as `0x66` for a direct register, `0x24:0x10` for a register in a
//! bank, and `0x24:0x10+3` for consecutive registers.

use std::fmt;
use std::str::FromStr;

use crate::devices::biss::protocol::RegisterAddress;

/// A range of consecutive registers, either direct or in one bank.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct RegisterRange {
    start: RegisterAddress,
    /// Number of registers, 1 to 64.
    count: u8,
}

/// Error for a string that does not name any registers.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{0:?} is not an item; items are 0x40 to 0x7F or BANK:OFFSET such as 0x24:0x10, either with +COUNT appended")]
pub struct ItemError(pub String);

impl RegisterRange {
    /// Creates a range of one register.
    pub const fn single(start: RegisterAddress) -> Self {
        RegisterRange { start, count: 1 }
    }

    /// Creates the range of `count` registers from `start`. Returns `None` if `count` is 0 or the range extends beyond
    /// the bank.
    pub fn new(start: RegisterAddress, count: u8) -> Option<Self> {
        start.offset_by(count.checked_sub(1)?).map(|_| RegisterRange { start, count })
    }

    /// Returns the first register of the range.
    pub const fn start(self) -> RegisterAddress {
        self.start
    }

    /// Returns the number of registers, 1 to 64.
    pub const fn count(self) -> u8 {
        self.count
    }

    /// Returns whether the range contains the given register.
    pub fn contains(self, address: RegisterAddress) -> bool {
        // Global addresses of a bank are consecutive, and a range lies within one bank.
        let first = self.start.global_number();
        (first..first + u16::from(self.count)).contains(&address.global_number())
    }

    /// Returns all registers of the range in ascending order.
    pub fn addresses(self) -> impl Iterator<Item = RegisterAddress> {
        (0..self.count).filter_map(move |at| self.start.offset_by(at))
    }

    /// Returns the shortest list of ranges that covers the given registers, which must be in ascending order.
    pub fn from_addresses(addresses: impl IntoIterator<Item = RegisterAddress>) -> Vec<Self> {
        let mut runs: Vec<RegisterRange> = Vec::new();
        for address in addresses {
            match runs.last_mut() {
                Some(run) if run.start.offset_by(run.count) == Some(address) => run.count += 1,
                _ => runs.push(RegisterRange::single(address)),
            }
        }
        runs
    }
}

impl fmt::Display for RegisterRange {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.start.fmt(f)?;
        if self.count > 1 { write!(f, "+{}", self.count) } else { Ok(()) }
    }
}

impl FromStr for RegisterRange {
    type Err = ItemError;

    fn from_str(text: &str) -> Result<Self, ItemError> {
        let read = || {
            let (start, count) = match text.split_once('+') {
                Some((start, count)) => (start, read_count(count)?),
                None => (text, 1),
            };
            RegisterRange::new(start.parse().ok()?, count)
        };
        read().ok_or_else(|| ItemError(text.to_owned()))
    }
}

fn read_count(text: &str) -> Option<u8> {
    match text.strip_prefix("0x").or_else(|| text.strip_prefix("0X")) {
        // from_str_radix accepts a sign.
        Some(digits) if digits.bytes().all(|c| c.is_ascii_hexdigit()) => u8::from_str_radix(digits, 16).ok(),
        None if text.bytes().all(|c| c.is_ascii_digit()) => text.parse().ok(),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn items_parse_and_print() {
        for text in ["0x40", "0x7F", "0x44+4", "0x24:0x10", "0x24:0x10+3", "0x43:0x00+64", "0x01:0x02+6"] {
            assert_eq!(text.parse::<RegisterRange>().unwrap().to_string(), text);
        }
        for (text, written) in [("102", "0x66"), ("36:16+0x3", "0x24:0x10+3"), ("0x24:0x10+1", "0x24:0x10")] {
            assert_eq!(text.parse::<RegisterRange>().unwrap().to_string(), written);
        }
    }

    #[test]
    fn rejects_invalid_items() {
        for text in
            ["", "+", "0x24:0x10+", "0x24:0x10+0", "0x24:0x3F+2", "0x7F+2", "0x24:0x10++1", "0x24:0x10+256", "0x66+x"]
        {
            assert_eq!(text.parse::<RegisterRange>(), Err(ItemError(text.to_owned())), "{text}");
        }
    }

    #[test]
    fn ranges_end_with_their_bank() {
        let addresses = ["0x7E", "0x7F", "0x00:0x00", "0x24:0x3E", "0x24:0x3F", "0x25:0x00", "0x25:0x02"];
        let runs = RegisterRange::from_addresses(addresses.map(|text| text.parse().unwrap()));
        let names: Vec<String> = runs.iter().map(ToString::to_string).collect();
        assert_eq!(names, ["0x7E+2", "0x00:0x00", "0x24:0x3E+2", "0x25:0x00", "0x25:0x02"]);
        let again: Vec<String> = runs.iter().flat_map(|run| run.addresses()).map(|at| at.to_string()).collect();
        assert_eq!(again, addresses);
        assert!(runs[3].contains("0x25:0x00".parse().unwrap()) && !runs[3].contains("0x25:0x01".parse().unwrap()));
    }

    proptest! {
        #[test]
        fn arbitrary_text_never_panics(text in ".*") {
            let _ = text.parse::<RegisterRange>();
        }
    }
}
