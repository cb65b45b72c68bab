//! What one does with a device: procedures that read like the manuals' step tables.

pub mod check;
pub(crate) mod line;
mod replies;
pub(crate) mod written;

pub use line::{Echo, LineQuality, LineState};
pub use replies::Replies;
pub use written::Written;
