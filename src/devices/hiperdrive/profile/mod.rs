//! HIPERDRIVE profiles: the values that an adapter or a hub stores for itself and its drives, the comparison of two
//! profiles, and the planning of writes.

#![warn(missing_docs)]

mod edit;
mod entry_error;
mod error;
mod image;
mod item;
mod network;
mod plan;
mod record;
mod restore;
#[cfg(test)]
mod test_profiles;
mod text;
mod undo;
mod warning;

pub use edit::{Positions, plan_edits, plan_service, plan_set_position};
pub use entry_error::EntryError;
pub use error::{PlanError, TypeMismatch};
pub use image::Image;
pub use item::{Item, ItemError};
pub use network::{NetworkSettings, plan_network};
pub use plan::{Base, HiperdrivePlan, Op, Service, written_values};
pub use record::{HiperdriveProfile, MountingMark, ProfileDrive, ProfileIdentity, UnknownEntries};
pub use restore::{DeviceState, Restore, RestoreOptions, check_device, plan_restore, type_differences};
pub use warning::{Warning, plan_warnings};
