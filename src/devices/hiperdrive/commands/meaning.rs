//! Textual meaning of control words, status words and parameters.

use serde_json::{Value as Json, json};

use super::image::direction_json;
use crate::bits::hex;
use crate::cli::args::Direction;
use crate::devices::hiperdrive::protocol::drive_parameter::{
    CONTROL, NEWEST_ERROR, OLDEST_ERROR, SERVICE, STATUS, VARIANT,
};
use crate::devices::hiperdrive::protocol::{
    ByteOrder, ControlBit, ControlWord, ErrorCode, ParameterAccess, ParameterNumber, ParameterRow, StatusBit,
    StatusWord, Travel, Value, Variant,
};

pub(super) struct DecodeContext {
    pub(super) direction: Option<Direction>,
    pub(super) order: ByteOrder,
}

pub(super) struct WordMeaning {
    pub(super) direction: &'static str,
    pub(super) lines: Vec<String>,
    pub(super) json: Json,
}

impl WordMeaning {
    pub(super) fn to_lines(&self) -> impl Iterator<Item = String> {
        self.lines.iter().map(|line| format!("{}: {line}", self.direction))
    }

    pub(super) fn json(&self) -> Json {
        let mut json = self.json.clone();
        if let Some(object) = json.as_object_mut() {
            object.insert("direction".to_owned(), direction_json(self.direction));
            object.insert("meaning".to_owned(), json!(self.lines));
        }
        json
    }
}

/// Interprets a word as a control word, a status word or both. If the direction is unknown, bit 11 usually decides: it
/// is never set in a control word, and always set in the status word of a detected drive.
///
/// # Errors
/// Returns an error with the reason if the direction shows that the word is a control word that must not be sent.
pub(super) fn from_word(word: u16, known: &DecodeContext) -> Result<Vec<WordMeaning>, String> {
    let (control, status) = (ControlWord::parse(word), StatusWord::new(word));
    match (known.direction, control) {
        (Some(Direction::Out), Err(why)) => Err(why.to_string()),
        (Some(Direction::Out), Ok(control)) => Ok(vec![control_meaning(control)]),
        (Some(Direction::In), _) => Ok(vec![status_meaning(status)]),
        (None, Ok(control)) if word == 0 => Ok(vec![control_meaning(control), status_meaning(status)]),
        (None, Ok(control)) => Ok(vec![control_meaning(control)]),
        (None, Err(_)) if status.is_plausible() => Ok(vec![status_meaning(status)]),
        (None, Err(why)) => {
            let refused = WordMeaning {
                direction: "OUT",
                lines: vec![format!("not to be sent, {why}")],
                json: json!({"bits": [], "legal": false}),
            };
            Ok(vec![refused, status_meaning(status)])
        }
    }
}

fn control_meaning(control: ControlWord) -> WordMeaning {
    let names: Vec<&str> = control.set_bits().map(|(_, name)| name).collect();
    let lines = vec![format!("control word, {}", control_word_text(control))];
    WordMeaning { direction: "OUT", lines, json: json!({"bits": names, "legal": true}) }
}

fn status_meaning(status: StatusWord) -> WordMeaning {
    let names: Vec<&str> = status.set_bits().map(StatusBit::name).collect();
    let lines = vec![format!("status word, {}", status_word_text(status))];
    WordMeaning { direction: "IN", lines, json: json!({"bits": names, "state": status.state().name()}) }
}

/// Formats a control word: what it does, followed by its set bits.
pub(super) fn control_word_text(control: ControlWord) -> String {
    let bits: Vec<String> = control.set_bits().map(|(bit, name)| format!("{bit} {name}")).collect();
    let bits = if bits.is_empty() { "no bit".to_owned() } else { format!("bits {}", bits.join(", ")) };
    let then = if control.is_set(ControlBit::Acknowledge) { ", acknowledges a fault when bit 7 falls" } else { "" };
    format!("{}{then}: {bits}", control_word_purpose(control))
}

fn control_word_purpose(control: ControlWord) -> &'static str {
    use ControlBit::{Control, Enable, JogOne, JogTwo, NoPause, NoStop, On, SpeedMode, Start};
    let speed = (control.is_set(NoStop), control.is_set(NoPause));
    match control {
        _ if !control.is_set(Control) => "leaves the drive alone",
        _ if !control.is_set(On) => "keeps it ready",
        _ if !control.is_set(Enable) => "keeps it operational",
        _ if control.is_set(SpeedMode) && !control.is_set(Start) => "speed mode, stands",
        _ if control.is_set(SpeedMode) => match speed {
            (true, false) => "speed mode, runs clockwise to the end of the range",
            (false, false) => "speed mode, runs counterclockwise to the end of the range",
            (true, true) => "speed mode, runs clockwise without end",
            (false, true) => "speed mode, runs counterclockwise without end",
        },
        _ if control.is_set(JogOne) || control.is_set(JogTwo) => "a jog step, which no stop ends",
        _ if speed == (false, false) => "keeps it enabled",
        _ if !control.is_set(NoStop) => "stops, the job is gone",
        _ if !control.is_set(NoPause) => "pauses the job",
        _ if control.is_set(Start) => "holds, and starts a job if status bit 12 is 0",
        _ => "holds, and starts a job if status bit 12 is 1",
    }
}

/// Formats a status word: the state, then its bits.
pub(super) fn status_word_text(status: StatusWord) -> String {
    let bits: Vec<String> = status.set_bits().map(|bit| format!("{} {}", bit.bit_number(), bit.name())).collect();
    let bits = if bits.is_empty() { "no bit".to_owned() } else { format!("bits {}", bits.join(", ")) };
    let present = match (status.is_plausible(), status.is_present()) {
        (false, _) => ", but no drive sends that",
        (true, false) => ", no drive found",
        (true, true) => "",
    };
    format!("{}{present}: {bits}", status.state().name())
}

/// Returns the name of the parameter at this class and attribute, with the value in the data, or with an error message
/// if the data does not match the parameter type.
pub(super) fn parameter_words(class: u16, attribute: u16, data: &[u8]) -> Option<(String, Result<String, String>)> {
    let number = ParameterNumber::from_attribute(class, attribute)?;
    let row = number.row();
    let value = match row.map(|row| (row, row.kind.parse(data))) {
        Some((row, Ok(Value::Number(value)))) => Ok(format!("{}{}", number_meaning(row, value), warning(row, value))),
        Some((_, Ok(Value::Text(text)))) => Ok(format!("\"{text}\"")),
        Some((_, Err(why))) => Err(why.to_string()),
        None => Ok(hex(data)),
    };
    Some((parameter_name(number.get()), value))
}

pub(super) fn parameter_name(own: u16) -> String {
    let Some(number) = ParameterNumber::new(own) else {
        return format!("parameter {own}, which there is not");
    };
    let name = number.row().map_or("not in the manual", |row| row.name);
    let drive = number.drive().map_or(String::new(), |drive| format!(" of drive {}", drive.get()));
    format!("parameter {own} ({name}{drive})")
}

pub(super) fn number_meaning(row: &ParameterRow, number: i64) -> String {
    let word = u16::try_from(number).ok();
    match (row.number, word) {
        (CONTROL, Some(word)) => ControlWord::parse(word).map_or_else(
            |why| format!("{word:04X} ({why})"),
            |control| format!("{word:04X} ({})", control_word_text(control)),
        ),
        (STATUS, Some(word)) => format!("{word:04X} ({})", status_word_text(StatusWord::new(word))),
        (NEWEST_ERROR..=OLDEST_ERROR, Some(0)) => "no error".to_owned(),
        (NEWEST_ERROR..=OLDEST_ERROR, Some(word)) => {
            let code = ErrorCode::new(word);
            code.row().map_or_else(|| code.to_string(), |row| format!("{code}: {}; {}", row.cause, row.remedy))
        }
        (VARIANT, Some(word)) => {
            let name = Variant::new(word).row().map_or("in no table", |row| row.name);
            format!("{word} ({name})")
        }
        (SERVICE, _) => format!("{number}{}", service_code_note(number)),
        _ => match row.unit {
            "0.1 rpm" => format!("{number} ({} rpm)", number as f64 / 10.0),
            "0.1 V" => format!("{number} ({} V)", number as f64 / 10.0),
            "0.1 s" => format!("{number} ({} s)", number as f64 / 10.0),
            "" => number.to_string(),
            unit => format!("{number} {unit}"),
        },
    }
}

/// Returns a warning if the value must not be written to the parameter, or an empty string otherwise.
pub(super) fn warning(row: &ParameterRow, number: i64) -> String {
    let beyond = row.allowed_values(Travel::UNKNOWN).filter(|range| !range.contains(number));
    match (row.access, beyond) {
        (ParameterAccess::Read, _) => "; warning: it can only be read".to_owned(),
        (_, Some(range)) => format!("; warning: it may be {range}"),
        (_, None) => String::new(),
    }
}

fn service_code_note(number: i64) -> &'static str {
    match number {
        -4 => " (reset the drives)",
        -3 => " (everything from the factory, with the IP address, and save)",
        -2 => " (own parameters of the device as saved last)",
        -1 => " (own parameters of the device from the factory, without saving)",
        0 => " (done)",
        1 => " (save)",
        _ => " (busy or bad)",
    }
}
