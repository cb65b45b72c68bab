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
    /// Product name given by the manufacturer.
    pub name: String,
    /// Source of this description.
    pub source: String,
    /// Length of a step in nanometres for linear encoders, or `None` for rotary ones.
    #[serde(default)]
    pub step_nanometres: Option<u32>,
    /// Minimum, factory and maximum width of the multiturn part in bits; `None` for singleturn and linear encoders.
    #[serde(default)]
    pub multiturn: Option<(u8, u8, u8)>,
    /// Minimum, factory and maximum width in bits of the singleturn part or of a linear position.
    pub singleturn: (u8, u8, u8),
    /// Maximum total width in bits, if below the sum of both parts.
    #[serde(default)]
    pub together: Option<u8>,
    /// Limits for numbers of steps that are not powers of two, if supported.
    #[serde(default)]
    pub steps: Option<StepLimits>,
    /// Codes named in the manual, starting with the factory setting. Other codes are accepted with a remark.
    pub codes: Vec<Code>,
    /// Possible alignments. The factory setting is the first one with enough room for the position.
    pub align: Vec<Align>,
    /// Whether the whole frame can be delayed by one clock.
    #[serde(default)]
    pub shift: bool,
    /// Frames by resolution. The first one with room for the position applies.
    pub frames: Vec<Frame>,
    /// Words with a special meaning.
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
    /// German translations of the source and the notes, keyed by the English text.
    #[serde(default)]
    pub german: BTreeMap<String, String>,
}

/// Limits for numbers of steps that are not powers of two.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct StepLimits {
    /// Steps per turn.
    pub per_turn: u32,
    /// Altogether.
    pub total: u32,
    /// Number of turns of a round axis as numerator and denominator, or `None` without a round axis.
    #[serde(default)]
    pub revolutions: Option<(u32, u32)>,
}

/// Frame that a family sends.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Frame {
    /// Maximum width in bits of a position that fits into the frame.
    pub up_to: u8,
    /// Number of clocks for the position and its zeros, or `None` for exactly as many as the position has bits.
    #[serde(default)]
    pub area: Option<u8>,
    /// Error bits in order. The `clock` of the first one is their fixed location.
    #[serde(default)]
    pub errors: Vec<ErrorBit>,
    /// Possible locations of the error bits, starting with the factory setting.
    #[serde(default)]
    pub place: Vec<ErrorPlace>,
    /// Maximum number of clocks in a burst, or `None` for exactly as many as the frame has bits.
    #[serde(default)]
    pub most_clocks: Option<u8>,
}

/// The alignment of the position in its area (reference section 3).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Align {
    /// The first position bit is on clock 1.
    Left,
    /// The last position bit is on clock 24.
    Right24,
    /// The last position bit is on clock 25.
    Right25,
    /// Tree format ("Tannenbaum") with turns ending on clock 12 and steps beginning on clock 13, and zeros on both
    /// sides.
    #[serde(rename = "tree12_13")]
    Tree12,
    /// Tree format with turns ending on clock 13 and steps beginning on clock 14.
    #[serde(rename = "tree13_12")]
    Tree13,
}

/// Location of the error bits.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum ErrorPlace {
    /// Error bits are not sent, or not clocked in.
    None,
    /// Error bits are on fixed clocks at any resolution.
    Fix,
    /// Error bits directly follow the last position bit.
    Following,
}

/// A signal in addition to SSI.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Signal {
    /// Name of the signal, such as `sine/cosine 0.5 Vpp`, `TTL` or `HTL`.
    pub name: String,
    /// Minimum and maximum peak-to-peak amplitude in volts.
    #[serde(default)]
    pub amplitude_volts: Option<(f64, f64)>,
    /// Minimum and maximum mean level in volts.
    #[serde(default)]
    pub offset_volts: Option<(f64, f64)>,
    /// Minimum and maximum supply voltage in volts.
    #[serde(default)]
    pub supply_volts: Option<(f64, f64)>,
}

/// Error in a family file, with its position.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{file}, line {line}, column {column}: {problem}")]
pub struct FamilyError {
    /// File name as given by the caller.
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
    /// The file is not valid RON or lacks the expected structure, with the parser's message.
    #[error("{0}")]
    Parser(String),
    /// The key cannot be used on the command line.
    #[error("the key {0:?} may contain only lower-case letters, digits, - and _")]
    Key(String),
    /// A German text translates neither the source nor a note.
    #[error("german: {0:?} is neither the source nor a note")]
    German(String),
    /// The frame with factory settings is invalid.
    #[error("factory setting: {0}")]
    Delivered(SettingsError),
}

/// All known families.
#[derive(Clone, Debug, PartialEq)]
pub struct Families(Vec<Family>);

impl Family {
    /// Parses a family. `file` is the name used in errors.
    ///
    /// # Errors
    /// Invalid RON, unknown or missing keys, a key that cannot be used on the command line, or an invalid frame with
    /// factory settings. The error contains line and column.
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

    /// Returns the German translation of the family's source or a note, or the English text if there is none.
    pub fn german<'f>(&'f self, english: &'f str) -> &'f str {
        self.german.get(english).map_or(english, String::as_str)
    }

    /// Returns the factory setting of the code.
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
    /// Built-in families, with their file names.
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

    /// Reads families from files, and returns an error for each unusable file. The other files are not affected.
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

    /// Returns these families combined with `others`, which replace families with the same key.
    #[must_use]
    pub fn merged_with(self, others: Families) -> Self {
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
