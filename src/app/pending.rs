//! Edits that are not written, as far as they are the same for every kind of device.

/// Edited values that differ from the device or the file, with undo.
pub trait PendingEdits {
    /// Returns the number of edits.
    fn count(&self) -> usize;

    /// Returns whether there is an edit.
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

/// Step through the edits: undoes or redoes one, or discards all.
pub type EditStep = fn(&mut dyn PendingEdits) -> bool;
