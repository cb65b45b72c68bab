//! Edited values of a device, by location, with undo. The base supplies the device's own values and defines which of
//! them can be edited.

use std::collections::BTreeMap;

use super::PendingEdits;
use super::history::History;

/// The values last read from a device.
pub trait EditBase: Default {
    type Location: Ord + Copy;
    type Value: Copy + PartialEq;

    /// Returns whether a value differs from the one read, and is therefore an edit.
    fn is_edit(&self, at: Self::Location, value: Self::Value) -> bool;
}

/// The values last read from a device, together with the edited values.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Edits<B: EditBase> {
    base: B,
    edits: BTreeMap<B::Location, B::Value>,
    history: History<BTreeMap<B::Location, B::Value>>,
}

impl<B: EditBase> Default for Edits<B> {
    fn default() -> Self {
        Edits { base: B::default(), edits: BTreeMap::new(), history: History::default() }
    }
}

impl<B: EditBase> Edits<B> {
    pub fn base(&self) -> &B {
        &self.base
    }

    /// Returns the edited value, or `None` if the value is not edited.
    pub fn get(&self, at: B::Location) -> Option<B::Value> {
        self.edits.get(&at).copied()
    }

    /// Returns all edits, ordered by location.
    pub fn iter(&self) -> impl Iterator<Item = (B::Location, B::Value)> {
        self.edits.iter().map(|(at, value)| (*at, *value))
    }

    /// Edits values as one undo step. A value equal to the one on the device is not an edit.
    pub fn edit_values(&mut self, values: impl IntoIterator<Item = (B::Location, B::Value)>) {
        let mut after = self.edits.clone();
        for (at, value) in values {
            if self.base.is_edit(at, value) {
                after.insert(at, value);
            } else {
                after.remove(&at);
            }
        }
        self.history.apply_step(&mut self.edits, after);
    }

    /// Reverts the edits for which `is_meant` returns `true`, as one undo step. Returns `false` if there are none.
    pub fn revert_matching(&mut self, is_meant: impl Fn(B::Location) -> bool) -> bool {
        let mut after = self.edits.clone();
        after.retain(|at, _| !is_meant(*at));
        self.history.apply_step(&mut self.edits, after)
    }

    /// Adopts newly read values. An edit is removed if the device now has the same value.
    pub fn update_base(&mut self, read: impl FnOnce(&mut B)) {
        read(&mut self.base);
        self.remove_redundant();
        self.history.discard_undone_steps();
    }

    /// Discards all values and edits, because another device is connected.
    pub fn clear(&mut self) {
        *self = Edits::default();
    }

    /// Removes edits that equal the device's value. An undo step can restore them.
    fn remove_redundant(&mut self) {
        let base = &self.base;
        self.edits.retain(|at, value| base.is_edit(*at, *value));
    }
}

impl<B: EditBase> PendingEdits for Edits<B> {
    fn count(&self) -> usize {
        self.edits.len()
    }

    fn is_dirty(&self) -> bool {
        !self.edits.is_empty()
    }

    fn can_undo(&self) -> bool {
        self.history.can_undo()
    }

    fn can_redo(&self) -> bool {
        self.history.can_redo()
    }

    fn undo(&mut self) -> bool {
        let done = self.history.undo(&mut self.edits);
        self.remove_redundant();
        done
    }

    fn redo(&mut self) -> bool {
        let done = self.history.redo(&mut self.edits);
        self.remove_redundant();
        done
    }

    fn discard_all(&mut self) -> bool {
        self.revert_matching(|_| true)
    }

    fn clear_undo_steps(&mut self) {
        self.history.clear_steps();
    }
}
