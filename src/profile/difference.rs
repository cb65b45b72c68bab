//! The differences between two profiles, or between a profile and a device.

use std::ops::Range;

/// One thing that is not the same on both sides.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Difference {
    /// The name, as `read` takes it: `field:1@3+2`.
    pub item: String,
    /// The value on the left; bytes as upper-case hex.
    pub left: String,
    /// The value on the right.
    pub right: String,
}

/// The result of a comparison.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Comparison {
    /// Only the differences, in the order of the device's memory.
    pub differences: Vec<Difference>,
    /// Number of values compared: a byte of a data field counts one, and so does its status byte.
    pub compared: u64,
    /// Items that only the left side has, or that the right side cannot read.
    pub only_left: Vec<String>,
    /// Items that only the right side has, or that the left side cannot read.
    pub only_right: Vec<String>,
}

impl Comparison {
    /// Compares an item that counts one, as far as both sides have it.
    pub fn add<V: PartialEq + ToString>(&mut self, item: String, left: Option<V>, right: Option<V>) {
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

    /// Returns the items that only one side has.
    pub fn missing(&self) -> Vec<String> {
        self.only_left.iter().chain(&self.only_right).cloned().collect()
    }
}

/// Runs of differing bytes, as far as both sides reach.
pub(crate) fn runs(left: &[u8], right: &[u8]) -> Vec<Range<usize>> {
    let mut runs: Vec<Range<usize>> = Vec::new();
    for (at, _) in left.iter().zip(right).enumerate().filter(|(_, (a, b))| a != b) {
        match runs.last_mut() {
            Some(run) if run.end == at => run.end += 1,
            _ => runs.push(at..at + 1),
        }
    }
    runs
}
