//! The saved content of a BiSS encoder: identity, settings, data areas and recorded values. For the text format, see
//! [`text`](super::text).

use std::fmt;

use super::RegisterRange;
use crate::devices::biss::protocol::{
    Area, DeviceMode, Firmware, Identity, PositionFilter, PresetValue, ProfileId, RegisterAddress, WiegandResult,
};
use crate::profile::ron_text::UnknownValues;

/// The profile of a BiSS encoder.
#[derive(Clone, Debug, PartialEq)]
pub struct BissProfile {
    /// Identity of the encoder from which the profile was read.
    pub identity: ProfileIdentity,
    /// Position filter, or `None` if the encoder offers no choice.
    pub filter: Option<PositionFilter>,
    /// Preset value, or `None` if the encoder has none. It is only valid while the encoder stays on its motor.
    pub preset: Option<PresetSetting>,
    /// Values that the encoder changes by itself or that are read-only. They are neither compared nor restored.
    pub recorded: RecordedValues,
    /// Values that are only valid for this encoder on its motor. They are written to another encoder only on request.
    pub mounting: Vec<MountingMark>,
    /// Data areas in ascending order of bank.
    pub data: Vec<DataImage>,
}

/// The identity of an encoder, as saved in a profile.
#[derive(Clone, Debug, PartialEq)]
pub struct ProfileIdentity {
    /// Serial number reported by the encoder, or empty if not available.
    pub serial_number: String,
    /// Profile ID (registers 42h and 43h).
    pub profile_id: ProfileId,
    /// Device ID (registers 78h to 7Dh).
    pub device_id: [u8; 6],
    /// Manufacturer ID (registers 7Eh and 7Fh).
    pub manufacturer: [u8; 2],
    /// Firmware version (registers 74h to 76h), or `None` if the encoder has no such registers.
    pub firmware: Option<Firmware>,
    /// Name of the description with which the encoder was read.
    pub description: String,
    /// Multiturn width in bits, if known.
    pub multiturn_bits: Option<u8>,
    /// Singleturn width in bits, if known.
    pub singleturn_bits: Option<u8>,
    /// Profile entries unknown to this program.
    pub unknown: UnknownValues,
}

/// The preset value stored in an encoder.
#[derive(Clone, Debug, PartialEq)]
pub struct PresetSetting {
    /// Stored preset value.
    pub value: PresetValue,
    /// Profile entries unknown to this program.
    pub unknown: UnknownValues,
}

/// The values in a profile that the encoder changes by itself or that are read-only.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct RecordedValues {
    /// Banks of the electronic data sheet.
    pub eds: Vec<ListedBank>,
    /// Result of the last Wiegand test since power-up.
    pub wiegand_last: Option<WiegandResult>,
    /// Result of the Wiegand test in the factory.
    pub wiegand_production: Option<WiegandResult>,
    /// Result of the Wiegand test saved in the encoder.
    pub wiegand_saved: Option<WiegandResult>,
    /// Value of the calibration status register (bank 0, 01h).
    pub calibration_status: Option<u8>,
    /// Device mode in which the profile was read, or `None` for operation mode. In a device mode, the profile may
    /// contain values that were never saved in the encoder.
    pub device_mode: Option<DeviceMode>,
    /// Profile entries unknown to this program.
    pub unknown: UnknownValues,
}

/// A mark on an item that is only valid for one encoder on one motor.
pub type MountingMark = crate::profile::MountingMark<MountingItem>;

/// An item that is only valid for one encoder on one motor.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MountingItem {
    /// A range of registers.
    Registers(RegisterRange),
    /// The calibration table, which stays in the encoder and cannot be read.
    Calibration,
}

impl MountingItem {
    /// Name of the calibration table, which cannot be read from registers.
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

/// A bank of 64 registers.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Bank {
    /// Bank number.
    pub number: u8,
    /// Contents of the registers.
    pub bytes: [u8; 64],
}

/// A bank listed in a profile.
#[derive(Clone, Debug, PartialEq)]
pub struct ListedBank {
    /// Number and contents of the bank.
    pub bank: Bank,
    /// Profile entries unknown to this program.
    pub unknown: UnknownValues,
}

/// The contents of a data area. Banks in which all bytes are equal may be left out.
#[derive(Clone, Debug, PartialEq)]
pub struct DataImage {
    /// Name of the area in the encoder's description.
    pub name: String,
    /// First bank of the area.
    pub first: u8,
    /// Last bank of the area.
    pub last: u8,
    /// The byte in every register of the banks that are not listed. If `None`, these banks are not part of the profile.
    pub empty: Option<u8>,
    /// Listed banks in ascending order.
    pub listed: Vec<ListedBank>,
    /// Profile entries unknown to this program.
    pub unknown: UnknownValues,
}

impl BissProfile {
    /// Registers of the preset value in a kit encoder, singleturn first.
    pub const PRESET: &'static str = "0x01:0x02+6";
    /// Filter register of a kit encoder.
    pub const FILTER: &'static str = "0x6E";

    /// Marks the preset value and the calibration as valid only for this encoder on its motor, unless they are already
    /// marked.
    pub fn mark_mounting_dependent_values(&mut self) {
        let preset = Self::PRESET.parse().ok().filter(|_| self.preset.is_some()).map(MountingItem::Registers);
        // An encoder with a preset value is a kit encoder, which also has a calibration.
        let calibration = preset.map(|_| MountingItem::Calibration);
        let known = [(preset, "preset value"), (calibration, "singleturn calibration: it stays in the encoder")];
        for (item, meaning) in known {
            let Some(item) = item.filter(|item| self.mounting.iter().all(|mark| mark.item != *item)) else { continue };
            self.mounting.push(MountingMark { item, meaning: meaning.to_owned(), unknown: UnknownValues::new() });
        }
    }

    /// Returns whether the value of a register is only valid for one encoder on one motor.
    pub fn depends_on_mounting(&self, address: RegisterAddress) -> bool {
        self.mounting.iter().any(|mark| match mark.item {
            MountingItem::Registers(range) => range.contains(address),
            MountingItem::Calibration => false,
        })
    }

    /// Returns the contents of a bank, or `None` if the profile does not contain the bank.
    pub fn bank(&self, number: u8) -> Option<Bank> {
        self.data.iter().find_map(|image| image.bank(number))
    }

    /// Returns the name of the data area to which a bank belongs.
    pub fn area_name(&self, bank: u8) -> Option<&str> {
        let area = self.data.iter().find(|area| (area.first..=area.last).contains(&bank))?;
        Some(area.name.as_str()).filter(|name| !name.is_empty())
    }

    /// Returns the value of a register in a data area, or `None` if the profile does not contain its bank.
    pub fn register(&self, address: RegisterAddress) -> Option<u8> {
        self.bank(address.bank()?)?.bytes.get(usize::from(address.address())).copied()
    }

    /// Changes a register in a data area. Returns `false` if the profile does not contain its bank.
    pub fn set_register(&mut self, address: RegisterAddress, byte: u8) -> bool {
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

    /// Returns all banks in the profile, in file order.
    pub fn banks(&self) -> impl Iterator<Item = Bank> {
        self.data.iter().flat_map(DataImage::all_banks)
    }
}

impl ProfileIdentity {
    /// Returns the part of the identity that all encoders of this type share.
    pub fn kind(&self) -> Identity {
        Identity { profile: self.profile_id, manufacturer: self.manufacturer, device_id: self.device_id }
    }
}

impl Bank {
    /// Number of registers in a bank.
    pub const SIZE: usize = RegisterAddress::BANK_SIZE as usize;

    /// Creates a bank with the given byte in every register.
    pub const fn filled_with(number: u8, byte: u8) -> Self {
        Bank { number, bytes: [byte; Self::SIZE] }
    }

    /// Returns the byte that is in every register, or `None` if the registers differ.
    fn uniform_byte(&self) -> Option<u8> {
        let [first, ..] = self.bytes;
        self.bytes.iter().all(|byte| *byte == first).then_some(first)
    }

    /// Returns each register address with its byte.
    pub fn registers(self) -> impl Iterator<Item = (RegisterAddress, u8)> {
        let place = move |offset| RegisterAddress::in_bank(self.number, offset);
        (0..RegisterAddress::BANK_SIZE).zip(self.bytes).filter_map(move |(offset, byte)| Some((place(offset)?, byte)))
    }
}

impl From<Bank> for ListedBank {
    fn from(bank: Bank) -> Self {
        ListedBank { bank, unknown: UnknownValues::new() }
    }
}

impl DataImage {
    /// Creates the contents of an area from the given banks, which must be in ascending order. If they cover the whole
    /// area, empty banks are left out.
    pub fn new(area: &Area, banks: Vec<Bank>) -> Self {
        let is_whole = area.banks().eq(banks.iter().map(|bank| bank.number));
        let count = |byte| banks.iter().filter(|bank| bank.uniform_byte() == Some(byte)).count();
        // Memory that was never written or was erased has these contents.
        let most = [0x00, 0xFF].into_iter().rev().max_by_key(|byte| count(*byte));
        let empty = most.filter(|byte| is_whole && count(*byte) > 0);
        let holds = |bank: &Bank| empty.is_none() || bank.uniform_byte() != empty;
        DataImage {
            name: area.name.english().to_owned(),
            first: area.first,
            last: area.last,
            empty,
            listed: banks.into_iter().filter(holds).map(ListedBank::from).collect(),
            unknown: UnknownValues::new(),
        }
    }

    /// Returns a bank of the area, or `None` if the profile does not contain the bank.
    pub fn bank(&self, number: u8) -> Option<Bank> {
        let listed = self.listed.iter().map(|listed| listed.bank).find(|bank| bank.number == number);
        let blank = || self.empty.map(|byte| Bank::filled_with(number, byte));
        listed.or_else(|| blank().filter(|_| (self.first..=self.last).contains(&number)))
    }

    /// Returns all banks of the area that the profile contains.
    pub fn all_banks(&self) -> impl Iterator<Item = Bank> {
        (self.first..=self.last).filter_map(|number| self.bank(number))
    }
}
