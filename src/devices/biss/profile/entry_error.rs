//! Errors in the entries of a BiSS profile.

/// Reason why a profile entry is rejected.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum EntryError {
    /// The bank is listed twice.
    #[error("bank 0x{0:02X} appears twice")]
    Twice(u8),
    /// The bank range ends before it begins.
    #[error("the first bank 0x{first:02X} comes after the last bank 0x{last:02X}")]
    Order {
        /// First bank of the range.
        first: u8,
        /// Last bank of the range.
        last: u8,
    },
    /// The bank does not belong to its area.
    #[error("bank 0x{bank:02X} is outside the range 0x{first:02X} to 0x{last:02X}")]
    Outside {
        /// Number of the bank.
        bank: u8,
        /// First bank of the area.
        first: u8,
        /// Last bank of the area.
        last: u8,
    },
    /// The number of bytes is wrong.
    #[error("{got} bytes instead of {expected}")]
    Length {
        /// Actual number of bytes.
        got: usize,
        /// Expected number of bytes.
        expected: usize,
    },
    /// The string is not a firmware release.
    #[error("{0:?} is not a version number such as 1.6.0")]
    Release(String),
    /// The string does not name an item that can be marked.
    #[error("{0:?} is neither \"calibration\" nor a register range such as 0x24:0x10+3")]
    Marked(String),
}
