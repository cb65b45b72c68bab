//! BiSS C: an encoder on the desk, its registers beside what the user has made of them.

mod act;
mod action;
mod drafts;
mod encoder;
mod meaning;
mod memory;
mod news;
mod record;
mod table;
pub mod words;

pub use action::Action;
pub use encoder::Encoder;
pub use memory::{Memory, MemoryError, Runs, places};
pub use record::Record;
pub use table::{Group, Row, Shown, Table};
