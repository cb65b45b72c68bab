//! What differs between two encoders, or between an encoder and a profile: an item each, as `read` names them.

use super::{InterbusProfile, Item};
use crate::profile::Comparison;

/// Compares parameters, the shift of the window, masks and cams. What is only recorded is not part of it, nor are names.
pub fn compare(left: &InterbusProfile, right: &InterbusProfile) -> Comparison {
    let mut comparison = Comparison::default();
    for item in Item::writable() {
        comparison.add(item.to_string(), left.image.item(item), right.image.item(item));
    }
    comparison
}
