//! Data fields in another encoder's profile that contain bytes of unknown meaning. These bytes may include an offset
//! between encoder and motor.

use super::{DeviceState, RestoreOptions};
use crate::devices::hiperface::profile::{FieldImage, FieldRange, HiperfaceProfile};
use crate::profile::difference::differing_ranges;

/// Data field whose bytes of unknown meaning differ between an encoder and another encoder's profile. They may include
/// an offset between encoder and motor.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct UnknownMeaningField {
    /// Field number.
    pub field: u8,
    /// Number of differing bytes of unknown meaning.
    pub bytes: usize,
    /// The user's decision. `Some(true)` copies the bytes. Otherwise, they are left unchanged.
    pub answer: Option<bool>,
}

impl UnknownMeaningField {
    /// Returns whether the bytes are copied to the other encoder.
    pub fn is_copied(&self) -> bool {
        self.answer == Some(true)
    }

    /// Returns the whole field as an item, which `--copy` and `--leave` accept.
    pub fn as_range(&self) -> FieldRange {
        FieldRange { field: self.field, start: 0, count: None }
    }
}

/// Returns the data fields that differ from another encoder's profile in bytes other than mounting values.
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
