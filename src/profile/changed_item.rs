//! An item changed by a write, as stored in the logbook.

use std::fmt;

use serde::{Deserialize, Serialize};

/// An item with its old and new value, all in the notation of the command line regardless of the display language.
/// Access codes are never included.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct ChangedItem {
    /// Name of the item. If the item is readable, the `read` command accepts this name.
    pub item: String,
    /// Name of the register or area in the manual, if `item` is an address.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub name: Option<String>,
    /// Value before the write, or `None` if it is unknown or the item did not exist.
    pub old: Option<String>,
    /// Value after the write, or `None` if the write does not set a value that can be displayed.
    pub new: Option<String>,
}

impl ChangedItem {
    /// Creates an item that has changed from one value to another.
    pub fn new(item: impl ToString, old: Option<String>, new: Option<String>) -> Self {
        ChangedItem { item: item.to_string(), name: None, old, new }
    }

    /// Creates an item with a new value that does not replace a single old one.
    pub fn new_value(item: impl ToString, new: impl ToString) -> Self {
        ChangedItem::new(item, None, Some(new.to_string()))
    }

    /// Adds the name that the manual uses.
    #[must_use]
    pub fn with_manual_name(self, name: impl ToString) -> Self {
        ChangedItem { name: Some(name.to_string()), ..self }
    }
}

impl fmt::Display for ChangedItem {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.item)?;
        if let Some(name) = &self.name {
            write!(f, " {name}")?;
        }
        match (&self.old, &self.new) {
            (Some(old), Some(new)) => write!(f, ": {old} → {new}"),
            (Some(old), None) => write!(f, ": {old} →"),
            (None, Some(new)) => write!(f, ": → {new}"),
            (None, None) => Ok(()),
        }
    }
}
