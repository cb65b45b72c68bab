//! Compares two profiles, or a profile with a device.

use std::ops::Range;

use crate::bits::hex_compact;

/// An item that one or both sides have.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct ComparedItem {
    /// Name of the item as accepted by `read`, such as `field:1@3+2`.
    pub item: String,
    /// Name of the register or area in the manual, if `item` is an address.
    pub name: Option<String>,
    /// Value on the left side, with bytes as upper-case hex. It is empty if unreadable, and `None` if the left side
    /// does not have the item.
    pub left: Option<String>,
    /// Value on the right side.
    pub right: Option<String>,
}

/// An item whose values differ.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Difference {
    /// Name of the item as accepted by `read`.
    pub item: String,
    /// Value on the left side, with bytes as upper-case hex.
    pub left: String,
    /// Value on the right side.
    pub right: String,
}

/// Result of a comparison.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Comparison {
    /// All items in the order of the device memory. Each run of differing bytes is one item, and so is each run of
    /// equal bytes.
    pub items: Vec<ComparedItem>,
    /// Number of values compared. Each byte of a data field, including its status byte, counts as one value.
    pub compared: u64,
}

impl ComparedItem {
    /// Returns whether the sides differ, or only one of them has the item.
    pub fn differs(&self) -> bool {
        self.left != self.right
    }
}

impl Comparison {
    /// Compares an item with a single value, which is `None` on a side that does not have the item.
    pub fn compare_item<V: PartialEq + ToString>(&mut self, item: String, left: Option<V>, right: Option<V>) {
        if left.is_some() && right.is_some() {
            self.compared += 1;
        }
        if left.is_some() || right.is_some() {
            let [left, right] = [left, right].map(|value| value.map(|value| value.to_string()));
            self.items.push(ComparedItem { item, name: None, left, right });
        }
    }

    /// Compares the bytes that both sides have. `item` returns the name for a range of bytes.
    pub(crate) fn compare_bytes(&mut self, left: &[u8], right: &[u8], item: impl Fn(Range<usize>) -> ComparedItem) {
        self.compared += left.len().min(right.len()) as u64;
        for (_, run) in runs(left, right) {
            let part = |side: &[u8]| Some(hex_compact(side.get(run.clone()).unwrap_or_default()));
            self.items.push(ComparedItem { left: part(left), right: part(right), ..item(run.clone()) });
        }
    }

    /// Returns the items whose values differ.
    pub fn differences(&self) -> Vec<Difference> {
        let difference = |own: &ComparedItem| {
            let (left, right) = (own.left.clone()?, own.right.clone()?);
            (left != right).then(|| Difference { item: own.item.clone(), left, right })
        };
        self.items.iter().filter_map(difference).collect()
    }

    /// Returns the items that are present or readable only on the left side.
    pub fn only_left(&self) -> Vec<String> {
        self.items.iter().filter(|own| own.right.is_none()).map(|own| own.item.clone()).collect()
    }

    /// Returns the items that are present or readable only on the right side.
    pub fn only_right(&self) -> Vec<String> {
        self.items.iter().filter(|own| own.left.is_none()).map(|own| own.item.clone()).collect()
    }

    /// Returns the items that are present on only one side.
    pub fn one_sided_items(&self) -> Vec<String> {
        [self.only_left(), self.only_right()].concat()
    }
}

/// Returns the ranges in which bytes differ. Bytes beyond the end of the shorter side are ignored.
pub(crate) fn differing_ranges(left: &[u8], right: &[u8]) -> Vec<Range<usize>> {
    runs(left, right).into_iter().filter(|(differs, _)| *differs).map(|(_, run)| run).collect()
}

/// Splits the bytes into ranges in which all are equal or all differ. The flag is set for ranges that differ.
fn runs(left: &[u8], right: &[u8]) -> Vec<(bool, Range<usize>)> {
    let mut runs: Vec<(bool, Range<usize>)> = Vec::new();
    for (at, (left, right)) in left.iter().zip(right).enumerate() {
        let differs = left != right;
        match runs.last_mut() {
            Some((own, run)) if *own == differs => run.end += 1,
            _ => runs.push((differs, at..at + 1)),
        }
    }
    runs
}
