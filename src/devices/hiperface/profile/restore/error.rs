//! Why a profile cannot be restored, or an edit cannot be planned.

use crate::devices::hiperface::protocol::CodeNumber;

/// Why a profile cannot be restored.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum PlanError {
    /// The profile was read from another encoder.
    #[error("the profile is of serial number {profile:?}, the encoder has {device:?}")]
    OtherDevice {
        /// In the profile.
        profile: String,
        /// In the encoder.
        device: String,
    },
    /// The profile is of another type of encoder.
    #[error("the profile is of type {profile:02X}h, the encoder of type {device:02X}h")]
    OtherType {
        /// In the profile.
        profile: u8,
        /// In the encoder.
        device: u8,
    },
    /// Only the last field changes its size.
    #[error("field {field} has {device} bytes in the encoder and {profile} in the profile, and is not the last")]
    SizeFixed {
        /// The field.
        field: u8,
        /// Bytes in the profile.
        profile: usize,
        /// Bytes in the encoder.
        device: usize,
    },
    /// Fields are created in ascending order.
    #[error("field {field} cannot be created before field {missing}")]
    Gap {
        /// The field.
        field: u8,
        /// The field that neither side has.
        missing: u8,
    },
    /// The EEPROM is too small.
    #[error("{needed} bytes are needed and {free} are free")]
    NoMemory {
        /// Bytes that the plan needs.
        needed: usize,
        /// Bytes that are free.
        free: usize,
    },
    /// A field must be created again and its content cannot be read.
    #[error("field {field} has to be created again and its content cannot be read: access code {code} is not known")]
    WouldLose {
        /// The field.
        field: u8,
        /// Its code.
        code: CodeNumber,
    },
    /// Fields are created in ascending order.
    #[error("field {field} cannot be created: the next one is {next}")]
    NotNext {
        /// The field asked for.
        field: u8,
        /// The only one that can be created.
        next: u8,
    },
    /// Only the last field is deleted or changes its size.
    #[error("field {field} is not the last: that is {last}")]
    NotLast {
        /// The field asked for.
        field: u8,
        /// The only one that can.
        last: u8,
    },
    /// There is no such field.
    #[error("field {field} does not exist; the encoder has {count}")]
    NoSuchField {
        /// The field asked for.
        field: u8,
        /// Number of fields.
        count: u8,
    },
    /// WE is 0.
    #[error("field {field} is write protected")]
    WriteProtected {
        /// The field.
        field: u8,
    },
    /// Bytes beyond the end of the field.
    #[error("field {field} has bytes 0 to {last}; {count} bytes at {start} do not fit")]
    OutOfField {
        /// The field.
        field: u8,
        /// Its last byte.
        last: usize,
        /// First byte to write.
        start: usize,
        /// Bytes to write.
        count: usize,
    },
    /// The content of the field cannot be read.
    #[error("field {field} cannot be read: access code {code} is not known")]
    CodeUnknown {
        /// The field.
        field: u8,
        /// Its code.
        code: CodeNumber,
    },
}
