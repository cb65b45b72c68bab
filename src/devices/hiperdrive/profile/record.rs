//! The saved content of an adapter or a hub with its drives: identities, and stored values.

use std::collections::BTreeMap;

use super::{Image, Item};
use crate::devices::hiperdrive::protocol::drive_parameter::REFERENCE;
use crate::devices::hiperdrive::protocol::{DriveNumber, Family, Topology, Variant};
use crate::profile::ron_text::Unknown;

/// Profile of an adapter or a hub.
#[derive(Clone, Debug, PartialEq)]
pub struct HiperdriveProfile {
    /// The identity.
    pub identity: ProfileIdentity,
    /// The stored values. A missing parameter is not in the profile.
    pub image: Image,
    /// Values that belong to the mounting and are never restored.
    pub mounting: Vec<MountingMark>,
    /// Entries that this program does not know.
    pub unknown: UnknownEntries,
}

/// Identity of an adapter or a hub; empty in a profile made by hand.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ProfileIdentity {
    /// From parameter 13.
    pub topology: Option<Topology>,
    /// Parameter 15.
    pub name: String,
    /// Parameter 16.
    pub article_number: String,
    /// Parameter 17, decimal; empty if the profile is of no particular device.
    pub serial_number: String,
    /// Parameter 19.
    pub version: String,
    /// Its drives, by place.
    pub drives: Vec<ProfileDrive>,
    /// Entries that this program does not know.
    pub unknown: Unknown,
}

/// The identity of a drive.
#[derive(Clone, Debug, PartialEq)]
pub struct ProfileDrive {
    /// Place of the drive.
    pub number: DriveNumber,
    /// Parameter 120; `None` if it is not known.
    pub variant: Option<Variant>,
    /// Parameter 121.
    pub name: String,
    /// Parameter 122.
    pub article_number: String,
    /// Parameter 123; empty if it is not known.
    pub serial_number: String,
    /// Parameter 125.
    pub version: String,
    /// Entries that this program does not know.
    pub unknown: Unknown,
}

/// Something that is right for one drive on one machine and no other.
pub type MountingMark = crate::profile::MountingMark<Item>;

/// Unknown entries among the parameters of the device (`None`) and of its drives, which are preserved.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct UnknownEntries(pub(super) BTreeMap<Option<DriveNumber>, Vec<(ron::Value, ron::Value)>>);

impl HiperdriveProfile {
    /// Creates the profile of a device that was read, with the values of the mounting marked.
    pub fn of(identity: ProfileIdentity, image: Image) -> Self {
        let mut profile =
            HiperdriveProfile { identity, image, mounting: Vec::new(), unknown: UnknownEntries::default() };
        profile.mark_mounting();
        profile
    }

    /// Marks the items that belong to the mounting and are not marked yet: the reference of each drive (198).
    pub fn mark_mounting(&mut self) {
        let references = self.image.values.keys().copied().filter(|number| number.base() == REFERENCE).map(Item);
        for item in references.collect::<Vec<_>>() {
            if !self.is_marked(item) {
                let meaning = "the position that was set".to_owned();
                self.mounting.push(MountingMark { item, meaning, unknown: Unknown::new() });
            }
        }
    }

    /// Returns whether an item belongs to the mounting: it is marked, or is a drive's reference.
    pub fn is_mounting(&self, item: Item) -> bool {
        item.0.base() == REFERENCE || self.is_marked(item)
    }

    /// Returns the items in the profile, in the order in which they are compared.
    pub fn items(&self) -> impl Iterator<Item = Item> {
        self.image.values.keys().copied().map(Item)
    }

    /// Returns the identity of the drive at a place; `None` if it is not known.
    pub fn drive(&self, number: DriveNumber) -> Option<&ProfileDrive> {
        self.identity.drives.iter().find(|drive| drive.number == number)
    }

    fn is_marked(&self, item: Item) -> bool {
        self.mounting.iter().any(|mark| mark.item == item)
    }
}

impl ProfileIdentity {
    /// Returns whether nothing is known of the device itself.
    pub fn is_of_no_device(&self) -> bool {
        *self == ProfileIdentity { drives: self.drives.clone(), ..ProfileIdentity::default() }
    }
}

impl ProfileDrive {
    /// Returns its family, if its variant is known.
    pub fn family(&self) -> Option<Family> {
        self.variant?.row().map(|row| row.family)
    }

    /// Creates the identity of a drive at a place, with nothing known.
    pub fn at(number: DriveNumber) -> Self {
        ProfileDrive {
            number,
            variant: None,
            name: String::new(),
            article_number: String::new(),
            serial_number: String::new(),
            version: String::new(),
            unknown: Unknown::new(),
        }
    }
}
