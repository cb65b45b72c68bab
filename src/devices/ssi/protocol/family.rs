//! Families of SSI encoders, described in RON files in `assets/devices/ssi/` and in the user's folder. A description
//! contains the frames that a family can send, its timing and its additional signals. [`Settings`] selects one of the
//! frames.

mod setting_name;
mod settings;
mod settings_search;
#[cfg(test)]
mod tests;
mod text;

pub use setting_name::SettingName;
pub use settings::{ResolvedFrame, SettingAdvice, Settings, SettingsError};

use std::collections::BTreeMap;

use serde::Deserialize;

use super::code::Code;
use super::descriptor::{ErrorBit, Pattern};
use super::timing::Times;

/// A family of SSI encoders with the frames, timing limits and signals that they have in common.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Family {
    /// Key of the family on the command line, such as `ahm36`.
    pub key: String,
    /// Product name used by the manufacturer.
    pub name: String,
    /// Document on which the description is based.
    pub source: String,
    /// Length of a step in nanometres. It is `None` for rotary encoders.
    #[serde(default)]
    pub step_nanometres: Option<u32>,
    /// Minimum, factory and maximum width of the multiturn part in bits. It is `None` for singleturn and linear
    /// encoders.
    #[serde(default)]
    pub multiturn: Option<(u8, u8, u8)>,
    /// Minimum, factory and maximum width of the singleturn part, or of a linear position, in bits.
    pub singleturn: (u8, u8, u8),
    /// Maximum width of the position in bits, if it is less than the multiturn and singleturn widths together.
    #[serde(default)]
    pub together: Option<u8>,
    /// Limits for a number of steps that is not a power of two.
    #[serde(default)]
    pub steps: Option<StepLimits>,
    /// Codes named in the manual, starting with the factory setting. Other codes are accepted with a remark.
    pub codes: Vec<Code>,
    /// Possible alignments. The factory setting is the first one with enough room for the position.
    pub align: Vec<Alignment>,
    /// Whether the position can be delayed by one clock.
    #[serde(default)]
    pub shift: bool,
    /// Frames in ascending order of their maximum position width. The first one with enough room for the position is
    /// used.
    pub frames: Vec<Frame>,
    /// Words that have a special meaning and are not a position.
    #[serde(default)]
    pub patterns: Vec<Pattern>,
    /// Timing limits of the encoder.
    pub times: Times,
    /// Signals that the encoder outputs in addition to SSI.
    #[serde(default)]
    pub signals: Vec<Signal>,
    /// Further notes for the user, one sentence each.
    #[serde(default)]
    pub notes: Vec<String>,
    /// German translations of the source and the notes, keyed by the English text.
    #[serde(default)]
    pub german: BTreeMap<String, String>,
}

/// Limits for a number of steps that is not a power of two.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct StepLimits {
    /// Maximum number of steps per turn.
    pub per_turn: u32,
    /// Maximum number of steps in total.
    pub total: u32,
    /// Maximum numerator and denominator of the number of turns on a round axis, or `None` if the family does not
    /// support round axes.
    #[serde(default)]
    pub revolutions: Option<(u32, u32)>,
}

/// A frame that a family sends up to a certain position width.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Frame {
    /// Maximum width of the position in bits for this frame.
    pub up_to: u8,
    /// Number of clocks for the position and the zeros around it. `None` means one clock per bit of the position.
    #[serde(default)]
    pub area: Option<u8>,
    /// Error bits in transmission order. If their location is fixed, the `clock` of the first one is used.
    #[serde(default)]
    pub errors: Vec<ErrorBit>,
    /// Possible locations of the error bits, starting with the factory setting.
    #[serde(default)]
    pub place: Vec<ErrorPlace>,
    /// Maximum number of clocks in a burst. `None` means that more clocks are accepted with a remark.
    #[serde(default)]
    pub most_clocks: Option<u8>,
}

/// Alignment of the position in its area. See reference section 3.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Alignment {
    /// The first position bit is on clock 1.
    Left,
    /// The last position bit is on clock 24.
    Right24,
    /// The last position bit is on clock 25.
    Right25,
    /// Tree format ("Tannenbaum"): turns end on clock 12 and steps begin on clock 13. Zeros fill the clocks on both
    /// sides.
    #[serde(rename = "tree12_13")]
    Tree12,
    /// Tree format: turns end on clock 13 and steps begin on clock 14.
    #[serde(rename = "tree13_12")]
    Tree13,
}

/// Location of the error bits in a frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum ErrorPlace {
    /// Error bits are not sent, or the host does not clock them in.
    None,
    /// Error bits are always on the same clocks, regardless of the resolution.
    Fix,
    /// Error bits directly follow the last position bit.
    Following,
}

/// A signal that an encoder outputs in addition to SSI.
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

/// An error in a family file, with its line and column.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{file}, line {line}, column {column}: {problem}")]
pub struct FamilyError {
    /// File name as given by the caller.
    pub file: String,
    /// Line, counted from 1.
    pub line: usize,
    /// Column, counted from 1.
    pub column: usize,
    /// Reason why the file is rejected.
    pub problem: FamilyProblem,
}

/// The reason why a family file is rejected.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum FamilyProblem {
    /// The file is not valid RON or lacks the expected structure. Contains the parser's message.
    #[error("{0}")]
    Parser(String),
    /// The key cannot be used on the command line.
    #[error("the key {0:?} may contain only lower-case letters, digits, - and _")]
    Key(String),
    /// A German text is not the translation of the source or a note.
    #[error("german: {0:?} is neither the source nor one of the notes of the family")]
    German(String),
    /// The factory settings do not yield a valid frame.
    #[error("factory setting: {0}")]
    Delivered(SettingsError),
}

/// The known encoder families.
#[derive(Clone, Debug, PartialEq)]
pub struct Families(Vec<Family>);

impl Family {
    /// Parses a family. `file` is the name used in errors.
    ///
    /// # Errors
    /// Returns an error with line and column if the text is not valid RON, if a key is unknown or missing, if the
    /// family key cannot be used on the command line, or if the factory settings do not result in a valid frame.
    pub fn parse(file: &str, text: &str) -> Result<Self, FamilyError> {
        let error = |line, column, what| FamilyError { file: file.to_owned(), line, column, problem: what };
        let family: Family = ron::from_str(text).map_err(|wrong| {
            error(wrong.span.start.line, wrong.span.start.col, FamilyProblem::Parser(wrong.code.to_string()))
        })?;
        let at = |entry| locate_entry(text, entry);
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
    pub fn german_or_english<'f>(&'f self, english: &'f str) -> &'f str {
        self.german.get(english).map_or(english, String::as_str)
    }

    /// Returns the position code of the factory settings.
    pub fn code(&self) -> Code {
        self.codes.first().copied().unwrap_or(Code::Binary)
    }
}

/// Returns the line and the column of the first line that begins with `entry`, both counted from 1. Both are 1 if there
/// is no such line.
fn locate_entry(text: &str, entry: &str) -> (usize, usize) {
    let lines = text.lines().enumerate();
    let found = lines.filter(|(_, line)| line.trim_start().starts_with(entry)).map(|(at, line)| {
        let blanks = line.chars().take_while(|letter| letter.is_whitespace()).count();
        (at + 1, blanks + 1)
    });
    found.min().unwrap_or((1, 1))
}

impl Families {
    /// File names and contents of the built-in families.
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

    /// Parses family files from their names and contents. Invalid files are skipped, and an error is returned for each
    /// of them.
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

    /// Parses and returns the built-in families.
    pub fn built_in() -> Self {
        // A test checks that they can be read.
        Self::read(Self::BUILT_IN).0
    }

    /// Returns these families together with `others`. A family in `others` replaces a family with the same key.
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

    /// Returns the family with the given key, if any.
    pub fn find_by_key(&self, key: &str) -> Option<&Family> {
        self.0.iter().find(|family| family.key == key)
    }

    /// Returns an iterator over all families.
    pub fn iter(&self) -> impl Iterator<Item = &Family> {
        self.0.iter()
    }
}
