//! Errors that occur while a change is planned.

use super::{Edge, Item};
use crate::devices::interbus::protocol::{Flags, GearError, OutOfRange};

/// A mismatch between the types of a profile and an encoder: only one of them counts turns, or only one reports its
/// steps minus one. Equal numbers then mean different things (manual 10.2).
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("the profile is for a {} encoder, but this encoder is {}", profile.type_name(), device.type_name())]
pub struct TypeMismatch {
    /// Flags in the profile.
    pub profile: Flags,
    /// Flags of the encoder.
    pub device: Flags,
}

/// The reason why a change cannot be planned. Nothing has been written.
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
    #[error(transparent)]
    TypeMismatch(#[from] TypeMismatch),
    /// Steps and turns do not form a valid gear.
    #[error(transparent)]
    Gear(#[from] GearError),
    /// A parameter is out of range.
    #[error(transparent)]
    OutOfRange(#[from] OutOfRange),
    /// A mounting-dependent value, which the restore leaves unchanged, is invalid with the values to be written.
    #[error("{item} belongs to the mounting and is kept: {value} is outside the range {low} to {high}")]
    MountingLeft {
        /// The mounting-dependent item.
        item: Item,
        /// Value in the encoder.
        value: u32,
        /// Lower limit.
        low: u32,
        /// Upper limit.
        high: u32,
    },
    /// An edge of a cam is beyond the measuring range.
    #[error("{item}, {edge}: {position} is outside the range 0 to {last}")]
    CamBeyondRange {
        /// Cam that would be changed.
        item: Item,
        /// Edge of the cam.
        edge: Edge,
        /// Planned position.
        position: u32,
        /// Largest position in the measuring range.
        last: u32,
    },
    /// The current value of an item is unknown, so the item cannot be changed.
    #[error("{item} cannot be changed because it has not been read")]
    NotRead {
        /// Item with the unknown value.
        item: Item,
    },
}
