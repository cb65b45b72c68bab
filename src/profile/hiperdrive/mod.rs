//! HIPERDRIVE: what an adapter or a hub keeps of itself and its drives, what is saved of it, how two differ, and what a write
//! would do.

mod error;
mod image;
mod item;
mod network;
mod plan;
mod record;

pub use error::{NetworkError, PlanError};
pub use image::Image;
pub use item::{Item, ItemError};
pub use network::{AddressSource, Interface, NetworkSettings};
pub use plan::{Base, HiperdrivePlan, Op, Service};
pub use record::{HiperdriveProfile, Kept, MountingMark, ProfileDrive, ProfileIdentity};
