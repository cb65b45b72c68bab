//! Data fields of another encoder whose bytes have no known meaning: they may contain an offset between encoder and motor.

use super::{DeviceState, RestoreOptions};
use crate::devices::hiperface::profile::{FieldImage, FieldRange, HiperfaceProfile};
use crate::profile::difference::runs;

/// Data field with differing bytes of no known meaning, if profile and encoder are not of one device. They may contain an
/// offset between encoder and motor.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct UnknownField {
    /// Number of the field.
    pub field: u8,
    /// Such bytes.
    pub bytes: usize,
    /// Copied or left out, as answered by the user; without an answer they are left out.
    pub answer: Option<bool>,
}

impl UnknownField {
    /// Returns whether its bytes are copied to the other encoder.
    pub fn is_copied(&self) -> bool {
        self.answer == Some(true)
    }

    /// Returns the item as `--copy` and `--leave` take it.
    pub fn item(&self) -> FieldRange {
        FieldRange { field: self.field, start: 0, count: None }
    }
}

/// Returns the data fields of another encoder's profile with bytes that differ and do not belong to the mounting.
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
        let bytes = differing.filter(|at| !profile.is_mounting(target.number, *at)).count();
        let answer = options.copy.get(&target.number).copied();
        (bytes > 0).then_some(UnknownField { field: target.number, bytes, answer })
    };
    profile.fields.iter().filter_map(of).collect()
}
