//! The read-only commands: `identify`, `status`, `read`.

use serde_json::{Value as Json, json};

use super::args::DriveOption;
use super::parse_item;
use super::run::{Runner, value};
use crate::cli::args::{CommonArgs, Read, Status as StatusArguments};
use crate::cli::output::{Lines, Output};
use crate::cli::runner::to_failure;
use crate::cli::{Result, Success};
use crate::devices::hiperdrive::jobs::{HiperdriveJob, HiperdriveOutput};
use crate::devices::hiperdrive::procedures::{DriveIdentity, DriveStatus, Identity, Status};
use crate::devices::hiperdrive::profile::Item;
use crate::devices::hiperdrive::protocol::drive_parameter::{
    CONTROL, NEWEST_ERROR, NO_TIMEOUT, OLDEST_ERROR, SPEED, SPEED_DENOMINATOR, SPEED_NUMERATOR, STATUS, TIMEOUT,
    VARIANT,
};
use crate::devices::hiperdrive::protocol::{
    DriveNumber, ErrorCode, KIND, ParameterNumber, SpeedScale, State, StatusBit, StatusWord, Value, Variant,
    nominal_value,
};
use crate::devices::hiperdrive::state::TEXTS;
use crate::devices::hiperdrive::state::explain;
use crate::result_of;

pub(super) fn identify(common: &CommonArgs, output: &Output) -> Result {
    let mut runner = Runner::open(common)?;
    let identity = result_of!(runner.run(HiperdriveJob::Identify)?, HiperdriveOutput::Identity(identity) => identity);
    let json = json!({
        "device": KIND,
        "category": identity.category,
        "name": identity.name,
        "article_number": identity.article_number,
        "serial_number": identity.serial_number,
        "production_date": identity.production_date,
        "version": identity.version,
        "drives": identity.drives.iter().map(drive_json).collect::<Vec<Json>>(),
    });
    output.show(&json, &identity_text(&identity))?;
    Ok(Success::Completed)
}

fn drive_json(drive: &DriveIdentity) -> Json {
    json!({
        "number": drive.number.get(),
        "variant": drive.variant.number(),
        "name": drive.name,
        "article_number": drive.article_number,
        "serial_number": drive.serial_number,
        "version": drive.version,
        "requested": drive.requested,
    })
}

fn identity_text(identity: &Identity) -> String {
    let mut lines = Lines::default();
    lines
        .add_line("device", format!("{} ({})", identity.name, identity.category))
        .add_line("article number", &identity.article_number)
        .add_line("serial number", &identity.serial_number)
        .add_line("production date", &identity.production_date)
        .add_line("version", &identity.version);
    for drive in &identity.drives {
        let requested = if drive.requested { "" } else { ", not requested (152 = 0)" };
        let DriveIdentity { name, serial_number, version, .. } = drive;
        lines.add_line(
            format!("drive {}", drive.number.get()),
            format!("{name}, serial number {serial_number}, version {version}{requested}"),
        );
    }
    if identity.drives.is_empty() {
        lines.add_line("drives", "none");
    }
    lines.text()
}

pub(super) fn status(common: &CommonArgs, output: &Output, status: &StatusArguments) -> Result {
    let only = status.own.read::<DriveOption>()?.drive.and_then(DriveNumber::new);
    let mut runner = Runner::open(common)?;
    let mut status = result_of!(runner.run(HiperdriveJob::Status)?, HiperdriveOutput::Status(status) => *status);
    if let Some(drive) = only {
        status.drives.retain(|own| own.number == drive);
        if status.drives.is_empty() {
            return Err(to_failure(&TEXTS.text("hd_said.no_drive").with("drive", drive.get())));
        }
    }
    let facts: Vec<DriveFact> = status.drives.iter().flat_map(drive_fact_list).collect();
    let list = |weight: FactSeverity| {
        facts.iter().filter(|own| own.severity == weight).map(DriveFact::json).collect::<Vec<Json>>()
    };
    let (errors, warnings, earlier) =
        (list(FactSeverity::Error), list(FactSeverity::Warning), list(FactSeverity::Earlier));
    let drives: Vec<Json> = status
        .drives
        .iter()
        .map(|drive| {
            json!({
                "number": drive.number.get(),
                "state": state_keyword(drive.status.state()),
                "status_word": drive.status.to_u16(),
                "requested": drive.requested,
                "faults": drive.faults,
                "words": drive.words,
                "temperature_c": drive.temperature,
            })
        })
        .collect();
    let json = json!({
        "ok": errors.is_empty(),
        "errors": errors,
        "warnings": warnings,
        "earlier": earlier,
        "drives": drives,
        "supply_v": volts(&status),
        "temperature_c": status.temperature,
    });
    output.show(&json, &status_text(&status, &facts))?;
    Ok(Success::Completed)
}

#[derive(Clone, Copy, PartialEq)]
enum FactSeverity {
    Error,
    Warning,
    /// A past error that is still in the error buffer.
    Earlier,
}

struct DriveFact {
    drive: u8,
    code: u16,
    text: String,
    severity: FactSeverity,
}

impl DriveFact {
    fn json(&self) -> Json {
        json!({"code": self.code, "text": self.text, "drive": self.drive})
    }
}

/// Returns the errors and warnings of a drive.
///
/// Entries in the error buffer survive a power cycle, so only the entries since the last acknowledgement are treated as
/// current errors. The fault counter gives their number, which is at least one during a fault. A position outside the
/// limits and a communication error are treated as warnings. See section 4 of the reference.
fn drive_fact_list(drive: &DriveStatus) -> Vec<DriveFact> {
    let number = drive.number.get();
    let is_fault = drive.status.is_set(StatusBit::Fault);
    let present = drive.present_error_count();
    let error = |(at, code): (usize, &ErrorCode)| {
        let weight = if at < present { FactSeverity::Error } else { FactSeverity::Earlier };
        DriveFact { drive: number, code: code.code(), text: error_text(*code), severity: weight }
    };
    let mut facts: Vec<DriveFact> = drive.buffer.iter().enumerate().map(error).collect();
    if is_fault && drive.buffer.is_empty() {
        let text = "the drive has a fault but reports no error".to_owned();
        facts.push(DriveFact { drive: number, code: 0, text, severity: FactSeverity::Error });
    }
    if drive.status.is_set(StatusBit::PositionLimit) {
        let text = "the drive is outside its limits (158, 160)".to_owned();
        facts.push(DriveFact { drive: number, code: drive.status.to_u16(), text, severity: FactSeverity::Warning });
    }
    // Parameter 118: 0 means no error, FFFFh no drive.
    let [_, _, communication] = drive.words;
    if !matches!(communication, 0 | 0xFFFF) {
        let text = format!("the RS-485 link to the drive has errors (parameter 118: 0x{communication:04X})");
        facts.push(DriveFact { drive: number, code: communication, text, severity: FactSeverity::Warning });
    }
    facts
}

pub(super) fn error_text(code: ErrorCode) -> String {
    let words = explain::error_code_explanation(code);
    format!("{}: {} {}", words.name.terminal_text(), words.cause.terminal_text(), words.remedy.terminal_text())
}

pub(super) fn state_keyword(state: State) -> &'static str {
    match state {
        State::NotReady => "not-ready",
        State::Ready => "ready",
        State::Operational => "operational",
        State::Enabled => "enabled",
        State::Moving => "moving",
        State::Fault => "fault",
        State::Locked => "locked",
    }
}

fn volts(status: &Status) -> f64 {
    // At most a few hundred tenths of a volt.
    status.supply_tenths as f64 / 10.0
}

fn status_text(status: &Status, facts: &[DriveFact]) -> String {
    let mut lines = Lines::default();
    let of = |weight: FactSeverity| facts.iter().filter(move |own| own.severity == weight);
    let words = |own: &DriveFact| format!("drive {}: 0x{:04X} {}", own.drive, own.code, own.text);
    for (label, weight) in [("error", FactSeverity::Error), ("warning", FactSeverity::Warning)] {
        for own in of(weight) {
            lines.add_line(label, words(own));
        }
        if of(weight).next().is_none() {
            lines.add_line(format!("{label}s"), "none");
        }
    }
    for own in of(FactSeverity::Earlier) {
        lines.add_line("note", format!("{} (earlier entry in the error buffer, not present now)", words(own)));
    }
    lines
        .add_line("supply", format!("{:.1} V", volts(status)))
        .add_line("temperature", format!("{} °C", status.temperature));
    for drive in &status.drives {
        let requested = if drive.requested { "" } else { ", not requested (152 = 0)" };
        let (word, celsius) = (drive.status.to_u16(), drive.temperature);
        let state = explain::state_text(drive.status.state()).terminal_text();
        lines.add_line(
            format!("drive {}", drive.number.get()),
            format!("{state} (0x{word:04X}), {celsius} °C{requested}"),
        );
    }
    lines.text()
}

/// Formats a numeric parameter value. Status and error words are shown in hexadecimal with their meaning, and values in
/// tenths of a unit are also converted to the unit.
fn number_text(item: Item, number: i64) -> String {
    let (base, unit) = (item.0.drive1_number(), item.0.row().map_or("", |row| row.unit));
    let word = u16::try_from(number).ok();
    match (base, word, unit.strip_prefix("0.1 ")) {
        (STATUS, Some(word), _) => {
            let state = explain::state_text(StatusWord::new(word).state());
            format!("0x{word:04X} ({})", state.terminal_text())
        }
        (NEWEST_ERROR..=OLDEST_ERROR, Some(0), _) => "0x0000 (no error)".to_owned(),
        (NEWEST_ERROR..=OLDEST_ERROR, Some(word), _) => format!("0x{word:04X} {}", error_text(ErrorCode::new(word))),
        (CONTROL | 116..=118, Some(word), _) => format!("0x{word:04X}"),
        (VARIANT, Some(word), _) => {
            format!("{number} ({})", explain::variant_text(Variant::new(word)).terminal_text())
        }
        (TIMEOUT, Some(word), _) if i64::from(word) == NO_TIMEOUT => "255 (no time-out)".to_owned(),
        // The number fits into 32 bits.
        (.., Some(whole)) => format!("{number} × {unit} = {:.1} {whole}", number as f64 / 10.0),
        (.., None) if unit.is_empty() => number.to_string(),
        (.., None) => format!("{number} {unit}"),
    }
}

/// Reads the speed scale of a drive (parameters 162 and 164), or returns `None` if either part is 0.
fn speed_scale(runner: &mut Runner, drive: DriveNumber) -> Result<Option<SpeedScale>> {
    let mut part = |base| match ParameterNumber::for_drive(base, drive).map(|number| value(runner, number)) {
        Some(Ok(Value::Number(number))) => Ok(u16::try_from(number).unwrap_or(0)),
        Some(Err(why)) => Err(why),
        Some(Ok(Value::Text(_))) | None => Ok(0),
    };
    Ok(SpeedScale::new(part(SPEED_NUMERATOR)?, part(SPEED_DENOMINATOR)?).ok())
}

/// Formats a string parameter. If the string contains a number, the number is appended with its unit.
fn nominal_text(text: &str, unit: &str) -> String {
    match nominal_value(text).filter(|_| !unit.is_empty()) {
        Some((number, decimals)) => format!("{text} = {number:.decimals$} {unit}"),
        None => text.to_owned(),
    }
}

pub(super) fn read(common: &CommonArgs, output: &Output, read: &Read) -> Result {
    let item = parse_item(&read.item, &read.own.read()?)?;
    let mut runner = Runner::open(common)?;
    let value = value(&mut runner, item.0)?;
    let unit = item.0.row().map_or("", |row| row.unit);
    // With the factory scale, the speed is in tenths of rpm (manual 6.2).
    let scale = item.0.drive().filter(|_| item.0.drive1_number() == SPEED).map(|drive| speed_scale(&mut runner, drive));
    let scale = scale.transpose()?.flatten().filter(|scale| *scale != SpeedScale::FACTORY);
    let unit = if scale.is_some() { "" } else { unit };
    let (own, text) = match value {
        Value::Number(number) => {
            let rpm = scale.zip(i16::try_from(number).ok()).map(|(scale, speed)| scale.rpm(speed));
            let text = rpm.map_or_else(|| number_text(item, number), |rpm| format!("{number} = {rpm:.1} rpm"));
            (json!(number), text)
        }
        Value::Text(text) => (json!(text), nominal_text(&text, unit)),
    };
    let is_number = own.is_number();
    let mut json = json!({"item": item.to_string(), "value": own, "name": item.name()});
    // The unit does not apply to a string, whose number may be in tenths.
    if let (true, false, Some(keys)) = (is_number, unit.is_empty(), json.as_object_mut()) {
        keys.insert("unit".to_owned(), json!(unit));
    }
    output.show(&json, &format!("{text}\n"))?;
    Ok(Success::Completed)
}
