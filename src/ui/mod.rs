//! The window: drawing only. A view reads the state, keeps nothing but its own text buffers and selection, and pushes
//! actions; it never does I/O, decodes, sorts or blocks.

pub mod icons;
mod skin;
pub mod widgets;

pub use skin::{Skin, install_fonts};
