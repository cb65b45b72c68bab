//! Values that a user wants otherwise than the device has them, by their place, with steps that can be undone. What a value
//! is on the device, and whether it may be edited at all, is said by whoever holds the memory.

use std::collections::BTreeMap;

use super::PendingEdits;
use super::history::History;

/// Edited values by their place: bytes, where no other type is named.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Edits<K: Ord, V = u8> {
    edits: BTreeMap<K, V>,
    history: History<BTreeMap<K, V>>,
}

impl<K: Ord, V> Default for Edits<K, V> {
    fn default() -> Self {
        Edits { edits: BTreeMap::new(), history: History::default() }
    }
}

impl<K: Ord + Copy, V: Copy + PartialEq> Edits<K, V> {
    /// The value that is wanted here; `None`: as the device has it.
    pub fn get(&self, at: K) -> Option<V> {
        self.edits.get(&at).copied()
    }

    /// There is something to write.
    pub fn is_dirty(&self) -> bool {
        !self.edits.is_empty()
    }

    /// All of them, in the order of their places.
    pub fn iter(&self) -> impl Iterator<Item = (K, V)> {
        self.edits.iter().map(|(at, value)| (*at, *value))
    }

    /// Edits values, as one step that can be undone; `is_edit` says whether a value at its place is one.
    pub fn put(&mut self, values: impl IntoIterator<Item = (K, V)>, is_edit: impl Fn(K, V) -> bool) {
        self.step(|edits| {
            for (at, value) in values {
                if is_edit(at, value) {
                    edits.insert(at, value);
                } else {
                    edits.remove(&at);
                }
            }
        });
    }

    /// Takes edits back, as one step that can be undone. False where none is meant.
    pub fn revert(&mut self, is_meant: impl Fn(K) -> bool) -> bool {
        self.step(|edits| edits.retain(|at, _| !is_meant(*at)))
    }

    /// Forgets what is no edit any more: the device was read again, or a step was undone.
    pub fn settle(&mut self, is_edit: impl Fn(K, V) -> bool) {
        self.edits.retain(|at, value| is_edit(*at, *value));
    }

    /// What was undone belongs to another memory.
    pub fn forget_redo(&mut self) {
        self.history.forget_undone();
    }

    fn step(&mut self, change: impl FnOnce(&mut BTreeMap<K, V>)) -> bool {
        let mut after = self.edits.clone();
        change(&mut after);
        self.history.step(&mut self.edits, after)
    }
}

impl<K: Ord + Copy, V: Copy + PartialEq> PendingEdits for Edits<K, V> {
    fn count(&self) -> usize {
        self.edits.len()
    }

    fn is_dirty(&self) -> bool {
        Edits::is_dirty(self)
    }

    fn can_undo(&self) -> bool {
        self.history.can_undo()
    }

    fn can_redo(&self) -> bool {
        self.history.can_redo()
    }

    fn undo(&mut self) -> bool {
        self.history.undo(&mut self.edits)
    }

    fn redo(&mut self) -> bool {
        self.history.redo(&mut self.edits)
    }

    fn revert(&mut self) -> bool {
        Edits::revert(self, |_| true)
    }

    fn forget_steps(&mut self) {
        self.history.forget();
    }
}
