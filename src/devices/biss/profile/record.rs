//! The saved content of a BiSS encoder: identity, settings, areas of plain data, and recorded values. Its text is in
//! [`text`](super::text).

use std::fmt;

use super::RegisterRange;
use crate::devices::biss::protocol::{
    Area, DeviceMode, Filter, Firmware, Identity, PresetValue, ProfileId, RegisterAddress, WiegandResult,
};
use crate::profile::ron_text::Unknown;

/// Profile of a BiSS encoder.
#[derive(Clone, Debug, PartialEq)]
pub struct BissProfile {
    /// The identity.
    pub identity: ProfileIdentity,
    /// The filter of the position; `None` if the encoder has no choice.
    pub filter: Option<Filter>,
    /// Preset value; `None` if the encoder has none. It belongs to the mounting.
    pub preset: Option<PresetSetting>,
    /// Values that change by themselves or cannot be written: recorded, neither compared nor restored.
    pub recorded: Recorded,
    /// Values that belong to the mounting and are never written to another encoder unasked.
    pub mounting: Vec<MountingMark>,
    /// Areas of plain data, by ascending bank.
    pub data: Vec<DataImage>,
}

/// The identity of an encoder.
#[derive(Clone, Debug, PartialEq)]
pub struct ProfileIdentity {
    /// Serial number from the encoder's identification; empty if it has none.
    pub serial_number: String,
    /// 42h and 43h.
    pub profile_id: ProfileId,
    /// 78h…7Dh.
    pub device_id: [u8; 6],
    /// 7Eh and 7Fh.
    pub manufacturer: [u8; 2],
    /// 74h…76h; `None` if the encoder has no such registers.
    pub firmware: Option<Firmware>,
    /// Name of the description with which it was read.
    pub description: String,
    /// Turn bits of the position; `None` if not known.
    pub multiturn_bits: Option<u8>,
    /// Bits within the revolution.
    pub singleturn_bits: Option<u8>,
    /// Entries that this program does not know.
    pub unknown: Unknown,
}

/// The stored preset value.
#[derive(Clone, Debug, PartialEq)]
pub struct PresetSetting {
    /// The value.
    pub value: PresetValue,
    /// Entries that this program does not know.
    pub unknown: Unknown,
}

/// Values that change by themselves or cannot be written.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Recorded {
    /// Banks of the electronic data sheet, as they were read.
    pub eds: Vec<ListedBank>,
    /// The last Wiegand test since power-up.
    pub wiegand_last: Option<WiegandResult>,
    /// The factory's Wiegand test.
    pub wiegand_production: Option<WiegandResult>,
    /// The Wiegand test that was saved in the encoder.
    pub wiegand_saved: Option<WiegandResult>,
    /// Status register of the calibration (bank 0, 01h).
    pub calibration_status: Option<u8>,
    /// The device mode in which it was read, if not operation: it may contain values that were never saved.
    pub device_mode: Option<DeviceMode>,
    /// Entries that this program does not know.
    pub unknown: Unknown,
}

/// Something that is right for one encoder on one motor and no other.
pub type MountingMark = crate::profile::MountingMark<MountingItem>;

/// An item that belongs to a mounting.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MountingItem {
    /// Registers.
    Registers(RegisterRange),
    /// The table of the calibration, which is in the encoder and cannot be read.
    Calibration,
}

impl MountingItem {
    /// The name of the calibration, which has no registers.
    pub(super) const CALIBRATION: &str = "calibration";
}

impl fmt::Display for MountingItem {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            MountingItem::Registers(range) => range.fmt(f),
            MountingItem::Calibration => f.write_str(Self::CALIBRATION),
        }
    }
}

/// The 64 registers of a bank.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Bank {
    /// Number of the bank.
    pub number: u8,
    /// The content of its registers.
    pub bytes: [u8; 64],
}

/// Bank listed in a profile.
#[derive(Clone, Debug, PartialEq)]
pub struct ListedBank {
    /// The content.
    pub bank: Bank,
    /// Entries that this program does not know.
    pub unknown: Unknown,
}

/// Content of a plain data area. Banks with the same byte in every register need not be listed.
#[derive(Clone, Debug, PartialEq)]
pub struct DataImage {
    /// The area's name in the encoder's description.
    pub name: String,
    /// First bank.
    pub first: u8,
    /// Last bank.
    pub last: u8,
    /// The byte in every register of a bank that is not listed; `None`: such a bank is not part of the profile.
    pub empty: Option<u8>,
    /// The banks that are listed, ascending.
    pub listed: Vec<ListedBank>,
    /// Entries that this program does not know.
    pub unknown: Unknown,
}

impl BissProfile {
    /// Registers of the kit encoder's preset value: singleturn, then multiturn.
    pub const PRESET: &'static str = "0x01:0x02+6";
    /// Register of the kit encoder's filter.
    pub const FILTER: &'static str = "0x6E";

    /// Marks the items that belong to the mounting and are not marked yet: preset and calibration.
    pub fn mark_mounting(&mut self) {
        let preset = Self::PRESET.parse().ok().filter(|_| self.preset.is_some()).map(MountingItem::Registers);
        // An encoder with a preset also has a calibration: it is a kit encoder.
        let calibration = preset.map(|_| MountingItem::Calibration);
        let known = [(preset, "preset value"), (calibration, "singleturn calibration: it stays in the encoder")];
        for (item, meaning) in known {
            let Some(item) = item.filter(|item| self.mounting.iter().all(|mark| mark.item != *item)) else { continue };
            self.mounting.push(MountingMark { item, meaning: meaning.to_owned(), unknown: Unknown::new() });
        }
    }

    /// Returns whether a register belongs to the mounting.
    pub fn is_mounting(&self, address: RegisterAddress) -> bool {
        self.mounting.iter().any(|mark| match mark.item {
            MountingItem::Registers(range) => range.contains(address),
            MountingItem::Calibration => false,
        })
    }

    /// Returns the content of a bank; `None` if the profile does not contain it.
    pub fn bank(&self, number: u8) -> Option<Bank> {
        self.data.iter().find_map(|image| image.bank(number))
    }

    /// Changes a register of plain data. Returns false if the profile does not contain its bank.
    pub fn put(&mut self, address: RegisterAddress, byte: u8) -> bool {
        let Some(number) = address.bank() else { return false };
        let image = self.data.iter_mut().find_map(|image| Some((image.bank(number)?, image)));
        let Some((mut bank, image)) = image else { return false };
        if let Some(own) = bank.bytes.get_mut(usize::from(address.address())) {
            *own = byte;
        }
        match image.listed.iter_mut().find(|listed| listed.bank.number == number) {
            Some(listed) => listed.bank = bank,
            None => {
                let at = image.listed.partition_point(|listed| listed.bank.number < number);
                image.listed.insert(at, bank.into());
            }
        }
        true
    }

    /// Returns every bank in the profile, in the order of the file.
    pub fn banks(&self) -> impl Iterator<Item = Bank> {
        self.data.iter().flat_map(DataImage::all)
    }
}

impl ProfileIdentity {
    /// Returns the kind of encoder.
    pub fn kind(&self) -> Identity {
        Identity { profile: self.profile_id, manufacturer: self.manufacturer, device_id: self.device_id }
    }
}

impl Bank {
    /// Registers of a bank.
    pub const SIZE: usize = RegisterAddress::BANK_SIZE as usize;

    /// Creates a bank with the same byte everywhere.
    pub const fn filled(number: u8, byte: u8) -> Self {
        Bank { number, bytes: [byte; Self::SIZE] }
    }

    /// Returns the byte in all registers; `None` if they differ.
    fn only_byte(&self) -> Option<u8> {
        let [first, ..] = self.bytes;
        self.bytes.iter().all(|byte| *byte == first).then_some(first)
    }

    /// Returns every register with its byte.
    pub fn registers(self) -> impl Iterator<Item = (RegisterAddress, u8)> {
        let place = move |offset| RegisterAddress::banked(self.number, offset);
        (0..RegisterAddress::BANK_SIZE).zip(self.bytes).filter_map(move |(offset, byte)| Some((place(offset)?, byte)))
    }
}

impl From<Bank> for ListedBank {
    fn from(bank: Bank) -> Self {
        ListedBank { bank, unknown: Unknown::new() }
    }
}

impl DataImage {
    /// Creates the image of an area with these banks, ascending; if the area is complete, empty banks are left out.
    pub fn of(area: &Area, banks: Vec<Bank>) -> Self {
        let is_whole = area.banks().eq(banks.iter().map(|bank| bank.number));
        let count = |byte| banks.iter().filter(|bank| bank.only_byte() == Some(byte)).count();
        // The content of memory that was never written, or was erased.
        let most = [0x00, 0xFF].into_iter().rev().max_by_key(|byte| count(*byte));
        let empty = most.filter(|byte| is_whole && count(*byte) > 0);
        let holds = |bank: &Bank| empty.is_none() || bank.only_byte() != empty;
        DataImage {
            name: area.name.english().to_owned(),
            first: area.first,
            last: area.last,
            empty,
            listed: banks.into_iter().filter(holds).map(ListedBank::from).collect(),
            unknown: Unknown::new(),
        }
    }

    /// Returns a bank of the area; `None` if the profile does not contain it.
    pub fn bank(&self, number: u8) -> Option<Bank> {
        let listed = self.listed.iter().map(|listed| listed.bank).find(|bank| bank.number == number);
        let blank = || self.empty.map(|byte| Bank::filled(number, byte));
        listed.or_else(|| blank().filter(|_| (self.first..=self.last).contains(&number)))
    }

    /// Returns every bank that it contains.
    pub fn all(&self) -> impl Iterator<Item = Bank> {
        (self.first..=self.last).filter_map(|number| self.bank(number))
    }
}
