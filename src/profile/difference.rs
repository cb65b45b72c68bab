//! Differences between two profiles, or between a profile and a device.

use std::ops::Range;

/// An item whose values differ.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Difference {
    /// Name of the item as accepted by `read`, such as `field:1@3+2`.
    pub item: String,
    /// Value on the left side, with bytes as upper-case hex.
    pub left: String,
    /// Value on the right side.
    pub right: String,
}

/// Result of a comparison.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Comparison {
    /// Differences in the order of the device memory.
    pub differences: Vec<Difference>,
    /// Number of compared values. Each byte of a data field is one value, including the status byte.
    pub compared: u64,
    /// Items that are present or readable only on the left side.
    pub only_left: Vec<String>,
    /// Items that are present or readable only on the right side.
    pub only_right: Vec<String>,
}

impl Comparison {
    /// Compares an item that is a single value. `None` means that a side does not have the item.
    pub fn compare_item<V: PartialEq + ToString>(&mut self, item: String, left: Option<V>, right: Option<V>) {
        match (left, right) {
            (None, None) => {}
            (Some(_), None) => self.only_left.push(item),
            (None, Some(_)) => self.only_right.push(item),
            (Some(left), Some(right)) => {
                self.compared += 1;
                if left != right {
                    self.differences.push(Difference { item, left: left.to_string(), right: right.to_string() });
                }
            }
        }
    }

    /// Returns the items that are present on only one side.
    pub fn one_sided_items(&self) -> Vec<String> {
        self.only_left.iter().chain(&self.only_right).cloned().collect()
    }
}

/// Returns the ranges of consecutive bytes that differ. Bytes beyond the shorter side are ignored.
pub(crate) fn differing_ranges(left: &[u8], right: &[u8]) -> Vec<Range<usize>> {
    let mut runs: Vec<Range<usize>> = Vec::new();
    for (at, _) in left.iter().zip(right).enumerate().filter(|(_, (a, b))| a != b) {
        match runs.last_mut() {
            Some(run) if run.end == at => run.end += 1,
            _ => runs.push(at..at + 1),
        }
    }
    runs
}
