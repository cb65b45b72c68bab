//! Undoes a write: splits changes into single bytes, and gives instructions for items that the backup cannot restore.

use super::{FieldRange, HiperfaceProfile, Item};
use crate::devices::hiperface::protocol::DataFieldStatus;
use crate::profile::{ChangedItem, Redo, single_bytes};

/// Splits a change to field bytes into single bytes. For a created or deleted field, only the change of the status is
/// returned.
pub(super) fn single_values(item: &ChangedItem) -> Vec<ChangedItem> {
    match item.item.parse() {
        Ok(Item::Field(_)) if item.old.is_none() => Vec::new(),
        Ok(Item::Field(range)) => {
            let byte = |at| FieldRange { start: range.start.saturating_add(at), count: Some(1), ..range };
            single_bytes(item, |at| byte(at).to_string())
        }
        Ok(Item::Status(_)) => {
            let existing = |value: &Option<String>| {
                let byte = u8::from_str_radix(value.as_deref()?, 16).ok()?;
                value.clone().filter(|_| DataFieldStatus::from_byte(byte).exists())
            };
            vec![ChangedItem::new(&item.item, existing(&item.old), existing(&item.new))]
        }
        _ => vec![item.clone()],
    }
}

impl HiperfaceProfile {
    /// Returns the instruction for an item that this backup cannot restore.
    pub(super) fn redo_item(&self, item: &ChangedItem) -> Option<Redo> {
        // The content of a field that was only created is unknown, and data may have been stored in it since.
        let is_known = |field: u8| self.created.iter().any(|own| own.number == field);
        let old = || item.old.clone().unwrap_or_default();
        Some(match item.item.parse() {
            Ok(Item::Status(field)) if item.old.is_none() && !is_known(field) => Redo::Delete,
            Ok(Item::Field(_) | Item::Status(_) | Item::Analogue(_)) => return None,
            Ok(Item::Address | Item::Settings) => Redo::Write(old()),
            Ok(Item::Counter) => Redo::KeepCounter,
            Err(_) if item.item == "position" => Redo::SetPosition,
            Err(_) => Redo::ChangeCode,
        })
    }
}
