//! What the program knows and can do, without drawing: so far the words for a person.

pub mod explain;
mod texts;

pub use texts::{Language, Text, Texts};
