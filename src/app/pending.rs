//! Unwritten edits, in a form common to all kinds of devices.

use super::history::History;

/// Edited values that differ from the device or the file, with undo and redo.
pub trait PendingEdits {
    fn count(&self) -> usize;

    fn is_dirty(&self) -> bool;

    fn can_undo(&self) -> bool;

    fn can_redo(&self) -> bool;

    /// Undoes the last step. Returns `false` if there is none.
    fn undo(&mut self) -> bool;

    /// Redoes the last undone step. Returns `false` if there is none.
    fn redo(&mut self) -> bool;

    /// Discards all edits as one undo step. Returns `false` if there are none.
    fn discard_all(&mut self) -> bool;

    /// Discards the undo steps because the edits have been written or saved.
    fn clear_undo_steps(&mut self);
}

/// Edits stored as a complete copy of the values, with their undo steps.
pub(crate) trait SnapshotEdits {
    type Values: Clone + PartialEq;

    fn differences_count(&self) -> usize;

    fn is_edited(&self) -> bool;

    fn history(&self) -> &History<Self::Values>;

    /// Returns the original values, the edited values and the undo steps, or `None` if no data has been read.
    fn history_parts(&mut self) -> Option<EditHistoryParts<'_, Self::Values>>;
}

/// The original values, the edited values and the undo steps.
pub(crate) type EditHistoryParts<'s, T> = (&'s T, &'s mut T, &'s mut History<T>);

impl<S: SnapshotEdits> PendingEdits for S {
    fn count(&self) -> usize {
        self.differences_count()
    }

    fn is_dirty(&self) -> bool {
        self.is_edited()
    }

    fn can_undo(&self) -> bool {
        self.history().can_undo()
    }

    fn can_redo(&self) -> bool {
        self.history().can_redo()
    }

    fn undo(&mut self) -> bool {
        self.history_parts().is_some_and(|(_, wanted, history)| history.undo(wanted))
    }

    fn redo(&mut self) -> bool {
        self.history_parts().is_some_and(|(_, wanted, history)| history.redo(wanted))
    }

    fn discard_all(&mut self) -> bool {
        self.history_parts().is_some_and(|(base, wanted, history)| history.apply_step(wanted, base.clone()))
    }

    fn clear_undo_steps(&mut self) {
        if let Some((_, _, history)) = self.history_parts() {
            history.clear_steps();
        }
    }
}

pub type EditStep = fn(&mut dyn PendingEdits) -> bool;
