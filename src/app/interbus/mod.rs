//! The INTERBUS tab: what is wanted of an encoder beside what it says, and its cams as a chart. Complete without a window.

pub mod cams;
pub mod staged;

pub use staged::{Edit, EditError, Mark, Place, Staged, Wanted};
