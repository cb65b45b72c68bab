//! Values of a drive that are known to differ from the saved ones after an interrupted set-up. They must be written
//! back.

use super::DriveFacts;
use crate::devices::hiperdrive::protocol::drive_parameter::REFERENCE;

/// A parameter, identified by its number for drive 1, whose value differs from the saved value.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Difference {
    pub number: u16,
    pub saved: i64,
    pub now: i64,
}

impl DriveFacts {
    /// Returns the values known to differ from the saved values, by number.
    pub fn differences(&self) -> Vec<Difference> {
        let difference = |(number, saved): (&u16, &i64)| {
            let now = *self.values.get(number)?;
            (now != *saved).then_some(Difference { number: *number, saved: *saved, now })
        };
        self.unsaved.iter().filter_map(difference).collect()
    }
}

/// Returns whether the position that was set is known to differ from the saved position.
pub(super) fn is_position_different(seen: &DriveFacts) -> bool {
    seen.differences().iter().any(|own| own.number == REFERENCE)
}

/// Returns the values to write in order to restore the previous state. The reference is left to the user, because
/// writing it assigns the number to the current location of the axis (manual, 198). At any other location, this would
/// set a wrong zero.
pub(super) fn values_to_restore(seen: &DriveFacts) -> Vec<(u16, i64)> {
    let differences = seen.differences().into_iter().filter(|own| own.number != REFERENCE);
    differences.map(|own| (own.number, own.saved)).collect()
}
