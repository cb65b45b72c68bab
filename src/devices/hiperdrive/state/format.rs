//! Formats parameters for the table: values, units, the meanings of numbers, and why an edit was rejected.

use super::staged::{EditError, EditFinding};
use crate::app::Text;
use crate::app::explain::literal_text;
use crate::devices::hiperdrive::protocol::drive_parameter::{
    CONTROL, DRIVE_REQUESTED, MAXIMUM_SPEED, NEWEST_ERROR, NO_TIMEOUT, OLDEST_ERROR, SERVICE, STATUS, TIMEOUT, VARIANT,
};
use crate::devices::hiperdrive::protocol::{
    self, AddressSwitch, ErrorCode, Kind, ParameterNumber, ParameterRow, StatusWord, Value, Variant,
};
use crate::devices::hiperdrive::state::TEXTS;
use crate::devices::hiperdrive::state::explain as hiperdrive;
use crate::devices::hiperdrive::state::explain as words;

/// Formats a value. Words consisting of bits, and error codes, are hexadecimal.
pub fn value_text(number: ParameterNumber, value: &Value) -> String {
    match value {
        Value::Text(text) => text.clone(),
        Value::Number(value) if matches!(number.drive1_number(), CONTROL | STATUS | 108..=118) => {
            format!("0x{value:04X}")
        }
        Value::Number(value) => value.to_string(),
    }
}

/// Returns the unit of a numeric parameter, if it has one. A string has no unit, even if it contains a number.
pub fn unit(row: &ParameterRow) -> Option<Text> {
    match row.unit {
        _ if row.kind == Kind::Text => None,
        "" => None,
        "steps" => Some(Text::new("unit.steps")),
        "0.1 rpm" => Some(TEXTS.text("hd_unit.tenth_rpm")),
        "0.1 V" => Some(TEXTS.text("hd_unit.tenth_volt")),
        "0.1 s" => Some(TEXTS.text("hd_unit.tenth_second")),
        own => Some(literal_text(own)),
    }
}

/// Formats the number in a string with its unit. Returns `None` if the string does not contain a number.
pub fn nominal_value(number: ParameterNumber, text: &str) -> Option<Text> {
    let unit = number.row().map(|row| row.unit).filter(|unit| !unit.is_empty())?;
    let (value, decimals) = protocol::nominal_value(text)?;
    Some(TEXTS.text("hd_entry.place").with_number("value", value, decimals).with_text("unit", literal_text(unit)))
}

/// Describes what a number means. Returns `None` if the number is self-explanatory.
pub fn value_meaning(number: ParameterNumber, value: i64) -> Option<Text> {
    let tenths = |id: &'static str, name: &'static str| TEXTS.text(id).with_number(name, value as f64 / 10.0, 1);
    let word = || u16::try_from(value).ok();
    Some(match number.drive1_number() {
        9 => tenths("hd_check.supply", "volts"),
        12 => match u8::try_from(value).ok().and_then(AddressSwitch::parse) {
            Some(switch) => hiperdrive::switch_text(switch),
            None => TEXTS.text("hd_check.unknown_switch").with("number", value),
        },
        SERVICE => TEXTS.text(if value == 0 { "hd_meaning.saved" } else { "hd_meaning.not_saved" }),
        STATUS => hiperdrive::state_text(StatusWord::new(word()?).state()),
        NEWEST_ERROR..=OLDEST_ERROR if value == 0 => TEXTS.text("hd_meaning.no_error"),
        NEWEST_ERROR..=OLDEST_ERROR => hiperdrive::error_code_explanation(ErrorCode::new(word()?)).name,
        116..=118 => TEXTS.text(match value {
            0 => "hd_meaning.word_well",
            0xFFFF => "hd_meaning.word_none",
            _ => "hd_meaning.word_error",
        }),
        VARIANT => hiperdrive::variant_text(Variant::new(word()?)),
        DRIVE_REQUESTED => TEXTS.text(if value == 0 { "hd_meaning.not_requested" } else { "hd_meaning.requested" }),
        MAXIMUM_SPEED => tenths("hd_entry.rpm", "rpm"),
        TIMEOUT if value == NO_TIMEOUT => TEXTS.text("hd_meaning.no_timeout"),
        TIMEOUT => tenths("hd_check.timeout", "seconds"),
        _ => return None,
    })
}

pub fn edit_error_text(error: &EditError) -> Text {
    match error {
        EditError::NothingRead => TEXTS.text("hd_entry.nothing_read"),
        EditError::Unknown(number) => TEXTS.text("hd_said.unknown").with("number", number),
        EditError::NotRead(number) => text_about("hd_entry.not_read", *number),
        EditError::NotAValue(number) => text_about("hd_entry.not_a_value", *number),
        EditError::OutOfRange(error) => words::out_of_range(error),
        EditError::Crossed { lower, upper } => TEXTS.text("hd_entry.crossed").with("lower", lower).with("upper", upper),
    }
}

pub fn finding_text(mark: &EditFinding) -> Text {
    match mark {
        EditFinding::OutOfRange(error) => words::out_of_range(error),
        EditFinding::Crossed { lower, upper, .. } => {
            TEXTS.text("hd_entry.crossed").with("lower", lower).with("upper", upper)
        }
        EditFinding::Outside { position, lower, upper, .. } => {
            TEXTS.text("hd_mark.outside").with("position", position).with("lower", lower).with("upper", upper)
        }
        EditFinding::LimitsMove { lower, upper, .. } => TEXTS
            .text("hd_mark.limits_move")
            .with_number("lower_now", lower.0, 2)
            .with_number("lower_then", lower.1, 2)
            .with_number("upper_now", upper.0, 2)
            .with_number("upper_then", upper.1, 2),
        EditFinding::NoTimeout { .. } => TEXTS.text("hd_mark.no_timeout"),
    }
}

fn text_about(id: &'static str, number: ParameterNumber) -> Text {
    TEXTS.text(id).with("number", number).with_text("name", words::parameter_name_text(number))
}
