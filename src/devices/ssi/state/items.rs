//! Names and values of layout entries in comparisons and reports. They are the same as in the form.

use super::form::{coverage_text, direction_text};
use super::{TEXTS, explain};
use crate::app::explain::literal_text;
use crate::app::{ItemValue, Text, significant_decimals};
use crate::devices::ssi::profile::SsiProfile;
use crate::devices::ssi::protocol::{BitMeaning, Range};

/// Returns the name of an entry of a profile, or `None` if a layout has no such entry.
pub(super) fn item_name(item: &str) -> Option<Text> {
    if let Some((number, part)) = split_indexed_entry(item, "errors") {
        let part = TEXTS.text(match part {
            "name" => "ssi_form.error_name",
            "clock" => "ssi_form.error_clock",
            "meaning" => "ssi_form.error_meaning",
            "active_low" => "ssi_form.error_low",
            "cleared_by_transfer" => "ssi_form.error_cleared",
            _ => return None,
        });
        return Some(TEXTS.text("ssi_name.error").with("number", number).with_text("part", part));
    }
    if let Some((number, part)) = split_indexed_entry(item, "patterns") {
        let part = TEXTS.text(match part {
            "name" => "ssi_form.error_name",
            "word" => "ssi_name.bits",
            "meaning" => "ssi_form.error_meaning",
            _ => return None,
        });
        return Some(TEXTS.text("ssi_name.pattern").with("number", number).with_text("part", part));
    }
    match item.split_once('.') {
        Some(("parity", "clock")) => return Some(TEXTS.text("ssi_form.parity_clock")),
        Some(("parity", _)) => return Some(TEXTS.text("ssi_form.parity")),
        _ => {}
    }
    Some(TEXTS.text(match item {
        "family" => "report.ssi_family",
        "clocks" => "ssi_form.clocks",
        "multiturn" => "ssi_name.multiturn",
        "singleturn" => "ssi_name.singleturn",
        "steps" => "ssi_name.steps",
        "turns" => "ssi_form.turns",
        "revolutions" => "ssi_form.revolutions",
        "bits" => "ssi_form.bits",
        "step_nanometres" => "ssi_form.step",
        "code" => "ssi_form.code",
        "over" => "ssi_form.over",
        "area" => "ssi_form.area",
        "lead" => "ssi_form.lead",
        "between" => "ssi_form.between",
        "shift" => "ssi_form.shift",
        "inverted" => "ssi_form.inverted",
        "repeat.word" => "ssi_name.repeated_word",
        "repeat.gap" => "ssi_name.gap",
        "direction" => "ssi_form.direction",
        "preset" => "ssi_form.preset",
        "reading.clock_hz" => "ssi_form.clock",
        "reading.pause_us" => "ssi_form.pause",
        "reading.cable_metres" => "ssi_form.cable",
        "reading.synchronous" => "ssi_form.synchronous",
        _ => return None,
    }))
}

/// Returns the heading under which an entry is listed. It is the same as in the form.
pub(super) fn item_group(item: &str) -> Option<Text> {
    if item.starts_with("reading.") {
        return Some(Text::new("report.interface"));
    }
    Some(TEXTS.text(match item {
        "direction" | "preset" => "ssi_form.counting",
        "multiturn" | "singleturn" | "steps" | "turns" | "revolutions" | "bits" | "step_nanometres" | "code"
        | "over" => "ssi_form.position",
        _ => "ssi_form.frame",
    }))
}

/// Returns the value of an entry of a profile with its unit and meaning.
pub(super) fn item_value(profile: &SsiProfile, item: &str, value: &str) -> Option<ItemValue> {
    let frame = &profile.descriptor;
    let text = match item {
        "code" => explain::code_text(frame.code),
        "over" => coverage_text(frame.coded),
        "direction" => direction_text(profile.direction, matches!(frame.range, Range::Length { .. })),
        "parity.even" => TEXTS.text(if value == "true" { "ssi_form.parity_even" } else { "ssi_form.parity_odd" }),
        "multiturn" | "singleturn" | "bits" | "lead" | "between" | "repeat.gap" => {
            with_unit(literal_text(value), TEXTS.text("ssi_form.bit"))
        }
        "step_nanometres" => with_unit(literal_text(value), literal_text("nm")),
        "reading.clock_hz" => {
            let kilohertz = f64::from(profile.reading.clock_hz) / 1000.0;
            let value = Text::new("item_value.number").with_number("value", kilohertz, significant_decimals(kilohertz));
            with_unit(value, literal_text("kHz"))
        }
        "reading.pause_us" => with_unit(literal_text(value), literal_text("µs")),
        "reading.cable_metres" => match profile.reading.cable_metres {
            Some(metres) => with_unit(literal_text(metres), literal_text("m")),
            None => TEXTS.text("ssi_name.not_checked"),
        },
        _ => match (split_indexed_entry(item, "errors"), value) {
            (Some((_, "meaning")), value) if value == BitMeaning::Invalid.to_string() => TEXTS.text("ssi_form.invalid"),
            (Some((_, "meaning")), _) => TEXTS.text("ssi_form.warning"),
            (_, "true") => Text::new("report.yes"),
            (_, "false") => Text::new("report.no"),
            _ => return None,
        },
    };
    Some(ItemValue::Text(text))
}

fn with_unit(value: Text, unit: Text) -> Text {
    Text::new("item_value.unit").with_text("value", value).with_text("unit", unit)
}

/// Splits an entry name such as `errors[0].clock` into its number, counted from 1, and the part after it.
fn split_indexed_entry<'i>(item: &'i str, list: &str) -> Option<(usize, &'i str)> {
    let (index, part) = item.strip_prefix(list)?.strip_prefix('[')?.split_once("].")?;
    Some((index.parse::<usize>().ok()?.checked_add(1)?, part))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::app::Language::{English, German};

    #[test]
    fn entries_have_names_in_both_languages() {
        for (item, english, german) in [
            ("errors[0].clock", "Error bit 1: On clock", "Fehlerbit 1: Auf Takt"),
            ("patterns[1].word", "Pattern 2: Bits", "Muster 2: Bits"),
            ("singleturn", "Bits for steps within a turn", "Bits für Schritte je Umdrehung"),
            ("reading.pause_us", "Pause", "Pause"),
        ] {
            let name = item_name(item).unwrap();
            assert_eq!((name.to_string_in(English).as_str(), name.to_string_in(German).as_str()), (english, german));
        }
        assert_eq!((item_name("errors[0].colour"), item_name("errors[x].clock")), (None, None));
    }
}
