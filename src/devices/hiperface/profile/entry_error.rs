//! Why a HIPERFACE profile is refused.

/// Why an entry of a profile is refused.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum EntryError {
    /// A data field that is already in the list.
    #[error("field {0} appears twice")]
    Twice(u8),
    /// A status byte without a field.
    #[error("{0:02X}h is not the status of an existing field")]
    Status(u8),
    /// Bytes of a field that could not be read.
    #[error("a locked field has no bytes")]
    Locked,
    /// Not the bytes of a readable field.
    #[error("missing; a field without bytes has locked: true")]
    NotLocked,
    /// Another number of bytes than the field has.
    #[error("{got} bytes, but the status gives {expected}")]
    Size {
        /// Number of bytes in the profile.
        got: usize,
        /// Number of bytes of the field.
        expected: usize,
    },
    /// The marked item is not part of a field.
    #[error("{0:?} is not of the form field:N@ADDR+COUNT")]
    Marked(String),
}
