//! Names and values of encoder items, as listed in comparisons, the logbook and reports.

use super::{TEXTS, explain, format};
use crate::app::explain::literal_text;
use crate::app::{ItemValue, Text};
use crate::devices::interbus::jobs::PROGRAM_READ_NOTE;
use crate::devices::interbus::profile::{Edge, InterbusProfile, Item, ItemValue as Value};
use crate::devices::interbus::protocol::{CamNumber, Parameter, ProgramNumber};

/// Returns the name of an item, or `None` if the encoder has no such item.
pub(super) fn item_name(item: &str) -> Option<Text> {
    match item {
        "position" => return Some(TEXTS.text("ib_op.fire")),
        PROGRAM_READ_NOTE => return Some(TEXTS.text("ib_name.programs_read")),
        item if item == Parameter::Default.name() => return Some(TEXTS.text("ib_op.default")),
        _ => {}
    }
    let edge = |edge: Edge| Some((item.strip_suffix(&format!(" {edge}"))?, edge));
    if let Some((cam, edge)) = edge(Edge::Start).or_else(|| edge(Edge::Stop)) {
        let Ok(Item::Cam(program, cam)) = cam.parse() else { return None };
        let id = match edge {
            Edge::Start => "ib_name.start",
            Edge::Stop => "ib_name.stop",
        };
        return Some(cam_text(id, program, cam));
    }
    let item: Item = item.parse().ok()?;
    if let Some(parameter) = item.parameter() {
        return Some(format::parameter(parameter));
    }
    Some(match item {
        Item::CamMask(program) => TEXTS.text("ib_name.mask").with("program", program.get()),
        Item::Cam(program, cam) => cam_text("ib_name.cam", program, cam),
        Item::Temperature => TEXTS.text("ib_card.temperature"),
        Item::OperatingTime => TEXTS.text("ib_card.time"),
        _ => TEXTS.text("report.ib_shift"),
    })
}

/// Returns the heading under which an item is grouped: its cam program, or the settings.
pub(super) fn item_group(item: &str) -> Option<Text> {
    Some(match item.parse::<Item>().ok()?.program() {
        Some(program) => TEXTS.text("report.ib_program").with("program", program.get()),
        None => Text::new("report.settings"),
    })
}

/// Returns the value of an item in a profile, with its unit and meaning.
pub(super) fn item_value(profile: &InterbusProfile, item: &str) -> Option<ItemValue> {
    let item: Item = item.parse().ok()?;
    let text = match profile.image.get_value(item)? {
        Value::Direction(direction) => explain::direction_text(direction),
        Value::Mask(mask) => explain::cam_mask_text(mask),
        Value::Cam(cam) => with_unit(literal_text(format!("{}…{}", cam.start.get(), cam.stop.get())), unit_text(item)?),
        value => with_unit(literal_text(value), unit_text(item)?),
    };
    Some(ItemValue::Text(text))
}

fn with_unit(value: Text, unit: Text) -> Text {
    Text::new("item_value.unit").with_text("value", value).with_text("unit", unit)
}

/// Returns the unit of an item, or `None` if it has none.
pub(super) fn unit_text(item: Item) -> Option<Text> {
    Some(match item.unit() {
        "" => return None,
        "steps" => Text::new("unit.steps"),
        "turns" => TEXTS.text("ib_item.revolutions"),
        "bits" => TEXTS.text("report.ib_bits"),
        symbol => literal_text(symbol),
    })
}

fn cam_text(id: &'static str, program: ProgramNumber, cam: CamNumber) -> Text {
    TEXTS.text(id).with("program", program.get()).with("cam", cam.get())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::app::Language::{English, German};

    #[test]
    fn items_have_names_in_both_languages() {
        for (item, english, german) in [
            ("zero-shift", "Zero shift", "Nullverschiebung"),
            ("shift", "Window shift", "Fensterverschiebung"),
            ("cam-mask:2", "Program 2, active cams", "Programm 2, aktive Nocken"),
            ("cam:2:5", "Program 2, cam 5", "Programm 2, Nocken 5"),
            ("cam:2:5 stop", "Program 2, cam 5, stop", "Programm 2, Nocken 5, Ende"),
            ("temperature", "Temperature", "Temperatur"),
            ("default", "All parameters", "Alle Parameter"),
        ] {
            let name = item_name(item).unwrap();
            assert_eq!((name.to_string_in(English).as_str(), name.to_string_in(German).as_str()), (english, german));
        }
        assert_eq!((item_name("cam:2:5 middle"), item_name("steps start")), (None, None));
        assert!(Item::writable_items().all(|item| item_name(&item.to_string()).is_some()));
    }
}
