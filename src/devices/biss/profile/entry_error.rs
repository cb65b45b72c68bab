//! Why a BiSS profile is refused.

/// Why an entry of a profile is refused.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum EntryError {
    /// A bank that is already in the list.
    #[error("bank 0x{0:02X} appears twice")]
    Twice(u8),
    /// Banks that end before they begin.
    #[error("0x{first:02X} comes after 0x{last:02X}")]
    Order {
        /// The first.
        first: u8,
        /// The last.
        last: u8,
    },
    /// A bank that is none of the area's.
    #[error("0x{bank:02X} is not within 0x{first:02X} to 0x{last:02X}")]
    Outside {
        /// The bank.
        bank: u8,
        /// The area's first.
        first: u8,
        /// The area's last.
        last: u8,
    },
    /// Another number of bytes than there has to be.
    #[error("{got} bytes instead of {expected}")]
    Length {
        /// Number of bytes.
        got: usize,
        /// Required number.
        expected: usize,
    },
    /// Not a release of a firmware.
    #[error("{0:?} is not of the form 1.6.0")]
    Release(String),
    /// The marked item does not exist.
    #[error("{0:?} is neither calibration nor of the form 0x24:0x10+3")]
    Marked(String),
}
