//! Bytes that a user wants otherwise than the device has them, by their place, with steps that can be undone. What a byte
//! is on the device, and whether it may be edited at all, is said by whoever holds the memory.

use std::collections::BTreeMap;

use super::history::History;

/// Edited bytes by their place.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Edits<K: Ord + Copy> {
    edits: BTreeMap<K, u8>,
    history: History<BTreeMap<K, u8>>,
}

impl<K: Ord + Copy> Default for Edits<K> {
    fn default() -> Self {
        Edits { edits: BTreeMap::new(), history: History::default() }
    }
}

impl<K: Ord + Copy> Edits<K> {
    /// The byte that is wanted here; `None`: as the device has it.
    pub(crate) fn get(&self, at: K) -> Option<u8> {
        self.edits.get(&at).copied()
    }

    /// There is something to write.
    pub(crate) fn is_dirty(&self) -> bool {
        !self.edits.is_empty()
    }

    /// All of them, in the order of their places.
    pub(crate) fn iter(&self) -> impl Iterator<Item = (K, u8)> {
        self.edits.iter().map(|(at, byte)| (*at, *byte))
    }

    /// Edits bytes, as one step that can be undone; `is_edit` says whether a byte at its place is one.
    pub(crate) fn put(&mut self, bytes: impl IntoIterator<Item = (K, u8)>, is_edit: impl Fn(K, u8) -> bool) {
        self.step(|edits| {
            for (at, byte) in bytes {
                if is_edit(at, byte) {
                    edits.insert(at, byte);
                } else {
                    edits.remove(&at);
                }
            }
        });
    }

    /// Takes edits back, as one step that can be undone. False where none is meant.
    pub(crate) fn revert(&mut self, is_meant: impl Fn(K) -> bool) -> bool {
        self.step(|edits| edits.retain(|at, _| !is_meant(*at)))
    }

    /// Forgets what is no edit any more: the device was read again, or a step was undone.
    pub(crate) fn settle(&mut self, is_edit: impl Fn(K, u8) -> bool) {
        self.edits.retain(|at, byte| is_edit(*at, *byte));
    }

    /// There is a step to undo.
    pub(crate) fn can_undo(&self) -> bool {
        self.history.can_undo()
    }

    /// There is a step to do again.
    pub(crate) fn can_redo(&self) -> bool {
        self.history.can_redo()
    }

    /// Undoes the last step. False when there is none.
    pub(crate) fn undo(&mut self) -> bool {
        self.history.undo(&mut self.edits)
    }

    /// Does the last undone step again. False when there is none.
    pub(crate) fn redo(&mut self) -> bool {
        self.history.redo(&mut self.edits)
    }

    /// What was undone belongs to another memory.
    pub(crate) fn forget_redo(&mut self) {
        self.history.forget_undone();
    }

    /// What led here cannot be undone any more.
    pub(crate) fn forget_steps(&mut self) {
        self.history.forget();
    }

    fn step(&mut self, change: impl FnOnce(&mut BTreeMap<K, u8>)) -> bool {
        let mut after = self.edits.clone();
        change(&mut after);
        self.history.step(&mut self.edits, after)
    }
}
