//! Marks for profile values that are valid only for one device on a particular machine.

use std::error::Error;

use super::ProfileError;
use super::ron_text::{Entries, UnknownValues, Writer, entries_text, quote};
use crate::expected::AllowedValues;

/// A mark for a value that is valid only for one device on a particular machine.
#[derive(Clone, Debug, PartialEq)]
pub struct MountingMark<Item> {
    /// Marked item, which is always writable.
    pub item: Item,
    /// Meaning of the item.
    pub meaning: String,
    /// Unknown entries, which are preserved when the profile is saved.
    pub unknown: UnknownValues,
}

const ENTRY: &str = "mounting";

impl<Item> MountingMark<Item> {
    /// Reads all marks of a profile. `item` parses the marked item or returns why it is invalid. `expected` describes
    /// the valid form of an item.
    pub(crate) fn read_all<E: Error + Clone + Eq + Send + Sync + 'static>(
        entries: &mut Entries,
        expected: AllowedValues,
        item: impl Fn(&str) -> Result<Item, E>,
    ) -> Result<Vec<Self>, ProfileError> {
        entries
            .take_structures(ENTRY)?
            .into_iter()
            .map(|entries| Self::read(entries, expected.clone(), &item))
            .collect()
    }

    fn read<E: Error + Clone + Eq + Send + Sync + 'static>(
        mut entries: Entries,
        expected: AllowedValues,
        item: impl Fn(&str) -> Result<Item, E>,
    ) -> Result<Self, ProfileError> {
        let path = entries.entry_path("item");
        let text: String = entries.take_required("item", expected)?;
        let item = item(&text).map_err(|error| ProfileError::invalid_entry(path, error))?;
        let meaning = entries.take_optional("meaning", AllowedValues::Text)?.unwrap_or_default();
        Ok(MountingMark { item, meaning, unknown: entries.into_unknown()? })
    }
}

impl<Item: ToString> MountingMark<Item> {
    /// Writes all marks of a profile below a comment, or nothing if there are none.
    pub(crate) fn write_all(marks: &[Self], comment: &str, writer: &mut Writer) {
        if marks.is_empty() {
            return;
        }
        writer.write_comment(comment);
        writer.open(ENTRY, '[');
        for mark in marks {
            let (item, meaning) = (quote(&mark.item.to_string()), quote(&mark.meaning));
            let unknown = entries_text(&mark.unknown);
            writer.write_list_element(&format!("(item: {item}, meaning: {meaning}{unknown})"));
        }
        writer.close(']');
    }
}

/// Comment above the items that are copied to another encoder only on request.
pub(crate) const MOUNTING_COMMENT: &str = "belongs to the mounting: never restored onto another encoder by itself";
