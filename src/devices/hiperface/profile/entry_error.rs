//! Reasons why a HIPERFACE profile is rejected.

/// Reason why a profile entry is rejected.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum EntryError {
    /// The data field occurs twice.
    #[error("field {0} appears twice")]
    Twice(u8),
    /// The status byte does not describe an existing field.
    #[error("{0:02X}h is not the status of an existing field")]
    Status(u8),
    /// A field marked as locked has content.
    #[error("the bytes of a locked field must not be specified")]
    Locked,
    /// A field that is not marked as locked has no content.
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
    /// A mounting mark refers to an item that is not part of a data field.
    #[error("{0:?} is not of the form field:N@ADDR+COUNT")]
    Marked(String),
}
