//! The read-only commands `find`, `identify`, `status`, `position` and `read`.

use std::time::Duration;

use serde_json::{Value as Json, json};

use super::args;
use crate::bits::{hex, hex_compact};
use crate::cli::args::{CommonArgs, FindArgs, Position};
use crate::cli::consent::can_prompt;
use crate::cli::output::{Lines, Output};
use crate::cli::positions::try_readings;
use crate::cli::runner::{JobFailure, unexpected_output};
use crate::cli::{Failure, Result, Success};
use crate::devices::hiperface::commands::run::{Runner, reported_codes};
use crate::devices::hiperface::commands::table::PositionTable;
use crate::devices::hiperface::jobs::{
    Hiperface, HiperfaceJob, HiperfaceOutput, JobError, Value, may_have_other_master,
};
use crate::devices::hiperface::procedures::find::{EncoderSearchResult, FindOptions, FoundEncoder};
use crate::devices::hiperface::procedures::{Identity, PositionReading};
use crate::devices::hiperface::profile::Item;
use crate::devices::hiperface::protocol::{EncoderTypes, KIND, LineSettings, StatusCode};
use crate::devices::hiperface::state::explain as explained;
use crate::result_of;

pub(super) fn find(common: &CommonArgs, output: &Output, find: &FindArgs) -> Result {
    if let Some(url) = &common.link
        && may_have_other_master(url)
        && !common.only_master
        && !can_prompt()
    {
        return Err(Failure::Usage(
            "a search sends to every address: add --only-master if no drive is connected to this line or powered, or \
             run it on a terminal; nothing was sent"
                .to_owned(),
        ));
    }
    let find = find.own.read::<args::FindOptions>()?;
    let mut runner = Runner::open(common)?;
    let power_cycle = find.power_cycle.map(Duration::from_secs);
    output.print_message(
        "Listening for one second, then trying every address with all settings. This takes one to two minutes.",
    );
    let options = FindOptions { one_encoder: find.one_encoder, power_cycle };
    match runner.run(HiperfaceJob::Find(options))? {
        HiperfaceOutput::Found(EncoderSearchResult::Searched { found, complete }) => {
            show_found_encoders(output, &found)?;
            if !complete {
                return Err(Failure::Failed(vec![
                    "Cancelled: the search is incomplete, so there may be more encoders.".to_owned(),
                ]));
            }
            if found.is_empty() {
                return Err(Failure::Failed(vec![
                    "No encoder answered. Check supply and wiring (A/B); if only one encoder is connected, try \
                     --one-encoder and --power-cycle 30."
                        .to_owned(),
                ]));
            }
            Ok(Success::Completed)
        }
        HiperfaceOutput::Found(EncoderSearchResult::ForeignTraffic { bytes }) => Err(Failure::Failed(vec![format!(
            "Another device sends on this line ({bytes} bytes in one second), so nothing was sent. Disconnect the \
             drive or controller, then try again."
        )])),
        other => Err(unexpected_output(&other)),
    }
}

fn show_found_encoders(output: &Output, found: &[FoundEncoder]) -> Result<()> {
    let types = EncoderTypes::built_in();
    let name = |found: &FoundEncoder| {
        types.find(found.label.encoder_type).map_or("unknown type".to_owned(), |row| row.name.clone())
    };
    let list: Vec<Json> = found
        .iter()
        .map(|found| {
            json!({
                "address": found.address,
                "baud": found.format.baud.bits_per_second(),
                "parity": found.format.parity.keyword(),
                "encoder_type": found.label.encoder_type,
                "encoder_name": name(found),
                "stored_settings": found.label.settings.byte(),
                "link_parameters": link_parameters(found),
            })
        })
        .collect();
    let text: String = found
        .iter()
        .map(|found| {
            format!(
                "address {:02X}h at {}  {}  stored: {}  ?{}\n",
                found.address,
                found.format,
                name(found),
                found.label.settings,
                link_parameters(found)
            )
        })
        .collect();
    output.show(&json!({ "devices": list }), &text)
}

fn link_parameters(found: &FoundEncoder) -> String {
    format!("baud={}&parity={}&address=0x{:02X}", found.format.baud, found.format.parity, found.address)
}

pub(super) fn identify(common: &CommonArgs, output: &Output) -> Result {
    let mut runner = Runner::open(common)?;
    let identity = identity(&mut runner)?;
    let free = identity.memory.map(|memory| memory.bytes());
    let fields = identity.memory.map(|memory| memory.fields);
    let json = json!({
        "device": KIND,
        "address": identity.address,
        "encoder_type": identity.label.encoder_type,
        "encoder_name": identity.name,
        "serial_number": identity.serial.serial_number,
        "firmware_version": identity.serial.firmware_version,
        "firmware_date": identity.serial.firmware_date,
        "eeprom_bytes": identity.label.eeprom_bytes(),
        "free_bytes": free,
        "data_fields": fields,
        "baud": runner.context.baud.bits_per_second(),
        "parity": runner.context.parity.keyword(),
        "stored_settings": identity.label.settings.byte(),
        "options": identity.label.options,
    });
    output.show(&json, &identity_text(&identity, &runner))?;
    Ok(Success::Completed)
}

fn identity_text(identity: &Identity, runner: &Runner) -> String {
    let unknown = || "not provided by this encoder".to_owned();
    let mut lines = Lines::default();
    lines
        .add_line("encoder", format!("{} (type {:02X}h)", identity.name, identity.label.encoder_type))
        .add_line(
            "resolution",
            identity
                .geometry
                .map_or_else(|| "not known: add periods= and turns= to the link".to_owned(), |g| g.to_string()),
        )
        .add_line("serial number", &identity.serial.serial_number)
        .add_line("firmware", format!("{} of {}", identity.serial.firmware_version, identity.serial.firmware_date))
        .add_line("address", format!("{:02X}h", identity.address))
        .add_line("talking at", runner.context)
        .add_line("stored settings", identity.label.settings)
        .add_line("EEPROM", format!("{} bytes", identity.label.eeprom_bytes()))
        .add_line("free", identity.memory.map_or_else(unknown, |memory| format!("{} bytes", memory.bytes())))
        .add_line("data fields", identity.memory.map_or_else(unknown, |memory| memory.fields.to_string()))
        .add_line("options", format!("{:02X}h", identity.label.options));
    if let Some(label) = identity.extended_label() {
        for parameter in &label.parameters {
            let value = parameter.value;
            lines.add_line(format!("label parameter {}", parameter.number), format!("{value} ({value:04X}h)"));
        }
        if !label.checksum_fits {
            lines.add_line("extended label", "checksum error");
        }
    }
    lines.text()
}

fn identity(runner: &mut Runner) -> Result<Identity> {
    Ok(result_of!(runner.run(HiperfaceJob::Identify)?, HiperfaceOutput::Identity(identity) => identity))
}

pub(super) fn status(common: &CommonArgs, output: &Output) -> Result {
    let mut runner = Runner::open(common)?;
    let codes = result_of!(runner.run(HiperfaceJob::Status)?, HiperfaceOutput::Status(codes) => codes);
    let (warnings, errors): (Vec<StatusCode>, Vec<StatusCode>) = codes.iter().partition(|code| code.is_warning());
    output.show(
        &json!({"ok": errors.is_empty(), "errors": code_list(&errors), "warnings": code_list(&warnings)}),
        &codes_text(&codes),
    )?;
    Ok(Success::Completed)
}

fn code_list(codes: &[StatusCode]) -> Vec<Json> {
    codes.iter().map(|code| json!({"code": code.byte(), "text": code.text()})).collect()
}

/// Returns the status codes, one per line, or a message that there are none.
pub(super) fn codes_text(codes: &[StatusCode]) -> String {
    if codes.is_empty() {
        return "no errors or warnings\n".to_owned();
    }
    let kind = |code: &StatusCode| if code.is_warning() { "warning" } else { "error" };
    codes.iter().map(|code| format!("{:7}  {code}\n", kind(code))).collect()
}

pub(super) fn position(common: &CommonArgs, output: &Output, position: &Position) -> Result {
    let mut runner = Runner::open(common)?;
    let identity = identity(&mut runner)?;
    if identity.geometry.is_none() {
        output.print_message(&format!(
            "The resolution of encoder type {:02X}h is not known: add periods= and turns= to the link.",
            identity.label.encoder_type
        ));
    }
    let table = position.csv.then(|| PositionTable::for_geometry(identity.geometry));
    if let Some(table) = &table {
        output.write_stdout(table.header())?;
    }
    // A status code reported during identification also applies to this position.
    let mut codes_before = reported_codes(&runner);
    let job = || HiperfaceJob::Position(identity.geometry);
    try_readings(&mut runner, position, job, |runner, came| {
        show(runner, output, came, table.as_ref(), &mut codes_before).map(|()| true)
    })
}

fn show(
    runner: &mut Runner,
    output: &Output,
    came: std::result::Result<HiperfaceOutput, Box<JobError>>,
    table: Option<&PositionTable>,
    codes_before: &mut Vec<StatusCode>,
) -> Result<()> {
    match came {
        Ok(HiperfaceOutput::Position(mut reading)) => {
            reading.valid &= !codes_before.iter().any(|code| code.invalidates_position());
            reading.codes = codes_before.drain(..).chain(reading.codes).collect();
            match table {
                Some(table) => output.write_stdout(&table.row(&reading)),
                None => show_position(output, &reading),
            }
        }
        Ok(other) => Err(unexpected_output(&other)),
        Err(error) if error.is_without_position() => match table {
            Some(table) => {
                output.print_message(&position_error_text(&error));
                output.write_stdout(&table.row_without_position(&reported_codes(runner)))
            }
            None => show_no_position(output, &error),
        },
        Err(error) => Err(JobFailure::<Hiperface>::Job(error).into_failure()),
    }
}

fn show_position(output: &Output, reading: &PositionReading) -> Result<()> {
    let t = reading.at.since_start().as_secs_f64();
    let place = reading.position;
    let mut json = json!({
        "t_s": t,
        "raw": reading.raw,
        "turns": place.and_then(|place| place.turns()),
        "steps": place.and_then(|place| place.steps()),
        "degrees": place.and_then(|place| place.degrees()),
        "valid": reading.valid,
    });
    if let (Some(millimetres), Some(object)) = (place.and_then(|place| place.millimetres()), json.as_object_mut()) {
        object.insert("millimetres".to_owned(), json!(millimetres));
    }
    let words = place.map_or_else(|| format!("{} steps", reading.raw), |place| place.to_string());
    let flag = if reading.valid { "" } else { "  not valid" };
    output.show(&json, &format!("{t:10.3} s  {:08X}h  {words}{flag}\n", reading.raw))
}

fn position_error_text(error: &JobError) -> String {
    explained::job_error_texts(error).iter().map(|text| text.terminal_text()).collect()
}

fn show_no_position(output: &Output, error: &JobError) -> Result<()> {
    output.print_message(&position_error_text(error));
    let json = json!({"t_s": null, "raw": null, "turns": null, "steps": null, "degrees": null, "valid": false});
    output.show(&json, "no position\n")
}

pub(super) fn read(common: &CommonArgs, output: &Output, item: &str) -> Result {
    let item = &super::parse_item(item)?;
    let mut runner = Runner::open(common)?;
    let value = result_of!(runner.run(HiperfaceJob::Read(*item))?, HiperfaceOutput::Value(value) => value);
    let (json, text) = match &value {
        Value::Bytes(bytes) => {
            (json!({"item": item.to_string(), "value": hex_compact(bytes)}), format!("{}\n", hex(bytes)))
        }
        Value::Analogue { value, limit } => {
            if limit.is_some_and(|limit| *value > limit) {
                output.print_message("The value exceeds the limit in the extended label of the encoder.");
            }
            let words = limit.map(|limit| format!("  (limit {limit})")).unwrap_or_default();
            (json!({"item": item.to_string(), "value": value, "limit": limit}), format!("{value}{words}\n"))
        }
        Value::Number(number) => (json!({"item": item.to_string(), "value": number}), number_text(item, *number)),
    };
    output.show(&json, &text)?;
    Ok(Success::Completed)
}

fn number_text(item: &Item, number: i64) -> String {
    match (item, u8::try_from(number)) {
        (Item::Settings, Ok(byte)) => format!("0x{byte:02X}  {}\n", LineSettings::from_byte(byte)),
        (Item::Status(_), Ok(byte)) => {
            format!("0x{byte:02X}  {}\n", crate::devices::hiperface::protocol::DataFieldStatus::from_byte(byte))
        }
        (Item::Address, Ok(byte)) => format!("0x{byte:02X}\n"),
        _ => format!("{number}\n"),
    }
}
