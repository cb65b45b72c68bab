//! Profile of an adapter or a hub with its drives: identities and stored values.

use std::collections::BTreeMap;

use super::{Image, Item};
use crate::devices::hiperdrive::protocol::drive_parameter::REFERENCE;
use crate::devices::hiperdrive::protocol::{DriveNumber, Family, Topology, Variant};
use crate::profile::ron_text::UnknownValues;

/// Profile of an adapter or a hub.
#[derive(Clone, Debug, PartialEq)]
pub struct HiperdriveProfile {
    /// Identity of the device.
    pub identity: ProfileIdentity,
    /// Stored parameter values. Parameters that are not in the profile have no value.
    pub image: Image,
    /// Marks of the values that depend on how a drive is mounted.
    pub mounting: Vec<MountingMark>,
    /// Unknown entries, preserved when the profile is saved.
    pub unknown: UnknownEntries,
}

/// Identity of an adapter or a hub. It may be empty in a profile written by hand.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ProfileIdentity {
    /// Topology, from parameter 13.
    pub topology: Option<Topology>,
    /// Name, parameter 15.
    pub name: String,
    /// Article number, parameter 16.
    pub article_number: String,
    /// Serial number (parameter 17) in decimal, or empty if the profile is for any device.
    pub serial_number: String,
    /// Version, parameter 19.
    pub version: String,
    /// Drives by port.
    pub drives: Vec<ProfileDrive>,
    /// Unknown entries, preserved when the profile is saved.
    pub unknown: UnknownValues,
}

/// Identity of a drive.
#[derive(Clone, Debug, PartialEq)]
pub struct ProfileDrive {
    /// Number of the drive, which equals its port number.
    pub number: DriveNumber,
    /// Variant of the drive (parameter 120), if known.
    pub variant: Option<Variant>,
    /// Name, parameter 121.
    pub name: String,
    /// Article number, parameter 122.
    pub article_number: String,
    /// Serial number of the drive (parameter 123), or empty if unknown.
    pub serial_number: String,
    /// Version, parameter 125.
    pub version: String,
    /// Unknown entries, preserved when the profile is saved.
    pub unknown: UnknownValues,
}

/// Marks a value as valid only for one drive on one machine.
pub type MountingMark = crate::profile::MountingMark<Item>;

/// Unknown entries among the parameters of the device (key `None`) or of a drive.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct UnknownEntries(pub(super) BTreeMap<Option<DriveNumber>, Vec<(ron::Value, ron::Value)>>);

impl HiperdriveProfile {
    /// Creates a profile from values that were read, and marks those that depend on how a drive is mounted.
    pub fn from_image(identity: ProfileIdentity, image: Image) -> Self {
        let mut profile =
            HiperdriveProfile { identity, image, mounting: Vec::new(), unknown: UnknownEntries::default() };
        profile.mark_mounting_dependent_values();
        profile
    }

    /// Marks the reference (parameter 198) of each drive as dependent on how the drive is mounted. Existing marks are
    /// kept.
    pub fn mark_mounting_dependent_values(&mut self) {
        let references =
            self.image.values.keys().copied().filter(|number| number.drive1_number() == REFERENCE).map(Item);
        for item in references.collect::<Vec<_>>() {
            if !self.is_marked(item) {
                let meaning = "the position that was set".to_owned();
                self.mounting.push(MountingMark { item, meaning, unknown: UnknownValues::new() });
            }
        }
    }

    /// Returns whether an item depends on how the drive is mounted, which is true of marked items and the reference of
    /// each drive.
    pub fn depends_on_mounting(&self, item: Item) -> bool {
        item.0.drive1_number() == REFERENCE || self.is_marked(item)
    }

    /// Returns the items of the profile in comparison order.
    pub fn items(&self) -> impl Iterator<Item = Item> {
        self.image.values.keys().copied().map(Item)
    }

    /// Returns the identity of a drive, if known.
    pub fn drive(&self, number: DriveNumber) -> Option<&ProfileDrive> {
        self.identity.drives.iter().find(|drive| drive.number == number)
    }

    fn is_marked(&self, item: Item) -> bool {
        self.mounting.iter().any(|mark| mark.item == item)
    }
}

impl ProfileIdentity {
    /// Returns whether the profile contains no information about the adapter or hub itself.
    pub fn is_device_unknown(&self) -> bool {
        *self == ProfileIdentity { drives: self.drives.clone(), ..ProfileIdentity::default() }
    }
}

impl ProfileDrive {
    /// Returns the family of the drive, if its variant is known.
    pub fn family(&self) -> Option<Family> {
        self.variant?.row().map(|row| row.family)
    }

    /// Creates the identity of an unknown drive in a port.
    pub fn unknown_drive(number: DriveNumber) -> Self {
        ProfileDrive {
            number,
            variant: None,
            name: String::new(),
            article_number: String::new(),
            serial_number: String::new(),
            version: String::new(),
            unknown: UnknownValues::new(),
        }
    }
}
