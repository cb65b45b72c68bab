//! The text format of a BiSS profile, which users can read and edit. Errors name the entry that caused them.

use super::{
    Bank, BissProfile, DataImage, EntryError, ListedBank, MountingItem, MountingMark, PresetSetting, ProfileIdentity,
    RecordedValues,
};
use crate::bits::hex;
use crate::devices::biss::protocol::{
    self, DeviceMode, Firmware, PositionFilter, PresetValue, ProfileId, WiegandResult,
};
use crate::expected::AllowedValues;
use crate::profile::mounting::MOUNTING_COMMENT;
use crate::profile::ron_text::{Entries, Writer, quote};
use crate::profile::{ChangedItem, Comparison, Profile, ProfileError, Redo};

/// Range of each part of a preset value, which occupies three registers.
const PRESET_NUMBER: AllowedValues = AllowedValues::whole_range(0, 16_777_215);

impl Profile for BissProfile {
    const KIND: &'static str = protocol::KIND;

    fn read(entries: &mut Entries) -> Result<Self, ProfileError> {
        let identity = read_identity(entries.take_structure("identity")?)?;
        let filter = entries.take_optional("filter", AllowedValues::Byte)?.map(PositionFilter::from_byte);
        let preset = entries.optional_structure("preset")?.map(read_preset).transpose()?;
        let recorded = entries.optional_structure("recorded")?.map(read_recorded).transpose()?.unwrap_or_default();
        let mounting = MountingMark::read_all(entries, AllowedValues::TextSuchAs("0x24:0x10+3"), parse_mounting_item)?;
        let mut data: Vec<DataImage> = Vec::new();
        for entries in entries.required_structures("data")? {
            let path = entries.entry_path("banks");
            let image = read_image(entries)?;
            if let Some(other) = data.iter().find(|other| other.first <= image.last && image.first <= other.last) {
                return Err(ProfileError::invalid_entry(path, EntryError::Twice(image.first.max(other.first))));
            }
            data.push(image);
        }
        data.sort_by_key(|image| image.first);
        Ok(BissProfile { identity, filter, preset, recorded, mounting, data })
    }

    fn write(&self, writer: &mut Writer) {
        self.write_identity(writer);
        if let Some(filter) = self.filter {
            let name = match filter {
                PositionFilter::Balanced => "balanced",
                PositionFilter::Dynamic => "dynamic",
                PositionFilter::Unknown(_) => "unknown",
            };
            writer.entry("filter", &format!("0x{:02X}", filter.byte()), name);
        }
        if let Some(preset) = &self.preset {
            writer.write_comment("stored, never carried out by a restore");
            writer.open("preset", '(');
            let degrees = self.identity.singleturn_bits.map(|bits| {
                let revolution = f64::powi(2.0, bits.into());
                format!("{:.3}°", f64::from(preset.value.singleturn()) / revolution * 360.0)
            });
            writer.entry("singleturn", &preset.value.singleturn().to_string(), &degrees.unwrap_or_default());
            writer.entry("multiturn", &preset.value.multiturn().to_string(), "");
            writer.write_unknown(&preset.unknown);
            writer.close(')');
        }
        self.recorded.write(writer);
        MountingMark::write_all(&self.mounting, MOUNTING_COMMENT, writer);
        writer.open("data", '[');
        for image in &self.data {
            image.write(writer);
        }
        writer.close(']');
    }

    fn compare(&self, other: &Self) -> Comparison {
        super::compare::compare(self, other)
    }

    fn single_values(item: &ChangedItem) -> Vec<ChangedItem> {
        super::undo::single_values(item)
    }

    fn redo(&self, item: &ChangedItem) -> Option<Redo> {
        self.redo_item(item)
    }
}

impl BissProfile {
    fn write_identity(&self, writer: &mut Writer) {
        let identity = &self.identity;
        writer.open("identity", '(');
        writer.text("serial_number", &identity.serial_number);
        writer.entry("profile_id", &format!("0x{:04X}", identity.profile_id.to_u16()), "");
        writer.entry("device_id", &quote(&hex(&identity.device_id)), "");
        writer.entry("manufacturer", &quote(&hex(&identity.manufacturer)), &to_printable(&identity.manufacturer));
        if let Some(firmware) = identity.firmware {
            writer.text("firmware", &firmware.to_string());
        }
        writer.text("description", &identity.description);
        for (name, bits) in [("multiturn_bits", identity.multiturn_bits), ("singleturn_bits", identity.singleturn_bits)]
        {
            if let Some(bits) = bits {
                writer.entry(name, &bits.to_string(), "");
            }
        }
        writer.write_unknown(&identity.unknown);
        writer.close(')');
    }
}

impl RecordedValues {
    fn write(&self, writer: &mut Writer) {
        writer.write_comment("recorded, neither compared nor restored");
        writer.open("recorded", '(');
        let results =
            [("last", self.wiegand_last), ("production", self.wiegand_production), ("saved", self.wiegand_saved)];
        if results.iter().any(|(_, result)| result.is_some()) {
            writer.write_comment("tenths of a volt: average, average - 4σ clockwise; the same counterclockwise");
            for (name, result) in results {
                let Some(result) = result else { continue };
                let numbers = result.emit().map(|tenths| tenths.to_string()).join(", ");
                writer.entry(&format!("wiegand_{name}"), &format!("[{numbers}]"), "");
            }
        }
        if let Some(status) = self.calibration_status {
            writer.entry("calibration_status", &format!("0x{status:02X}"), "");
        }
        if let Some(mode) = self.device_mode {
            writer.entry("device_mode", &format!("0x{:02X}", mode.byte()), "values may not have been saved");
        }
        if !self.eds.is_empty() {
            writer.open("eds", '[');
            self.eds.iter().for_each(|listed| write_bank(writer, listed));
            writer.close(']');
        }
        writer.write_unknown(&self.unknown);
        writer.close(')');
    }
}

impl DataImage {
    fn write(&self, writer: &mut Writer) {
        writer.open("", '(');
        writer.text("name", &self.name);
        writer.entry("banks", &format!("(0x{:02X}, 0x{:02X})", self.first, self.last), "");
        if let Some(byte) = self.empty {
            writer.entry("empty", &format!("0x{byte:02X}"), "every register of the banks that are not listed");
        }
        writer.open("listed", '[');
        self.listed.iter().for_each(|listed| write_bank(writer, listed));
        writer.close(']');
        writer.write_unknown(&self.unknown);
        writer.close(')');
    }
}

fn write_bank(writer: &mut Writer, listed: &ListedBank) {
    writer.open("", '(');
    writer.entry("bank", &format!("0x{:02X}", listed.bank.number), "");
    writer.bytes("bytes", &listed.bank.bytes);
    writer.write_unknown(&listed.unknown);
    writer.close(')');
}

fn to_printable(bytes: &[u8]) -> String {
    bytes.iter().map(|byte| crate::bits::ascii(*byte).unwrap_or('.')).collect()
}

fn read_identity(mut entries: Entries) -> Result<ProfileIdentity, ProfileError> {
    let firmware =
        match entries.take_optional::<String>("firmware", AllowedValues::TextSuchAs("1.6.0"))? {
            None => None,
            Some(text) => Some(read_firmware(&text).ok_or_else(|| {
                ProfileError::invalid_entry(entries.entry_path("firmware"), EntryError::Release(text))
            })?),
        };
    let device_id = read_array(&mut entries, "device_id")?;
    let manufacturer = read_array(&mut entries, "manufacturer")?;
    Ok(ProfileIdentity {
        serial_number: entries.take_required("serial_number", AllowedValues::Text)?,
        profile_id: ProfileId::new(entries.take_required("profile_id", AllowedValues::Word)?),
        device_id,
        manufacturer,
        firmware,
        description: entries.take_optional("description", AllowedValues::Text)?.unwrap_or_default(),
        multiturn_bits: entries.take_optional("multiturn_bits", AllowedValues::Byte)?,
        singleturn_bits: entries.take_optional("singleturn_bits", AllowedValues::Byte)?,
        unknown: entries.into_unknown()?,
    })
}

fn read_firmware(text: &str) -> Option<Firmware> {
    let numbers: Vec<u8> = text.split('.').map(|number| number.parse::<u8>().ok()).collect::<Option<_>>()?;
    match numbers.as_slice() {
        [major, minor, patch] => Some(Firmware::new(*major, *minor, *patch)),
        _ => None,
    }
}

fn read_array<const N: usize>(entries: &mut Entries, name: &str) -> Result<[u8; N], ProfileError> {
    let path = entries.entry_path(name);
    let bytes = entries.bytes(name)?.ok_or_else(|| ProfileError::Missing { path: path.clone() })?;
    let length = EntryError::Length { got: bytes.len(), expected: N };
    bytes.try_into().map_err(|_| ProfileError::invalid_entry(path, length))
}

fn read_preset(mut entries: Entries) -> Result<PresetSetting, ProfileError> {
    let mut number = |name| {
        let number: u32 = entries.take_required(name, PRESET_NUMBER)?;
        let fits = PresetValue::new(number, 0).is_some();
        let path = entries.entry_path(name);
        if fits { Ok(number) } else { Err(ProfileError::Shape { path, expected: PRESET_NUMBER }) }
    };
    let (singleturn, multiturn) = (number("singleturn")?, number("multiturn")?);
    let value = PresetValue::new(singleturn, multiturn).unwrap_or_default();
    Ok(PresetSetting { value, unknown: entries.into_unknown()? })
}

fn read_recorded(mut entries: Entries) -> Result<RecordedValues, ProfileError> {
    let mut result = |name| {
        let tenths: Option<[u8; 4]> = entries.take_optional(name, AllowedValues::FourTenths)?;
        Ok(tenths.map(WiegandResult::parse))
    };
    Ok(RecordedValues {
        wiegand_last: result("wiegand_last")?,
        wiegand_production: result("wiegand_production")?,
        wiegand_saved: result("wiegand_saved")?,
        calibration_status: entries.take_optional("calibration_status", AllowedValues::Byte)?,
        device_mode: entries.take_optional("device_mode", AllowedValues::Byte)?.map(DeviceMode::new),
        eds: entries.take_structures("eds")?.into_iter().map(read_bank).collect::<Result<_, _>>()?,
        unknown: entries.into_unknown()?,
    })
}

fn parse_mounting_item(text: &str) -> Result<MountingItem, EntryError> {
    if text == MountingItem::CALIBRATION {
        return Ok(MountingItem::Calibration);
    }
    let range = text.parse().map_err(|_| EntryError::Marked(text.to_owned()))?;
    Ok(MountingItem::Registers(range))
}

fn read_image(mut entries: Entries) -> Result<DataImage, ProfileError> {
    let (first, last): (u8, u8) = entries.take_required("banks", AllowedValues::Banks)?;
    if first > last {
        return Err(ProfileError::invalid_entry(entries.entry_path("banks"), EntryError::Order { first, last }));
    }
    let mut listed: Vec<ListedBank> = Vec::new();
    for entries in entries.take_structures("listed")? {
        let path = entries.entry_path("bank");
        let own = read_bank(entries)?;
        let number = own.bank.number;
        if !(first..=last).contains(&number) {
            return Err(ProfileError::invalid_entry(path, EntryError::Outside { bank: number, first, last }));
        }
        if listed.iter().any(|other| other.bank.number == number) {
            return Err(ProfileError::invalid_entry(path, EntryError::Twice(number)));
        }
        listed.push(own);
    }
    listed.sort_by_key(|listed| listed.bank.number);
    let name = entries.take_optional("name", AllowedValues::Text)?.unwrap_or_default();
    let empty = entries.take_optional("empty", AllowedValues::Byte)?;
    Ok(DataImage { name, first, last, empty, listed, unknown: entries.into_unknown()? })
}

fn read_bank(mut entries: Entries) -> Result<ListedBank, ProfileError> {
    let number = entries.take_required("bank", AllowedValues::Byte)?;
    let bytes = read_array(&mut entries, "bytes")?;
    Ok(ListedBank { bank: Bank { number, bytes }, unknown: entries.into_unknown()? })
}

#[cfg(test)]
mod tests;
