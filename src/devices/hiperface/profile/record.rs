//! Profile of a HIPERFACE encoder: its saved content. Access codes are never included.

use super::{EntryError, FieldRange, Item};
use crate::devices::hiperface::protocol::{self, DataFieldStatus, LineSettings};
use crate::expected::AllowedValues;
use crate::profile::mounting::MOUNTING_COMMENT;
use crate::profile::ron_text::{Entries, UnknownValues, Writer};
use crate::profile::{ChangedItem, Comparison, Profile, ProfileError, Redo};

/// Profile of a HIPERFACE encoder.
#[derive(Clone, Debug, PartialEq)]
pub struct HiperfaceProfile {
    /// Identity of the encoder.
    pub identity: ProfileIdentity,
    /// Address and interface settings. They are recorded, but neither compared nor restored.
    pub interface: Interface,
    /// Values that change without being written. They are recorded, but neither compared nor restored.
    pub recorded: RecordedValues,
    /// Mounting values. They are written to another encoder only if the user agrees.
    pub mounting: Vec<MountingMark>,
    /// Data fields in ascending order.
    pub fields: Vec<FieldImage>,
    /// Fields created by the write, with their content. Only a backup contains such fields, and restoring it deletes
    /// them.
    pub created: Vec<FieldImage>,
    /// Unknown profile entries by field number.
    pub unknown_in_fields: Vec<(u8, UnknownValues)>,
}

/// Identity of an encoder.
#[derive(Clone, Debug, PartialEq)]
pub struct ProfileIdentity {
    /// Serial number, or an empty string if the encoder has none.
    pub serial_number: String,
    /// Type code.
    pub encoder_type: u8,
    /// Family or type designation.
    pub encoder_name: String,
    /// Firmware version.
    pub firmware_version: String,
    /// Firmware date in the format `DD.MM.YY`.
    pub firmware_date: String,
    /// EEPROM size in bytes.
    pub eeprom_bytes: u32,
    /// Options byte of the type label.
    pub options: u8,
    /// Content of data field FFh.
    pub extended_label: Option<Vec<u8>>,
    /// Profile entries that this program does not know. They are kept when the profile is saved.
    pub unknown: UnknownValues,
}

/// Address and interface settings.
#[derive(Clone, Debug, PartialEq)]
pub struct Interface {
    /// Address, 40h to 5Fh.
    pub address: u8,
    /// Stored interface settings.
    pub settings: LineSettings,
    /// Profile entries that this program does not know. They are kept when the profile is saved.
    pub unknown: UnknownValues,
}

/// Values that change without being written.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct RecordedValues {
    /// Position in steps.
    pub position: Option<u32>,
    /// Value of the counter.
    pub counter: Option<u32>,
    /// Profile entries that this program does not know. They are kept when the profile is saved.
    pub unknown: UnknownValues,
}

/// Mark for a range of a data field that holds a mounting value. Such a value is valid only for one encoder on one
/// motor.
pub type MountingMark = crate::profile::MountingMark<FieldRange>;

/// A data field.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub struct FieldImage {
    /// Field number.
    pub number: u8,
    /// Status byte.
    pub status: DataFieldStatus,
    /// Field content with the length given in the status, or `None` if the access code is unknown.
    pub bytes: Option<Vec<u8>>,
}

impl HiperfaceProfile {
    /// Prefix of a commutation offset stored by this program.
    pub const COMMUTATION_MAGIC: &'static [u8] = b"CO1";
    /// Length of a commutation offset stored by this program, in bytes.
    pub const COMMUTATION_BYTES: usize = 16;

    /// Marks all items that are recognised as mounting values and are not marked yet.
    pub fn mark_mounting_dependent_values(&mut self) {
        for field in &self.fields {
            let Some(bytes) = &field.bytes else { continue };
            let blocks = bytes.chunks_exact(Self::COMMUTATION_BYTES).zip(0..);
            for (_, block) in blocks.filter(|(block, _)| block.starts_with(Self::COMMUTATION_MAGIC)) {
                let start = block * Self::COMMUTATION_BYTES;
                let marked = |mark: &MountingMark| mark.item.contains(field.number, start);
                if self.mounting.iter().any(marked) {
                    continue;
                }
                self.mounting.push(MountingMark {
                    item: FieldRange::new(field.number, start, Self::COMMUTATION_BYTES),
                    meaning: "commutation offset".to_owned(),
                    unknown: UnknownValues::new(),
                });
            }
        }
    }

    /// Returns whether a byte of a data field is a mounting value.
    pub fn depends_on_mounting(&self, field: u8, address: usize) -> bool {
        self.mounting.iter().any(|mark| mark.item.contains(field, address))
    }

    fn write_identity(&self, writer: &mut Writer) {
        let identity = &self.identity;
        writer.open("identity", '(');
        writer.text("serial_number", &identity.serial_number);
        writer.entry("encoder_type", &format!("0x{:02X}", identity.encoder_type), "");
        writer.text("encoder_name", &identity.encoder_name);
        writer.text("firmware_version", &identity.firmware_version);
        writer.text("firmware_date", &identity.firmware_date);
        writer.entry("eeprom_bytes", &identity.eeprom_bytes.to_string(), "");
        writer.entry("options", &format!("0x{:02X}", identity.options), "");
        if let Some(label) = &identity.extended_label {
            writer.bytes("extended_label", label);
        }
        writer.write_unknown(&identity.unknown);
        writer.close(')');
    }
}

impl Profile for HiperfaceProfile {
    const KIND: &'static str = protocol::KIND;

    fn read(entries: &mut Entries) -> Result<Self, ProfileError> {
        let identity = read_identity(entries.take_structure("identity")?)?;
        let interface = read_interface(entries.take_structure("interface")?)?;
        let recorded = entries.optional_structure("recorded")?.map(read_recorded).transpose()?.unwrap_or_default();
        let mounting = MountingMark::read_all(entries, AllowedValues::TextSuchAs("field:0@0+16"), parse_mounting_item)?;
        let mut fields: Vec<FieldImage> = Vec::new();
        let mut unknown_in_fields = Vec::new();
        for entries in entries.required_structures("fields")? {
            let path = entries.entry_path("number");
            let (field, unknown) = read_field(entries)?;
            if fields.iter().any(|other| other.number == field.number) {
                return Err(ProfileError::invalid_entry(path, EntryError::Twice(field.number)));
            }
            if !unknown.is_empty() {
                unknown_in_fields.push((field.number, unknown));
            }
            fields.push(field);
        }
        fields.sort_by_key(|field| field.number);
        let mut created = Vec::new();
        for entries in entries.take_structures("created")? {
            created.push(read_field(entries)?.0);
        }
        Ok(HiperfaceProfile { identity, interface, recorded, mounting, fields, created, unknown_in_fields })
    }

    fn write(&self, writer: &mut Writer) {
        self.write_identity(writer);
        writer.open("interface", '(');
        writer.entry("address", &format!("0x{:02X}", self.interface.address), "");
        let settings = self.interface.settings;
        writer.entry("settings", &format!("0x{:02X}", settings.byte()), &settings.to_string());
        writer.write_unknown(&self.interface.unknown);
        writer.close(')');
        writer.write_comment("recorded, neither compared nor restored; the position belongs to the mounting");
        writer.open("recorded", '(');
        if let Some(position) = self.recorded.position {
            writer.entry("position", &position.to_string(), "steps");
        }
        if let Some(counter) = self.recorded.counter {
            writer.entry("counter", &counter.to_string(), "");
        }
        writer.write_unknown(&self.recorded.unknown);
        writer.close(')');
        MountingMark::write_all(&self.mounting, MOUNTING_COMMENT, writer);
        writer.open("fields", '[');
        for field in &self.fields {
            let unknown = self.unknown_in_fields.iter().find(|(number, _)| *number == field.number);
            write_field(writer, field, unknown.map(|(_, unknown)| unknown));
        }
        writer.close(']');
        if self.created.is_empty() {
            return;
        }
        writer.write_comment(
            "created by the write: restoring this deletes them again where they are unchanged and the last",
        );
        writer.open("created", '[');
        for field in &self.created {
            write_field(writer, field, None);
        }
        writer.close(']');
    }

    fn compare(&self, other: &Self) -> Comparison {
        super::compare::compare(&self.fields, &other.fields)
    }

    fn single_values(item: &ChangedItem) -> Vec<ChangedItem> {
        super::undo::single_values(item)
    }

    fn redo(&self, item: &ChangedItem) -> Option<Redo> {
        self.redo_item(item)
    }
}

fn write_field(writer: &mut Writer, field: &FieldImage, unknown: Option<&UnknownValues>) {
    writer.open("", '(');
    writer.entry("number", &field.number.to_string(), "");
    writer.entry("status", &format!("0x{:02X}", field.status.byte()), &field.status.to_string());
    match &field.bytes {
        Some(bytes) => writer.bytes("bytes", bytes),
        None => writer.entry("locked", "true", "the access code is not known, so there are no bytes"),
    }
    if let Some(unknown) = unknown {
        writer.write_unknown(unknown);
    }
    writer.close(')');
}

fn read_identity(mut entries: Entries) -> Result<ProfileIdentity, ProfileError> {
    Ok(ProfileIdentity {
        serial_number: entries.take_required("serial_number", AllowedValues::Text)?,
        encoder_type: entries.take_required("encoder_type", AllowedValues::Byte)?,
        encoder_name: entries.take_optional("encoder_name", AllowedValues::Text)?.unwrap_or_default(),
        firmware_version: entries.take_optional("firmware_version", AllowedValues::Text)?.unwrap_or_default(),
        firmware_date: entries.take_optional("firmware_date", AllowedValues::Text)?.unwrap_or_default(),
        eeprom_bytes: entries.take_optional("eeprom_bytes", AllowedValues::Whole)?.unwrap_or_default(),
        options: entries.take_optional("options", AllowedValues::Byte)?.unwrap_or_default(),
        extended_label: entries.bytes("extended_label")?,
        unknown: entries.into_unknown()?,
    })
}

fn read_interface(mut entries: Entries) -> Result<Interface, ProfileError> {
    Ok(Interface {
        address: entries.take_required("address", AllowedValues::Byte)?,
        settings: LineSettings::from_byte(entries.take_required("settings", AllowedValues::Byte)?),
        unknown: entries.into_unknown()?,
    })
}

fn read_recorded(mut entries: Entries) -> Result<RecordedValues, ProfileError> {
    Ok(RecordedValues {
        position: entries.take_optional("position", AllowedValues::whole_range(0, 4_294_967_295))?,
        counter: entries.take_optional("counter", AllowedValues::whole_range(0, 16_777_215))?,
        unknown: entries.into_unknown()?,
    })
}

fn parse_mounting_item(text: &str) -> Result<FieldRange, EntryError> {
    match text.parse::<Item>() {
        Ok(Item::Field(range)) => Ok(range),
        _ => Err(EntryError::Marked(text.to_owned())),
    }
}

fn read_field(mut entries: Entries) -> Result<(FieldImage, UnknownValues), ProfileError> {
    let number: u8 = entries.take_required("number", AllowedValues::whole_range(0, 254))?;
    let status = DataFieldStatus::from_byte(entries.take_required("status", AllowedValues::Byte)?);
    let wrong =
        |entries: &Entries, name: &str, error| Err(ProfileError::invalid_entry(entries.entry_path(name), error));
    if !status.exists() {
        return wrong(&entries, "status", EntryError::Status(status.byte()));
    }
    let bytes = entries.bytes("bytes")?;
    let locked = entries.take_optional("locked", AllowedValues::words(&["true", "false"]))?.unwrap_or(false);
    if bytes.is_some() == locked {
        return wrong(&entries, "bytes", if locked { EntryError::Locked } else { EntryError::NotLocked });
    }
    if let Some(bytes) = &bytes
        && bytes.len() != status.size().bytes()
    {
        let size = EntryError::Size { got: bytes.len(), expected: status.size().bytes() };
        return wrong(&entries, "bytes", size);
    }
    Ok((FieldImage { number, status, bytes }, entries.into_unknown()?))
}

#[cfg(test)]
mod tests;
