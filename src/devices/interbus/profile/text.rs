//! The text format of INTERBUS profiles, which users can read and edit. Each error names the entry at fault.

use super::{
    CamNames, Direction, EntryError, Image, InterbusProfile, Item, ItemError, MountingMark, Parameters,
    ProfileIdentity, RecordedValues, UnknownEntries,
};
use crate::devices::interbus::protocol::{
    self, Cam, CamNumber, Flags, Program, ProgramNumber, StartupMode, Value, WindowShift,
};
use crate::expected::AllowedValues;
use crate::profile::mounting::MOUNTING_COMMENT;
use crate::profile::ron_text::{Entries, UnknownValues, Writer, entries_text, quote};
use crate::profile::{Comparison, Profile, ProfileError};

const NUMBER: AllowedValues = AllowedValues::whole_range(0, Value::MAX.get() as i128);
const DIRECTION: AllowedValues = AllowedValues::words(&["cw", "ccw"]);
const SHIFT: AllowedValues = AllowedValues::whole_range(0, 25);

impl Profile for InterbusProfile {
    const KIND: &'static str = protocol::KIND;

    fn read(entries: &mut Entries) -> Result<Self, ProfileError> {
        let identity = match entries.optional_structure("identity")? {
            Some(entries) => read_identity(entries)?,
            None => ProfileIdentity::default(),
        };
        let mut unknown = UnknownEntries::default();
        let mut image = Image::from_parameters(read_parameters(entries.take_structure("parameters")?, &mut unknown)?);
        image.shift = entries.take_optional("shift", SHIFT)?.map(|shift| window_shift(entries, shift)).transpose()?;
        let mut names = CamNames::default();
        for entries in entries.take_structures("programs")? {
            let path = entries.entry_path("program");
            let (number, program) = read_program(entries, &mut names, &mut unknown)?;
            match image.program_mut(number) {
                Some(place @ None) => *place = Some(program),
                _ => {
                    return Err(ProfileError::invalid_entry(path, EntryError::ProgramTwice(number)));
                }
            }
        }
        let mounting = MountingMark::read_all(entries, AllowedValues::TextSuchAs("preset"), parse_mounting_item)?;
        let recorded = entries.optional_structure("recorded")?.map(read_recorded).transpose()?.unwrap_or_default();
        Ok(InterbusProfile { identity, image, names, mounting, recorded, unknown })
    }

    fn write(&self, writer: &mut Writer) {
        // A profile that was written by hand has no identity.
        if self.identity != ProfileIdentity::default() {
            self.identity.write(writer);
        }
        if self.recorded != RecordedValues::default() {
            self.recorded.write(writer);
        }
        MountingMark::write_all(&self.mounting, MOUNTING_COMMENT, writer);
        self.write_parameters(writer);
        if let Some(shift) = self.image.shift {
            write_number(writer, "shift", shift.get(), "of the position under its window in cam mode");
        }
        if self.image.known_programs().next().is_some() {
            writer.open("programs", '[');
            for (number, program) in self.image.known_programs() {
                self.write_program(writer, number, program);
            }
            writer.close(']');
        }
    }

    fn compare(&self, other: &Self) -> Comparison {
        let mut comparison = Comparison::default();
        for item in Item::writable_items() {
            comparison.compare_item(item.to_string(), self.image.get_value(item), other.image.get_value(item));
        }
        comparison
    }
}

impl InterbusProfile {
    fn write_parameters(&self, writer: &mut Writer) {
        let Parameters { steps, revolutions, direction, preset, zero_shift } = self.image.parameters;
        writer.open("parameters", '(');
        write_number(writer, "steps", steps, "over all turns: the measuring range");
        write_number(writer, "revolutions", revolutions, "");
        writer.text("direction", direction.keyword());
        write_number(writer, "preset", preset, "stored, never fired by a restore");
        write_number(writer, "zero_shift", zero_shift, "");
        writer.write_unknown(&self.unknown.parameters);
        writer.close(')');
    }

    fn write_program(&self, writer: &mut Writer, at: ProgramNumber, program: &Program) {
        writer.open("", '(');
        write_number(writer, "program", at.get(), "");
        name(writer, self.names.program(at));
        let active = CamNumber::all().filter(|cam| program.is_on(*cam)).map(|cam| cam.get().to_string());
        let active = active.collect::<Vec<_>>().join(", ");
        let comment = if active.is_empty() { "no cam works".to_owned() } else { format!("these cams work: {active}") };
        writer.entry("mask", &format!("0x{:02X}", program.mask), &comment);
        writer.open("cams", '[');
        for cam in CamNumber::all() {
            let Some(Cam { start, stop }) = program.cam(cam) else { continue };
            let called = match self.names.cam(at, cam) {
                "" => String::new(),
                called => format!(", name: {}", quote(called)),
            };
            let more = self.unknown.cams.get(&(at, cam)).map(entries_text).unwrap_or_default();
            let (cam, start, stop) = (cam.get(), start.get(), stop.get());
            writer.write_list_element(&format!("(cam: {cam}, start: {start}, stop: {stop}{called}{more})"));
        }
        writer.close(']');
        if let Some(unknown) = self.unknown.programs.get(&at) {
            writer.write_unknown(unknown);
        }
        writer.close(')');
    }
}

impl ProfileIdentity {
    fn write(&self, writer: &mut Writer) {
        writer.open("identity", '(');
        writer.text("serial_number", &self.serial_number);
        if let Some(flags) = self.flags {
            write_number(writer, "flags", flags.value().get(), flags.type_name());
        }
        writer.write_unknown(&self.unknown);
        writer.close(')');
    }
}

impl RecordedValues {
    fn write(&self, writer: &mut Writer) {
        writer.write_comment("recorded, neither compared nor restored");
        writer.open("recorded", '(');
        if let Some(version) = self.software_version {
            write_number(writer, "software_version", version, "");
        }
        if let Some(minutes) = self.operating_minutes {
            write_number(writer, "operating_minutes", minutes, "");
        }
        if let Some(tenths) = self.temperature_tenths {
            let celsius = format!("{:.1} °C", f64::from(tenths) / 10.0);
            writer.entry("temperature_tenths", &tenths.to_string(), &celsius);
        }
        if let Some(mode) = self.mode {
            write_number(writer, "startup_mode", mode.emit(), "");
        }
        if let Some(flag) = self.preset_flag {
            write_number(writer, "preset_flag", flag, "");
        }
        writer.write_unknown(&self.unknown);
        writer.close(')');
    }
}

fn write_number(writer: &mut Writer, name: &str, value: impl Into<u32>, comment: &str) {
    writer.entry(name, &value.into().to_string(), comment);
}

fn name(writer: &mut Writer, name: &str) {
    if !name.is_empty() {
        writer.text("name", name);
    }
}

fn read_identity(mut entries: Entries) -> Result<ProfileIdentity, ProfileError> {
    let serial_number = entries.take_optional("serial_number", AllowedValues::Text)?.unwrap_or_default();
    let flags = optional_value(&mut entries, "flags")?.map(Flags::new);
    Ok(ProfileIdentity { serial_number, flags, unknown: entries.into_unknown()? })
}

fn read_parameters(mut entries: Entries, unknown: &mut UnknownEntries) -> Result<Parameters, ProfileError> {
    let steps = value(&mut entries, "steps")?.get();
    let revolutions = value(&mut entries, "revolutions")?.get();
    let path = entries.entry_path("direction");
    let word: String = entries.take_required("direction", DIRECTION)?;
    let direction = word.parse::<Direction>().map_err(|_| ProfileError::Shape { path, expected: DIRECTION })?;
    let preset = value(&mut entries, "preset")?.get();
    let zero_shift = value(&mut entries, "zero_shift")?.get();
    unknown.parameters = entries.into_unknown()?;
    Ok(Parameters { steps, revolutions, direction, preset, zero_shift })
}

fn read_program(
    mut entries: Entries,
    names: &mut CamNames,
    unknown: &mut UnknownEntries,
) -> Result<(ProgramNumber, Program), ProfileError> {
    let path = entries.entry_path("program");
    let number: u32 = entries.take_required("program", AllowedValues::Whole)?;
    let at = u8::try_from(number).ok().and_then(ProgramNumber::new).ok_or_else(|| {
        ProfileError::invalid_entry(path, EntryError::Item(ItemError::Program { number: number.into() }))
    })?;
    names.set_program(at, entries.take_optional("name", AllowedValues::Text)?.unwrap_or_default());
    let mut program = Program { mask: entries.take_required("mask", AllowedValues::Byte)?, ..Program::default() };
    for mut entries in entries.take_structures("cams")? {
        let path = entries.entry_path("cam");
        let number: u32 = entries.take_required("cam", AllowedValues::Whole)?;
        let cam = u8::try_from(number).ok().and_then(CamNumber::new);
        let wrong = |error: EntryError| ProfileError::invalid_entry(path, error);
        let Some(cam) = cam else {
            return Err(wrong(ItemError::Cam { number: number.into() }.into()));
        };
        if program.cam(cam).is_some() {
            return Err(wrong(EntryError::CamTwice(cam)));
        }
        program.set_cam(cam, Some(Cam { start: value(&mut entries, "start")?, stop: value(&mut entries, "stop")? }));
        names.set_cam(at, cam, entries.take_optional("name", AllowedValues::Text)?.unwrap_or_default());
        insert_unknown_values(&mut unknown.cams, (at, cam), entries.into_unknown()?);
    }
    insert_unknown_values(&mut unknown.programs, at, entries.into_unknown()?);
    Ok((at, program))
}

fn insert_unknown_values<K: Ord>(
    kept: &mut std::collections::BTreeMap<K, UnknownValues>,
    place: K,
    unknown: UnknownValues,
) {
    if !unknown.is_empty() {
        kept.insert(place, unknown);
    }
}

fn parse_mounting_item(text: &str) -> Result<Item, EntryError> {
    match text.parse::<Item>() {
        Ok(item) if item.is_writable() => Ok(item),
        Ok(item) => Err(EntryError::Measured(item)),
        Err(error) => Err(error.into()),
    }
}

fn read_recorded(mut entries: Entries) -> Result<RecordedValues, ProfileError> {
    Ok(RecordedValues {
        software_version: entries.take_optional("software_version", AllowedValues::Whole)?,
        operating_minutes: entries.take_optional("operating_minutes", AllowedValues::Whole)?,
        temperature_tenths: entries.take_optional("temperature_tenths", AllowedValues::Whole)?,
        mode: optional_value(&mut entries, "startup_mode")?.map(StartupMode::parse),
        preset_flag: entries.take_optional("preset_flag", AllowedValues::Whole)?,
        unknown: entries.into_unknown()?,
    })
}

fn value(entries: &mut Entries, name: &str) -> Result<Value, ProfileError> {
    optional_value(entries, name)?.ok_or_else(|| ProfileError::Missing { path: entries.entry_path(name) })
}

fn optional_value(entries: &mut Entries, name: &str) -> Result<Option<Value>, ProfileError> {
    let Some(number) = entries.take_optional(name, NUMBER)? else { return Ok(None) };
    let shape = || ProfileError::Shape { path: entries.entry_path(name), expected: NUMBER };
    Value::new(number).ok_or_else(shape).map(Some)
}

fn window_shift(entries: &Entries, shift: u8) -> Result<WindowShift, ProfileError> {
    WindowShift::new(shift).ok_or_else(|| ProfileError::Shape { path: entries.entry_path("shift"), expected: SHIFT })
}

#[cfg(test)]
mod tests;
