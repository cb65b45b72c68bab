//! What of a drive is known to be other than saved: after a run that was broken off, and for what is written back.

use super::Seen;
use crate::devices::hiperdrive::protocol::drive_parameter::REFERENCE;

/// A parameter, by the number of drive 1.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Difference {
    /// Which one.
    pub number: u16,
    /// As it was saved.
    pub saved: i64,
    /// As it is.
    pub now: i64,
}

impl Seen {
    /// What is known to be other than saved, by number.
    pub fn differences(&self) -> Vec<Difference> {
        let difference = |(number, saved): (&u16, &i64)| {
            let now = *self.values.get(number)?;
            (now != *saved).then_some(Difference { number: *number, saved: *saved, now })
        };
        self.unsaved.iter().filter_map(difference).collect()
    }
}

/// The position that is set is known to be another than the saved one.
pub(super) fn is_place_other(seen: &Seen) -> bool {
    seen.differences().iter().any(|own| own.number == REFERENCE)
}

/// What is to be written so that all is as it was. The reference is set by a person, at its place: writing it gives the place
/// where the axis stands that number (manual, 198), which at any other place would be a wrong zero.
pub(super) fn to_write_back(seen: &Seen) -> Vec<(u16, i64)> {
    let differences = seen.differences().into_iter().filter(|own| own.number != REFERENCE);
    differences.map(|own| (own.number, own.saved)).collect()
}
