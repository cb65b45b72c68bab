//! Undoing a write to an encoder: one change per register, and instructions for items that the backup cannot restore.

use super::{BissProfile, RegisterRange};
use crate::profile::{ChangedItem, Redo, single_bytes};

/// An item of the logbook.
enum LoggedItem {
    Registers(RegisterRange),
    /// The position filter or the preset value, with its old and new values as strings.
    Setting,
    Procedure,
}

fn logged_item(item: &ChangedItem) -> LoggedItem {
    match (item.item.parse::<RegisterRange>(), item.name.as_deref()) {
        (_, Some("filter" | "preset value")) => LoggedItem::Setting,
        (Ok(range), _) => LoggedItem::Registers(range),
        (Err(_), _) => LoggedItem::Procedure,
    }
}

/// Splits the change of several registers into one change per register.
pub(super) fn single_values(item: &ChangedItem) -> Vec<ChangedItem> {
    match logged_item(item) {
        LoggedItem::Setting | LoggedItem::Procedure => vec![item.clone()],
        LoggedItem::Registers(range) => {
            let addresses: Vec<String> = range.addresses().map(|address| address.to_string()).collect();
            single_bytes(item, |at| addresses.get(at).cloned().unwrap_or_default())
        }
    }
}

impl BissProfile {
    /// Returns how to undo a change to an item that this backup does not contain, or `None` if the backup can.
    pub(super) fn redo_item(&self, item: &ChangedItem) -> Option<Redo> {
        let range = match logged_item(item) {
            LoggedItem::Setting => return None,
            LoggedItem::Procedure => return Some(Redo::Repeat),
            LoggedItem::Registers(range) => range,
        };
        let bank = range.start().bank();
        let is_saved = self.banks().any(|own| Some(own.number) == bank);
        (!is_saved).then(|| item.old.clone().map_or(Redo::WriteUnknown, Redo::Write))
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]

    use super::super::test_profiles;
    use super::*;

    /// Register 0x66 is in no bank, so no backup contains it.
    #[test]
    fn backup_does_not_undo_direct_register() {
        let backup = test_profiles::profile("12345678");
        let changed = |old: Option<&str>| ChangedItem::new("0x66", old.map(str::to_owned), Some("50".to_owned()));
        assert_eq!(backup.redo_item(&changed(Some("14"))), Some(Redo::Write("14".to_owned())));
        assert_eq!(backup.redo_item(&changed(None)), Some(Redo::WriteUnknown));
    }
}
