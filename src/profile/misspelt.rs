//! Detection of misspelt entry names, and of entries that the schema does not define, while a profile is read.

use std::cell::{Cell, RefCell};

use super::{ProfileError, SCHEMA};

/// State shared by the structures of a file while it is being read.
#[derive(Default)]
pub(super) struct Reading {
    /// Schema of the file if newer than supported, in which case unknown entries are kept.
    newer: Cell<Option<u32>>,
    beyond: RefCell<Vec<String>>,
    /// A misspelt name found where an entry is missing, which explains an error about that entry.
    slip: RefCell<Option<Misspelling>>,
}

/// A name that differs from an expected one by a typing error. Misspellings are ordered by the number of differing
/// letters.
#[derive(PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Misspelling {
    pub(super) letters: usize,
    pub(super) path: String,
    pub(super) intended: String,
}

impl Misspelling {
    /// Returns the error without its line number, which is added later.
    pub(super) fn error(self) -> ProfileError {
        let Misspelling { path, intended, .. } = self;
        ProfileError::Misspelt { line: 0, column: 0, path, intended }
    }
}

impl Reading {
    /// Records that the file uses the given newer schema.
    pub(super) fn set_newer_schema(&self, schema: u32) {
        self.newer.set(Some(schema));
    }

    pub(super) fn is_newer(&self) -> bool {
        self.newer.get().is_some()
    }

    /// Records that the entry at this path is not part of the known schema.
    pub(super) fn is_beyond(&self, path: String) {
        self.beyond.borrow_mut().push(path);
    }

    /// Returns the paths of the entries that are not part of the known schema, in reading order.
    pub(super) fn beyond(&self) -> Vec<String> {
        self.beyond.borrow().clone()
    }

    /// Records a misspelt name where reading ended early. The innermost structure takes precedence.
    pub(super) fn record_misspelling(&self, slip: Misspelling) {
        self.slip.borrow_mut().get_or_insert(slip);
    }

    /// Returns the error to report, which is the misspelt name if that is the cause, or the schema if the file has a
    /// newer schema. An error about another entry is attributed to a misspelt name only if no more than one letter
    /// differs.
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

/// Returns how many letters differ between a name and the intended one if the difference looks like a typing error,
/// which means that only a few letters differ or one name is a prefix of the other. Case, hyphens and underscores are
/// ignored.
pub(super) fn edit_distance(name: &str, intended: &str) -> Option<usize> {
    let plain = |text: &str| -> Vec<char> {
        text.chars().filter(|c| !matches!(c, '_' | '-' | ' ')).flat_map(char::to_lowercase).collect()
    };
    let (name, intended) = (plain(name), plain(intended));
    let (shorter, longer) = if name.len() < intended.len() { (&name, &intended) } else { (&intended, &name) };
    let begins = shorter.len() >= 3 && longer.starts_with(shorter);
    let letters = distance(&name, &intended);
    (begins || letters <= (longer.len() / 2).clamp(1, 3)).then_some(letters)
}

/// Returns the number of letters that must be inserted, removed, replaced or swapped with a neighbour to turn one name
/// into the other.
fn distance(from: &[char], to: &[char]) -> usize {
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
    fn typos_are_distinguished_from_other_names() {
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
