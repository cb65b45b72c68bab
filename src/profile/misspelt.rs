//! Detects misspelt and undefined entries while a profile is being read.

use std::cell::{Cell, RefCell};

use super::{ProfileError, SCHEMA};

/// State shared by the structures of a file while it is being read.
#[derive(Default)]
pub(super) struct Reading {
    /// Schema version of the file, if it is newer than supported. Unknown entries of such a file are kept.
    newer: Cell<Option<u32>>,
    beyond: RefCell<Vec<String>>,
    /// A misspelt name that may explain why an entry is missing.
    slip: RefCell<Option<Misspelling>>,
}

/// A misspelt entry name. Misspellings are ordered by the number of wrong letters.
#[derive(PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Misspelling {
    pub(super) letters: usize,
    pub(super) path: String,
    pub(super) intended: String,
}

impl Misspelling {
    /// Converts the misspelling to an error, still without its line and column.
    pub(super) fn error(self) -> ProfileError {
        let Misspelling { path, intended, .. } = self;
        ProfileError::Misspelt { line: 0, column: 0, path, intended }
    }
}

impl Reading {
    pub(super) fn set_newer_schema(&self, schema: u32) {
        self.newer.set(Some(schema));
    }

    pub(super) fn is_newer(&self) -> bool {
        self.newer.get().is_some()
    }

    /// Records an entry that the schema does not define.
    pub(super) fn record_undefined_entry(&self, path: String) {
        self.beyond.borrow_mut().push(path);
    }

    /// Returns the paths of the entries that the schema does not define, in the order in which they were read.
    pub(super) fn undefined_entries(&self) -> Vec<String> {
        self.beyond.borrow().clone()
    }

    /// Records a misspelt name, unless an inner structure has already recorded one.
    pub(super) fn record_misspelling(&self, slip: Misspelling) {
        self.slip.borrow_mut().get_or_insert(slip);
    }

    /// Returns the error to report in place of `error`. For a newer schema, this is the schema error. An error caused
    /// by a misspelt name becomes an error about that name. Any other error is attributed to a misspelt name only if at
    /// most one letter is wrong.
    pub(super) fn reported_error(&self, error: ProfileError) -> ProfileError {
        if let Some(found) = self.newer.get() {
            return ProfileError::Schema { found, known: SCHEMA };
        }
        let Some(slip) = self.slip.take() else { return error };
        let is_it = match &error {
            ProfileError::Misspelt { .. } => false,
            ProfileError::Missing { path } => path.ends_with(&slip.intended),
            _ => slip.letters <= 1,
        };
        if is_it { slip.error() } else { error }
    }
}

/// Returns the number of wrong letters, or `None` if the name does not look like a misspelling of `intended`. Only a
/// few letters may be wrong, or one name must be a prefix of the other. Case, hyphens and underscores are ignored.
pub(super) fn edit_distance(name: &str, intended: &str) -> Option<usize> {
    let plain = |text: &str| -> Vec<char> {
        text.chars().filter(|c| !matches!(c, '_' | '-' | ' ')).flat_map(char::to_lowercase).collect()
    };
    let (name, intended) = (plain(name), plain(intended));
    let (shorter, longer) = if name.len() < intended.len() { (&name, &intended) } else { (&intended, &name) };
    let begins = shorter.len() >= 3 && longer.starts_with(shorter);
    let letters = char_distance(&name, &intended);
    (begins || letters <= (longer.len() / 2).clamp(1, 3)).then_some(letters)
}

/// Returns the edit distance between two names. Swapping two adjacent letters counts as one edit.
fn char_distance(from: &[char], to: &[char]) -> usize {
    let mut before: Vec<usize> = Vec::new();
    let mut last: Vec<usize> = (0..=to.len()).collect();
    for (row, letter) in from.iter().enumerate() {
        let mut next = vec![row + 1];
        for (column, other) in to.iter().enumerate() {
            let at = |line: &[usize], at: usize| line.get(at).copied().unwrap_or(usize::MAX - 1);
            let mut least = at(&last, column) + usize::from(letter != other);
            least = least.min(at(&last, column + 1) + 1).min(at(&next, column) + 1);
            let is_exchanged =
                row > 0 && column > 0 && from.get(row - 1) == Some(other) && to.get(column - 1) == Some(letter);
            if is_exchanged {
                least = least.min(at(&before, column - 1) + 1);
            }
            next.push(least);
        }
        (before, last) = (last, next);
    }
    last.last().copied().unwrap_or(0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn distinguishes_typos_from_other_names() {
        let cases = [
            ("filtr", "filter", Some(1)),
            ("presett", "preset", Some(1)),
            ("fitler", "filter", Some(1)),
            ("Serial-Number", "serial_number", Some(0)),
            ("pre", "preset", Some(3)),
            ("serial", "serial_number", Some(6)),
            ("identy", "identity", Some(2)),
            ("owner", "note", None),
            ("by", "item", None),
            ("colour", "counter", None),
            ("multiturn_bits", "singleturn_bits", None),
        ];
        for (name, meant, letters) in cases {
            assert_eq!(edit_distance(name, meant), letters, "{name} {meant}");
            assert_eq!(edit_distance(meant, name), letters, "{meant} {name}");
        }
    }
}
