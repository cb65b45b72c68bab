//! Undoes a write from the logbook, provided that the device still has the written values. A value that has changed
//! since is not overwritten.

use std::collections::BTreeMap;

use super::{Body, ChangedItem};

/// The total changes made by a series of operations, from the first old value to the last new one. Values that are
/// changed and changed back, such as the protection of a field, are not included.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct ValueChanges(BTreeMap<String, Change>);

#[derive(Clone, Debug, PartialEq, Eq)]
struct Change {
    old: Option<String>,
    new: Option<String>,
}

/// A value that has changed since a write.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct LaterChange {
    /// Name of the value.
    pub item: String,
    /// Value directly after the write. `None` if the item did not exist.
    pub expected: Option<String>,
    /// Present value. `None` if the item does not exist.
    pub found: Option<String>,
}

/// What the user must do about an item whose write cannot be undone.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Redo {
    /// Write this value again. The backup does not contain it.
    Write(String),
    /// Write the previous value again. It is unknown, because it could not be read before the write.
    WriteUnknown,
    /// Delete the created data if they are not needed. Their content may have been used since.
    Delete,
    /// Set the position again.
    SetPosition,
    /// Change the access code again. Access codes are never stored.
    ChangeCode,
    /// Change the network settings again.
    ChangeNetwork,
    /// Repeat the procedure.
    Repeat,
    /// Leave the counter as it is. The device can only increment or clear it.
    KeepCounter,
}

/// A written item that cannot be undone.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct IrreversibleItem {
    /// Name of the item.
    pub item: String,
    /// Instruction for the user.
    pub redo: Redo,
}

/// A write that can be undone by restoring its backup.
#[derive(Clone, Debug)]
pub struct UndoableWrite {
    changes: ValueChanges,
    kept: Vec<IrreversibleItem>,
    item_count: usize,
    single_values: fn(&ChangedItem) -> Vec<ChangedItem>,
}

impl UndoableWrite {
    /// Prepares to undo a write of these items. All values that the write did not change are removed from the backup.
    pub fn new(items: &[ChangedItem], backup: &mut Body) -> Self {
        let kept = |item: &ChangedItem| Some(IrreversibleItem { item: item.item.clone(), redo: backup.redo(item)? });
        let kept: Vec<IrreversibleItem> = items.iter().filter_map(kept).collect();
        backup.keep_items(items);
        let single_values = backup.single_values();
        let single = items.iter().flat_map(single_values);
        let changes = ValueChanges::of(single.filter(|value| kept.iter().all(|own| own.item != value.item)));
        UndoableWrite { changes, kept, item_count: items.len(), single_values }
    }

    /// Returns the items that cannot be undone.
    pub fn kept(&self) -> &[IrreversibleItem] {
        &self.kept
    }

    /// Returns whether any item can be undone.
    pub fn has_effect(&self) -> bool {
        self.kept.len() < self.item_count
    }

    /// Returns whether a message about a profile item is relevant to the write.
    pub fn concerns(&self, item: &str) -> bool {
        let is_part =
            |value: &str| value.strip_prefix(item).is_some_and(|rest| rest.is_empty() || rest.starts_with('@'));
        self.changes.items().any(is_part)
    }

    /// Returns the values that have changed since the write. `planned` are the changes that restoring the backup would
    /// make.
    pub fn changed_since(&self, planned: impl IntoIterator<Item = ChangedItem>) -> Vec<LaterChange> {
        let planned = ValueChanges::of(planned.into_iter().flat_map(|item| (self.single_values)(&item)));
        self.changes.changed_since(&planned)
    }
}

/// Splits an item with hexadecimal bytes into one item per byte. `name` returns the name of a byte.
pub(crate) fn single_bytes(item: &ChangedItem, name: impl Fn(usize) -> String) -> Vec<ChangedItem> {
    let bytes = |text: &Option<String>| -> Vec<String> {
        let text = text.as_deref().unwrap_or_default().as_bytes();
        text.chunks(2).map(|digits| String::from_utf8_lossy(digits).into_owned()).collect()
    };
    let (old, new) = (bytes(&item.old), bytes(&item.new));
    let count = old.len().max(new.len());
    (0..count).map(|at| ChangedItem::new(name(at), old.get(at).cloned(), new.get(at).cloned())).collect()
}

impl ValueChanges {
    /// Combines changes in chronological order. Each item must be a single value.
    pub fn of(items: impl IntoIterator<Item = ChangedItem>) -> Self {
        let mut values: BTreeMap<String, Change> = BTreeMap::new();
        for ChangedItem { item, old, new, .. } in items {
            match values.get_mut(&item) {
                Some(change) => change.new = new,
                None => {
                    values.insert(item, Change { old, new });
                }
            }
        }
        values.retain(|_, change| change.old != change.new);
        ValueChanges(values)
    }

    /// Returns the names of the changed values.
    pub fn items(&self) -> impl Iterator<Item = &str> {
        self.0.keys().map(String::as_str)
    }

    /// Compares a write with the operations that would undo it, and returns the values that have changed since,
    /// including those that the write did not change.
    pub fn changed_since(&self, undoing: &ValueChanges) -> Vec<LaterChange> {
        let changed = undoing.0.iter().filter_map(|(item, Change { old: found, new: back })| {
            // The write did not change this value, so it left the value that would be written back.
            let expected = self.0.get(item).map_or(back, |change| &change.new);
            (expected != found).then(|| LaterChange {
                item: item.clone(),
                expected: expected.clone(),
                found: found.clone(),
            })
        });
        changed.collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn item(item: &str, old: &str, new: &str) -> ChangedItem {
        let value = |text: &str| (!text.is_empty()).then(|| text.to_owned());
        ChangedItem::new(item, value(old), value(new))
    }

    fn changes(items: &[(&str, &str, &str)]) -> ValueChanges {
        ValueChanges::of(items.iter().map(|(name, old, new)| item(name, old, new)))
    }

    #[test]
    fn value_changes_accumulate() {
        let unlocked = [("status:3", "A8", "E8"), ("field:3@0", "00", "11"), ("status:3", "E8", "A8")];
        assert_eq!(changes(&unlocked), changes(&[("field:3@0", "00", "11")]));
        assert_eq!(changes(&[("a", "1", "2"), ("a", "2", "3")]), changes(&[("a", "1", "3")]));
        assert_eq!(changes(&[("code 2", "", "")]), ValueChanges::default());
    }

    #[test]
    fn names_values_changed_after_write() {
        let write = changes(&[("a", "1", "2"), ("b", "5", "6"), ("c", "", "7")]);
        let since = |undoing: &[(&str, &str, &str)]| {
            let text = |value: Option<String>| value.unwrap_or_default();
            let changed = write.changed_since(&changes(undoing)).into_iter();
            changed.map(|own| (own.item, text(own.expected), text(own.found))).collect::<Vec<_>>()
        };
        assert_eq!(since(&[("a", "2", "1"), ("b", "6", "5"), ("c", "7", "")]), []);
        assert_eq!(since(&[]), [], "all values are the old ones already");
        assert_eq!(since(&[("a", "9", "1")]), [("a".into(), "2".into(), "9".into())]);
        assert_eq!(since(&[("d", "8", "3")]), [("d".into(), "3".into(), "8".into())], "another write changed it");
        assert_eq!(since(&[("c", "", "7")]), [("c".into(), "7".into(), String::new())]);
    }
}
