//! What the program knows and can do, without drawing: the words for a person, the form to connect with, the user's
//! edits beside an encoder's memory, what is remembered.

pub mod connect;
pub mod explain;
pub mod hiperface;
mod look;
mod settings;
mod texts;

pub use look::{Look, Palette, Rgb, Spaces, TextSizes};
pub use settings::{Settings, Theme};
pub use texts::{Language, Text, Texts};
