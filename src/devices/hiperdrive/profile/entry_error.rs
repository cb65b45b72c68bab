//! Why a HIPERDRIVE profile is refused.

use super::item::{Item, ItemError};
use crate::devices::hiperdrive::protocol::{DriveNumber, OutOfRange};

/// Why an entry of a profile is refused.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum EntryError {
    /// A drive that is already in the list.
    #[error("drive {} appears twice", .0.get())]
    DriveTwice(DriveNumber),
    /// A parameter that already has a value.
    #[error("{0} appears twice")]
    Twice(Item),
    /// The marked item is not a parameter.
    #[error(transparent)]
    Marked(#[from] ItemError),
    /// The marked item is not a setting.
    #[error("{0} is not saved and does not belong to the mounting")]
    NoMounting(Item),
    /// A parameter that is no setting.
    #[error("{name} is not saved by the device and is not part of a profile", name = .0.name())]
    NotKept(Item),
    /// The device has no such parameter.
    #[error("parameter {0} does not exist")]
    NoParameter(String),
    /// Drives have no such parameter.
    #[error(
        "drives have no parameter {number}; give those of drive {drive} with the numbers of drive 1, 100 to 199",
        drive = .drive.get()
    )]
    NoParameterOfDrive {
        /// As written in the profile.
        number: String,
        /// The drive that the entry belongs to.
        drive: DriveNumber,
    },
    /// A number that the parameter cannot be.
    #[error(transparent)]
    OutOfRange(#[from] OutOfRange),
}
