//! Errors of planning.

use super::{Edge, Item};
use crate::devices::interbus::protocol::{Flags, GearError, OutOfRange};

/// Difference of type between a profile and an encoder by their flags (manual, 10.2): only one counts turns, or only one
/// reports its steps minus one, so that the same number is another gear.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("the profile is of a {} encoder, the encoder is a {} one", profile.type_name(), device.type_name())]
pub struct OtherType {
    /// In the profile.
    pub profile: Flags,
    /// In the encoder.
    pub device: Flags,
}

/// Why a change cannot be planned. Nothing has been written.
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
    #[error(transparent)]
    OtherType(#[from] OtherType),
    /// Steps and turns are no gear.
    #[error(transparent)]
    Gear(#[from] GearError),
    /// A parameter is out of range.
    #[error(transparent)]
    OutOfRange(#[from] OutOfRange),
    /// A value of the mounting, which is left as it is in the encoder, does not fit the other values to be written.
    #[error("{item}, which is left alone as a value of the mounting: {value} is not within {low} to {high}")]
    MountingLeft {
        /// The item.
        item: Item,
        /// The value of the encoder.
        value: u32,
        /// The least.
        low: u32,
        /// The greatest.
        high: u32,
    },
    /// An edge of a cam is beyond the measuring range.
    #[error("{item}, {edge}: {position} is not within 0 to {last}")]
    CamBeyondRange {
        /// The cam.
        item: Item,
        /// The edge.
        edge: Edge,
        /// As planned.
        position: u32,
        /// The last position of the measuring range.
        last: u32,
    },
    /// The present value of an item to be changed is not known.
    #[error("{item} was not read before it is to be changed")]
    NotRead {
        /// The item.
        item: Item,
    },
}
