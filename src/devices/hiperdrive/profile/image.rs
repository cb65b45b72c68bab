//! The values that a device stores for itself and its drives, and that can be read.

use std::collections::BTreeMap;

use crate::devices::hiperdrive::protocol::drive_parameter::{DENOMINATOR, LOWER, NUMERATOR, UPPER};
use crate::devices::hiperdrive::protocol::{Access, DriveNumber, ParameterNumber, ParameterRow, PositionScale};

/// Values of parameters by their own numbers. Of a device: all that are saved and can be written, of the device and of the
/// drives present. Values not read, not in the profile, or of empty places are missing.
#[derive(Clone, Debug, Default, PartialEq, Eq, Hash)]
pub struct Image {
    /// The values.
    pub values: BTreeMap<ParameterNumber, i64>,
}

impl Image {
    /// Returns whether a parameter belongs in an image: it is saved and can be written.
    pub fn holds(row: &ParameterRow) -> bool {
        row.saved && row.access == Access::ReadWrite
    }

    /// Returns the value of a parameter; `None` if it is not known.
    pub fn get(&self, number: ParameterNumber) -> Option<i64> {
        self.values.get(&number).copied()
    }

    /// Returns a drive's parameter by the number of drive 1.
    pub fn of_drive(&self, drive: DriveNumber, number: u16) -> Option<i64> {
        self.get(ParameterNumber::of_drive(number, drive)?)
    }

    /// Returns the drives with any known values.
    pub fn drives(&self) -> Vec<DriveNumber> {
        // The numbers of a drive are adjacent.
        let mut drives: Vec<DriveNumber> = self.values.keys().filter_map(|number| number.drive()).collect();
        drives.dedup();
        drives
    }

    /// Returns the scale of a drive's position (154, 156); `None` if it is not known, or not possible.
    pub fn scale(&self, drive: DriveNumber) -> Option<PositionScale> {
        let part = |number| self.of_drive(drive, number).and_then(|value| u16::try_from(value).ok());
        PositionScale::new(part(NUMERATOR)?, part(DENOMINATOR)?).ok()
    }

    /// Returns a drive's limits, lower and upper (158, 160), in steps as scaled.
    pub fn limits(&self, drive: DriveNumber) -> Option<(i64, i64)> {
        Some((self.of_drive(drive, LOWER)?, self.of_drive(drive, UPPER)?))
    }

    /// Returns the known values of these parameters.
    pub fn of(&self, numbers: impl IntoIterator<Item = ParameterNumber>) -> BTreeMap<ParameterNumber, i64> {
        numbers.into_iter().filter_map(|number| Some((number, self.get(number)?))).collect()
    }

    /// Returns this image with the values of `other` taking precedence.
    pub fn with(&self, other: &Image) -> Image {
        let mut image = self.clone();
        image.values.extend(&other.values);
        image
    }
}
