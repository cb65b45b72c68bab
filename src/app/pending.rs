//! Edits that have not been written, as far as they are common to every kind of device.

use super::history::History;

/// Edited values that differ from the device or the file, with undo.
pub trait PendingEdits {
    fn count(&self) -> usize;

    fn is_dirty(&self) -> bool;

    /// Returns whether there is a step to undo.
    fn can_undo(&self) -> bool;

    /// Returns whether there is a step to redo.
    fn can_redo(&self) -> bool;

    /// Undoes the last step. Returns false if there is none.
    fn undo(&mut self) -> bool;

    /// Redoes the last undone step. Returns false if there is none.
    fn redo(&mut self) -> bool;

    /// Discards all edits as one step that can be undone. Returns false if there are none.
    fn revert(&mut self) -> bool;

    /// Forgets the steps: the edits were written or saved, and can no longer be undone.
    fn forget_steps(&mut self);
}

/// Edits that are whole values beside those of the device or the file, with the steps that led to them.
pub(crate) trait Stepped {
    type Values: Clone + PartialEq;

    fn differences_count(&self) -> usize;

    fn is_edited(&self) -> bool;

    fn history(&self) -> &History<Self::Values>;

    /// Returns the values of the device or the file, the edited ones, and the steps; `None` where nothing was read.
    fn parts(&mut self) -> Option<SteppedParts<'_, Self::Values>>;
}

/// The values of the device or the file, the edited ones, and the steps.
pub(crate) type SteppedParts<'s, T> = (&'s T, &'s mut T, &'s mut History<T>);

impl<S: Stepped> PendingEdits for S {
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
        self.parts().is_some_and(|(_, wanted, history)| history.undo(wanted))
    }

    fn redo(&mut self) -> bool {
        self.parts().is_some_and(|(_, wanted, history)| history.redo(wanted))
    }

    fn revert(&mut self) -> bool {
        self.parts().is_some_and(|(base, wanted, history)| history.step(wanted, base.clone()))
    }

    fn forget_steps(&mut self) {
        if let Some((_, _, history)) = self.parts() {
            history.forget();
        }
    }
}

/// A step through the edits: undoes or redoes one, or discards all.
pub type EditStep = fn(&mut dyn PendingEdits) -> bool;
