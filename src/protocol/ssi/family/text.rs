//! A family and its settings in one word: `ahm36,code=gray,st=12`.

use std::fmt;
use std::str::FromStr;

use super::{Align, ErrorPlace, Settings};
use crate::protocol::ssi::code::Code;
use crate::protocol::ssi::descriptor::Coded;
use crate::protocol::ssi::range::Fraction;

/// Why a text is no layout.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum TextError {
    /// No `name=value`.
    #[error("\"{0}\" is not NAME=VALUE; names: {names}", names = NAMES.join(", "))]
    Form(String),
    /// A name that is none.
    #[error("there is no \"{0}\"; names: {names}", names = NAMES.join(", "))]
    Name(String),
    /// A value that is none.
    #[error("{name} must be {expected}, not \"{value}\"")]
    Value {
        /// Of which name.
        name: String,
        /// What it may be.
        expected: &'static str,
        /// What it is.
        value: String,
    },
    /// The same twice.
    #[error("{0} is given twice")]
    Twice(String),
}

const NAMES: [&str; 12] =
    ["code", "over", "mt", "st", "steps", "turns", "revolutions", "clocks", "align", "shift", "err", "step"];

impl Settings {
    /// Splits `ahm36,code=gray,st=12` into the family's key and its settings.
    ///
    /// # Errors
    /// [`TextError`], with what may stand there.
    pub fn parse(text: &str) -> Result<(String, Self), TextError> {
        let mut words = text.split(',').map(str::trim);
        let key = words.next().unwrap_or_default().to_ascii_lowercase();
        let mut settings = Settings::default();
        let mut seen: Vec<&str> = Vec::new();
        for word in words.filter(|word| !word.is_empty()) {
            let (name, value) = word.split_once('=').ok_or_else(|| TextError::Form(word.to_owned()))?;
            let (name, value) = (name.trim(), value.trim());
            if seen.contains(&name) {
                return Err(TextError::Twice(name.to_owned()));
            }
            seen.push(name);
            settings.set(name, value)?;
        }
        Ok((key, settings))
    }

    fn set(&mut self, name: &str, value: &str) -> Result<(), TextError> {
        let wrong = |expected| TextError::Value { name: name.to_owned(), expected, value: value.to_owned() };
        let small = || value.parse::<u8>().map_err(|_| wrong("a number from 0 to 255"));
        let number = || value.parse::<u32>().map_err(|_| wrong("a whole number"));
        match name {
            "code" => self.code = Some(value.parse().map_err(wrong)?),
            "over" => {
                self.coded = Some(match value {
                    "position" => Coded::Position,
                    "padded" => Coded::Area,
                    "errors" => Coded::AreaAndErrors,
                    _ => return Err(wrong("position, padded or errors")),
                });
            }
            "mt" => self.multiturn = Some(small()?),
            "st" => self.singleturn = Some(small()?),
            "steps" => self.steps = Some(number()?),
            "turns" => self.turns = Some(number()?),
            "revolutions" => {
                let (above, below) = value.split_once('/').unwrap_or((value, "1"));
                let part = |text: &str| text.trim().parse().map_err(|_| wrong("a number or a fraction such as 25/2"));
                self.revolutions = Some(Fraction { numerator: part(above)?, denominator: part(below)? });
            }
            "clocks" => self.clocks = Some(small()?),
            "align" => self.align = Some(value.parse().map_err(wrong)?),
            "shift" => {
                self.shift = match value {
                    "0" => false,
                    "1" => true,
                    _ => return Err(wrong("0 or 1")),
                };
            }
            "err" => self.errors = Some(value.parse().map_err(wrong)?),
            "step" => self.step_nanometres = Some(number()?),
            _ => return Err(TextError::Name(name.to_owned())),
        }
        Ok(())
    }
}

/// What stands for a value in text: the word, and others that are understood.
trait Words: Copy + PartialEq + 'static {
    const ALL: &'static [(&'static str, Self)];

    fn word(self) -> &'static str {
        Self::ALL.iter().find(|(_, value)| *value == self).map_or("", |(word, _)| word)
    }

    fn named(word: &str) -> Option<Self> {
        Self::ALL.iter().find(|(known, _)| *known == word).map(|(_, value)| *value)
    }
}

impl Words for Code {
    const ALL: &'static [(&'static str, Self)] = &[
        ("binary", Code::Binary),
        ("bin", Code::Binary),
        ("gray", Code::Gray),
        ("gray-excess", Code::GrayExcess),
        ("bcd", Code::Bcd),
    ];
}

impl Words for Align {
    const ALL: &'static [(&'static str, Self)] = &[
        ("left", Align::Left),
        ("right24", Align::Right24),
        ("right25", Align::Right25),
        ("tree12_13", Align::Tree12),
        ("tree13_12", Align::Tree13),
    ];
}

impl Words for ErrorPlace {
    const ALL: &'static [(&'static str, Self)] =
        &[("none", ErrorPlace::None), ("fix", ErrorPlace::Fix), ("following", ErrorPlace::Following)];
}

/// Text for a value and back; the error says what may stand there.
macro_rules! in_words {
    ($($type:ty: $expected:literal,)*) => {$(
        impl fmt::Display for $type {
            fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str(self.word())
            }
        }

        impl FromStr for $type {
            type Err = &'static str;

            fn from_str(word: &str) -> Result<Self, &'static str> {
                Self::named(word).ok_or($expected)
            }
        }
    )*};
}

in_words! {
    Code: "binary, gray, gray-excess or bcd",
    Align: "left, right24, right25, tree12_13 or tree13_12",
    ErrorPlace: "none, fix or following",
}
