//! HIPERFACE profiles: the saved content of an encoder, and how it is compared and restored.

#![warn(missing_docs)]

mod commutation;
mod compare;
mod edit;
mod entry_error;
mod item;
mod plan;
mod record;
mod restore;
mod undo;

pub use commutation::{CommutationRecord, CommutationRecordError};
pub use edit::{plan_create, plan_delete, plan_redefine, plan_scalar, plan_store};
pub use entry_error::EntryError;
pub use item::{FieldRange, Item, ItemError, PlanItem};
pub use plan::{Base, HiperfacePlan, Op, SingleValue};
pub use record::{FieldImage, HiperfaceProfile, Interface, MountingMark, ProfileIdentity, RecordedValues};
pub use restore::{
    DeviceState, PlanError, RequiredSetup, Restore, RestoreOptions, UnknownMeaningField, check_allowed, check_device,
    created_fields, plan_restore,
};
