//! Data fields with bytes of unknown meaning in a profile of another encoder. They may contain an offset between
//! encoder and motor.

use super::{DeviceState, RestoreOptions};
use crate::devices::hiperface::profile::{FieldImage, FieldRange, HiperfaceProfile};
use crate::profile::difference::differing_ranges;

/// Data field in which bytes of unknown meaning differ between the profile and another encoder. They may contain an
/// offset between encoder and motor.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct UnknownMeaningField {
    /// Field number.
    pub field: u8,
    /// Number of differing bytes of unknown meaning.
    pub bytes: usize,
    /// Decision of the user. `Some(true)` copies the bytes. Otherwise, they are left unchanged.
    pub answer: Option<bool>,
}

impl UnknownMeaningField {
    /// Returns whether the bytes are copied to the other encoder.
    pub fn is_copied(&self) -> bool {
        self.answer == Some(true)
    }

    /// Returns the whole field as an item, in the form that `--copy` and `--leave` accept.
    pub fn as_range(&self) -> FieldRange {
        FieldRange { field: self.field, start: 0, count: None }
    }
}

/// Returns the data fields in which bytes other than mounting values differ from the profile of another encoder.
pub(super) fn unknown_fields(
    profile: &HiperfaceProfile,
    device: &DeviceState,
    options: &RestoreOptions,
) -> Vec<UnknownMeaningField> {
    let of = |target: &FieldImage| {
        let new = target.bytes.as_ref()?;
        let now = device.fields.iter().find(|field| field.number == target.number);
        let old = match now {
            // An unreadable field is left unchanged in any case.
            Some(now) => now.bytes.as_deref()?,
            None => &[],
        };
        let grown = old.len()..new.len();
        let differing = differing_ranges(old, new).into_iter().flatten().chain(grown);
        let bytes = differing.filter(|at| !profile.depends_on_mounting(target.number, *at)).count();
        let answer = options.copy.get(&target.number).copied();
        (bytes > 0).then_some(UnknownMeaningField { field: target.number, bytes, answer })
    };
    profile.fields.iter().filter_map(of).collect()
}
