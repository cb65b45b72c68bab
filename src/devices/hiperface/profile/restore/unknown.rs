//! Data fields of another encoder with bytes of unknown meaning, which may contain an offset between encoder and motor.

use super::{DeviceState, RestoreOptions};
use crate::devices::hiperface::profile::{FieldImage, FieldRange, HiperfaceProfile};
use crate::profile::difference::runs;

/// Data field with differing bytes of unknown meaning, if profile and encoder do not belong to the same device. These
/// bytes may contain an offset between encoder and motor.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct UnknownField {
    /// Field number.
    pub field: u8,
    /// Number of differing bytes of unknown meaning.
    pub bytes: usize,
    /// Decision of the user: `true` copies the bytes. Without a decision, the bytes are left out.
    pub answer: Option<bool>,
}

impl UnknownField {
    /// Returns whether the bytes are copied to the other encoder.
    pub fn is_copied(&self) -> bool {
        self.answer == Some(true)
    }

    /// Returns the item in the form accepted by `--copy` and `--leave`.
    pub fn item(&self) -> FieldRange {
        FieldRange { field: self.field, start: 0, count: None }
    }
}

/// Returns the data fields of another encoder's profile that differ in bytes other than mounting values.
pub(super) fn unknown_fields(
    profile: &HiperfaceProfile,
    device: &DeviceState,
    options: &RestoreOptions,
) -> Vec<UnknownField> {
    let of = |target: &FieldImage| {
        let new = target.bytes.as_ref()?;
        let now = device.fields.iter().find(|field| field.number == target.number);
        let old = match now {
            // An unreadable field is left alone regardless.
            Some(now) => now.bytes.as_deref()?,
            None => &[],
        };
        let grown = old.len()..new.len();
        let differing = runs(old, new).into_iter().flatten().chain(grown);
        let bytes = differing.filter(|at| !profile.depends_on_mounting(target.number, *at)).count();
        let answer = options.copy.get(&target.number).copied();
        (bytes > 0).then_some(UnknownField { field: target.number, bytes, answer })
    };
    profile.fields.iter().filter_map(of).collect()
}
