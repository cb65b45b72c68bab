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

    /// Undoes the last step. False where nothing has changed.
    fn undo(&mut self) -> bool;

    /// Redoes the last undone step. False if there is none.
    fn redo(&mut self) -> bool;

    /// Discards all edits as one step that can be undone. False if there are none.
    fn revert(&mut self) -> bool;

    /// The edits were written or saved: what led to them cannot be undone any more.
    fn forget_steps(&mut self);
}

/// A step through the edits: one undone or done again, or all taken back.
pub type EditStep = fn(&mut dyn PendingEdits) -> bool;
