//! The compared items as rows, with readable names and values.

use crate::app::explain::literal_text;
use crate::app::{DeviceKind, KindRegistry, Text};
use crate::profile::{ComparedItem, ProfileDocument, ProfileError};

/// A value as shown in lists.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum ItemValue {
    Bytes(Vec<u8>),
    /// Value with its unit and meaning.
    Text(Text),
}

/// A function that describes the value of an item. It takes the item and its value, and returns `None` if the value
/// needs no description.
pub type ItemValues = Box<dyn Fn(&str, &str) -> Option<ItemValue>>;

/// Compared items in groups.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ComparedRows {
    pub groups: Vec<ComparedGroup>,
    /// Number of compared values.
    pub compared: u64,
    /// Number of items that differ or exist on only one side.
    pub different: usize,
}

/// Items that belong together, such as those of a drive or a data field.
#[derive(Clone, Debug, PartialEq)]
pub struct ComparedGroup {
    /// Heading, or `None` for a kind of device without groups.
    pub title: Option<Text>,
    pub rows: Vec<ComparedRow>,
}

/// An item with its value on both sides.
#[derive(Clone, Debug, PartialEq)]
pub struct ComparedRow {
    /// Name of the item as used on the command line.
    pub item: String,
    pub name: Text,
    /// Value on the left side, or `None` if that side does not have the item.
    pub left: Option<ItemValue>,
    pub right: Option<ItemValue>,
    pub differs: bool,
    /// Whether the value on the right side was copied from the left side. The row then stays in place, although the
    /// values are equal.
    pub is_taken: bool,
}

impl ComparedRows {
    fn rows_mut(&mut self) -> impl Iterator<Item = &mut ComparedRow> {
        self.groups.iter_mut().flat_map(|group| &mut group.rows)
    }

    /// Marks an item as copied, and updates the other items from a new comparison. Bytes that were separate rows stay
    /// separate, even if they are now equal.
    pub(super) fn mark_copied(&mut self, item: &str, now: &ComparedRows) {
        let find = |item: &str| now.groups.iter().flat_map(|group| &group.rows).find(|row| row.item == item);
        for row in self.rows_mut() {
            if row.item == item {
                row.right.clone_from(&row.left);
                (row.differs, row.is_taken) = (false, true);
            } else if let Some(now) = find(&row.item) {
                *row = ComparedRow { is_taken: row.is_taken, ..now.clone() };
            }
        }
        self.different = self.rows_mut().filter(|row| row.differs).count();
    }
}

/// Compares two profiles.
///
/// # Errors
/// Returns an error if they are of different kinds, or of a kind that the program does not support.
pub(in crate::app) fn compare_documents(
    kinds: KindRegistry,
    left: &ProfileDocument,
    right: &ProfileDocument,
) -> Result<ComparedRows, ProfileError> {
    let comparison = left.body.compare(&right.body)?;
    let found = left.body.kind();
    let unknown = || ProfileError::Device { found: found.to_owned(), known: kinds.formats.kinds().collect() };
    let kind = kinds.for_profile(found).ok_or_else(unknown)?;
    let mut rows = ComparedRows { compared: comparison.compared, ..ComparedRows::default() };
    let values = [left, right].map(|document| kind.item_values(document));
    for item in &comparison.items {
        let title = kind.item_group(&item.item);
        let row = compared_row(kinds, kind, &values, item);
        rows.different += usize::from(row.differs);
        match rows.groups.iter_mut().find(|group| group.title == title) {
            Some(group) => group.rows.push(row),
            None => rows.groups.push(ComparedGroup { title, rows: vec![row] }),
        }
    }
    Ok(rows)
}

fn compared_row(
    kinds: KindRegistry,
    kind: &dyn DeviceKind,
    [of_left, of_right]: &[ItemValues; 2],
    compared: &ComparedItem,
) -> ComparedRow {
    let ComparedItem { item, name, left, right } = compared;
    let describe = |values: &ItemValues, value: &Option<String>| {
        let value = value.as_deref()?;
        Some(values(item, value).unwrap_or_else(|| ItemValue::Text(literal_text(value))))
    };
    ComparedRow {
        item: item.clone(),
        name: kinds.item_name(kind.keyword(), item, name.as_deref()),
        left: describe(of_left, left),
        right: describe(of_right, right),
        differs: compared.differs(),
        is_taken: false,
    }
}
