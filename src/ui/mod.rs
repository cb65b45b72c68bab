//! The window: drawing only. A view reads the state, keeps nothing but its own text buffers and selection, and pushes
//! actions; it never does I/O, decodes, sorts or blocks.

pub(crate) mod backups;
pub(crate) mod check;
pub(crate) mod controls;
pub(crate) mod dialogs;
mod docks;
mod end;
pub(crate) mod foot;
mod header;
pub mod icons;
mod keys;
pub(crate) mod motor;
mod navigation;
pub(crate) mod page;
pub(crate) mod panels;
pub mod plot;
mod review;
mod run;
mod skin;
pub(crate) mod stopping;
pub mod widgets;
mod window;
pub(crate) mod wires;
mod workspace;

use crate::devices::biss::views as biss;
use crate::devices::hiperdrive::views as hiperdrive;
use crate::devices::hiperface::views as hiperface;
use crate::devices::interbus::views as interbus;
use crate::devices::ssi::views as ssi;
use crate::signals::views as signals;
pub use run::run;
pub use skin::{Skin, install_fonts};
pub use window::{Views, Window};

/// The pages of a tab in their order, as the table of texts names them.
pub fn pages(tab: crate::app::Tab) -> Vec<&'static str> {
    match tab {
        crate::app::Tab::Hiperface => hiperface::Page::ALL.into_iter().map(hiperface::Page::word).collect(),
        crate::app::Tab::Biss => biss::Page::ALL.into_iter().map(biss::Page::word).collect(),
        crate::app::Tab::Ssi => ssi::Page::ALL.into_iter().map(ssi::Page::word).collect(),
        crate::app::Tab::Interbus => interbus::Page::ALL.into_iter().map(interbus::Page::word).collect(),
        crate::app::Tab::Hiperdrive => hiperdrive::Page::ALL.into_iter().map(hiperdrive::Page::word).collect(),
        crate::app::Tab::Signals => signals::Page::ALL.into_iter().map(signals::Page::word).collect(),
    }
}
