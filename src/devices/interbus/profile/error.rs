//! Errors of planning a change.

use super::{Edge, Item};
use crate::devices::interbus::protocol::{Flags, GearError, OutOfRange};

/// A type mismatch between a profile and an encoder, determined by their flags (manual, 10.2): only one of them counts
/// turns, or only one reports its steps minus one, so that the same number denotes another gear.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("the profile is of a {} encoder, the encoder is a {} one", profile.type_name(), device.type_name())]
pub struct OtherType {
    /// Flags in the profile.
    pub profile: Flags,
    /// Flags of the encoder.
    pub device: Flags,
}

/// The reason why a change cannot be planned. Nothing has been written in this case.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum PlanError {
    /// The profile was read from another encoder.
    #[error("the profile is of serial number {profile:?}, the encoder has {device:?}")]
    OtherDevice {
        /// Serial number in the profile.
        profile: String,
        /// Serial number of the encoder.
        device: String,
    },
    /// The profile belongs to another type of encoder.
    #[error(transparent)]
    OtherType(#[from] OtherType),
    /// Steps and turns do not form a valid gear.
    #[error(transparent)]
    Gear(#[from] GearError),
    /// A parameter is out of range.
    #[error(transparent)]
    OutOfRange(#[from] OutOfRange),
    /// A mounting value, which is left unchanged in the encoder, does not fit the values to be written.
    #[error("{item}, which is left alone as a value of the mounting: {value} is not within {low} to {high}")]
    MountingLeft {
        /// The item.
        item: Item,
        /// Value in the encoder.
        value: u32,
        /// Lower limit.
        low: u32,
        /// Upper limit.
        high: u32,
    },
    /// An edge of a cam is beyond the measuring range.
    #[error("{item}, {edge}: {position} is not within 0 to {last}")]
    CamBeyondRange {
        /// Cam to change.
        item: Item,
        /// Edge of the cam.
        edge: Edge,
        /// Planned position.
        position: u32,
        /// Last position of the measuring range.
        last: u32,
    },
    /// The present value of an item to change is unknown.
    #[error("{item} was not read before it is to be changed")]
    NotRead {
        /// The item.
        item: Item,
    },
}
