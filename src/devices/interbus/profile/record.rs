//! The saved data of an INTERBUS encoder: identity, EEPROM content, cam names and recorded values. The
//! [`text`](super::text) module defines the file format.

use std::collections::BTreeMap;

use super::{Image, Item};
use crate::devices::interbus::protocol::{CamNumber, Flags, ProgramNumber, StartupMode};
use crate::profile::ron_text::UnknownValues;

/// A profile of an INTERBUS encoder.
#[derive(Clone, Debug, PartialEq)]
pub struct InterbusProfile {
    /// Identity of the encoder.
    pub identity: ProfileIdentity,
    /// EEPROM content. Programs, cams and the window shift are `None` if they are missing from the profile.
    pub image: Image,
    /// Names of programs and cams, which the encoder does not store.
    pub names: CamNames,
    /// Values that depend on the mounting. They are never copied to another encoder without asking.
    pub mounting: Vec<MountingMark>,
    /// Values that change by themselves or cannot be written. They are neither compared nor restored.
    pub recorded: RecordedValues,
    /// Entries that this version does not recognise. They are preserved when the profile is saved.
    pub unknown: UnknownEntries,
}

/// Identity of an encoder.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ProfileIdentity {
    /// Serial number in decimal (read-out 0). It is empty if the profile is not for a particular encoder.
    pub serial_number: String,
    /// Flags (read-out Ah), or `None` if unknown. They state how steps are counted and whether turns are counted.
    pub flags: Option<Flags>,
    /// Entries that this version does not recognise. They are preserved when the profile is saved.
    pub unknown: UnknownValues,
}

/// Values that change by themselves or cannot be written.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct RecordedValues {
    /// Software version, read-out 7.
    pub software_version: Option<u32>,
    /// Operating time in minutes, read-out 8.
    pub operating_minutes: Option<u32>,
    /// Temperature in tenths of a degree Celsius, read-out Ch.
    pub temperature_tenths: Option<i32>,
    /// Mode in which the encoder was found (read-out 9).
    pub mode: Option<StartupMode>,
    /// Preset flag, read-out 6.
    pub preset_flag: Option<u32>,
    /// Entries that this version does not recognise. They are preserved when the profile is saved.
    pub unknown: UnknownValues,
}

/// A mark for a value that is valid only for one encoder in a particular machine.
pub type MountingMark = crate::profile::MountingMark<Item>;

/// User-defined names of programs and cams. An unnamed one has an empty name.
#[derive(Clone, Debug, Default, PartialEq, Eq, Hash)]
pub struct CamNames {
    programs: BTreeMap<ProgramNumber, String>,
    cams: BTreeMap<(ProgramNumber, CamNumber), String>,
}

/// Entries that this version does not recognise, grouped by the structure that contains them.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct UnknownEntries {
    pub(super) parameters: UnknownValues,
    pub(super) programs: BTreeMap<ProgramNumber, UnknownValues>,
    pub(super) cams: BTreeMap<(ProgramNumber, CamNumber), UnknownValues>,
}

impl InterbusProfile {
    /// Creates a profile from the values of an encoder and marks the mounting values.
    pub fn new(identity: ProfileIdentity, image: Image, recorded: RecordedValues) -> Self {
        let mut profile = InterbusProfile {
            identity,
            image,
            names: CamNames::default(),
            mounting: Vec::new(),
            recorded,
            unknown: UnknownEntries::default(),
        };
        profile.mark_mounting_dependent_values();
        profile
    }

    /// Marks the preset and the zero shift as mounting-dependent.
    pub fn mark_mounting_dependent_values(&mut self) {
        for (item, meaning) in [(Item::Preset, "preset value"), (Item::ZeroShift, "zero point shifting")] {
            if !self.depends_on_mounting(item) {
                self.mounting.push(MountingMark { item, meaning: meaning.to_owned(), unknown: UnknownValues::new() });
            }
        }
    }

    /// Returns whether an item is marked as mounting-dependent.
    pub fn depends_on_mounting(&self, item: Item) -> bool {
        self.mounting.iter().any(|mark| mark.item == item)
    }

    /// Returns the settings that the profile contains, in comparison order.
    pub fn items(&self) -> impl Iterator<Item = Item> {
        Item::writable_items().filter(|item| self.image.get_value(*item).is_some())
    }
}

impl CamNames {
    /// Returns the name of a program.
    pub fn program(&self, program: ProgramNumber) -> &str {
        self.programs.get(&program).map_or("", String::as_str)
    }

    /// Returns the name of a cam.
    pub fn cam(&self, program: ProgramNumber, cam: CamNumber) -> &str {
        self.cams.get(&(program, cam)).map_or("", String::as_str)
    }

    /// Sets the name of a program. An empty string removes the name.
    pub fn set_program(&mut self, program: ProgramNumber, name: String) {
        if name.is_empty() {
            self.programs.remove(&program)
        } else {
            self.programs.insert(program, name)
        };
    }

    /// Sets the name of a cam. An empty string removes the name.
    pub fn set_cam(&mut self, program: ProgramNumber, cam: CamNumber, name: String) {
        let place = (program, cam);
        if name.is_empty() {
            self.cams.remove(&place)
        } else {
            self.cams.insert(place, name)
        };
    }
}
