//! Layout specifications written as one word, `KEY,name=value,…`. This module contains the parts common to families and
//! arbitrary frames.

use crate::expected::AllowedValues;

/// The reason why a layout specification is invalid.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum SpecError {
    /// A part of the specification is not of the form `name=value`.
    #[error("\"{word}\" is not NAME=VALUE; names: {names}", names = names.join(", "))]
    Form {
        /// Text of the invalid part.
        word: String,
        /// Names that are valid in this specification.
        names: &'static [&'static str],
    },
    /// The specification contains an unknown name.
    #[error("there is no \"{name}\"; names: {names}", names = names.join(", "))]
    Name {
        /// The unknown name.
        name: String,
        /// Names that are valid in this specification.
        names: &'static [&'static str],
    },
    /// The value of a setting is invalid.
    #[error("{name} must be {expected}, not \"{value}\"")]
    Value {
        /// Name of the setting.
        name: String,
        /// Description of the valid values.
        expected: AllowedValues,
        /// The invalid value.
        value: String,
    },
    /// The same setting occurs twice.
    #[error("{0} is specified twice")]
    Twice(String),
}

#[derive(Clone, Copy, Debug)]
pub(super) struct Setting<'t> {
    pub(super) name: &'t str,
    pub(crate) value: &'t str,
    names: &'static [&'static str],
}

impl<'t> Setting<'t> {
    /// Parses `name=value` pairs, ignoring empty items.
    ///
    /// # Errors
    /// Returns [`SpecError::Form`] or [`SpecError::Twice`] if the pairs are invalid.
    pub(super) fn parse_all(
        words: impl Iterator<Item = &'t str>,
        names: &'static [&'static str],
    ) -> Result<Vec<Self>, SpecError> {
        let mut settings: Vec<Self> = Vec::new();
        for word in words.filter(|word| !word.is_empty()) {
            let (name, value) = word.split_once('=').ok_or_else(|| SpecError::Form { word: word.to_owned(), names })?;
            let (name, value) = (name.trim(), value.trim());
            if settings.iter().any(|known| known.name == name) {
                return Err(SpecError::Twice(name.to_owned()));
            }
            settings.push(Setting { name, value, names });
        }
        Ok(settings)
    }

    pub(super) fn parse_u8(self) -> Result<u8, SpecError> {
        self.value.parse().map_err(|_| self.wrong_value(AllowedValues::whole_range(0, 255)))
    }

    pub(super) fn parse_u32(self) -> Result<u32, SpecError> {
        self.value.parse().map_err(|_| self.wrong_value(AllowedValues::Whole))
    }

    pub(super) fn parse_switch(self) -> Result<bool, SpecError> {
        match self.value {
            "0" => Ok(false),
            "1" => Ok(true),
            _ => Err(self.wrong_value(AllowedValues::words(&["0", "1"]))),
        }
    }

    pub(super) fn wrong_value(self, expected: AllowedValues) -> SpecError {
        SpecError::Value { name: self.name.to_owned(), expected, value: self.value.to_owned() }
    }

    pub(super) fn unknown_name(self) -> SpecError {
        SpecError::Name { name: self.name.to_owned(), names: self.names }
    }
}
