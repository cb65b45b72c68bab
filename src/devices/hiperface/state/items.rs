//! Names and values of an encoder's items, as listed in comparisons, the logbook and reports.

use super::{TEXTS, explain};
use crate::app::{ItemValue, Text};
use crate::bits::parse_hex;
use crate::devices::hiperface::profile::{FieldRange, Item, PlanItem};
use crate::devices::hiperface::protocol::DataFieldStatus;

/// Returns the name of an item, or `None` if the encoder has no such item.
pub(super) fn item_name(item: &str) -> Option<Text> {
    if let Some(number) = item.strip_prefix("code ") {
        return Some(TEXTS.text("hf_name.code").with("number", number));
    }
    if item == PlanItem::Position.to_string() {
        return Some(TEXTS.text("hf_name.position"));
    }
    Some(match item.parse().ok()? {
        Item::Field(range) => range_name(range),
        Item::Status(field) => TEXTS.text("hf_name.status").with("field", field),
        Item::Analogue(channel) => TEXTS.text("hf_name.analogue").with("channel", format!("0x{channel:02X}")),
        Item::Counter => TEXTS.text("recorder.counter"),
        Item::Address => TEXTS.text("encoder_card.address"),
        Item::Settings => TEXTS.text("encoder_card.settings"),
    })
}

/// Returns the group heading for an item: the name of its data field. Other items have no heading.
pub(super) fn item_group(item: &str) -> Option<Text> {
    match item.parse().ok()? {
        Item::Field(FieldRange { field, .. }) | Item::Status(field) => {
            Some(TEXTS.text("memory.field").with("number", field))
        }
        _ => None,
    }
}

/// Describes the value of an item. An empty value means that the field could not be read.
pub(super) fn item_value(item: &str, value: &str) -> Option<ItemValue> {
    let bytes = parse_hex(value).ok()?;
    match (item.parse().ok()?, bytes.as_slice()) {
        (Item::Field(_), []) => Some(ItemValue::Text(TEXTS.text("hf_name.locked"))),
        (Item::Field(_), _) => Some(ItemValue::Bytes(bytes)),
        (Item::Status(_), [status]) => {
            Some(ItemValue::Text(explain::field_status(DataFieldStatus::from_byte(*status))))
        }
        _ => None,
    }
}

fn range_name(range: FieldRange) -> Text {
    let address = |at: usize| format!("0x{at:02X}");
    let (first, last) = match (range.start, range.count) {
        (0, None) => return TEXTS.text("memory.field").with("number", range.field),
        (start, count) => (start, count.map(|count| start.saturating_add(count).saturating_sub(1))),
    };
    let text = TEXTS.text(match last {
        None => "hf_name.rest",
        Some(last) if last == first => "hf_name.byte",
        Some(_) => "hf_name.bytes",
    });
    let text = text.with("field", range.field).with("first", address(first));
    last.map_or_else(|| text.clone(), |last| text.clone().with("last", address(last)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::app::Language::{English, German};

    #[test]
    fn items_have_names_in_both_languages() {
        for (item, english, german) in [
            ("field:2", "Data field 2", "Datenfeld 2"),
            ("field:0@3+2", "Data field 0, bytes 0x03 to 0x04", "Datenfeld 0, Bytes 0x03 bis 0x04"),
            ("field:1@26+1", "Data field 1, byte 0x1A", "Datenfeld 1, Byte 0x1A"),
            ("field:1@16", "Data field 1 from byte 0x10", "Datenfeld 1 ab Byte 0x10"),
            ("status:1", "Status of data field 1", "Status von Datenfeld 1"),
            ("analogue:0x48", "Analogue channel 0x48", "Analogkanal 0x48"),
            ("counter", "Counter", "Zähler"),
            ("position", "Position", "Position"),
            ("code 2", "Access code 2", "Zugriffsschlüssel 2"),
        ] {
            let name = item_name(item).unwrap();
            assert_eq!((name.to_string_in(English).as_str(), name.to_string_in(German).as_str()), (english, german));
        }
        assert_eq!(item_name("steps"), None);
    }
}
