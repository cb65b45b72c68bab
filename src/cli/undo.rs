//! `undo`: plans a write of the logbook back. The backup of the write is restored in the usual way, after a check that
//! the device is the same and its values are those that the write has left.

use serde_json::{Value as Json, json};

use super::args::{CommonArgs, Restore, UndoArgs};
use super::commands::DeviceCommands;
use super::log::{entry_with_number, profile_of};
use super::output::Output;
use super::profiles::load_profile_to_write;
use super::{Failure, Result};
use crate::profile::{ChangedItem, ChangedSince, ValueChanges};
use crate::store::{DeviceKey, Entry, EntryId, EntryKind};
use crate::worker::commit::PlannedWrite;

/// Number of changed values that a refusal names.
const NAMED: usize = 3;

/// A write that a restore undoes.
#[derive(Clone)]
pub(crate) struct UndoneWrite {
    entry: EntryId,
    device: DeviceKey,
    changes: ValueChanges,
    kind: &'static dyn DeviceCommands,
    kept: Vec<KeptItem>,
}

/// An item that cannot be undone.
#[derive(Clone)]
struct KeptItem {
    item: String,
    /// Instruction for the user.
    instead: String,
}

pub(super) fn undo(common: &CommonArgs, output: &Output, undo: &UndoArgs) -> Result {
    let entry = entry_with_number(common, undo.entry)?;
    check_kind(&entry)?;
    let file = profile_of(&entry)?;
    let kind = output.commands().device(&entry.device.kind)?;
    let mut profile = load_profile_to_write(output, &file)?;
    if profile.kind() != kind.name() {
        return Err(Failure::Failed(vec![format!("{} is not a profile of {}.", file.display(), kind.name())]));
    }
    let kept = entry
        .items
        .iter()
        .filter_map(|item| Some(KeptItem { item: item.item.clone(), instead: kind.instead_of_undo(item, &profile)? }));
    let kept: Vec<KeptItem> = kept.collect();
    kind.keep_items(&mut profile, &entry.items);
    let single = entry.items.iter().flat_map(|item| kind.single_values(item));
    let changes = ValueChanges::of(single.filter(|value| kept.iter().all(|own| own.item != value.item)));
    if entry.items.len() == kept.len() {
        let lines = kept.iter().map(|own| format!("{} cannot be undone: {}.", own.item, own.instead));
        return Err(Failure::Failed(lines.take(NAMED).collect()));
    }
    for KeptItem { item, instead } in &kept {
        output.print_message(&format!("{item} is not undone: {instead}."));
    }
    let undone = UndoneWrite { entry: entry.id, device: entry.device, changes, kind, kept };
    let restore = Restore::of_backup(file, undo, undone);
    kind.restore(common, output, &restore, profile)
}

/// Rejects an entry that is not a write of single values.
fn check_kind(entry: &Entry) -> Result<()> {
    let (id, kind) = (entry.id, entry.device.kind.as_str());
    let why = match entry.kind {
        EntryKind::Write | EntryKind::Restore => {
            if entry.items.is_empty() {
                format!("Entry {id} is of an older version and does not contain the changed values.")
            } else {
                return Ok(());
            }
        }
        EntryKind::Preset => format!(
            "Entry {id} cannot be undone: the position was set or a preset was stored. Set the position again (help do \
             lists the actions of {kind})."
        ),
        EntryKind::Procedure => match &entry.backup {
            Some(backup) => format!(
                "Entry {id} is a procedure and cannot be undone. Its wear remains. The values before it are in {}, \
                 for restore.",
                backup.display()
            ),
            None => format!("Entry {id} is a procedure and cannot be undone. Its wear remains."),
        },
        EntryKind::Connected
        | EntryKind::Assigned
        | EntryKind::Status
        | EntryKind::Backup
        | EntryKind::Check
        | EntryKind::Note => {
            format!("Entry {id} ({}) wrote nothing to the device: there is nothing to undo.", entry.kind.keyword())
        }
    };
    Err(Failure::Failed(vec![why]))
}

impl UndoneWrite {
    /// Rejects the undo on a different device, or if values have changed since the write.
    fn check<P: PlannedWrite>(&self, common: &CommonArgs, prepared: &P) -> Result<()> {
        let (id, of) = (self.entry, &self.device);
        if let Some(found) = common.log.device().filter(|found| found != of) {
            let name = |key: &DeviceKey| {
                let DeviceKey { kind, device_type, serial_number, is_virtual } = key;
                format!("{kind} {device_type} {serial_number}{}", if *is_virtual { " (virtual)" } else { "" })
            };
            let why = format!("Entry {id} is of {}, the device is {}.", name(of), name(&found));
            return Err(Failure::Failed(vec![why]));
        }
        let planned = prepared.plan().ops.iter().flat_map(|op| prepared.changed_items(op));
        let planned = ValueChanges::of(planned.flat_map(|item| self.kind.single_values(&item)));
        let changed = self.changes.changed_since(&planned);
        let Some((first, further)) = changed.split_first() else { return Ok(()) };
        let mut lines = vec![format!("Entry {id} cannot be undone, because values have changed since.")];
        lines.extend(std::iter::once(first).chain(further).take(NAMED - 1).map(describe));
        if changed.len() >= NAMED {
            lines.push(format!("{} values differ in total. Undo the later writes first.", changed.len()));
        }
        Err(Failure::Failed(lines))
    }

    /// Returns whether a message about an item of the profile is about the write.
    fn concerns(&self, item: &str) -> bool {
        let is_part =
            |value: &str| value.strip_prefix(item).is_some_and(|rest| rest.is_empty() || rest.starts_with('@'));
        self.changes.items().any(is_part)
    }

    /// Adds the keys of an undo to the result of a restore.
    pub(super) fn add_keys(&self, json: &mut Json, operations: &[Json]) {
        let kept: Vec<Json> = self.kept.iter().map(|own| json!({"item": own.item, "instead": own.instead})).collect();
        if let Some(keys) = json.as_object_mut() {
            keys.insert("entry".to_owned(), json!(self.entry.to_string()));
            keys.insert("operations".to_owned(), json!(operations));
            keys.insert("not_undone".to_owned(), json!(kept));
        }
    }
}

fn describe(changed: &ChangedSince) -> String {
    let value = |value: &Option<String>| value.clone().unwrap_or_else(|| "no value".to_owned());
    format!("{}: expected {}, found {}.", changed.item, value(&changed.expected), value(&changed.found))
}

impl Restore {
    /// Rejects the undo of a write on a different device, or if values have changed since the write. Does nothing for a
    /// restore of a profile.
    ///
    /// # Errors
    /// Returns a failure that names the changed values.
    pub(super) fn check_undo<P: PlannedWrite>(&self, common: &CommonArgs, prepared: &P) -> Result<()> {
        self.undone.as_ref().map_or(Ok(()), |undone| undone.check(common, prepared))
    }

    /// Returns whether an item that is left unchanged has to be reported. An undo reports only items of the write.
    pub(crate) fn concerns(&self, item: &str) -> bool {
        self.undone.as_ref().is_none_or(|undone| undone.concerns(item))
    }
}

/// Splits an item whose values are hexadecimal bytes into one item for each byte. `name` returns the name of a byte.
pub(crate) fn single_bytes(item: &ChangedItem, name: impl Fn(usize) -> String) -> Vec<ChangedItem> {
    let bytes = |text: &Option<String>| -> Vec<String> {
        let text = text.as_deref().unwrap_or_default().as_bytes();
        text.chunks(2).map(|digits| String::from_utf8_lossy(digits).into_owned()).collect()
    };
    let (old, new) = (bytes(&item.old), bytes(&item.new));
    let count = old.len().max(new.len());
    (0..count).map(|at| ChangedItem::new(name(at), old.get(at).cloned(), new.get(at).cloned())).collect()
}
