//! What differs between two devices, or between a device and a profile: a parameter each, as `read` names them.

use super::{HiperdriveProfile, Item};
use crate::profile::Comparison;

/// Compares the parameters that are kept. Who the devices are is not part of it, nor what is measured.
pub fn compare(left: &HiperdriveProfile, right: &HiperdriveProfile) -> Comparison {
    let mut comparison = Comparison::default();
    let both = left.image.with(&right.image);
    for number in both.values.into_keys() {
        comparison.add(Item(number).to_string(), left.image.get(number), right.image.get(number));
    }
    comparison
}
