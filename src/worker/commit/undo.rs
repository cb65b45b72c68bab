//! Determines how the operations of a plan can be undone, before they are written.

use super::PlannedWrite;
use crate::profile::{Body, ChangedItem, Operation as _, Redo};
use crate::store::{EntryKind, UndoObstacle};

/// How an operation can be undone after the write.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Undo {
    /// Undoing the logbook entry restores the exact old values.
    Exactly,
    /// The old value must be written again, because it is not in the backup.
    AnotherWrite {
        /// Old value.
        value: String,
        /// Number of write cycles required to write the old value.
        cycles: u64,
    },
    /// The logbook entry cannot be undone, but restoring the backup writes the exact old values.
    RestoreBackup,
    /// The operation cannot be undone.
    Never(Redo),
}

impl Undo {
    /// Returns how each operation of a plan can be undone, or `None` for an operation that changes nothing.
    pub(super) fn for_write_plan<P: PlannedWrite + ?Sized>(prepared: &P) -> Vec<Option<Undo>> {
        let (backup, kind) = (prepared.backup().body, prepared.entry_kind());
        let of_operation = |op: &P::Op| {
            let cycles = op.write_cycles();
            let items = prepared.changed_items(op).into_iter();
            let changed = items.filter(|item| cycles > 0 || item.old != item.new);
            changed.map(|item| Undo::of_item(&item, &backup, kind, cycles)).max_by_key(Undo::effort)
        };
        prepared.plan().ops.iter().map(of_operation).collect()
    }

    fn of_item(item: &ChangedItem, backup: &Body, kind: EntryKind, cycles: u64) -> Self {
        match (kind.undo_obstacle(), backup.redo(item)) {
            (Some(UndoObstacle::Preset), _) => Undo::Never(Redo::SetPosition),
            (_, Some(Redo::Write(value))) => Undo::AnotherWrite { value, cycles },
            (_, Some(redo)) => Undo::Never(redo),
            (None, None) => Undo::Exactly,
            (Some(_), None) => Undo::RestoreBackup,
        }
    }

    /// Ranks the effort that an undo requires from the user. A higher rank means more effort.
    const fn effort(&self) -> u8 {
        match self {
            Undo::Exactly => 0,
            Undo::RestoreBackup => 1,
            Undo::AnotherWrite { .. } => 2,
            Undo::Never(_) => 3,
        }
    }
}
