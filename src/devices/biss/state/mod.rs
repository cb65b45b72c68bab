//! BiSS C: an open encoder, its registers and the user's edits.

mod act;
mod action;
mod connect_form;
mod decoded;
mod drafts;
mod encoder;
mod events;
pub mod explain;
pub mod format;
pub mod forms;
mod guide;
mod items;
mod kind;
mod log;
mod mark;
mod meaning;
mod memory;
mod model;
mod record;
#[cfg(test)]
mod recorded;
mod report;
mod review;
mod table;
mod texts;
mod write;

pub use texts::TEXTS;

pub use action::BissAction;
pub use connect_form::{BissForm, BissLinkKind};
pub use encoder::Encoder;
pub use guide::{GuideStep, ProcedureEnd, ProcedureRun, StepStatus};
pub use mark::ValidityMark;
pub use memory::{EditedRuns, Memory, MemoryError, area_addresses};
pub use record::{FrameStream, Record};
pub use report::status_lines;
pub use review::{Review, ReviewState};
pub use table::{Group, RegisterEntry, Row, Table};
