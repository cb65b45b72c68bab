//! Errors of planning.

use super::Item;
use crate::buses::ethernet_ip::protocol::AddressError;
use crate::devices::hiperdrive::protocol::{DriveNumber, OutOfRange, Topology, Variant};

/// Difference of type between profile and device: of the whole (parameter 13), or of the drive at a place (parameter 120),
/// whose variant determines travel, speed and torque.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum OtherType {
    /// An adapter, and hubs with four and with eight places, are three types.
    #[error("the profile is of a {}, the device is a {}", profile.category(), device.category())]
    Device {
        /// In the profile.
        profile: Topology,
        /// Topology of the device.
        device: Topology,
    },
    /// At a place there is a drive of another variant than the profile's.
    #[error(
        "drive {}: the profile is of variant {} ({}), the drive is of variant {} ({})",
        drive.get(),
        profile.number(),
        profile.row().map_or("in no table", |row| row.name),
        device.number(),
        device.row().map_or("in no table", |row| row.name)
    )]
    Drive {
        /// The drive.
        drive: DriveNumber,
        /// In the profile.
        profile: Variant,
        /// Variant of the drive.
        device: Variant,
    },
}

/// Why a change cannot be planned. Nothing has been written.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum PlanError {
    /// The profile was read from another adapter or hub.
    #[error("the profile is of serial number {profile:?}, the device has {device:?}")]
    OtherDevice {
        /// In the profile.
        profile: String,
        /// In the device.
        device: String,
    },
    /// The drive at a place is not the one that the profile was read from.
    #[error("drive {}: the profile is of serial number {profile:?}, the drive has {device:?}", drive.get())]
    OtherDrive {
        /// The drive.
        drive: DriveNumber,
        /// In the profile.
        profile: String,
        /// In the drive.
        device: String,
    },
    /// The profile was read from another type of device or drive.
    #[error(transparent)]
    OtherType(#[from] OtherType),
    /// A number out of the parameter's range.
    #[error(transparent)]
    OutOfRange(#[from] OutOfRange),
    /// A read-only parameter.
    #[error("parameter {item} ({}) can only be read", item.name())]
    ReadOnly {
        /// The item.
        item: Item,
    },
    /// 101 to 104: these move drives, which is allowed over the cyclic connection only.
    #[error("parameter {item} ({}) moves the drive and is never written as a parameter", item.name())]
    Moves {
        /// The item.
        item: Item,
    },
    /// 47, 197 to 199: these trigger actions, and are services of their own.
    #[error("parameter {item} ({}) does something and keeps nothing", item.name())]
    Acts {
        /// The item.
        item: Item,
    },
    /// The present value is not known: it was not read, or its drive is missing.
    #[error("parameter {item} ({}) was not read before it is to be changed", item.name())]
    NotRead {
        /// The item.
        item: Item,
    },
    /// The upper limit would not be above the lower one.
    #[error("drive {}: the lower limit {lower} is not below the upper limit {upper}", drive.get())]
    LimitsCrossed {
        /// The drive of the limits.
        drive: DriveNumber,
        /// As planned.
        lower: i64,
        /// As planned.
        upper: i64,
    },
    /// The drive's position is outside the planned limits.
    #[error("drive {}: the actual position {position} is outside the limits {lower} to {upper}", drive.get())]
    PositionOutside {
        /// The drive.
        drive: DriveNumber,
        /// The drive's position in the new scale.
        position: i64,
        /// As planned.
        lower: i64,
        /// As planned.
        upper: i64,
    },
    /// The actual position would have no room in 32 bits.
    #[error("drive {}: the actual position would be {position} steps, beyond −2147483648 to 2147483647", drive.get())]
    PositionTooLarge {
        /// The drive.
        drive: DriveNumber,
        /// In scaled steps.
        position: i64,
    },
    /// The position to be set is outside the limits after rounding.
    #[error(
        "drive {}: position {position} becomes {becomes}, which is not within the limits {lower} to {upper}",
        drive.get()
    )]
    ReferenceOutside {
        /// The drive.
        drive: DriveNumber,
        /// As requested.
        position: i32,
        /// Rounded to 64 steps; may not fit into 32 bits.
        becomes: i64,
        /// Present value.
        lower: i64,
        /// Present value.
        upper: i64,
    },
    /// Addresses at which a device cannot be reached.
    #[error(transparent)]
    Address(#[from] AddressError),
    /// An unknown source of addresses is kept if found, and never set.
    #[error("{0} is no source of addresses: they are 0 stored, 1 BOOTP and 2 DHCP")]
    Source(u8),
}
