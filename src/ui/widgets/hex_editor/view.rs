//! The cursor and selection of a hex editor, independent of its bytes.

use std::ops::Range;

use crate::app::Text;

#[derive(Clone, Debug, Default)]
pub struct HexView {
    anchor: usize,
    cursor: usize,
    len: usize,
    /// High nibble already typed for the byte at the cursor, if any.
    pub(super) pending: Option<u8>,
    pub(super) column: Column,
    pub(super) problem: Option<Text>,
    pub(super) reveal: bool,
    pub(super) page: usize,
    /// The bytes before the last undo or redo, if any.
    before: Option<Vec<u8>>,
}

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) enum Column {
    #[default]
    Hex,
    Text,
}

impl HexView {
    pub fn cursor(&self) -> usize {
        self.cursor
    }

    /// Returns the range of selected addresses. It contains at least the byte at the cursor, unless the editor is
    /// empty.
    pub fn selection(&self) -> Range<usize> {
        let (first, last) = (self.anchor.min(self.cursor), self.anchor.max(self.cursor));
        first..(last + 1).min(self.len.max(first))
    }

    /// Selects a range and scrolls to its end. An empty range only sets the cursor.
    pub fn select(&mut self, range: Range<usize>) {
        self.pending = None;
        self.anchor = range.start;
        self.cursor = range.end.saturating_sub(1).max(range.start);
        self.len = self.len.max(range.end);
        self.reveal = true;
    }

    /// Returns the range of bytes to interpret as numbers: the selection, or everything from the cursor onward if only
    /// one byte is selected.
    pub fn to_read<'a>(&self, bytes: &'a [u8]) -> &'a [u8] {
        let selected = self.selection();
        let range = if selected.len() > 1 { selected } else { self.cursor..bytes.len() };
        bytes.get(range).unwrap_or_default()
    }

    /// Moves the cursor to the first byte changed by an undo or redo step. `before` contains the bytes before the
    /// change.
    pub fn move_to_change(&mut self, before: &[u8]) {
        self.pending = None;
        self.before = Some(before.to_vec());
    }

    /// Moves the cursor to the first byte changed by an undo or redo step.
    pub(super) fn move_cursor_to_change(&mut self, wanted: &[u8]) {
        let Some(before) = self.before.take().filter(|before| before.len() == wanted.len()) else { return };
        if let Some(at) = before.iter().zip(wanted).position(|(before, now)| before != now) {
            self.move_cursor(at, false);
        }
    }

    /// Returns the reason why the last request was rejected.
    pub fn problem(&self) -> Option<&Text> {
        self.problem.as_ref()
    }

    /// Clamps the cursor and selection to a new number of bytes, which may be smaller.
    pub(super) fn adapt_to_len(&mut self, len: usize) {
        self.len = len;
        let last = len.saturating_sub(1);
        if self.cursor > last || self.anchor > last {
            self.pending = None;
        }
        self.cursor = self.cursor.min(last);
        self.anchor = self.anchor.min(last);
    }

    /// Moves the cursor. If `selecting` is set, extends the selection.
    pub(super) fn move_cursor(&mut self, to: usize, selecting: bool) {
        self.pending = None;
        self.cursor = to.min(self.len.saturating_sub(1));
        if !selecting {
            self.anchor = self.cursor;
        }
        self.reveal = true;
    }
}
