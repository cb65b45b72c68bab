//! Formats process data and parameter words as text.

use serde_json::{Value as Json, json};

use super::meaning::{self, DecodeContext, WordMeaning, control_word_text, parameter_name, status_word_text};
use crate::cli::args::Direction;
use crate::devices::hiperdrive::protocol::{
    ActualValues, Answer, ControlWord, InputImage, Kind, Layout, OutputData, OutputImage, ParameterNumber,
    ParameterRow, Pkw, Task, Value, to_turns_and_steps,
};

/// Decodes process data, with one result for each layout of matching length. If the direction is known, only layouts of
/// that direction are used. The result is empty if no layout matches.
///
/// # Errors
/// Returns an error with the reason if the data cannot have been sent in the known direction.
pub(super) fn decode_bytes(bytes: &[u8], known: &DecodeContext) -> Result<Vec<WordMeaning>, String> {
    let mut readings = Vec::new();
    let words = decode_parameter_word(bytes, known);
    for layout in possible_layouts(bytes.len(), known) {
        // An implausible status word is shown only if no other meaning fits.
        let from = || decode_input_image(bytes, layout).filter(|_| words.is_empty() || is_input_image(bytes, layout));
        match (decode_output_image(bytes, layout), known.direction) {
            (Err(why), Some(Direction::Out)) if words.is_empty() => return Err(why),
            (Err(_), Some(Direction::Out)) => {}
            (Ok(reading), Some(Direction::Out)) => readings.push(reading),
            (Ok(reading), None) => {
                readings.push(reading);
                readings.extend(from().filter(|_| !has_nonzero_control(bytes, layout)));
            }
            (_, Some(Direction::In)) | (Err(_), None) => readings.extend(from()),
        }
    }
    readings.extend(words);
    Ok(readings)
}

fn possible_layouts(length: usize, known: &DecodeContext) -> impl Iterator<Item = Layout> {
    Layout::all_with_length(length).map(|layout| Layout { order: known.order, ..layout })
}

/// Returns whether any control word is nonzero. If all are 0, the data may also come from ports without drives.
fn has_nonzero_control(bytes: &[u8], layout: Layout) -> bool {
    OutputImage::parse(bytes, layout).is_ok_and(|image| image.drives.iter().any(|drive| drive.control != 0))
}

/// Returns whether a drive can send every status word in the data.
fn is_input_image(bytes: &[u8], layout: Layout) -> bool {
    InputImage::parse(bytes, layout).is_ok_and(|image| image.drives.iter().all(|drive| drive.status.is_plausible()))
}

/// Decodes the process data in a cyclic packet, once for each layout of matching length. An explicitly known direction
/// takes precedence over the direction of the packet.
pub(super) fn explain_cyclic(data: &[u8], to_target: bool, known: &DecodeContext) -> Vec<WordMeaning> {
    let to_target = known.direction.map_or(to_target, |direction| direction == Direction::Out);
    let reading = |layout: Layout| {
        if !to_target {
            return decode_input_image(data, layout);
        }
        let refused = |why: String| WordMeaning { direction: "OUT", lines: vec![why], json: json!({"legal": false}) };
        Some(decode_output_image(data, layout).unwrap_or_else(refused))
    };
    possible_layouts(data.len(), known).filter_map(reading).collect()
}

fn decode_output_image(bytes: &[u8], layout: Layout) -> Result<WordMeaning, String> {
    let image = OutputImage::parse(bytes, layout).map_err(|why| why.to_string())?;
    let mut lines = Vec::new();
    let mut list = Vec::new();
    for (number, drive) in (1..).zip(&image.drives) {
        let control = drive.control_word().map_err(|why| format!("drive {number}: {why}"))?;
        lines.push(format!("drive {number}: {}", output_text(drive, control)));
        list.push(json!({
            "drive": number,
            "control": format!("{:04X}", drive.control),
            "speed_percent": drive.speed,
            "torque_percent": drive.torque,
            "target": drive.target,
        }));
    }
    lines.extend(image.pkw.map(pkw_request_text));
    Ok(WordMeaning { direction: "OUT", lines, json: json!({"drives": list}) })
}

fn decode_input_image(bytes: &[u8], layout: Layout) -> Option<WordMeaning> {
    let image = InputImage::parse(bytes, layout).ok()?;
    let mut lines = Vec::new();
    let mut list = Vec::new();
    for (number, drive) in (1..).zip(&image.drives) {
        lines.push(format!("drive {number}: {}", actual_text(drive)));
        list.push(json!({
            "drive": number,
            "status": format!("{:04X}", drive.status.to_u16()),
            "state": drive.status.state().name(),
            "speed_rpm": f64::from(drive.speed) / 10.0,
            "position": drive.position,
        }));
    }
    lines.extend(image.pkw.map(answer_text));
    Some(WordMeaning { direction: "IN", lines, json: json!({"drives": list}) })
}

fn output_text(drive: &OutputData, control: ControlWord) -> String {
    let OutputData { control: word, speed, torque, target } = drive;
    let none = if *speed == 0 || *torque == 0 { "; with 0 % nothing begins" } else { "" };
    format!(
        "control word {word:04X} ({}), speed {speed} %, torque {torque} %, target {target}{}{none}",
        control_word_text(control),
        turns_text(*target)
    )
}

fn actual_text(drive: &ActualValues) -> String {
    let ActualValues { status, speed, position } = drive;
    let rpm = f64::from(*speed) / 10.0;
    format!(
        "status word {:04X} ({}), speed {rpm} rpm, position {position}{}",
        status.to_u16(),
        status_word_text(*status),
        turns_text(*position)
    )
}

/// Formats a position in turns and degrees for a drive with default scaling.
fn turns_text(position: i32) -> String {
    let (turn, steps) = to_turns_and_steps(position);
    format!(" (turn {turn}, {:.3}° at 65536 steps a turn)", f64::from(steps) * 360.0 / 65536.0)
}

/// Decodes eight bytes as a parameter word, as a request and as an answer. The result is empty if the manual does not
/// list the parameter. Only strings have elements, so a request for an element must refer to a string parameter.
fn decode_parameter_word(bytes: &[u8], known: &DecodeContext) -> Vec<WordMeaning> {
    let Ok(bytes) = <[u8; 8]>::try_from(bytes) else { return Vec::new() };
    let pkw = Pkw::parse(bytes, known.order);
    let Some(row) = row(pkw) else { return Vec::new() };
    let is_request = pkw.task().is_some_and(|task| match task {
        Task::None => false,
        Task::Read | Task::WriteWord | Task::WriteDouble => row.kind != Kind::Text,
        Task::ReadElement | Task::WriteElementWord | Task::WriteElementDouble | Task::Count => row.kind == Kind::Text,
    });
    let is_answer = !matches!(pkw.answer(), Answer::None | Answer::Unknown);
    let readings = [
        (is_request, "OUT", Direction::Out, pkw_request_text as fn(Pkw) -> String),
        (is_answer, "IN", Direction::In, answer_text),
    ];
    readings
        .into_iter()
        .filter(|(is, _, direction, _)| *is && known.direction.is_none_or(|known| known == *direction))
        .map(|(_, direction, _, words)| {
            let fits = direction == "OUT" || has_expected_width(pkw, row);
            let json = json!({"parameter": pkw.number(), "element": pkw.ind, "value": fits.then_some(pkw.pwe)});
            WordMeaning { direction, lines: vec![words(pkw)], json }
        })
        .collect()
}

fn pkw_request_text(pkw: Pkw) -> String {
    let name = parameter_name(pkw.number());
    let request = match pkw.task() {
        None => return format!("parameter word: a request {}, which there is not, about {name}", pkw.pke >> 12),
        Some(Task::None) => return "parameter word: nothing is asked".to_owned(),
        Some(task @ (Task::Read | Task::Count)) => format!("{} of {name}", task.name()),
        Some(Task::ReadElement) => format!("read element {} of {name}", pkw.ind),
        Some(Task::WriteWord) => write_request_text(pkw, pkw.pwe & 0xFFFF, true),
        Some(Task::WriteDouble) => write_request_text(pkw, pkw.pwe, false),
        Some(task @ (Task::WriteElementWord | Task::WriteElementDouble)) => {
            format!("{} {} of {name}: {}", task.name(), pkw.ind, pkw.pwe)
        }
    };
    format!("parameter word: {request}")
}

fn answer_text(pkw: Pkw) -> String {
    let name = parameter_name(pkw.number());
    let answer = match pkw.answer() {
        Answer::None => return "parameter word: nothing is answered".to_owned(),
        Answer::Unknown => format!("an answer {}, which there is not, about {name}", pkw.pke >> 12),
        Answer::Word(word) => format!("{name} is {}", value_description(pkw, word.into(), true)),
        Answer::Double(double) => format!("{name} is {}", value_description(pkw, double, false)),
        Answer::Elements(count) => format!("{name} has {count} elements"),
        Answer::Refused(error) => format!("{name} refused: {error}"),
    };
    format!("parameter word: {answer}")
}

/// Returns whether the answer's width matches the parameter type.
fn has_expected_width(pkw: Pkw, row: &ParameterRow) -> bool {
    match pkw.answer() {
        Answer::Word(_) => matches_width(row, true),
        Answer::Double(_) => matches_width(row, false),
        _ => true,
    }
}

/// Returns whether a value of this width, one word or a double word, fits the parameter. A double word can also hold
/// four characters of a string.
fn matches_width(row: &ParameterRow, word: bool) -> bool {
    row.kind.byte_length().map_or(!word, |bytes| (bytes < 4) == word)
}

fn write_request_text(pkw: Pkw, raw: u32, word: bool) -> String {
    let own = row(pkw).filter(|row| matches_width(row, word));
    let warning = own.map_or(String::new(), |row| meaning::warning(row, signed_value(row, raw)));
    format!("write {} to {}{warning}", value_description(pkw, raw, word), parameter_name(pkw.number()))
}

/// Formats a value in the parameter's unit, or as four characters of a string.
fn value_description(pkw: Pkw, raw: u32, word: bool) -> String {
    match row(pkw) {
        None => raw.to_string(),
        Some(row) if !matches_width(row, word) => {
            let (got, expected) = if word { (2, 4) } else { (4, row.kind.byte_length().unwrap_or(2).max(2)) };
            format!("no value ({got} bytes where its type has {expected}: 0x{raw:X})")
        }
        Some(row) if row.kind == Kind::Text => match Kind::Text.parse(&raw.to_le_bytes()) {
            Ok(Value::Text(text)) => format!("\"{text}\""),
            _ => raw.to_string(),
        },
        Some(row) => meaning::number_meaning(row, signed_value(row, raw)),
    }
}

fn row(pkw: Pkw) -> Option<&'static ParameterRow> {
    ParameterNumber::new(pkw.number()).and_then(ParameterNumber::row)
}

/// Returns the value, sign-extended if the parameter type is signed.
fn signed_value(row: &ParameterRow, raw: u32) -> i64 {
    match row.kind {
        Kind::I8 | Kind::I16 => i64::from((raw as u16).cast_signed()),
        Kind::I32 => i64::from(raw.cast_signed()),
        _ => i64::from(raw),
    }
}

pub(super) fn direction_json(direction: &str) -> Json {
    json!(direction.to_lowercase())
}
