//! The kinds of devices that this program knows: the one file that names them all, a line each.

mod kind;

use std::sync::OnceLock;

pub use kind::{Kind, Program, ToolTab};

use crate::buses::ethernet_ip::commands::EthernetIpDecoder;
use crate::devices::{biss, hiperdrive, hiperface, interbus, ssi};
use crate::signals;

/// The kinds of devices, in the order of the navigation and of the help.
pub const KINDS: [Kind; 5] = [hiperface::KIND, biss::KIND, ssi::KIND, interbus::KIND, hiperdrive::KIND];

/// Returns the program with all of them.
pub fn program() -> Program {
    static PROGRAM: OnceLock<Program> = OnceLock::new();
    *PROGRAM.get_or_init(|| {
        Program::new(&KINDS, &[signals::TAB], &[&EthernetIpDecoder], &[&signals::commands::AnalyseCommand])
    })
}

#[cfg(test)]
mod tests;
