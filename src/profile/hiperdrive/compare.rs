//! What differs between two devices, or between a device and a profile: a parameter each, as `read` names them.

use super::{HiperdriveProfile, Item};
use crate::profile::{Comparison, Difference};

/// Compares the parameters that are kept. Who the devices are is not part of it, nor what is measured.
pub fn compare(left: &HiperdriveProfile, right: &HiperdriveProfile) -> Comparison {
    let mut comparison = Comparison::default();
    let both = left.image.with(&right.image);
    for number in both.values.into_keys() {
        let name = Item(number).to_string();
        match (left.image.get(number), right.image.get(number)) {
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
