//! The device kinds that the program supports. No other file lists them.

mod kind;

use std::sync::OnceLock;

pub use kind::{Kind, Program, ToolTab};

use crate::buses::bridge::sim::AttachableKind;
use crate::buses::ethernet_ip::commands::EthernetIpDecoder;
use crate::signals;

pub const KINDS: &[Kind] = &[
    crate::devices::hiperface::KIND,
    crate::devices::biss::KIND,
    crate::devices::ssi::KIND,
    crate::devices::interbus::KIND,
    crate::devices::hiperdrive::KIND,
];

pub fn program() -> Program {
    static PROGRAM: OnceLock<Program> = OnceLock::new();
    *PROGRAM.get_or_init(|| {
        Program::new(KINDS, &[signals::TAB], &[&EthernetIpDecoder], &[&signals::commands::AnalyseCommand])
    })
}

/// Returns the virtual devices that can be attached to the virtual adapter. Devices with a speed setting (`rpm`) come
/// last.
pub fn attachable_kinds() -> &'static [&'static dyn AttachableKind] {
    static DEVICES: OnceLock<Vec<&'static dyn AttachableKind>> = OnceLock::new();
    DEVICES.get_or_init(|| {
        let mut devices: Vec<_> = KINDS.iter().filter_map(|kind| kind.at_adapter).collect();
        devices.sort_by_key(|device| device.setting_names().contains(&"rpm"));
        devices
    })
}

#[cfg(test)]
mod tests;
