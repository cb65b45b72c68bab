//! Reasons why a HIPERFACE profile is refused.

/// Reason why a profile entry is rejected.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum EntryError {
    /// The data field occurs twice.
    #[error("field {0} appears twice")]
    Twice(u8),
    /// The status byte denotes a missing field.
    #[error("{0:02X}h is not the status of an existing field")]
    Status(u8),
    /// A field that could not be read has content.
    #[error("the bytes of a locked field must not be specified")]
    Locked,
    /// A readable field has no content.
    #[error("the bytes are missing; a field without bytes must have locked: true")]
    NotLocked,
    /// The number of bytes differs from the size of the field.
    #[error("the field has {got} bytes, but its status specifies {expected}")]
    Size {
        /// Number of bytes in the profile.
        got: usize,
        /// Size of the field in bytes.
        expected: usize,
    },
    /// The item marked as a mounting value is not part of a data field.
    #[error("{0:?} is not of the form field:N@ADDR+COUNT")]
    Marked(String),
}
