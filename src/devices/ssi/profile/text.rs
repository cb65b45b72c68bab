//! The text format of an SSI profile, which users can read and edit. Default values are omitted. Each error names the
//! entry that caused it, and an invalid frame is rejected with the reason.

use std::collections::VecDeque;
use std::str::FromStr;

use ron::Value;

use super::{EntryError, ReadingSettings, SsiProfile, UnknownEntries};
use crate::devices::ssi::protocol::{
    self, Code, Direction, ErrorBit, Fraction, FrameDescriptor, GrayCoverage, Layout, Parity, Pattern, PositionCode,
    Range, Repeat, Word,
};
use crate::expected::AllowedValues;
use crate::profile::ron_text::{Entries, UnknownValues, Writer, entries_text, quote};
use crate::profile::{Comparison, Profile, ProfileError};

const BYTE_RANGE: AllowedValues = AllowedValues::whole_range(0, 255);
const FLAG: AllowedValues = AllowedValues::words(&["true", "false"]);
const CLOCK_HZ: AllowedValues = AllowedValues::whole_range(1000, 20_000_000);
const PAUSE_US: AllowedValues = AllowedValues::whole_range(1, 65_535);
const METRES: AllowedValues = AllowedValues::whole_range(0, 65_535);
/// Keyword for a pattern that consists only of ones.
const ALL_ONES: &str = "ones";

impl Profile for SsiProfile {
    const KIND: &'static str = protocol::KIND;

    fn read(entries: &mut Entries) -> Result<Self, ProfileError> {
        let name = entries.take_optional("name", AllowedValues::Text)?.unwrap_or_default();
        // Keys are in lower case, but a user may write the product name.
        let family = entries.take_optional("family", AllowedValues::Text)?.map(|key: String| key.to_ascii_lowercase());
        let mut unknown = UnknownEntries::default();
        let path = entries.entry_path("frame");
        let descriptor = read_frame(entries.take_structure("frame")?, &mut unknown)?;
        let refused = |error| ProfileError::invalid_entry(path, EntryError::Layout(error));
        let layout = Layout::new(descriptor.clone()).map_err(refused)?;
        let direction = take_keyword(entries, "direction")?.unwrap_or_default();
        let preset = entries.take_optional("preset", AllowedValues::Whole)?.unwrap_or(0);
        let last = layout.position_code().last_position();
        if preset > last {
            return Err(ProfileError::invalid_entry(entries.entry_path("preset"), EntryError::Preset { preset, last }));
        }
        let reading = match entries.optional_structure("reading")? {
            Some(entries) => parse_reading_settings(entries, &mut unknown)?,
            None => ReadingSettings::default(),
        };
        Ok(SsiProfile { name, family, descriptor, direction, preset, reading, unknown })
    }

    fn write(&self, writer: &mut Writer) {
        if !self.name.is_empty() {
            writer.text("name", &self.name);
        }
        if let Some(family) = &self.family {
            writer.text("family", family);
        }
        self.write_frame(writer);
        if self.direction != Direction::default() {
            writer.text("direction", &self.direction.to_string());
        }
        if self.preset != 0 {
            writer.entry("preset", &self.preset.to_string(), "");
        }
        self.write_reading(writer);
    }

    fn compare(&self, other: &Self) -> Comparison {
        super::compare::compare(self, other)
    }
}

impl SsiProfile {
    fn write_frame(&self, writer: &mut Writer) {
        let frame = &self.descriptor;
        writer.open("frame", '(');
        write_number(writer, "clocks", frame.clocks);
        write_range(writer, &frame.range);
        if frame.code != Code::Binary {
            writer.text("code", &frame.code.to_string());
        }
        if frame.coded != GrayCoverage::Position {
            writer.text("over", &frame.coded.to_string());
        }
        if frame.area != default_area_clocks(frame) {
            write_number(writer, "area", frame.area);
        }
        for (name, zeros) in [("lead", frame.lead), ("between", frame.between)] {
            if zeros > 0 {
                write_number(writer, name, zeros);
            }
        }
        for (name, is_set) in [("shift", frame.shift_right), ("inverted", frame.inverted)] {
            if is_set {
                writer.entry(name, "true", "");
            }
        }
        self.write_errors(writer);
        if let Some(Parity { clock, even }) = frame.parity {
            let more = entries_text(&self.unknown.parity);
            writer.entry("parity", &format!("(clock: {clock}, even: {even}{more})"), "");
        }
        if let Some(Repeat { word, gap }) = frame.repeat {
            let more = entries_text(&self.unknown.repeat);
            writer.entry("repeat", &format!("(word: {word}, gap: {gap}{more})"), "");
        }
        self.write_patterns(writer);
        writer.write_unknown(&self.unknown.frame);
        writer.close(')');
    }

    fn write_errors(&self, writer: &mut Writer) {
        let mut kept: VecDeque<_> = self.unknown.errors.iter().collect();
        let line = |bit: &ErrorBit| {
            let (name, clock, meaning) = (quote(&bit.name), bit.clock, bit.meaning);
            let low = if bit.active_low { ", active_low: true" } else { "" };
            let cleared = if bit.cleared_by_transfer { ", cleared_by_transfer: true" } else { "" };
            let more = entries_text(&take_unknown_values_by_name(&mut kept, &bit.name));
            format!("(name: {name}, clock: {clock}, meaning: \"{meaning}\"{low}{cleared}{more})")
        };
        write_list(writer, "errors", self.descriptor.errors.iter().map(line));
    }

    fn write_patterns(&self, writer: &mut Writer) {
        let mut kept: VecDeque<_> = self.unknown.patterns.iter().collect();
        let digits = usize::from(self.descriptor.clocks).div_ceil(4);
        let line = |pattern: &Pattern| {
            let (name, meaning) = (quote(&pattern.name), pattern.meaning);
            let word = match pattern.word {
                Word::Ones => quote(ALL_ONES),
                Word::Bits(bits) => format!("0x{bits:0digits$X}"),
            };
            let more = entries_text(&take_unknown_values_by_name(&mut kept, &pattern.name));
            format!("(name: {name}, word: {word}, meaning: \"{meaning}\"{more})")
        };
        write_list(writer, "patterns", self.descriptor.patterns.iter().map(line));
    }

    fn write_reading(&self, writer: &mut Writer) {
        let (reading, usual) = (self.reading, ReadingSettings::default());
        if reading == usual && self.unknown.reading.is_empty() {
            return;
        }
        writer.open("reading", '(');
        if reading.clock_hz != usual.clock_hz {
            write_number(writer, "clock_hz", reading.clock_hz);
        }
        if reading.pause_us != usual.pause_us {
            write_number(writer, "pause_us", reading.pause_us);
        }
        if let Some(metres) = reading.cable_metres {
            write_number(writer, "cable_metres", metres);
        }
        if reading.synchronous {
            writer.entry("synchronous", "true", "");
        }
        writer.write_unknown(&self.unknown.reading);
        writer.close(')');
    }
}

fn write_number(writer: &mut Writer, name: &str, value: impl Into<u64>) {
    writer.entry(name, &value.into().to_string(), "");
}

fn write_range(writer: &mut Writer, range: &Range) {
    match *range {
        Range::Bits { multiturn, singleturn } => {
            if multiturn > 0 {
                write_number(writer, "multiturn", multiturn);
            }
            write_number(writer, "singleturn", singleturn);
        }
        Range::Steps { per_turn, turns } => {
            write_number(writer, "steps", per_turn);
            if turns != 1 {
                write_number(writer, "turns", turns);
            }
        }
        Range::RoundAxis { steps, revolutions } => {
            write_number(writer, "steps", steps);
            writer.text("revolutions", &revolutions.to_string());
        }
        Range::Length { bits, step_nanometres } => {
            write_number(writer, "bits", bits);
            write_number(writer, "step_nanometres", step_nanometres);
        }
    }
}

fn write_list(writer: &mut Writer, name: &str, lines: impl ExactSizeIterator<Item = String>) {
    if lines.len() > 0 {
        writer.open(name, '[');
        lines.for_each(|line| writer.write_list_element(&line));
        writer.close(']');
    }
}

fn take_unknown_values_by_name(kept: &mut VecDeque<&(String, UnknownValues)>, name: &str) -> UnknownValues {
    let at = kept.iter().position(|(own, _)| own == name);
    at.and_then(|at| kept.remove(at)).map(|(_, unknown)| unknown.clone()).unwrap_or_default()
}

/// Returns the number of clocks for the position, without the zeros after it.
fn default_area_clocks(frame: &FrameDescriptor) -> u8 {
    let coding = frame.range.last_position().ok().and_then(|last| PositionCode::new(frame.code, last).ok());
    let bits = coding.map_or(0, |coding| coding.bits());
    bits.saturating_add(frame.lead).saturating_add(frame.between)
}

fn read_frame(mut entries: Entries, unknown: &mut UnknownEntries) -> Result<FrameDescriptor, ProfileError> {
    let mut frame = FrameDescriptor {
        clocks: entries.take_required("clocks", BYTE_RANGE)?,
        range: read_range(&mut entries)?,
        code: take_keyword(&mut entries, "code")?.unwrap_or(Code::Binary),
        coded: take_keyword(&mut entries, "over")?.unwrap_or(GrayCoverage::Position),
        area: 0,
        lead: entries.take_optional("lead", BYTE_RANGE)?.unwrap_or(0),
        between: entries.take_optional("between", BYTE_RANGE)?.unwrap_or(0),
        shift_right: entries.take_optional("shift", FLAG)?.unwrap_or(false),
        errors: Vec::new(),
        parity: None,
        repeat: None,
        inverted: entries.take_optional("inverted", FLAG)?.unwrap_or(false),
        patterns: Vec::new(),
    };
    frame.area = entries.take_optional("area", BYTE_RANGE)?.unwrap_or_else(|| default_area_clocks(&frame));
    for entries in entries.take_structures("errors")? {
        let (bit, more) = read_error(entries)?;
        unknown.errors.push((bit.name.clone(), more));
        frame.errors.push(bit);
    }
    if let Some(mut entries) = entries.optional_structure("parity")? {
        let clock = entries.take_required("clock", BYTE_RANGE)?;
        frame.parity = Some(Parity { clock, even: entries.take_required("even", FLAG)? });
        unknown.parity = entries.into_unknown()?;
    }
    if let Some(mut entries) = entries.optional_structure("repeat")? {
        let word = entries.take_required("word", BYTE_RANGE)?;
        frame.repeat = Some(Repeat { word, gap: entries.take_optional("gap", BYTE_RANGE)?.unwrap_or(1) });
        unknown.repeat = entries.into_unknown()?;
    }
    for entries in entries.take_structures("patterns")? {
        let (pattern, more) = read_pattern(entries)?;
        unknown.patterns.push((pattern.name.clone(), more));
        frame.patterns.push(pattern);
    }
    unknown.errors.retain(|(_, more)| !more.is_empty());
    unknown.patterns.retain(|(_, more)| !more.is_empty());
    unknown.frame = entries.into_unknown()?;
    Ok(frame)
}

/// Parses the range of positions, which is given by turn and step bits, a number of steps, or a length.
fn read_range(entries: &mut Entries) -> Result<Range, ProfileError> {
    let multiturn: Option<u8> = entries.take_optional("multiturn", BYTE_RANGE)?;
    let singleturn: Option<u8> = entries.take_optional("singleturn", BYTE_RANGE)?;
    let steps: Option<u32> = entries.take_optional("steps", AllowedValues::Whole)?;
    let turns: Option<u32> = entries.take_optional("turns", AllowedValues::Whole)?;
    let revolutions = read_revolutions(entries)?;
    let bits: Option<u8> = entries.take_optional("bits", BYTE_RANGE)?;
    let step_nanometres: Option<u32> = entries.take_optional("step_nanometres", AllowedValues::Whole)?;
    let given = [
        ("singleturn", singleturn.is_some()),
        ("multiturn", multiturn.is_some()),
        ("steps", steps.is_some()),
        ("turns", turns.is_some()),
        ("revolutions", revolutions.is_some()),
        ("bits", bits.is_some()),
        ("step_nanometres", step_nanometres.is_some()),
    ];
    // The other entries must match the one that selects the kind of range.
    let only = |own: &'static str, others: &[&str]| {
        let other = given.iter().find(|(name, is_given)| *is_given && *name != own && !others.contains(name));
        match other {
            None => Ok(()),
            Some((name, _)) => Err(ProfileError::invalid_entry(entries.entry_path(name), EntryError::NotWith(own))),
        }
    };
    match (singleturn, steps, bits) {
        (Some(singleturn), _, _) => {
            only("singleturn", &["multiturn"])?;
            Ok(Range::Bits { multiturn: multiturn.unwrap_or(0), singleturn })
        }
        (None, Some(steps), _) => match revolutions {
            Some(revolutions) => {
                only("steps", &["revolutions"])?;
                Ok(Range::RoundAxis { steps, revolutions })
            }
            None => {
                only("steps", &["turns"])?;
                Ok(Range::Steps { per_turn: steps, turns: turns.unwrap_or(1) })
            }
        },
        (None, None, Some(bits)) => {
            only("bits", &["step_nanometres"])?;
            let missing = || ProfileError::Missing { path: entries.entry_path("step_nanometres") };
            Ok(Range::Length { bits, step_nanometres: step_nanometres.ok_or_else(missing)? })
        }
        (None, None, None) => Err(ProfileError::invalid_entry(entries.path().to_owned(), EntryError::NoPositions)),
    }
}

fn read_revolutions(entries: &mut Entries) -> Result<Option<Fraction>, ProfileError> {
    let path = entries.entry_path("revolutions");
    let Some(value) = entries.take_optional::<Value>("revolutions", AllowedValues::Revolutions)? else {
        return Ok(None);
    };
    let revolutions = match value {
        Value::String(text) => text.parse().ok(),
        value => value.into_rust().ok().map(|numerator| Fraction { numerator, denominator: 1 }),
    };
    revolutions.map(Some).ok_or(ProfileError::Shape { path, expected: AllowedValues::Revolutions })
}

fn read_error(mut entries: Entries) -> Result<(ErrorBit, UnknownValues), ProfileError> {
    let bit = ErrorBit {
        name: entries.take_required("name", AllowedValues::Text)?,
        clock: entries.take_required("clock", BYTE_RANGE)?,
        meaning: required_word(&mut entries, "meaning")?,
        active_low: entries.take_optional("active_low", FLAG)?.unwrap_or(false),
        cleared_by_transfer: entries.take_optional("cleared_by_transfer", FLAG)?.unwrap_or(false),
    };
    Ok((bit, entries.into_unknown()?))
}

fn read_pattern(mut entries: Entries) -> Result<(Pattern, UnknownValues), ProfileError> {
    let wrong = |path| ProfileError::Shape { path, expected: AllowedValues::Frame };
    let path = entries.entry_path("word");
    let word = match entries.take_required::<Value>("word", AllowedValues::Frame)? {
        Value::String(word) if word == ALL_ONES => Word::Ones,
        value => Word::Bits(value.into_rust().map_err(|_| wrong(path))?),
    };
    let name = entries.take_required("name", AllowedValues::Text)?;
    Ok((Pattern { name, word, meaning: required_word(&mut entries, "meaning")? }, entries.into_unknown()?))
}

fn parse_reading_settings(mut entries: Entries, unknown: &mut UnknownEntries) -> Result<ReadingSettings, ProfileError> {
    let usual = ReadingSettings::default();
    let clock_hz = entries.take_optional("clock_hz", CLOCK_HZ)?.unwrap_or(usual.clock_hz);
    if !(1_000..=20_000_000).contains(&clock_hz) {
        return Err(ProfileError::Shape { path: entries.entry_path("clock_hz"), expected: CLOCK_HZ });
    }
    let pause_us = entries.take_optional("pause_us", PAUSE_US)?.unwrap_or(usual.pause_us);
    if pause_us == 0 {
        return Err(ProfileError::Shape { path: entries.entry_path("pause_us"), expected: PAUSE_US });
    }
    let cable_metres = entries.take_optional("cable_metres", METRES)?;
    let synchronous = entries.take_optional("synchronous", FLAG)?.unwrap_or(usual.synchronous);
    unknown.reading = entries.into_unknown()?;
    Ok(ReadingSettings { clock_hz, pause_us, cable_metres, synchronous })
}

/// Parses an entry whose value is a keyword from a fixed set.
fn take_keyword<T: FromStr<Err = AllowedValues>>(entries: &mut Entries, name: &str) -> Result<Option<T>, ProfileError> {
    let path = entries.entry_path(name);
    let Some(word) = entries.take_optional::<String>(name, AllowedValues::Text)? else { return Ok(None) };
    word.parse().map(Some).map_err(|expected| ProfileError::Shape { path, expected })
}

fn required_word<T: FromStr<Err = AllowedValues>>(entries: &mut Entries, name: &str) -> Result<T, ProfileError> {
    take_keyword(entries, name)?.ok_or_else(|| ProfileError::Missing { path: entries.entry_path(name) })
}

#[cfg(test)]
mod tests;
