//! The read-only commands `identify`, `status` and `read`.

use serde_json::{Value as Json, json};

use super::DisturbanceLevel;
use super::run::{Runner, identity};
use crate::cli::args::CommonArgs;
use crate::cli::output::{Lines, Output};
use crate::cli::{Result, Success};
use crate::devices::interbus::jobs::{InterbusJob, InterbusOutput};
use crate::devices::interbus::procedures::{Identity, Status};
use crate::devices::interbus::profile::ItemValue;
use crate::devices::interbus::protocol::{KIND, Reply, StartupMode, Value};
use crate::devices::interbus::state::explain;
use crate::result_of;

pub(super) fn identify(common: &CommonArgs, output: &Output) -> Result {
    let mut runner = Runner::open(common)?;
    DisturbanceLevel::Reading.print_effect(output);
    let identity = identity(&mut runner)?;
    let json = json!({
        "device": KIND,
        "profile": "K3",
        "serial_number": identity.serial_number,
        "steps": identity.steps,
        "revolutions": identity.revolutions,
        "direction": identity.direction.keyword(),
        "software_version": identity.software_version.to_string(),
        "mode": mode_name(identity.mode),
        "multiturn": identity.flags.counts_turns(),
        "steps_minus_one": identity.flags.steps_minus_one(),
    });
    output.show(&json, &identity_text(&identity))?;
    Ok(Success::Completed)
}

fn identity_text(identity: &Identity) -> String {
    let kind = if identity.flags.counts_turns() { "multiturn" } else { "single turn" };
    let less = if identity.flags.steps_minus_one() { ", steps minus one" } else { "" };
    let direction = explain::direction_text(identity.direction).terminal_text();
    let mut lines = Lines::default();
    lines
        .add_line("encoder", format!("INTERBUS K3, {kind}{less}"))
        .add_line("serial number", &identity.serial_number)
        .add_line("software version", identity.software_version)
        .add_line("steps", format!("{} over {}", identity.steps, format_turns(identity.revolutions)))
        .add_line("direction", format!("{} ({direction})", identity.direction))
        .add_line("mode", explain::startup_mode_text(identity.mode).terminal_text());
    lines.text()
}

fn format_turns(turns: u32) -> String {
    if turns == 1 { "1 revolution".to_owned() } else { format!("{turns} revolutions") }
}

/// Returns the name of a start-up mode for JSON output, such as `velocity` or `cam 3`.
pub(super) fn mode_name(mode: StartupMode) -> String {
    match mode {
        StartupMode::K2 => "K2".to_owned(),
        StartupMode::K3 => "K3".to_owned(),
        StartupMode::Velocity => "velocity".to_owned(),
        StartupMode::Cams(program) => format!("cam {}", program.get()),
        StartupMode::Unknown(value) => value.get().to_string(),
    }
}

pub(super) fn status(common: &CommonArgs, output: &Output) -> Result {
    let mut runner = Runner::open(common)?;
    DisturbanceLevel::Reading.print_effect(output);
    let status = result_of!(runner.run(InterbusJob::Status)?, InterbusOutput::Status(status) => *status);
    let errors: Vec<Json> = status
        .error
        .iter()
        .map(|error| {
            let word = format!("0x{:08X}", Reply::Error(*error).emit());
            json!({"code": error.code.get(), "text": explain::error_word_text(*error).terminal_text(), "word": word})
        })
        .collect();
    let warnings: Vec<Json> =
        unexpected_bits(&status).map(|(code, text)| json!({"code": code, "text": text})).into_iter().collect();
    let json = json!({
        "ok": errors.is_empty(),
        "errors": errors,
        "warnings": warnings,
        "raw": status.reading.word,
        "mode": mode_name(status.mode),
        "temperature_c": to_celsius(status.temperature_tenths),
        "operating_minutes": status.operating_minutes,
    });
    output.show(&json, &status_text(&status))?;
    Ok(Success::Completed)
}

/// Returns the bits of a position word that should be 0 but are set, with a message.
fn unexpected_bits(status: &Status) -> Option<(u32, String)> {
    let bits = u32::from(status.reading.unexpected_bits()) << Value::BITS;
    (bits != 0).then(|| (bits, format!("the bits 0x{bits:08X} of IN should be 0")))
}

fn to_celsius(tenths: i32) -> f64 {
    f64::from(tenths) / 10.0
}

fn status_text(status: &Status) -> String {
    let error = status.error.map(|error| {
        format!("0x{:08X}: {}", Reply::Error(error).emit(), explain::error_word_text(error).terminal_text())
    });
    let mut lines = Lines::default();
    lines
        .add_line("errors", error.unwrap_or_else(|| "none".to_owned()))
        .add_line("warnings", unexpected_bits(status).map_or_else(|| "none".to_owned(), |(_, text)| text))
        .add_line("IN word", format!("0x{:08X}", status.reading.word))
        .add_line("mode", explain::startup_mode_text(status.mode).terminal_text())
        .add_line("temperature", format!("{:.1} °C", to_celsius(status.temperature_tenths)))
        .add_line("operating time", format!("{} min", status.operating_minutes));
    lines.text()
}

pub(super) fn read(common: &CommonArgs, output: &Output, item: &str) -> Result {
    let item = super::parse_item(item)?;
    let mut runner = Runner::open(common)?;
    let disturbs = if item.parameter().is_some() || !item.is_writable() {
        DisturbanceLevel::Reading
    } else {
        DisturbanceLevel::Programs
    };
    disturbs.confirm_start(common, output, None)?;
    let value = result_of!(runner.run(InterbusJob::Read(item))?, InterbusOutput::Item(value) => value);
    let own = match value {
        ItemValue::Number(number) | ItemValue::Minutes(number) => json!(number),
        ItemValue::Mask(mask) => json!(mask),
        ItemValue::TenthsOfDegree(tenths) => json!(to_celsius(tenths)),
        ItemValue::Direction(_) | ItemValue::Cam(_) => json!(value.to_string()),
    };
    let mut json = json!({"item": item.to_string(), "value": own});
    let unit = item.unit();
    if let Some(keys) = json.as_object_mut() {
        if !unit.is_empty() {
            keys.insert("unit".to_owned(), json!(unit));
        }
        if let ItemValue::Cam(cam) = value {
            keys.insert("start".to_owned(), json!(cam.start.get()));
            keys.insert("stop".to_owned(), json!(cam.stop.get()));
        }
    }
    let text = if unit.is_empty() { format!("{value}\n") } else { format!("{value} {unit}\n") };
    output.show(&json, &text)?;
    Ok(Success::Completed)
}
