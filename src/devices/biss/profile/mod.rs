//! BiSS profiles, which contain the saved content of an encoder. This includes comparing two encoders, and planning
//! restores and guided procedures.

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
