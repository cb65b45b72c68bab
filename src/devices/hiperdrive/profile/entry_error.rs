//! Reasons why a HIPERDRIVE profile is rejected.

use super::item::{Item, ItemError};
use crate::devices::hiperdrive::protocol::{DriveNumber, OutOfRange};

/// Reason why an entry of a profile is rejected.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum EntryError {
    /// The drive occurs twice.
    #[error("drive {} appears twice", .0.get())]
    DriveTwice(DriveNumber),
    /// The parameter occurs twice.
    #[error("{0} appears twice")]
    Twice(Item),
    /// The marked item is not a valid parameter.
    #[error(transparent)]
    Marked(#[from] ItemError),
    /// The marked item is not a setting.
    #[error("{0} is not saved by the device and cannot be listed under \"mounting\"")]
    NoMounting(Item),
    /// The parameter is not a setting.
    #[error("{name} is not saved by the device and cannot be part of a profile", name = .0.name())]
    NotKept(Item),
    /// The device has no parameter with this number.
    #[error("parameter {0} does not exist")]
    NoParameter(String),
    /// Drives have no parameter with this number.
    #[error(
        "drives have no parameter {number}; specify the parameters of drive {drive} with the numbers of drive 1 (100 to \
         199)",
        drive = .drive.get()
    )]
    NoParameterOfDrive {
        /// The number as written in the profile.
        number: String,
        /// Drive that the entry belongs to.
        drive: DriveNumber,
    },
    /// The value is outside the range of the parameter.
    #[error(transparent)]
    OutOfRange(#[from] OutOfRange),
}
