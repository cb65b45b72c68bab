//! Profiles, differences and plans. There is no I/O here: the `store` module opens files, and the procedures of a
//! device access the device.

#![warn(missing_docs)]

mod body;
mod cause;
mod changed_item;
pub(crate) mod difference;
mod document;
mod entry_location;
mod error;
mod misspelt;
pub(crate) mod mounting;
mod plan;
mod restore;
mod rewrite;
pub(crate) mod ron_text;
mod source;
#[cfg(test)]
pub(crate) mod testing;
#[cfg(test)]
mod tests;
mod undo;
mod unique_names;
mod write;
mod written;

pub use body::{Body, Profile, ProfileBody, ProfileFormat, ProfileFormats};
pub use cause::Cause;
pub use changed_item::ChangedItem;
pub use difference::{ComparedItem, Comparison, Difference};
pub use document::{ProfileDocument, SCHEMA};
pub(crate) use entry_location::find_location;
pub use error::{ProfileError, SyntaxErrorKind};
pub use mounting::MountingMark;
pub use plan::{Consent, Operation, Plan, PlanId};
pub use restore::{Restore, RestoreOptions};
pub use rewrite::{ChangedSide, diverging_changes};
pub use ron_text::{Entries, UnknownValues, Writer};
pub use source::{Change, PathStep, UpdatedText};
pub(crate) use undo::single_bytes;
pub use undo::{IrreversibleItem, LaterChange, Redo, UndoableWrite, ValueChanges};
pub(crate) use write::WriteInterruption;
pub use write::{ConfirmedPlan, DeviceError, InterruptedWrite, OperationError, Write};
pub use written::{WriteRecord, WrittenChanges};
