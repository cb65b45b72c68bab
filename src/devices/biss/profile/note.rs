//! The changes made by an operation, as listed in the logbook. Registers are listed with their address and their name
//! in the manual, whatever the language of the window.

use super::{Op, PresetParts, RegisterChange, RegisterRange};
use crate::bits::hex_compact;
use crate::devices::biss::protocol::{Description, PositionFilter, PresetValue};
use crate::profile::ChangedItem;

impl Op {
    /// Returns the changed items with their old and new values. Consecutive registers form one item.
    pub fn changed_items(&self, description: &Description) -> Vec<ChangedItem> {
        let byte = |byte: u8| format!("{byte:02X}");
        vec![match self {
            Op::StoreData { area, registers } => {
                let ranges = RegisterRange::from_addresses(registers.iter().map(|change| change.address)).into_iter();
                return ranges
                    .map(|range| range_item(range, registers).with_manual_name(area.name.english()))
                    .collect();
            }
            Op::StorePreset { from, to } => {
                ChangedItem::new(self.item_name(), Some(format_preset(*from)), Some(format_preset(*to)))
                    .with_manual_name("preset value")
            }
            Op::FirePreset { parts, value } => ChangedItem::new_value(
                "position",
                match parts {
                    PresetParts::Both => format_preset(*value),
                    PresetParts::Singleturn => format!("step {}", value.singleturn()),
                    PresetParts::Multiturn => format!("turn {}", value.multiturn()),
                },
            ),
            Op::SelectFilter { from, to } => {
                let [old, new] = [from, to].map(|own| Some(filter(*own).to_owned()));
                ChangedItem::new(self.item_name(), old, new).with_manual_name("filter")
            }
            Op::Calibrate | Op::WiegandTest { save: false } => ChangedItem::new(self.item_name(), None, None),
            Op::WiegandTest { save: true } => ChangedItem::new_value(self.item_name(), "result saved"),
            Op::WriteRegister { address, old, new, .. } => {
                let item = ChangedItem::new(address, old.map(byte), Some(byte(*new)));
                match description.register_at(*address) {
                    Some(register) => item.with_manual_name(&register.name),
                    None => item,
                }
            }
        }]
    }
}

fn range_item(range: RegisterRange, registers: &[RegisterChange]) -> ChangedItem {
    let own = registers.iter().filter(|change| range.contains(change.address));
    let (old, new): (Vec<u8>, Vec<u8>) = own.map(|change| (change.old, change.new)).unzip();
    ChangedItem::new(range, Some(hex_compact(&old)), Some(hex_compact(&new)))
}

fn format_preset(value: PresetValue) -> String {
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
    fn operations_describe_their_changes() {
        let kit = Descriptions::built_in().find_by_name("POSITAL IXARC kit encoder").unwrap().clone();
        let area: Area = kit.areas().iter().find(|area| area.first == 0x24).unwrap().clone();
        let change = |at: u8, new| {
            let address = RegisterAddress::in_bank(0x24, at).unwrap();
            RegisterChange { address, old: 0, new }
        };
        let value = PresetValue::new(98_304, 5).unwrap();
        let zero = PresetValue::new(0, 0).unwrap();
        let mode = RegisterAddress::direct_register(0x6A).unwrap();
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
                format!("0x24:0x00+9 {}: 000000000000000000 → 000102030405060708", area.name),
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
                format!("0x6A {}: 05 → 00", kit.register_at(mode).unwrap().name),
            ),
        ];
        for (op, words) in cases {
            let items = op.changed_items(&kit);
            assert_eq!(items.iter().map(ToString::to_string).collect::<Vec<_>>().join(", "), words);
        }
    }
}
