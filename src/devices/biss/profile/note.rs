//! One-line summary of an operation for the logbook. It lists registers by address and name, with old and new values.
//! It uses the terms of the manual in every language of the window.

use super::{Op, PresetParts, RegisterChange, RegisterRange};
use crate::bits::hex_compact;
use crate::devices::biss::protocol::{Description, PositionFilter, PresetValue};

impl Op {
    /// Returns a description of the changes with old and new values. If many registers change, only the first are
    /// listed. The backup contains all of them.
    pub fn note(&self, description: &Description) -> String {
        match self {
            Op::StoreData { area, registers } => {
                let ranges = RegisterRange::runs(registers.iter().map(|change| change.address));
                let shown = ranges.iter().take(RUNS).map(|range| run(*range, area.name.english(), registers));
                let left = ranges.len().saturating_sub(RUNS);
                let rest = (left > 0).then(|| format!("further runs: {left}"));
                shown.chain(rest).collect::<Vec<_>>().join(", ")
            }
            Op::StorePreset { from, to } => format!("{} preset value: {} → {}", self.item(), place(*from), place(*to)),
            Op::FirePreset { parts, value } => match parts {
                PresetParts::Both => format!("position: → {}", place(*value)),
                PresetParts::Singleturn => format!("position: → step {}", value.singleturn()),
                PresetParts::Multiturn => format!("position: → turn {}", value.multiturn()),
            },
            Op::SelectFilter { from, to } => format!("{} filter: {} → {}", self.item(), filter(*from), filter(*to)),
            Op::Calibrate | Op::WiegandTest { save: false } => self.item(),
            Op::WiegandTest { save: true } => format!("{}: → result saved", self.item()),
            Op::WriteRegister { address, old, new, .. } => {
                let name = description.at(*address).map(|register| format!(" {}", register.name)).unwrap_or_default();
                let old = old.map(|old| format!(" {old:02X}")).unwrap_or_default();
                format!("{address}{name}:{old} → {new:02X}")
            }
        }
    }
}

/// Maximum number of ranges listed in a note.
const RUNS: usize = 8;
/// Maximum number of registers per range that are listed with their values.
const VALUES: usize = 8;

fn run(range: RegisterRange, name: &str, registers: &[RegisterChange]) -> String {
    let own = registers.iter().filter(|change| range.contains(change.address)).take(VALUES);
    let (old, new): (Vec<u8>, Vec<u8>) = own.map(|change| (change.old, change.new)).unzip();
    let more = if usize::from(range.count()) > VALUES { "…" } else { "" };
    format!("{range} {name}: {}{more} → {}{more}", hex_compact(&old), hex_compact(&new))
}

fn place(value: PresetValue) -> String {
    format!("step {}, turn {}", value.singleturn(), value.multiturn())
}

fn filter(filter: PositionFilter) -> &'static str {
    match filter {
        PositionFilter::Balanced => "balanced",
        PositionFilter::Dynamic => "dynamic",
        PositionFilter::Unknown(_) => "unknown",
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::devices::biss::protocol::{Area, Descriptions, RegisterAddress};

    #[test]
    fn every_operation_describes_its_change() {
        let kit = Descriptions::built_in().named("POSITAL IXARC kit encoder").unwrap().clone();
        let area: Area = kit.areas().iter().find(|area| area.first == 0x24).unwrap().clone();
        let change = |at: u8, new| {
            let address = RegisterAddress::banked(0x24, at).unwrap();
            RegisterChange { address, old: 0, new }
        };
        let value = PresetValue::new(98_304, 5).unwrap();
        let zero = PresetValue::new(0, 0).unwrap();
        let mode = RegisterAddress::direct(0x6A).unwrap();
        let cases = [
            (
                Op::StoreData {
                    area: area.clone(),
                    registers: vec![change(0x10, 0xC0), change(0x11, 0xFF), change(0x30, 1)],
                },
                format!("0x24:0x10+2 {name}: 0000 → C0FF, 0x24:0x30 {name}: 00 → 01", name = area.name),
            ),
            (
                Op::StoreData { area: area.clone(), registers: (0..9).map(|at| change(at, at)).collect() },
                format!("0x24:0x00+9 {}: 0000000000000000… → 0001020304050607…", area.name),
            ),
            (
                Op::StorePreset { from: zero, to: value },
                "0x01:0x02+6 preset value: step 0, turn 0 → step 98304, turn 5".to_owned(),
            ),
            (Op::FirePreset { parts: PresetParts::Singleturn, value }, "position: → step 98304".to_owned()),
            (
                Op::SelectFilter { from: PositionFilter::Balanced, to: PositionFilter::Dynamic },
                "0x6E filter: balanced → dynamic".to_owned(),
            ),
            (Op::Calibrate, "calibration".to_owned()),
            (Op::WiegandTest { save: true }, "Wiegand test: → result saved".to_owned()),
            (
                Op::WriteRegister { address: mode, old: Some(5), new: 0, cycles: 0 },
                format!("0x6A {}: 05 → 00", kit.at(mode).unwrap().name),
            ),
        ];
        for (op, words) in cases {
            assert_eq!(op.note(&kit), words);
        }
    }
}
