//! The open devices of all kinds.

mod any_device;
mod command;
mod kind;
mod memory;
mod model;
mod open_device;
mod selection;

pub use command::DeviceCommand;
pub(crate) use kind::OpenProfile;
pub use kind::{DeviceKind, DeviceType, ProfileSubject};
pub use memory::DeviceMemory;
pub(crate) use model::PrepareFn;
pub use model::{ActionContext, DeviceModel, MotionControl};
pub use open_device::{AnyDevice, OpenDevice};
pub(super) use selection::Selection;
