//! What differs between two encoders, or between an encoder and a profile: an item each, as `read` names them.

use super::{InterbusProfile, Item};
use crate::profile::{Comparison, Difference};

/// Compares parameters, the shift of the window, masks and cams. What is only recorded is not part of it, nor are names.
pub fn compare(left: &InterbusProfile, right: &InterbusProfile) -> Comparison {
    let mut comparison = Comparison::default();
    for item in Item::writable() {
        let name = item.to_string();
        match (left.image.item(item), right.image.item(item)) {
            (None, None) => {}
            (Some(_), None) => comparison.only_left.push(name),
            (None, Some(_)) => comparison.only_right.push(name),
            (Some(left), Some(right)) => {
                comparison.compared += 1;
                if left != right {
                    let (left, right) = (left.to_string(), right.to_string());
                    comparison.differences.push(Difference { item: name, left, right });
                }
            }
        }
    }
    comparison
}
