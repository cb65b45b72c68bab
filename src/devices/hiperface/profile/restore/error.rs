//! Reasons why a profile cannot be restored or an edit cannot be planned.

use crate::devices::hiperface::protocol::AccessCodeNumber;

/// Reason why a profile cannot be restored or an edit cannot be planned.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum PlanError {
    /// The profile was read from another encoder.
    #[error("the profile is for serial number {profile:?}, but the encoder has {device:?}")]
    OtherDevice {
        /// Serial number in the profile.
        profile: String,
        /// Serial number of the encoder.
        device: String,
    },
    /// The profile belongs to another type of encoder.
    #[error("the profile is for type {profile:02X}h, but the encoder has type {device:02X}h")]
    TypeMismatch {
        /// Type code in the profile.
        profile: u8,
        /// Type code of the encoder.
        device: u8,
    },
    /// Only the last field can change size.
    #[error(
        "field {field} has {device} bytes in the encoder but {profile} in the profile, and it is not the last field"
    )]
    SizeFixed {
        /// Field number.
        field: u8,
        /// Size in the profile, in bytes.
        profile: usize,
        /// Size in the encoder, in bytes.
        device: usize,
    },
    /// Fields can only be created in ascending order, and a field in between is missing.
    #[error("field {field} cannot be created before field {missing}")]
    Gap {
        /// Field number.
        field: u8,
        /// Number of the field that is missing in both the profile and the encoder.
        missing: u8,
    },
    /// The EEPROM is too small.
    #[error("{needed} bytes are required, but only {free} are free")]
    NoMemory {
        /// Required number of bytes.
        needed: usize,
        /// Number of free bytes.
        free: usize,
    },
    /// A field must be deleted and created again, but its content cannot be read.
    #[error("field {field} must be created again, but its content cannot be read: access code {code} is not known")]
    WouldLose {
        /// Field number.
        field: u8,
        /// Number of the access code that protects the field.
        code: AccessCodeNumber,
    },
    /// Fields can only be created in ascending order, and the requested field is not the next one.
    #[error("field {field} cannot be created: the next field is {next}")]
    NotNext {
        /// Requested field number.
        field: u8,
        /// Number of the only field that can be created next.
        next: u8,
    },
    /// Only the last field can be deleted or change its size.
    #[error("field {field} is not the last field, which is {last}")]
    NotLast {
        /// Requested field number.
        field: u8,
        /// Number of the last field.
        last: u8,
    },
    /// The field does not exist.
    #[error("field {field} does not exist; the encoder has {count}")]
    NoSuchField {
        /// Requested field number.
        field: u8,
        /// Number of fields.
        count: u8,
    },
    /// The field is write-protected (WE is 0).
    #[error("field {field} is write-protected")]
    WriteProtected {
        /// Field number.
        field: u8,
    },
    /// The bytes extend beyond the end of the field.
    #[error("field {field} has bytes 0 to {last}; {count} bytes at {start} do not fit")]
    OutOfField {
        /// Field number.
        field: u8,
        /// Index of the last byte in the field.
        last: usize,
        /// Index of the first byte to write.
        start: usize,
        /// Number of bytes to write.
        count: usize,
    },
    /// The content of the field cannot be read because its access code is unknown.
    #[error("field {field} cannot be read: access code {code} is not known")]
    CodeUnknown {
        /// Field number.
        field: u8,
        /// Number of the access code that protects the field.
        code: AccessCodeNumber,
    },
}
