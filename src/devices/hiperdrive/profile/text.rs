//! The text format of a HIPERDRIVE profile, which can be read and edited by hand. Errors give the name of the entry.
//!
//! The parameters of a drive have the numbers of drive 1. They may also be listed together with the device parameters,
//! whose numbers are below 100. In this case, numbers from 200 refer to the other drives.

use super::{EntryError, HiperdriveProfile, Image, Item, MountingMark, ProfileDrive, ProfileIdentity, UnknownEntries};
use crate::devices::hiperdrive::protocol::drive_parameter::{LOWER_LIMIT, UPPER_LIMIT};
use crate::devices::hiperdrive::protocol::{self, DriveNumber, ParameterNumber, Topology, Travel, Variant};
use crate::expected::AllowedValues;
use crate::profile::ron_text::{Entries, Writer, value_text};
use crate::profile::{ChangedItem, Comparison, Profile, ProfileError, Redo};

const PORT_NUMBER: AllowedValues = AllowedValues::whole_range(1, 8);
const VARIANT: AllowedValues = AllowedValues::whole_range(0, 65_535);
const CATEGORY: AllowedValues =
    AllowedValues::words(&["\"HIPERDRIVE SINGLE\"", "\"HIPERDRIVE HUB-4\"", "\"HIPERDRIVE HUB-8\""]);

impl Profile for HiperdriveProfile {
    const KIND: &'static str = protocol::KIND;

    fn read(entries: &mut Entries) -> Result<Self, ProfileError> {
        let mut identity = match entries.optional_structure("identity")? {
            Some(entries) => read_identity(entries)?,
            None => ProfileIdentity::default(),
        };
        let mounting = MountingMark::read_all(entries, AllowedValues::TextSuchAs("198 drive 2"), parse_mounting_item)?;
        let (mut image, mut unknown) = (Image::default(), UnknownEntries::default());
        read_parameters(entries, None, &mut image, &mut unknown)?;
        for mut entries in entries.take_structures("drives")? {
            let path = entries.entry_path("number");
            let place: u8 = entries.take_required("number", PORT_NUMBER)?;
            let number = DriveNumber::new(place)
                .ok_or_else(|| ProfileError::Shape { path: path.clone(), expected: PORT_NUMBER })?;
            if identity.drives.iter().any(|drive| drive.number == number) {
                return Err(ProfileError::invalid_entry(path, EntryError::DriveTwice(number)));
            }
            read_parameters(&mut entries, Some(number), &mut image, &mut unknown)?;
            identity.drives.push(read_drive(entries, number)?);
        }
        Ok(HiperdriveProfile { identity, image, mounting, unknown })
    }

    fn write(&self, writer: &mut Writer) {
        // A profile made by hand belongs to no particular device.
        if !self.identity.is_device_unknown() {
            self.identity.write(writer);
        }
        MountingMark::write_all(
            &self.mounting,
            "belongs to the mounting: a reference is never restored, the rest not onto another device",
            writer,
        );
        self.write_parameters(writer, None);
        let mut drives = self.image.drives();
        drives.extend(self.identity.drives.iter().map(|drive| drive.number));
        drives.sort();
        drives.dedup();
        if drives.is_empty() {
            return;
        }
        writer.open("drives", '[');
        for number in drives {
            writer.open("", '(');
            writer.entry("number", &number.get().to_string(), "");
            if let Some(drive) = self.drive(number) {
                drive.write(writer);
            }
            self.write_parameters(writer, Some(number));
            writer.close(')');
        }
        writer.close(']');
    }

    /// Compares the stored parameters. Identities and measured values are not compared.
    fn compare(&self, other: &Self) -> Comparison {
        let mut comparison = Comparison::default();
        for number in self.image.with_overlay(&other.image).values.into_keys() {
            comparison.compare_item(Item(number).to_string(), self.image.get(number), other.image.get(number));
        }
        comparison
    }

    fn single_values(item: &ChangedItem) -> Vec<ChangedItem> {
        super::undo::single_values(item)
    }

    fn keep_items(&mut self, items: &[ChangedItem]) {
        self.keep_parameters(items);
    }

    fn redo(&self, item: &ChangedItem) -> Option<Redo> {
        super::undo::redo(item)
    }
}

impl HiperdriveProfile {
    fn write_parameters(&self, writer: &mut Writer, drive: Option<DriveNumber>) {
        let unknown = self.unknown.0.get(&drive).map(Vec::as_slice).unwrap_or_default();
        let own: Vec<(ParameterNumber, i64)> = self
            .image
            .values
            .iter()
            .map(|(number, value)| (*number, *value))
            .filter(|(n, _)| n.drive() == drive)
            .collect();
        if own.is_empty() && unknown.is_empty() {
            return;
        }
        writer.open("parameters", '{');
        for (number, value) in own {
            writer.entry(
                &number.drive1_number().to_string(),
                &value.to_string(),
                &self.parameter_comment(number, value),
            );
        }
        for (name, value) in unknown {
            writer.entry(&value_text(name), &value_text(value), "");
        }
        writer.close('}');
    }

    /// Returns the comment after a parameter: its name and, for a limit, the number of turns.
    fn parameter_comment(&self, number: ParameterNumber, value: i64) -> String {
        let Some(row) = number.row() else { return String::new() };
        let unit = if row.unit.is_empty() { String::new() } else { format!(" [{}]", row.unit) };
        let scale = number
            .drive()
            .filter(|_| matches!(row.number, LOWER_LIMIT | UPPER_LIMIT))
            .and_then(|drive| self.image.scale(drive));
        let turns = scale.zip(i32::try_from(value).ok()).map(|(scale, steps)| scale.to_turns(steps));
        let turns = turns.map(|turns| format!(", {turns:.3} turns")).unwrap_or_default();
        format!("{}{unit}{turns}", row.name)
    }
}

impl ProfileIdentity {
    fn write(&self, writer: &mut Writer) {
        writer.open("identity", '(');
        if let Some(topology) = self.topology {
            writer.text("category", topology.category());
        }
        for (name, own) in [
            ("name", &self.name),
            ("article_number", &self.article_number),
            ("serial_number", &self.serial_number),
            ("version", &self.version),
        ] {
            text(writer, name, own);
        }
        writer.write_unknown(&self.unknown);
        writer.close(')');
    }
}

impl ProfileDrive {
    fn write(&self, writer: &mut Writer) {
        if let Some(variant) = self.variant {
            writer.entry("variant", &variant.number().to_string(), variant.row().map_or("", |row| row.name));
        }
        for (name, own) in [
            ("name", &self.name),
            ("article_number", &self.article_number),
            ("serial_number", &self.serial_number),
            ("version", &self.version),
        ] {
            text(writer, name, own);
        }
        writer.write_unknown(&self.unknown);
    }
}

fn text(writer: &mut Writer, name: &str, own: &str) {
    if !own.is_empty() {
        writer.text(name, own);
    }
}

fn read_identity(mut entries: Entries) -> Result<ProfileIdentity, ProfileError> {
    let path = entries.entry_path("category");
    let category = entries.take_optional::<String>("category", CATEGORY)?;
    let topology = category
        .map(|category| Topology::from_category(&category).ok_or(ProfileError::Shape { path, expected: CATEGORY }));
    let topology = topology.transpose()?;
    let mut text =
        |name: &str| entries.take_optional::<String>(name, AllowedValues::Text).map(Option::unwrap_or_default);
    let (name, article_number) = (text("name")?, text("article_number")?);
    let (serial_number, version) = (text("serial_number")?, text("version")?);
    let unknown = entries.into_unknown()?;
    Ok(ProfileIdentity { topology, name, article_number, serial_number, version, drives: Vec::new(), unknown })
}

fn read_drive(mut entries: Entries, number: DriveNumber) -> Result<ProfileDrive, ProfileError> {
    let variant = entries.take_optional("variant", VARIANT)?.map(Variant::new);
    let mut text =
        |name: &str| entries.take_optional::<String>(name, AllowedValues::Text).map(Option::unwrap_or_default);
    let (name, article_number) = (text("name")?, text("article_number")?);
    let (serial_number, version) = (text("serial_number")?, text("version")?);
    Ok(ProfileDrive { number, variant, name, article_number, serial_number, version, unknown: entries.into_unknown()? })
}

fn parse_mounting_item(text: &str) -> Result<Item, EntryError> {
    let item = text.parse::<Item>()?;
    if item.0.row().is_none_or(|row| !Image::contains_row(row)) {
        return Err(EntryError::NoMounting(item));
    }
    Ok(item)
}

/// Parses the parameters of the device, or those of a drive by their numbers for drive 1. A number that is not valid
/// there is an error. A key that is not a number is kept as an unknown entry.
fn read_parameters(
    entries: &mut Entries,
    drive: Option<DriveNumber>,
    image: &mut Image,
    unknown: &mut UnknownEntries,
) -> Result<(), ProfileError> {
    for (name, value) in entries.take_map("parameters")? {
        let own = name.clone().into_rust::<u16>().ok();
        let number = own.and_then(|own| match drive {
            None => ParameterNumber::new(own),
            Some(drive) => ParameterNumber::for_drive(own, drive),
        });
        let Some((number, row)) = number.and_then(|number| Some((number, number.row()?))) else {
            if let ron::Value::Number(own) = &name {
                let path = format!("{}.{}", entries.entry_path("parameters"), value_text(&name));
                return Err(ProfileError::invalid_entry(path, invalid_parameter_error(own, drive)));
            }
            entries.record_undefined_entry(format!("{}.{}", entries.entry_path("parameters"), value_text(&name)));
            unknown.0.entry(drive).or_default().push((name, value));
            continue;
        };
        let path = format!("{}.{}", entries.entry_path("parameters"), row.number);
        let wrong = |error: EntryError| ProfileError::invalid_entry(path.clone(), error);
        if !Image::contains_row(row) {
            return Err(wrong(EntryError::NotKept(Item(number))));
        }
        let value: i64 = value
            .into_rust()
            .map_err(|_| ProfileError::Shape { path: path.clone(), expected: AllowedValues::Whole })?;
        // The travel depends on the drive to be written, so the plan checks it.
        let value = row.check_value(number, value, Travel::UNKNOWN).map_err(|error| wrong(error.into()))?;
        if image.values.insert(number, value).is_some() {
            return Err(wrong(EntryError::Twice(Item(number))));
        }
    }
    Ok(())
}

/// Returns the error for a number that is not a valid parameter.
fn invalid_parameter_error(number: &ron::value::Number, drive: Option<DriveNumber>) -> EntryError {
    let number = number.into_f64().to_string();
    match drive {
        None => EntryError::NoParameter(number),
        Some(drive) => EntryError::NoParameterOfDrive { number, drive },
    }
}

#[cfg(test)]
mod tests;
