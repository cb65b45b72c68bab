//! The German names of a description. They are listed separately from the English names, so that each is translated
//! only once. An unused entry is reported as an error with its position.

use std::collections::BTreeMap;
use std::fmt;

use ron::error::Position;
use serde::de::{MapAccess, Visitor};
use serde::{Deserialize, Deserializer};

use super::description_error::{self, DescriptionErrorKind, UniqueItem};
use super::name::Name;

/// A map from English names to German ones.
#[derive(Default)]
pub(super) struct GermanNames(BTreeMap<String, String>);

impl GermanNames {
    /// Adds the German names to the English names. `text` is the file content, in which an unused entry is located.
    pub(super) fn translate<'a>(
        mut self,
        names: impl Iterator<Item = &'a mut Name>,
        text: &str,
    ) -> Result<(), (Position, DescriptionErrorKind)> {
        let mut used = BTreeMap::new();
        for name in names {
            if let Some((english, german)) = self.0.remove_entry(name.english()) {
                used.insert(english, german);
            }
            if let Some(german) = used.get(name.english()) {
                name.translate(german.clone());
            }
        }
        match self.0.into_keys().next() {
            None => Ok(()),
            Some(english) => Err((entry_location(&english, text), DescriptionErrorKind::UnusedGermanName(english))),
        }
    }
}

/// Returns the line and column of an entry, counted from 1. Returns the start of the file if the entry is not found.
fn entry_location(english: &str, text: &str) -> Position {
    let key = format!("\"{english}\"");
    let is_entry = |line: &str| line.find(&key).filter(|at| line.get(at + key.len()..).is_some_and(starts_with_colon));
    let found = text.lines().enumerate().find_map(|(line, words)| Some((line + 1, words, is_entry(words)?)));
    found.map_or(Position { line: 1, col: 1 }, |(line, words, at)| Position {
        line,
        col: words.get(..at).map_or(0, |before| before.chars().count()) + 1,
    })
}

fn starts_with_colon(rest: &str) -> bool {
    rest.trim_start().starts_with(':')
}

impl<'de> Deserialize<'de> for GermanNames {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_map(Entries)
    }
}

struct Entries;

impl<'de> Visitor<'de> for Entries {
    type Value = GermanNames;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("English names with their German ones")
    }

    fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<GermanNames, A::Error> {
        let mut entries = BTreeMap::new();
        while let Some((english, german)) = map.next_entry::<String, String>()? {
            if german.trim().is_empty() {
                return Err(description_error::store_error(DescriptionErrorKind::GermanEmpty(english)));
            }
            if entries.contains_key(&english) {
                return Err(description_error::store_error(DescriptionErrorKind::Twice(UniqueItem::Name(english))));
            }
            entries.insert(english, german);
        }
        Ok(GermanNames(entries))
    }
}
