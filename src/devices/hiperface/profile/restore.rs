//! Plans a restore. Only differences are written, in as few writes as possible. Mounting values from another encoder
//! are not written unless the user agrees.

mod device;
mod error;
mod planner;
mod undo;
mod unknown;

use std::collections::BTreeMap;
use std::fmt;

pub use device::{check_allowed, check_device};
pub use error::PlanError;
pub use undo::created_fields;
pub use unknown::UnknownMeaningField;

use planner::Planner;
use undo::{deletable_created_fields, delete, without_fields};
use unknown::unknown_fields;

use super::{FieldImage, FieldRange, HiperfacePlan, HiperfaceProfile};
use crate::devices::hiperface::protocol::FreeMemory;

/// Options of a restore.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct RestoreOptions {
    /// Whether the profile may be written to an encoder with another serial number.
    pub allow_other_device: bool,
    /// Whether the profile may be written to an encoder of another type.
    pub allow_other_type: bool,
    /// Whether mounting values may be written to another encoder.
    pub with_mounting: bool,
    /// Whether a field may be deleted and created again to change its size even if it is not the last field. This also
    /// affects all fields after it.
    pub recreate: bool,
    /// The user's decision for each data field that contains bytes of unknown meaning and would be written to another
    /// encoder. `true` copies the field. A field without a decision is left unchanged.
    pub copy: BTreeMap<u8, bool>,
}

/// Current content of an encoder's memory.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct DeviceState {
    /// Serial number, or an empty string if the encoder has none.
    pub serial_number: String,
    /// Type code.
    pub encoder_type: u8,
    /// Free memory and number of data fields.
    pub memory: FreeMemory,
    /// All data fields in ascending order.
    pub fields: Vec<FieldImage>,
}

/// Result of planning a restore.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Restore {
    /// Part of the result that does not depend on the kind of device.
    pub common: crate::profile::Restore<HiperfacePlan, FieldRange, FieldRange>,
    /// Data fields whose bytes of unknown meaning differ between the profile and the encoder.
    pub unknown_fields: Vec<UnknownMeaningField>,
    /// Data fields that the write created and that are kept, because they have changed or other fields follow.
    pub created_left: Vec<u8>,
}

/// Value that must be set up again after another encoder's profile has been restored.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RequiredSetup {
    /// Offset between encoder and motor.
    Commutation,
    /// A mounting value.
    Value(FieldRange),
}

impl fmt::Display for RequiredSetup {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            RequiredSetup::Commutation => f.write_str("commutation"),
            RequiredSetup::Value(range) => range.fmt(f),
        }
    }
}

/// Plans to restore a profile to an encoder.
///
/// # Errors
/// Returns a [`PlanError`] if the restore is not possible. In this case, nothing has been written.
pub fn plan_restore(
    profile: &HiperfaceProfile,
    device: &DeviceState,
    options: RestoreOptions,
) -> Result<Restore, PlanError> {
    check_allowed(profile, &device.serial_number, device.encoder_type, &options)?;
    let is_other = check_device(profile, &device.serial_number, device.encoder_type).is_err();
    let unknown_fields = if is_other { unknown_fields(profile, device, &options) } else { Vec::new() };
    let left: Vec<u8> = unknown_fields.iter().filter(|own| !own.is_copied()).map(|own| own.field).collect();
    let (undone, created_left) =
        if is_other { (Vec::new(), Vec::new()) } else { deletable_created_fields(profile, device) };
    let now = without_fields(device, &undone);
    let mut planner = Planner {
        profile,
        device: &now,
        wanted: profile.fields.clone(),
        left,
        is_other,
        with_mounting: options.with_mounting,
        ops: Vec::new(),
        unchanged: 0,
        missing: Vec::new(),
        mounting_left: Vec::new(),
        mounting_written: Vec::new(),
        touched: Vec::new(),
    };
    planner.skip_unknown_fields();
    planner.check_fields_are_consecutive()?;
    let recreated = planner.first_field_to_recreate(options.recreate)?;
    planner.check_memory(recreated)?;
    let mut kept = now.fields.clone();
    if let Some(first) = recreated {
        planner.delete_fields_from(first)?;
        kept.truncate(usize::from(first));
    }
    for target in planner.target_fields(recreated) {
        match kept.iter().find(|field| field.number == target.number) {
            Some(now) => planner.change_field(now, &target),
            None => planner.create(&target),
        }
    }
    let mut common = planner.finish();
    common.plan.ops.splice(0..0, undone.iter().map(delete));
    common.plan.base.field_count = device.memory.fields;
    common.plan.base.fields.extend(undone.into_iter().rev());
    Ok(Restore { common, unknown_fields, created_left })
}

#[cfg(test)]
mod tests;
