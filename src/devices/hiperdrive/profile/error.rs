//! Errors in planning a change.

use super::Item;
use crate::buses::ethernet_ip::protocol::AddressError;
use crate::devices::hiperdrive::protocol::{DriveNumber, OutOfRange, Topology, Variant};

/// A type mismatch between profile and device: of the adapter or hub (parameter 13), or of the variant of a drive
/// (parameter 120), which determines its travel, speed and torque.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum TypeMismatch {
    /// The profile is for another type of device. Adapters, hubs with four ports and hubs with eight ports are different
    /// types.
    #[error("the profile is for a {}, but the device is a {}", profile.category(), device.category())]
    Device {
        /// Topology in the profile.
        profile: Topology,
        /// Topology of the device.
        device: Topology,
    },
    /// The drive in this port is of a different variant from the one in the profile.
    #[error(
        "drive {}: the profile is for variant {} ({}), but the drive has variant {} ({})",
        drive.get(),
        profile.number(),
        profile.row().map_or("unknown", |row| row.name),
        device.number(),
        device.row().map_or("unknown", |row| row.name)
    )]
    Drive {
        /// Number of the drive.
        drive: DriveNumber,
        /// Variant in the profile.
        profile: Variant,
        /// Variant of the drive.
        device: Variant,
    },
}

/// Reason why a change cannot be planned. Nothing has been written.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum PlanError {
    /// The profile was read from another adapter or hub.
    #[error("the profile is for serial number {profile:?}, but the device has {device:?}")]
    OtherDevice {
        /// Serial number in the profile.
        profile: String,
        /// Serial number of the device.
        device: String,
    },
    /// The profile was read with a different drive in this port.
    #[error("drive {}: the profile is for serial number {profile:?}, but the drive has {device:?}", drive.get())]
    OtherDrive {
        /// Number of the drive.
        drive: DriveNumber,
        /// Serial number in the profile.
        profile: String,
        /// Serial number of the drive.
        device: String,
    },
    /// The profile was read from another type of device or drive.
    #[error(transparent)]
    TypeMismatch(#[from] TypeMismatch),
    /// The value is outside the range of the parameter.
    #[error(transparent)]
    OutOfRange(#[from] OutOfRange),
    /// The parameter is read-only.
    #[error("parameter {item} ({}) is read-only", item.name())]
    ReadOnly {
        /// Read-only parameter.
        item: Item,
    },
    /// Parameters 101 to 104 move the drive and may be written only over the cyclic connection.
    #[error("parameter {item} ({}) moves the drive and cannot be written as a value", item.name())]
    Moves {
        /// Parameter that moves a drive.
        item: Item,
    },
    /// Parameters 47 and 197 to 199 trigger actions, which are planned as services.
    #[error("parameter {item} ({}) triggers an action and cannot be written as a value", item.name())]
    Acts {
        /// Parameter that triggers an action.
        item: Item,
    },
    /// The current value is unknown, because it was not read or the drive is missing.
    #[error("parameter {item} ({}) cannot be changed because it has not been read", item.name())]
    NotRead {
        /// Parameter whose present value is unknown.
        item: Item,
    },
    /// The upper limit would not be greater than the lower limit.
    #[error("drive {}: the lower limit {lower} is not below the upper limit {upper}", drive.get())]
    LimitsCrossed {
        /// Number of the drive.
        drive: DriveNumber,
        /// Planned lower limit.
        lower: i64,
        /// Planned upper limit.
        upper: i64,
    },
    /// The position of the drive is outside the planned limits.
    #[error("drive {}: the actual position {position} is outside the limits {lower} to {upper}", drive.get())]
    PositionOutside {
        /// Number of the drive.
        drive: DriveNumber,
        /// Position of the drive in the new scale.
        position: i64,
        /// Planned lower limit.
        lower: i64,
        /// Planned upper limit.
        upper: i64,
    },
    /// The position in the new scale does not fit in 32 bits.
    #[error("drive {}: the actual position would be {position} steps, which does not fit into 32 bits", drive.get())]
    PositionTooLarge {
        /// Number of the drive.
        drive: DriveNumber,
        /// Position in scaled steps.
        position: i64,
    },
    /// The position to set is outside the limits after rounding.
    #[error(
        "drive {}: position {position} becomes {becomes}, which is outside the limits {lower} to {upper}",
        drive.get()
    )]
    ReferenceOutside {
        /// Number of the drive.
        drive: DriveNumber,
        /// Requested position.
        position: i32,
        /// Position rounded to 64 steps, which may exceed 32 bits.
        becomes: i64,
        /// Current lower limit.
        lower: i64,
        /// Current upper limit.
        upper: i64,
    },
    /// The device would be unreachable at these addresses.
    #[error(transparent)]
    Address(#[from] AddressError),
    /// The requested address source has an unknown number and cannot be written. A device that already uses an unknown
    /// source keeps it.
    #[error("{0} is not an address source; valid sources are 0 (stored), 1 (BOOTP) and 2 (DHCP)")]
    Source(u8),
}
