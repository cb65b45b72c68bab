//! Values that a device stores for itself and its drives, as far as they can be read.

use std::collections::BTreeMap;

use crate::devices::hiperdrive::protocol::drive_parameter::{DENOMINATOR, LOWER_LIMIT, NUMERATOR, UPPER_LIMIT};
use crate::devices::hiperdrive::protocol::{
    DriveNumber, ParameterAccess, ParameterNumber, ParameterRow, PositionScale,
};

/// Parameter values by parameter number, such as all values that an adapter or a hub stores for itself and its drives.
/// Values are missing if they were not read, are not in the profile, or belong to an empty port.
#[derive(Clone, Debug, Default, PartialEq, Eq, Hash)]
pub struct Image {
    /// Values by parameter number.
    pub values: BTreeMap<ParameterNumber, i64>,
}

impl Image {
    /// Returns whether the parameter is stored by the device, that is, both saved and writable.
    pub fn contains_row(row: &ParameterRow) -> bool {
        row.saved && row.access == ParameterAccess::ReadWrite
    }

    /// Returns the value of a parameter, if known.
    pub fn get(&self, number: ParameterNumber) -> Option<i64> {
        self.values.get(&number).copied()
    }

    /// Returns the value of a drive parameter by its number for drive 1.
    pub fn for_drive(&self, drive: DriveNumber, number: u16) -> Option<i64> {
        self.get(ParameterNumber::for_drive(number, drive)?)
    }

    /// Returns the drives that have at least one known value.
    pub fn drives(&self) -> Vec<DriveNumber> {
        // The numbers of a drive are adjacent.
        let mut drives: Vec<DriveNumber> = self.values.keys().filter_map(|number| number.drive()).collect();
        drives.dedup();
        drives
    }

    /// Returns the position scale of a drive (parameters 154 and 156), or `None` if the scale is unknown or invalid.
    pub fn scale(&self, drive: DriveNumber) -> Option<PositionScale> {
        let part = |number| self.for_drive(drive, number).and_then(|value| u16::try_from(value).ok());
        PositionScale::new(part(NUMERATOR)?, part(DENOMINATOR)?).ok()
    }

    /// Returns the lower and upper limits of a drive (parameters 158 and 160), in scaled steps.
    pub fn limits(&self, drive: DriveNumber) -> Option<(i64, i64)> {
        Some((self.for_drive(drive, LOWER_LIMIT)?, self.for_drive(drive, UPPER_LIMIT)?))
    }

    /// Returns the known values of the given parameters.
    pub fn values_of(&self, numbers: impl IntoIterator<Item = ParameterNumber>) -> BTreeMap<ParameterNumber, i64> {
        numbers.into_iter().filter_map(|number| Some((number, self.get(number)?))).collect()
    }

    /// Returns a copy with the values of `other` added or replaced.
    pub fn with_overlay(&self, other: &Image) -> Image {
        let mut image = self.clone();
        image.values.extend(&other.values);
        image
    }
}
