//! The saved content of an INTERBUS encoder: identity, EEPROM, names of its cams, and recorded values. Its text is in
//! [`text`](super::text).

use std::collections::BTreeMap;

use super::{Image, Item};
use crate::devices::interbus::protocol::{CamNumber, Flags, ProgramNumber, StartupMode};
use crate::profile::ron_text::Unknown;

/// Profile of an INTERBUS encoder.
#[derive(Clone, Debug, PartialEq)]
pub struct InterbusProfile {
    /// The identity.
    pub identity: ProfileIdentity,
    /// The content of its EEPROM. A program, a cam or a shift that is `None` is not in the profile.
    pub image: Image,
    /// Names of the programs and their cams; the encoder does not store them.
    pub names: Names,
    /// Values that belong to the mounting and are never written to another encoder unasked.
    pub mounting: Vec<MountingMark>,
    /// Values that change by themselves or cannot be written: recorded, neither compared nor restored.
    pub recorded: Recorded,
    /// Entries that this program does not know.
    pub unknown: UnknownEntries,
}

/// The identity of an encoder.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ProfileIdentity {
    /// Read-out 0, decimal; empty if the profile is of no particular encoder.
    pub serial_number: String,
    /// Read-out Ah: how its steps count, and whether it counts turns; `None` if it is not known.
    pub flags: Option<Flags>,
    /// Entries that this program does not know.
    pub unknown: Unknown,
}

/// Values that change by themselves or cannot be written.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Recorded {
    /// Read-out 7.
    pub software_version: Option<u32>,
    /// Read-out 8.
    pub operating_minutes: Option<u32>,
    /// Read-out Ch.
    pub temperature_tenths: Option<i32>,
    /// Read-out 9: the mode in which it was found.
    pub mode: Option<StartupMode>,
    /// Read-out 6.
    pub preset_flag: Option<u32>,
    /// Entries that this program does not know.
    pub unknown: Unknown,
}

/// Something that is right for one encoder on one machine and no other.
pub type MountingMark = crate::profile::MountingMark<Item>;

/// The user's names of programs and cams; empty without a name.
#[derive(Clone, Debug, Default, PartialEq, Eq, Hash)]
pub struct Names {
    programs: BTreeMap<ProgramNumber, String>,
    cams: BTreeMap<(ProgramNumber, CamNumber), String>,
}

/// Unknown entries, by their structure, which are preserved.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct UnknownEntries {
    pub(super) parameters: Unknown,
    pub(super) programs: BTreeMap<ProgramNumber, Unknown>,
    pub(super) cams: BTreeMap<(ProgramNumber, CamNumber), Unknown>,
}

impl InterbusProfile {
    /// Creates the profile of an encoder that was read, with the values of the mounting marked.
    pub fn of(identity: ProfileIdentity, image: Image, recorded: Recorded) -> Self {
        let mut profile = InterbusProfile {
            identity,
            image,
            names: Names::default(),
            mounting: Vec::new(),
            recorded,
            unknown: UnknownEntries::default(),
        };
        profile.mark_mounting();
        profile
    }

    /// Marks the items that belong to the mounting and are not marked yet: preset and zero shift.
    pub fn mark_mounting(&mut self) {
        for (item, meaning) in [(Item::Preset, "preset value"), (Item::ZeroShift, "zero point shifting")] {
            if !self.is_mounting(item) {
                self.mounting.push(MountingMark { item, meaning: meaning.to_owned(), unknown: Unknown::new() });
            }
        }
    }

    /// Returns whether an item belongs to the mounting.
    pub fn is_mounting(&self, item: Item) -> bool {
        self.mounting.iter().any(|mark| mark.item == item)
    }

    /// Returns the items in the profile, in the order in which they are compared.
    pub fn items(&self) -> impl Iterator<Item = Item> {
        Item::writable().filter(|item| self.image.item(*item).is_some())
    }
}

impl Names {
    /// Returns a program's name.
    pub fn program(&self, program: ProgramNumber) -> &str {
        self.programs.get(&program).map_or("", String::as_str)
    }

    /// Returns a cam's name.
    pub fn cam(&self, program: ProgramNumber, cam: CamNumber) -> &str {
        self.cams.get(&(program, cam)).map_or("", String::as_str)
    }

    /// Names a program; an empty name removes its name.
    pub fn set_program(&mut self, program: ProgramNumber, name: String) {
        if name.is_empty() {
            self.programs.remove(&program)
        } else {
            self.programs.insert(program, name)
        };
    }

    /// Names a cam; an empty name removes its name.
    pub fn set_cam(&mut self, program: ProgramNumber, cam: CamNumber, name: String) {
        let place = (program, cam);
        if name.is_empty() {
            self.cams.remove(&place)
        } else {
            self.cams.insert(place, name)
        };
    }
}
