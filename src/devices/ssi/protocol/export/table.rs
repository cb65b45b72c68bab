//! CSV table of the bits in a frame.

use std::fmt::Write;

use super::svg::role_name;
use super::text::{ExportText, TranslateFn};
use crate::devices::ssi::protocol::explain::Role;
use crate::devices::ssi::protocol::layout::Layout;

impl Layout {
    /// Returns the name of a bit as in the manual, such as `MT11`, `ST0`, `P3`, `0`, or the name of an error bit.
    pub fn role_name(&self, role: Role) -> String {
        match role {
            Role::Zero => "0".to_owned(),
            Role::Multiturn(bit) => format!("MT{bit}"),
            Role::Singleturn(bit) => format!("ST{bit}"),
            Role::Position(bit) => format!("P{bit}"),
            Role::Error(index) => self.descriptor().errors.get(index).map_or_else(String::new, |bit| bit.name.clone()),
            Role::Parity => "parity".to_owned(),
            Role::Repetition(clock) => format!("= {clock}"),
        }
    }
}

/// Returns a CSV table with one row per clock: its number, the number of its bit, and what the bit means.
pub fn bit_table(layout: &Layout, say: TranslateFn<'_>) -> String {
    let mut text = say(&ExportText::TableHeading) + "\n";
    let clocks = layout.clock_count();
    for (clock, role) in (1..=clocks).zip(layout.clock_roles()) {
        let name = role_name(layout, role, say);
        let quoted = if name.contains([',', '"', '\n']) { format!("\"{}\"", name.replace('"', "\"\"")) } else { name };
        // Writing into a String cannot fail.
        let _ = writeln!(text, "{clock},{},{quoted}", clocks - clock);
    }
    text
}
