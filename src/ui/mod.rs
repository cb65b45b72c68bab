//! The window: drawing only. A view reads the state, keeps nothing but its own text buffers and selection, and pushes
//! actions; it never does I/O, decodes, sorts or blocks.

mod controls;
mod dialogs;
mod docks;
mod header;
mod hiperface;
pub mod icons;
mod panels;
pub mod plot;
mod run;
mod signals;
mod skin;
pub mod widgets;
mod window;
mod workspace;

pub use run::run;
pub use skin::{Skin, install_fonts};
pub use window::{Views, Window};
