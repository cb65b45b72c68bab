//! CSV table of the clocks in a frame with their content.

use std::fmt::Write;

use super::svg::role_name;
use super::text::{ExportText, Say};
use crate::devices::ssi::protocol::explain::Role;
use crate::devices::ssi::protocol::layout::Layout;

impl Layout {
    /// Returns the name of a clock's content in the terms of the manual: `MT11`, `ST0`, `P3`, the name of an error bit,
    /// or `0`.
    pub fn role_name(&self, role: Role) -> String {
        match role {
            Role::Zero => "0".to_owned(),
            Role::Multiturn(bit) => format!("MT{bit}"),
            Role::Singleturn(bit) => format!("ST{bit}"),
            Role::Position(bit) => format!("P{bit}"),
            Role::Error(index) => self.descriptor().errors.get(index).map_or_else(String::new, |bit| bit.name.clone()),
            Role::Parity => "parity".to_owned(),
            Role::Again(clock) => format!("= {clock}"),
        }
    }
}

/// Returns a table with one row for each clock: its number, its bit and its content.
pub fn bit_table(layout: &Layout, say: Say<'_>) -> String {
    let mut text = say(&ExportText::TableHeading) + "\n";
    let clocks = layout.clocks();
    for (clock, role) in (1..=clocks).zip(layout.clock_roles()) {
        let name = role_name(layout, role, say);
        let quoted = if name.contains([',', '"', '\n']) { format!("\"{}\"", name.replace('"', "\"\"")) } else { name };
        // Writing into a String cannot fail.
        let _ = writeln!(text, "{clock},{},{quoted}", clocks - clock);
    }
    text
}
