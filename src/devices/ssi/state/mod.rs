//! State of the SSI tab: layouts being designed, encoders behind an adapter, and the search for a layout. It is
//! independent of the window. Nothing is ever written to an encoder.

mod act;
mod action;
mod connect_form;
mod design;
mod drafts;
mod encoder;
mod events;
pub mod explain;
mod export;
mod families;
mod form;
mod items;
mod job;
mod kind;
mod model;
mod record;
#[cfg(test)]
mod recorded;
mod report;
mod search;
pub mod strip;
mod texts;
pub mod timing;
mod trace;
mod trial;

pub use texts::TEXTS;

pub use action::{SsiAction, TrialInput};
pub use connect_form::{SsiForm, SsiLinkKind};
pub use design::{Design, Edit, LayoutDesigner};
pub use encoder::Encoder;
pub use export::ExportFormat;
pub use form::{Entry, Field, FieldInput, Group, Row, parse_whole};
pub use record::{ReceivedWord, Record, WordStream};
pub use search::{Frames, Origin, SearchState, parse_frame_file, read_clocks, read_frames};
pub use trial::{Decoded, TrialFrame};

use std::path::PathBuf;

use crate::store::FileError;

pub enum TaskResult {
    Found { number: u32, search: Box<SearchState> },
    Written(PathBuf, Result<(), FileError>),
}
