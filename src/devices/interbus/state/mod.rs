//! State of the INTERBUS tab: the values of an encoder, its edits and its cams. It does not depend on the window.

mod act;
mod action;
pub mod cams;
mod connect_form;
mod drafts;
mod encoder;
mod events;
pub mod explain;
pub mod format;
pub mod forms;
mod items;
mod job;
mod kind;
mod model;
mod preview;
pub mod reader;
mod record;
#[cfg(test)]
mod recorded;
mod report;
mod review;
pub mod staged;
mod table;
mod texts;
mod trace;
pub mod word_meaning;
mod write;

pub use texts::TEXTS;

pub use action::InterbusAction;
pub use connect_form::{InterbusForm, InterbusLinkKind};
pub use encoder::Encoder;
pub use preview::{OutputComparison, OutputMismatch};
pub use record::Record;
pub use report::status_lines;
pub use review::{Review, ReviewState};
use std::path::PathBuf;

use crate::store::FileError;

pub use staged::{Edit, EditError, EditFinding, EditedValues, StagedEdits, ValueId};
pub use table::Import;

pub enum TaskResult {
    /// A cam table file was read.
    Read(PathBuf, Result<String, FileError>),
    Written(PathBuf, Result<(), FileError>),
}
