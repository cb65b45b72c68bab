//! State of the HIPERFACE tab: an open encoder, the edits to its memory, and the review of a write.

mod act;
mod action;
pub mod commutation;
mod connect_form;
mod drafts;
mod encoder;
mod events;
pub mod explain;
pub mod forms;
mod items;
mod job;
mod kind;
mod meaning;
mod model;
mod mounting;
mod position_entry;
mod record;
#[cfg(test)]
mod recorded;
mod report;
mod rest;
mod review;
pub mod rules;
mod search;
mod staged;
mod texts;
mod write;

pub use texts::TEXTS;

pub use action::HiperfaceAction;
pub use connect_form::{LinkForm, LinkKind};
pub use encoder::Encoder;
pub use position_entry::{PositionEntry, PositionUnit, position_text};
pub use record::{Record, watch_name};
pub use report::status_lines;
pub use review::{Review, ReviewState};
pub use rules::ActionPermission;
pub use search::{EncoderSearchForm, Search, SearchAction};
pub use staged::{ByteEditError, StagedEdits};
