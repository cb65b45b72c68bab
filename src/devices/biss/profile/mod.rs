//! BiSS profiles, which hold the saved content of an encoder. They can be compared and restored. Guided procedures are
//! planned here as well.

#![warn(missing_docs)]

mod compare;
mod edit;
mod entry_error;
mod item;
mod note;
mod other_type;
mod plan;
mod record;
mod restore;
#[cfg(test)]
mod test_profiles;
mod text;
mod undo;

pub use edit::{
    MotorSource, MountingSteps, RegisterKind, find_procedure, plan_edits, plan_filter, plan_mounting, plan_preset,
    register_kind,
};
pub use entry_error::EntryError;
pub use item::{ItemError, RegisterRange};
pub use other_type::{TypeMismatch, Width, other_type};
pub use plan::{Base, BissPlan, Op, PresetParts, RegisterChange};
pub use record::{
    Bank, BissProfile, DataImage, ListedBank, MountingItem, MountingMark, PresetSetting, ProfileIdentity,
    RecordedValues,
};
pub use restore::{
    DeviceState, PlanError, Restore, RestoreOptions, check_allowed, check_device, plan_data_areas, plan_restore,
    required_banks,
};
