//! Families of SSI encoders: user-extensible descriptions (RON, `assets/devices/ssi/`) with the frames that a family
//! can send, its timing and its additional signals. Pure data; [`Settings`] resolves the settings of a family.

mod sends;
mod setting_name;
mod settings;
#[cfg(test)]
mod tests;
mod text;

pub use setting_name::SettingName;
pub use settings::{Advice, ResolvedFrame, Settings, SettingsError};

use std::collections::BTreeMap;

use serde::Deserialize;

use super::code::Code;
use super::descriptor::{ErrorBit, Pattern};
use super::timing::Times;

/// A family.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Family {
    /// Key on the command line: `ahm36`.
    pub key: String,
    /// Name given by its maker.
    pub name: String,
    /// Source of this description.
    pub source: String,
    /// Length of a step in nanometres, if the position is a length. None: an angle.
    #[serde(default)]
    pub step_nanometres: Option<u32>,
    /// Bits of the revolutions: the least, the factory setting, the most. None: singleturn, or a length.
    #[serde(default)]
    pub multiturn: Option<(u8, u8, u8)>,
    /// Bits within a revolution, or of a length, likewise.
    pub singleturn: (u8, u8, u8),
    /// Most bits of both together, if that is less.
    #[serde(default)]
    pub together: Option<u8>,
    /// Numbers of steps that are no power of two.
    #[serde(default)]
    pub steps: Option<StepLimits>,
    /// Codes that the manual names, the factory setting first; others are accepted with a remark.
    pub codes: Vec<Code>,
    /// The possible alignments; the factory setting is the first with enough room.
    pub align: Vec<Align>,
    /// The whole frame can come one clock later.
    #[serde(default)]
    pub shift: bool,
    /// Frames by resolution: the first with room for the position counts.
    pub frames: Vec<Frame>,
    /// Words with a meaning of their own.
    #[serde(default)]
    pub patterns: Vec<Pattern>,
    /// The allowed times.
    pub times: Times,
    /// Signals besides SSI.
    #[serde(default)]
    pub signals: Vec<Signal>,
    /// Further notes for engineers, a sentence each.
    #[serde(default)]
    pub notes: Vec<String>,
    /// Source and notes in German, by the English words.
    #[serde(default)]
    pub german: BTreeMap<String, String>,
}

/// Limits of steps that are no power of two.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct StepLimits {
    /// Steps per turn.
    pub per_turn: u32,
    /// Altogether.
    pub total: u32,
    /// Number of turns of a round axis, as numerator and denominator; none: no round axis.
    #[serde(default)]
    pub revolutions: Option<(u32, u32)>,
}

/// A frame of a family.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Frame {
    /// Largest number of bits of the position.
    pub up_to: u8,
    /// Clocks of the position and its zeros; none: as many as the position has bits.
    #[serde(default)]
    pub area: Option<u8>,
    /// Error bits in their order; `clock` of the first is their fixed place.
    #[serde(default)]
    pub errors: Vec<ErrorBit>,
    /// The possible places of error bits, the factory setting first.
    #[serde(default)]
    pub place: Vec<ErrorPlace>,
    /// Most clocks of a burst; none: as many as the frame has bits.
    #[serde(default)]
    pub most_clocks: Option<u8>,
}

/// The alignment of the position in its area (reference section 3).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Align {
    /// Its first bit on clock 1.
    Left,
    /// Its last bit on clock 24.
    Right24,
    /// Its last bit on clock 25.
    Right25,
    /// Turns end on clock 12, steps begin on 13: zeros before and after ("Tannenbaum").
    #[serde(rename = "tree12_13")]
    Tree12,
    /// Turns end on clock 13, steps begin on 14.
    #[serde(rename = "tree13_12")]
    Tree13,
}

/// The place of error bits.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum ErrorPlace {
    /// Not sent, or not clocked in.
    None,
    /// On their own clocks, with any resolution.
    Fix,
    /// Immediately after the position's last bit.
    Following,
}

/// A signal in addition to SSI.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Signal {
    /// `sine/cosine 0.5 Vpp`, `TTL`, `HTL`.
    pub name: String,
    /// Volts peak to peak: least and most.
    #[serde(default)]
    pub amplitude_volts: Option<(f64, f64)>,
    /// Mean level in volts: least and most.
    #[serde(default)]
    pub offset_volts: Option<(f64, f64)>,
    /// Supply in volts: least and most.
    #[serde(default)]
    pub supply_volts: Option<(f64, f64)>,
}

/// A family that is invalid, and the position of the error.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{file}, line {line}, column {column}: {problem}")]
pub struct FamilyError {
    /// The file's name as given.
    pub file: String,
    /// Line, counted from 1.
    pub line: usize,
    /// Column, counted from 1.
    pub column: usize,
    /// The problem.
    pub problem: FamilyProblem,
}

/// The reason why a family is invalid.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum FamilyProblem {
    /// Not the RON expected, with the parser's message.
    #[error("{0}")]
    Parser(String),
    /// A key that is not possible on the command line.
    #[error("the key {0:?} may contain only lower-case letters, digits, - and _")]
    Key(String),
    /// German text for neither the source nor a note.
    #[error("german: {0:?} is neither the source nor a note")]
    German(String),
    /// A frame as delivered that cannot work.
    #[error("factory setting: {0}")]
    Delivered(SettingsError),
}

/// All known families.
#[derive(Clone, Debug, PartialEq)]
pub struct Families(Vec<Family>);

impl Family {
    /// Parses a family. `file` is its name for errors.
    ///
    /// # Errors
    /// Returns line and column: text that is not RON, unknown or missing keys; a key that is not possible on the command
    /// line, and a family whose frame with factory settings is not possible.
    pub fn parse(file: &str, text: &str) -> Result<Self, FamilyError> {
        let error = |line, column, what| FamilyError { file: file.to_owned(), line, column, problem: what };
        let family: Family = ron::from_str(text).map_err(|wrong| {
            error(wrong.span.start.line, wrong.span.start.col, FamilyProblem::Parser(wrong.code.to_string()))
        })?;
        let at = |entry| place(text, entry);
        let fits = |letter: char| letter.is_ascii_lowercase() || letter.is_ascii_digit() || matches!(letter, '-' | '_');
        if family.key.is_empty() || !family.key.chars().all(fits) {
            let (line, column) = at("key:");
            return Err(error(line, column, FamilyProblem::Key(family.key)));
        }
        if let Some(english) = family.german.keys().find(|own| **own != family.source && !family.notes.contains(own)) {
            let (line, column) = at("german:");
            return Err(error(line, column, FamilyProblem::German(english.clone())));
        }
        match Settings::default().resolve(&family) {
            Ok(_) => Ok(family),
            Err(wrong) => {
                let (line, column) = at("frames:");
                Err(error(line, column, FamilyProblem::Delivered(wrong)))
            }
        }
    }

    /// Returns the German of its source or a note; the English if the file has none.
    pub fn german<'f>(&'f self, english: &'f str) -> &'f str {
        self.german.get(english).map_or(english, String::as_str)
    }

    /// Returns the code as delivered.
    pub fn code(&self) -> Code {
        self.codes.first().copied().unwrap_or(Code::Binary)
    }
}

/// Returns line and column of the first line that begins with an entry, counted from 1; the beginning if there is none.
fn place(text: &str, entry: &str) -> (usize, usize) {
    let lines = text.lines().enumerate();
    let found = lines.filter(|(_, line)| line.trim_start().starts_with(entry)).map(|(at, line)| {
        let blanks = line.chars().take_while(|letter| letter.is_whitespace()).count();
        (at + 1, blanks + 1)
    });
    found.min().unwrap_or((1, 1))
}

impl Families {
    /// The families that ship with the program, with their files' names.
    pub const BUILT_IN: [(&'static str, &'static str); 11] = [
        ("ahs36.ron", include_str!("../../../../assets/devices/ssi/ahs36.ron")),
        ("ahm36.ron", include_str!("../../../../assets/devices/ssi/ahm36.ron")),
        ("afs60.ron", include_str!("../../../../assets/devices/ssi/afs60.ron")),
        ("afm60.ron", include_str!("../../../../assets/devices/ssi/afm60.ron")),
        ("afs60s.ron", include_str!("../../../../assets/devices/ssi/afs60s.ron")),
        ("afm60s.ron", include_str!("../../../../assets/devices/ssi/afm60s.ron")),
        ("atm60.ron", include_str!("../../../../assets/devices/ssi/atm60.ron")),
        ("atm90.ron", include_str!("../../../../assets/devices/ssi/atm90.ron")),
        ("ars60.ron", include_str!("../../../../assets/devices/ssi/ars60.ron")),
        ("ttk70.ron", include_str!("../../../../assets/devices/ssi/ttk70.ron")),
        ("kh53.ron", include_str!("../../../../assets/devices/ssi/kh53.ron")),
    ];

    /// Reads files; returns the reason for each that cannot be used, which does not affect the others.
    pub fn read<'a>(files: impl IntoIterator<Item = (&'a str, &'a str)>) -> (Self, Vec<FamilyError>) {
        let mut errors = Vec::new();
        let mut read = Vec::new();
        for (file, text) in files {
            match Family::parse(file, text) {
                Ok(family) => read.push(family),
                Err(error) => errors.push(error),
            }
        }
        (Families(read), errors)
    }

    /// Creates the built-in ones.
    pub fn built_in() -> Self {
        // A test checks that they can be read.
        Self::read(Self::BUILT_IN).0
    }

    /// Returns these families with those of `others`, which replace those with the same key.
    #[must_use]
    pub fn overlaid_with(self, others: Families) -> Self {
        let mut all = others.0;
        for family in self.0 {
            if all.iter().all(|known| known.key != family.key) {
                all.push(family);
            }
        }
        Families(all)
    }

    /// Returns the family with this key.
    pub fn named(&self, key: &str) -> Option<&Family> {
        self.0.iter().find(|family| family.key == key)
    }

    /// Returns all of them.
    pub fn iter(&self) -> impl Iterator<Item = &Family> {
        self.0.iter()
    }
}
