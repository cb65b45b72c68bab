//! Values of a drive that still differ from the saved values after an interrupted set-up, and have to be written back.

use super::DriveFacts;
use crate::devices::hiperdrive::protocol::drive_parameter::REFERENCE;

/// A parameter, given by its number for drive 1, whose value differs from the saved value.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Difference {
    pub number: u16,
    pub saved: i64,
    pub now: i64,
}

impl DriveFacts {
    /// Returns all values that are known to differ from the saved values, in the order of their numbers.
    pub fn differences(&self) -> Vec<Difference> {
        let difference = |(number, saved): (&u16, &i64)| {
            let now = *self.values.get(number)?;
            (now != *saved).then_some(Difference { number: *number, saved: *saved, now })
        };
        self.unsaved.iter().filter_map(difference).collect()
    }
}

/// Returns whether the set position is known to differ from the saved position.
pub(super) fn is_position_different(seen: &DriveFacts) -> bool {
    seen.differences().iter().any(|own| own.number == REFERENCE)
}

/// Returns the values to write back. The reference is not one of them, because writing it assigns its number to the
/// current location of the axis (manual, 198). If the axis is somewhere else, this would move the zero point, so the
/// user must set the reference.
pub(super) fn values_to_restore(seen: &DriveFacts) -> Vec<(u16, i64)> {
    let differences = seen.differences().into_iter().filter(|own| own.number != REFERENCE);
    differences.map(|own| (own.number, own.saved)).collect()
}
