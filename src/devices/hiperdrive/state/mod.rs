//! State of the HIPERDRIVE tab: data about an adapter or a hub and its drives, edited values, and motion of the drives.
//! It does not depend on a window.

mod act;
mod action;
pub mod axis;
mod brake;
mod connect_form;
mod discovery;
mod drafts;
mod endless_run;
mod events;
pub mod explain;
pub mod format;
pub mod forms;
mod items;
mod job;
mod kind;
pub mod leds;
mod model;
mod moves;
pub mod network;
mod outside;
mod record;
#[cfg(test)]
mod recorded;
mod remembered;
mod report;
mod request_state;
mod review;
mod rows;
mod ruler;
mod setup;
mod staged;
mod survey;
mod texts;
mod trace;
mod unit;
mod unsaved;
mod write;

pub use texts::TEXTS;

pub use action::{HiperdriveAction, MotorCommand};
pub use connect_form::{HiperdriveForm, HiperdriveLinkKind, VirtualHub};
pub use discovery::{Discovery, DiscoveryAction, DiscoveryFinder, DiscoveryStub, FoundDevice};
pub use moves::DriveMotion;
pub use record::Record;
pub use report::status_lines;
pub use request_state::RequestState;
pub use review::{Review, ReviewState};
pub use rows::Row;
pub use ruler::{PositionRangeError, PositionUnit, Ruler};
pub use staged::{Edit, EditError, EditFinding, LimitsPolicy, SavedEdit, StagedEdits, ValueDifference, is_editable};
pub use unit::HiperdriveDevice;
