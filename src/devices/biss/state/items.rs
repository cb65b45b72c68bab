//! Names and values of an encoder's registers and operations, as listed in comparisons, the logbook and reports.

use std::sync::LazyLock;

use super::{TEXTS, explain, format};
use crate::app::explain::literal_text;
use crate::app::{ItemValue, Text};
use crate::bits::parse_hex;
use crate::devices::biss::profile::{BissProfile, RegisterRange};
use crate::devices::biss::protocol::{Descriptions, Name};

/// The built-in descriptions, which contain the German names.
static BUILT_IN: LazyLock<Descriptions> = LazyLock::new(Descriptions::built_in);

/// Returns the name of an item, or `None` if an encoder has no such item. `manual_name` is the name of the register or
/// of its data area in the manual.
pub(super) fn item_name(item: &str, manual_name: Option<&str>) -> Option<Text> {
    match item {
        BissProfile::FILTER => return Some(TEXTS.text("biss_status.filter")),
        BissProfile::PRESET => return Some(TEXTS.text("biss_status.preset")),
        "calibration" => return Some(TEXTS.text("guide.calibration")),
        "Wiegand test" => return Some(TEXTS.text("guide.wiegand")),
        "position" => return Some(TEXTS.text("biss_op.fire")),
        _ => {}
    }
    let range: RegisterRange = item.parse().ok()?;
    let addresses = match range.addresses().last() {
        Some(last) if range.count() > 1 => {
            TEXTS.text("biss_name.registers").with("first", range.start()).with("last", last)
        }
        _ => TEXTS.text("biss_op.register").with("address", range.start()),
    };
    Some(match manual_name {
        Some(name) => {
            TEXTS.text("biss_name.named").with_text("registers", addresses).with_text("name", translated(name))
        }
        None => addresses,
    })
}

/// Returns the heading under which an item is grouped: its bank, or the settings.
pub(super) fn item_group(item: &str) -> Option<Text> {
    match item {
        BissProfile::FILTER | BissProfile::PRESET => Some(Text::new("report.settings")),
        item => {
            let bank = item.parse::<RegisterRange>().ok()?.start().bank()?;
            Some(TEXTS.text("report.biss_bank").with("bank", format!("0x{bank:02X}")))
        }
    }
}

/// Returns the value of a profile item: the meaning of a setting, or the bytes of a register.
pub(super) fn item_value(profile: &BissProfile, item: &str, value: &str) -> Option<ItemValue> {
    Some(match (item, profile.filter, &profile.preset) {
        (BissProfile::FILTER, Some(filter), _) => ItemValue::Text(format::filter(filter)),
        (item, _, Some(preset)) if item.starts_with("0x01:") => {
            let bits = profile.identity.singleturn_bits.unwrap_or_default();
            ItemValue::Text(explain::preset_value_text(preset.value, bits))
        }
        _ => ItemValue::Bytes(parse_hex(value).ok()?),
    })
}

/// Returns a name from the manual, with its German translation if a built-in description has one.
fn translated(manual_name: &str) -> Text {
    let names = BUILT_IN.iter().flat_map(|own| {
        let registers = own.registers().iter().map(|register| &register.name);
        registers.chain(own.areas().iter().map(|area| &area.name))
    });
    let is_meant = |name: &&Name| name.english() == manual_name;
    names.into_iter().find(is_meant).map_or_else(|| literal_text(manual_name), explain::name_text)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::app::Language::{English, German};

    #[test]
    fn translates_item_names() {
        for (item, manual_name, english, german) in [
            ("0x6E", Some("filter"), "Filter", "Filter"),
            ("0x01:0x02+6", None, "Preset value", "Preset-Wert"),
            ("0x24:0x10", None, "Register 0x24:0x10", "Register 0x24:0x10"),
            ("0x24:0x10+3", None, "Registers 0x24:0x10 to 0x24:0x12", "Register 0x24:0x10 bis 0x24:0x12"),
            ("0x6A", Some("device mode"), "Register 0x6A, device mode", "Register 0x6A, Gerätemodus"),
            ("0x40", Some("own name"), "Register 0x40, own name", "Register 0x40, own name"),
            ("Wiegand test", None, "Wiegand test", "Wiegand-Test"),
        ] {
            let name = item_name(item, manual_name).unwrap();
            assert_eq!((name.to_string_in(English).as_str(), name.to_string_in(German).as_str()), (english, german));
        }
        assert_eq!(item_name("field:0", None), None);
    }
}
