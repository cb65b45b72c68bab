//! Commands that only look: `identify`, `status`, `read`.

use serde_json::{Value as Json, json};

use super::item;
use super::run::{Runner, value};
use crate::app::explain;
use crate::cli::args::{Common, Read};
use crate::cli::output::{Lines, Output};
use crate::cli::runner::unexpected;
use crate::cli::{Done, Result};
use crate::device::hiperdrive::{DriveIdentity, DriveStatus, Identity, Status};
use crate::protocol::hiperdrive::{ErrorCode, KIND, State, StatusBit, Value};
use crate::worker::hiperdrive::{HiperdriveJob, HiperdriveOutput};

pub(super) fn identify(common: &Common, output: &Output) -> Result {
    let mut runner = Runner::open(common)?;
    let identity = match runner.run(HiperdriveJob::Identify)? {
        HiperdriveOutput::Identity(identity) => identity,
        other => return Err(unexpected(&other)),
    };
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
    Ok(Done::Well)
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
        .add("device", format!("{} ({})", identity.name, identity.category))
        .add("article number", &identity.article_number)
        .add("serial number", &identity.serial_number)
        .add("production date", &identity.production_date)
        .add("version", &identity.version);
    for drive in &identity.drives {
        let requested = if drive.requested { "" } else { ", not requested (152 = 0)" };
        let DriveIdentity { name, serial_number, version, .. } = drive;
        lines.add(
            format!("drive {}", drive.number.get()),
            format!("{name}, serial number {serial_number}, version {version}{requested}"),
        );
    }
    if identity.drives.is_empty() {
        lines.add("drives", "none");
    }
    lines.text()
}

pub(super) fn status(common: &Common, output: &Output) -> Result {
    let mut runner = Runner::open(common)?;
    let status = match runner.run(HiperdriveJob::Status)? {
        HiperdriveOutput::Status(status) => *status,
        other => return Err(unexpected(&other)),
    };
    let said: Vec<Said> = status.drives.iter().flat_map(said).collect();
    let list =
        |is_error: bool| said.iter().filter(|own| own.is_error == is_error).map(Said::json).collect::<Vec<Json>>();
    let (errors, warnings) = (list(true), list(false));
    let drives: Vec<Json> = status
        .drives
        .iter()
        .map(|drive| {
            json!({
                "number": drive.number.get(),
                "state": state_word(drive.status.state()),
                "status_word": drive.status.word(),
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
        "drives": drives,
        "supply_v": volts(&status),
        "temperature_c": status.temperature,
    });
    output.show(&json, &status_text(&status, &said))?;
    Ok(Done::Well)
}

/// Something that a drive says of itself.
struct Said {
    drive: u8,
    code: u16,
    text: String,
    is_error: bool,
}

impl Said {
    fn json(&self) -> Json {
        json!({"code": self.code, "text": self.text, "drive": self.drive})
    }
}

/// What a drive reports. As many of its newest errors as it counts since the acknowledgement are errors, and at least one in a
/// fault; the rest are of before, as the buffer has them also after power-up (reference 4), and are warnings. So is a drive that
/// stands outside its limits, and one whose communication says something.
fn said(drive: &DriveStatus) -> Vec<Said> {
    let number = drive.number.get();
    let is_fault = drive.status.has(StatusBit::Fault);
    let since = usize::from(drive.faults).max(usize::from(is_fault));
    let error = |(at, code): (usize, &ErrorCode)| {
        let is_error = at < since;
        let before = if is_error { "" } else { " (of before the acknowledgement)" };
        Said { drive: number, code: code.code(), text: format!("{}{before}", error_text(*code)), is_error }
    };
    let mut said: Vec<Said> = drive.buffer.iter().enumerate().map(error).collect();
    if is_fault && drive.buffer.is_empty() {
        let text = "the drive is in a fault and names no error".to_owned();
        said.push(Said { drive: number, code: 0, text, is_error: true });
    }
    if drive.status.has(StatusBit::PositionLimit) {
        let text = "the drive stands outside its limits (158, 160)".to_owned();
        said.push(Said { drive: number, code: drive.status.word(), text, is_error: false });
    }
    // 118: 0 is well, FFFFh no drive.
    let [_, _, communication] = drive.words;
    if !matches!(communication, 0 | 0xFFFF) {
        let text = format!("RS-485 to the drive has errors (parameter 118: 0x{communication:04X})");
        said.push(Said { drive: number, code: communication, text, is_error: false });
    }
    said
}

fn error_text(code: ErrorCode) -> String {
    let words = explain::hiperdrive::error(code);
    format!("{}: {} {}", words.name.terminal(), words.cause.terminal(), words.remedy.terminal())
}

/// A state for scripts.
pub(super) fn state_word(state: State) -> &'static str {
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
    // A few hundred tenths.
    status.supply_tenths as f64 / 10.0
}

fn status_text(status: &Status, said: &[Said]) -> String {
    let mut lines = Lines::default();
    for (label, is_error) in [("error", true), ("warning", false)] {
        let own: Vec<&Said> = said.iter().filter(|own| own.is_error == is_error).collect();
        for one in &own {
            lines.add(label, format!("drive {}: 0x{:04X} {}", one.drive, one.code, one.text));
        }
        if own.is_empty() {
            lines.add(format!("{label}s"), "none");
        }
    }
    lines.add("supply", format!("{:.1} V", volts(status))).add("temperature", format!("{} °C", status.temperature));
    for drive in &status.drives {
        let requested = if drive.requested { "" } else { ", not requested (152 = 0)" };
        let (word, celsius) = (drive.status.word(), drive.temperature);
        let state = explain::hiperdrive::state(drive.status.state()).terminal();
        lines.add(format!("drive {}", drive.number.get()), format!("{state} (0x{word:04X}), {celsius} °C{requested}"));
    }
    lines.text()
}

pub(super) fn read(common: &Common, output: &Output, read: &Read) -> Result {
    let item = item(&read.item, &read.of)?;
    let mut runner = Runner::open(common)?;
    let value = value(&mut runner, item.0)?;
    let unit = item.0.row().map_or("", |row| row.unit);
    let (own, text) = match value {
        Value::Number(number) if unit.is_empty() => (json!(number), format!("{number}\n")),
        // Of a fraction of something.
        Value::Number(number) if unit.starts_with("0.") => (json!(number), format!("{number} × {unit}\n")),
        Value::Number(number) => (json!(number), format!("{number} {unit}\n")),
        Value::Text(text) => (json!(text), format!("{text}\n")),
    };
    let mut json = json!({"item": item.to_string(), "value": own, "name": item.name()});
    if let (false, Some(keys)) = (unit.is_empty(), json.as_object_mut()) {
        keys.insert("unit".to_owned(), json!(unit));
    }
    output.show(&json, &text)?;
    Ok(Done::Well)
}
