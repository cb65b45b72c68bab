//! Procedures in which values are first entered and then saved: data, filter and preset. This module holds the entered
//! values, and the [`Encoder`](super::Encoder) saves them. A command out of sequence is rejected. This behaviour is not
//! documented (`U`). See manual 6.5 to 6.7.

use crate::devices::biss::protocol::{
    DataCommand, DataStatus, FilterCommand, FilterStatus, Layout, PositionFilter, PresetCommand, PresetStatus,
    PresetValue,
};

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Area {
    Motor,
    Oem,
}

impl Area {
    /// Returns the area that contains a bank, and the offset of the bank in the area. Returns `None` if the bank does
    /// not belong to an area.
    pub(super) fn find_bank_area(bank: u8) -> Option<(Area, usize)> {
        let begin = |first: u8| usize::from(bank - first) * 64;
        match bank {
            0x04..=0x23 => Some((Area::Motor, begin(0x04))),
            0x24..=0x43 => Some((Area::Oem, begin(0x24))),
            _ => None,
        }
    }
}

#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) enum EntryEffect {
    Refused,
    Nothing,
    /// A data area is being opened. Its content must be passed to [`DataEntry::open`].
    Open(Area),
    SaveData(Area, Vec<u8>),
    /// The filter is written to the flash, and the encoder restarts.
    SaveFilter(PositionFilter),
    /// The preset value is written to the flash, and the encoder restarts.
    SavePreset(PresetValue),
    /// The singleturn part, the multiturn part or both are set to the preset value, and the encoder restarts.
    Preset {
        singleturn: bool,
        multiturn: bool,
    },
}

#[derive(Clone, Debug, Default)]
pub(super) struct DataEntry {
    pub(super) command: u8,
    open: Option<(Area, Vec<u8>)>,
}

impl DataEntry {
    pub(super) fn status(&self) -> DataStatus {
        if self.open.is_some() { DataStatus::Open } else { DataStatus::Closed }
    }

    pub(super) fn command(&mut self, value: u8) -> EntryEffect {
        let then = match (DataCommand::from_byte(value), self.open.take()) {
            (DataCommand::OpenMotorData, None) => EntryEffect::Open(Area::Motor),
            (DataCommand::OpenOemData, None) => EntryEffect::Open(Area::Oem),
            (DataCommand::Save, Some((area, bytes))) => EntryEffect::SaveData(area, bytes),
            (DataCommand::Cancel, _) => EntryEffect::Nothing,
            (_, open) => {
                self.open = open;
                EntryEffect::Refused
            }
        };
        if then != EntryEffect::Refused {
            self.command = value;
        }
        then
    }

    pub(super) fn open(&mut self, area: Area, bytes: Vec<u8>) {
        self.open = Some((area, bytes));
    }

    /// Returns an entered byte, or `None` if the given area is not open.
    pub(super) fn byte(&self, area: Area, at: usize) -> Option<u8> {
        let (_, bytes) = self.open.as_ref().filter(|(open, _)| *open == area)?;
        bytes.get(at).copied()
    }

    /// Enters a byte. Returns `false` if the area is not open.
    pub(super) fn enter(&mut self, area: Area, at: usize, value: u8) -> bool {
        let place = self.open.as_mut().filter(|(open, _)| *open == area).and_then(|(_, bytes)| bytes.get_mut(at));
        place.map(|byte| *byte = value).is_some()
    }
}

#[derive(Clone, Debug)]
pub(super) struct FilterEntry {
    pub(super) command: u8,
    pub(super) status: FilterStatus,
    chosen: PositionFilter,
}

impl Default for FilterEntry {
    fn default() -> Self {
        FilterEntry { command: 0, status: FilterStatus::Closed, chosen: PositionFilter::Balanced }
    }
}

impl FilterEntry {
    pub(super) fn command(&mut self, value: u8) -> EntryEffect {
        let (status, then) = match (FilterCommand::from_byte(value), self.status) {
            (FilterCommand::Open, FilterStatus::Closed) => (FilterStatus::WaitForValue, EntryEffect::Nothing),
            (
                FilterCommand::Balanced | FilterCommand::Dynamic,
                FilterStatus::WaitForValue | FilterStatus::WaitForSave,
            ) => {
                self.chosen = PositionFilter::from_byte(value);
                (FilterStatus::WaitForSave, EntryEffect::Nothing)
            }
            (FilterCommand::Save, FilterStatus::WaitForSave) => {
                (FilterStatus::Closed, EntryEffect::SaveFilter(self.chosen))
            }
            _ => return EntryEffect::Refused,
        };
        (self.command, self.status) = (value, status);
        then
    }
}

#[derive(Clone, Debug)]
pub(super) struct PresetEntry {
    pub(super) command: u8,
    pub(super) status: PresetStatus,
    bytes: [u8; 6],
}

impl PresetEntry {
    pub(super) fn new(stored: PresetValue) -> Self {
        PresetEntry { command: 0, status: PresetStatus::Idle, bytes: stored.emit() }
    }

    /// Handles a command. `parts` is whether the encoder can preset singleturn and multiturn separately.
    pub(super) fn command(&mut self, value: u8, parts: bool, layout: &Layout) -> EntryEffect {
        let then = match (PresetCommand::from_byte(value), self.status) {
            (PresetCommand::Edit, _) => {
                self.status = PresetStatus::WaitForValue;
                EntryEffect::Nothing
            }
            (PresetCommand::Save, PresetStatus::WaitForValue) => {
                let preset = PresetValue::parse(self.bytes);
                let fits = u64::from(preset.singleturn()) >> layout.singleturn_bits() == 0
                    && u64::from(preset.multiturn()) >> layout.multiturn_bits() == 0;
                if fits { EntryEffect::SavePreset(preset) } else { EntryEffect::Refused }
            }
            (PresetCommand::Both, _) => EntryEffect::Preset { singleturn: true, multiturn: true },
            (PresetCommand::Singleturn, _) if parts => EntryEffect::Preset { singleturn: true, multiturn: false },
            (PresetCommand::Multiturn, _) if parts => EntryEffect::Preset { singleturn: false, multiturn: true },
            _ => EntryEffect::Refused,
        };
        if then != EntryEffect::Refused {
            self.command = value;
        }
        then
    }

    pub(super) fn byte(&self, at: usize) -> Option<u8> {
        self.bytes.get(at).copied()
    }

    /// Enters a byte. Returns `false` if no byte is expected.
    pub(super) fn enter(&mut self, at: usize, value: u8) -> bool {
        let open = self.status == PresetStatus::WaitForValue;
        self.bytes.get_mut(at).filter(|_| open).map(|byte| *byte = value).is_some()
    }
}
