//! `undo`: reverts a write recorded in the logbook. Its backup is restored in the usual way, after a check that the
//! device is the same one and still has the values that were written.

use serde_json::{Value as Json, json};

use super::args::{CommonArgs, Restore, UndoArgs};
use super::commands::DeviceCommands;
use super::log::{check_bench, entry_with_number, local_time, no_backup};
use super::output::Output;
use super::profiles::load_profile_to_write;
use super::{Failure, Result};
use crate::profile::{IrreversibleItem, LaterChange, Redo, UndoableWrite};
use crate::store::{DeviceKey, Entry, EntryId, EntryUid, UndoObstacle};
use crate::worker::commit::PlannedWrite;

/// Maximum number of items that an error lists.
const MAX_LISTED_ITEMS: usize = 3;

/// A logbook entry that a restore undoes.
#[derive(Clone)]
pub(crate) struct UndoneEntry {
    entry: EntryId,
    uid: EntryUid,
    device: DeviceKey,
    write: UndoableWrite,
    /// Items that cannot be undone, each with an instruction for the user.
    kept: Vec<(String, String)>,
}

pub(super) fn undo(common: &CommonArgs, output: &Output, undo: &UndoArgs) -> Result {
    let entry = entry_with_number(common, undo.entry)?;
    let file = entry.undo_backup().map_err(|why| obstacle(&entry, why))?.to_owned();
    check_bench(&entry, &file)?;
    let kind = output.commands().device(&entry.device.kind)?;
    let mut profile = load_profile_to_write(output, &file)?;
    if profile.kind() != kind.name() {
        return Err(Failure::Failed(vec![format!("{} is not a profile of {}.", file.display(), kind.name())]));
    }
    let write = UndoableWrite::new(&entry.items, &mut profile);
    let kept: Vec<_> = write.kept().iter().map(|own| (own.item.clone(), instruction(kind, own))).collect();
    if !write.has_effect() {
        let lines = kept.iter().map(|(item, instead)| format!("{item} cannot be undone: {instead}."));
        return Err(Failure::Failed(lines.take(MAX_LISTED_ITEMS).collect()));
    }
    if let Some(earlier) = entry.undone_by {
        let (id, by) = (entry.id, earlier.id);
        output.print_message(&format!("Entry {id} was already undone by entry {by}, on {}.", local_time(earlier.at)));
    }
    for (item, instead) in &kept {
        output.print_message(&format!("{item} is not undone: {instead}."));
    }
    let undone = UndoneEntry { entry: entry.id, uid: entry.uid, device: entry.device, write, kept };
    let restore = Restore::from_backup(file, undo, undone);
    kind.restore(common, output, &restore, profile)
}

/// Returns an instruction for an item that cannot be undone, with a command if this device kind has one.
fn instruction(kind: &dyn DeviceCommands, kept: &IrreversibleItem) -> String {
    let general = match &kept.redo {
        Redo::Write(value) => format!("write {value} again"),
        Redo::WriteUnknown => "write its previous value again, which could not be read".to_owned(),
        Redo::Delete => "delete it if its content is not needed".to_owned(),
        Redo::SetPosition => "set the position again".to_owned(),
        Redo::ChangeCode => "change the access code again".to_owned(),
        Redo::ChangeNetwork => "change the settings of the network again".to_owned(),
        Redo::Repeat => "repeat the procedure".to_owned(),
        Redo::KeepCounter => "the encoder can only increment or clear its counter".to_owned(),
    };
    kind.redo_command(kept).unwrap_or(general)
}

fn obstacle(entry: &Entry, why: UndoObstacle) -> Failure {
    let (id, kind) = (entry.id, entry.device.kind.as_str());
    let why = match why {
        UndoObstacle::NoBackup => return no_backup(entry),
        UndoObstacle::NoItems => {
            format!("Entry {id} is of an older version and does not contain the changed values.")
        }
        UndoObstacle::Preset => format!(
            "Entry {id} cannot be undone: the position was set or a preset was stored. Set the position again (help do \
             lists the actions of {kind})."
        ),
        UndoObstacle::Procedure => match &entry.backup {
            Some(backup) => format!(
                "Entry {id} is a procedure and cannot be undone. Its wear remains. The values before it are in {}, \
                 for restore.",
                backup.display()
            ),
            None => format!("Entry {id} is a procedure and cannot be undone. Its wear remains."),
        },
        UndoObstacle::NothingWritten => {
            format!("Entry {id} ({}) wrote nothing to the device: there is nothing to undo.", entry.kind.keyword())
        }
    };
    Failure::Failed(vec![why])
}

impl UndoneEntry {
    pub(super) fn uid(&self) -> &EntryUid {
        &self.uid
    }

    /// Returns an error if the device is a different one or its values have changed since the write.
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
        let changed = self.write.changed_since(planned);
        let Some((first, further)) = changed.split_first() else { return Ok(()) };
        let mut lines = vec![format!("Entry {id} cannot be undone, because values have changed since.")];
        lines.extend(std::iter::once(first).chain(further).take(MAX_LISTED_ITEMS - 1).map(describe));
        if changed.len() >= MAX_LISTED_ITEMS {
            lines.push(format!("{} values differ in total. Undo the later writes first.", changed.len()));
        }
        Err(Failure::Failed(lines))
    }

    /// Adds the details of the undo to the JSON result of a restore.
    pub(super) fn add_keys(&self, json: &mut Json, operations: &[Json]) {
        let kept: Vec<Json> =
            self.kept.iter().map(|(item, instead)| json!({"item": item, "instead": instead})).collect();
        if let Some(keys) = json.as_object_mut() {
            keys.insert("entry".to_owned(), json!(self.entry.to_string()));
            keys.insert("operations".to_owned(), json!(operations));
            keys.insert("not_undone".to_owned(), json!(kept));
        }
    }
}

fn describe(changed: &LaterChange) -> String {
    let value = |value: &Option<String>| value.clone().unwrap_or_else(|| "no value".to_owned());
    format!("{}: expected {}, found {}.", changed.item, value(&changed.expected), value(&changed.found))
}

impl Restore {
    /// Checks that an undo restores the device that was written, and that its values have not changed since. Does
    /// nothing if a profile is restored.
    ///
    /// # Errors
    /// Returns a failure with the changed values or with both devices.
    pub(super) fn check_undo<P: PlannedWrite>(&self, common: &CommonArgs, prepared: &P) -> Result<()> {
        self.undone.as_ref().map_or(Ok(()), |undone| undone.check(common, prepared))
    }

    /// Returns whether to report an item that is left unchanged. An undo reports only the items of its write.
    pub(crate) fn must_report(&self, item: &str) -> bool {
        self.undone.as_ref().is_none_or(|undone| undone.write.concerns(item))
    }
}
