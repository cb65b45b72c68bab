//! Read-only commands: `identify`, `status`, `position` and `read`.

use std::time::{Duration, Instant};

use serde_json::{Value as Json, json};

use super::register_text;
use super::run::{Runner, crc_errors, identity, read_registers, registers};
use crate::bits::{hex, hex_compact};
use crate::cli::args::{CommonArgs, Position};
use crate::cli::output::{Lines, Output, write_stderr};
use crate::cli::positions::try_readings;
use crate::cli::runner::{JobFailure, unexpected_output};
use crate::cli::{Result, Success};
use crate::devices::biss::jobs::{Biss, BissJob, BissOutput, JobError, RegisterValues};
use crate::devices::biss::procedures::{
    EncoderStatus, Error, FlagRegister, FrameSource, Identity, PositionReading, ReplyDamage, Transport,
};
use crate::devices::biss::profile::RegisterRange;
use crate::devices::biss::protocol::{KIND, Name, Role};
use crate::devices::biss::state::explain as explained;
use crate::result_of;

/// Time without a valid frame after which the line is considered to carry only noise.
const NOISE: Duration = Duration::from_secs(5);

pub(super) fn identify(common: &CommonArgs, output: &Output) -> Result {
    let mut runner = Runner::open(common)?;
    let identity = identity(&mut runner)?;
    let celsius = temperature(&mut runner, &identity)?;
    let json = json!({
        "device": KIND,
        "name": identity.description.name(),
        "profile_id": format!("{:04X}", identity.kind.profile.to_u16()),
        "serial_number": identity.serial_number,
        "firmware": identity.firmware.map(|firmware| firmware.to_string()),
        "device_id": hex_compact(&identity.kind.device_id),
        "manufacturer": manufacturer_text(&identity),
        "multiturn_bits": identity.multiturn_bits(),
        "singleturn_bits": identity.singleturn_bits(),
        "temperature_c": celsius,
        "adapter": identity.adapter.as_ref().map(|hello| &hello.name),
    });
    output.show(&json, &identity_text(&identity, celsius))?;
    Ok(Success::Completed)
}

/// Returns the manufacturer ID as text if it is printable, or as hexadecimal bytes otherwise.
fn manufacturer_text(identity: &Identity) -> String {
    let bytes = &identity.kind.manufacturer;
    let text = std::str::from_utf8(bytes).ok().filter(|text| text.chars().all(|c| c.is_ascii_graphic()));
    text.map_or_else(|| hex_compact(bytes), str::to_owned)
}

/// Reads the temperature in degrees Celsius, if the encoder has a register for it.
fn temperature(runner: &mut Runner, identity: &Identity) -> Result<Option<f64>> {
    let Some(register) = identity.description.register_with_role(Role::Temperature) else { return Ok(None) };
    let Some(range) = RegisterRange::new(register.address, register.width) else { return Ok(None) };
    Ok(register_text::register_quantity(register, &registers(runner, range)?))
}

fn identity_text(identity: &Identity, celsius: Option<f64>) -> String {
    let unknown = || "not provided by this encoder".to_owned();
    let kind = &identity.kind;
    let frame = match identity.source {
        FrameSource::DataSheet => "from its data sheet",
        FrameSource::Description => "from its description",
        FrameSource::Given => "from the link",
        FrameSource::Checksum => "found by its checksum: the number of turn bits is not known",
        FrameSource::Assumed => "assumed: no source available",
    };
    let (multiturn, singleturn) = (identity.layout.multiturn_bits(), identity.layout.singleturn_bits());
    let mut lines = Lines::default();
    lines
        .add_line("encoder", identity.description.name())
        .add_line("profile", format!("0x{:04X}", kind.profile.to_u16()))
        .add_line("manufacturer", manufacturer_text(identity))
        .add_line("device ID", hex(&kind.device_id))
        .add_line(
            "serial number",
            if identity.serial_bytes.is_empty() { unknown() } else { format_serial_number(identity) },
        )
        .add_line("firmware", identity.firmware.map_or_else(unknown, |firmware| firmware.to_string()))
        .add_line("position", format!("{multiturn} bits of turns, {singleturn} of steps, {frame}"))
        .add_line("temperature", celsius.map_or_else(unknown, |celsius| format!("{celsius} °C")));
    if let Some(mismatch) = &identity.mismatch {
        lines.add_line("note", mismatch);
    }
    if let Some(hello) = &identity.adapter {
        lines.add_line(
            "adapter",
            format!("{}, serial number {}, firmware {}", hello.name, hello.serial, hello.firmware),
        );
    }
    lines.text()
}

/// Formats the serial number with its raw bytes, because the manual does not define the byte order.
fn format_serial_number(identity: &Identity) -> String {
    format!("{} ({})", identity.serial_number, hex(&identity.serial_bytes))
}

pub(super) fn status(common: &CommonArgs, output: &Output) -> Result {
    let mut runner = Runner::open(common)?;
    let status = result_of!(runner.run(BissJob::Status)?, BissOutput::Status(status) => *status);
    let position_error = status.position.and_then(|reading| reading.error);
    let errors = status.errors.as_ref().map_or_else(Vec::new, flag_list);
    let json = json!({
        "ok": errors.is_empty() && position_error != Some(true),
        "errors": errors,
        "warnings": status.warnings.as_ref().map_or_else(Vec::new, flag_list),
        "position_error": position_error,
        "position_warning": status.position.and_then(|reading| reading.warning),
        "mode": status.mode.map(|mode| mode.byte()),
        "temperature_c": status.celsius,
        "filter": status.filter.map(register_text::filter),
    });
    output.show(&json, &status_text(&status))?;
    Ok(Success::Completed)
}

fn flag_list(bits: &FlagRegister) -> Vec<Json> {
    bits.set
        .iter()
        .map(|(bit, name)| json!({"code": bit, "text": bit_text(*bit, name.as_ref().map(Name::english))}))
        .collect()
}

fn bit_text(bit: u8, name: Option<&str>) -> String {
    name.map_or_else(|| format!("bit {bit}, which is not described"), str::to_owned)
}

fn status_text(status: &EncoderStatus) -> String {
    let mut lines = Lines::default();
    for (label, bits) in [("errors", &status.errors), ("warnings", &status.warnings)] {
        match bits {
            None => lines.add_line(label, "not provided by this encoder"),
            Some(bits) if bits.set.is_empty() => lines.add_line(label, "none"),
            Some(bits) => {
                let named = bits.set.iter().map(|(bit, name)| bit_text(*bit, name.as_ref().map(Name::english)));
                lines.add_line(label, named.collect::<Vec<_>>().join(", "))
            }
        };
    }
    if let Some(mode) = status.mode {
        lines.add_line("mode", mode);
    }
    if let Some(celsius) = status.celsius {
        lines.add_line("temperature", format!("{celsius} °C"));
    }
    if let Some(filter) = status.filter {
        lines.add_line("filter", register_text::filter(filter));
    }
    match &status.position {
        None => lines.add_line("position", "none can be read"),
        Some(reading) => {
            lines.add_line("position", format!("{}{}", describe_position(reading), describe_flags(reading)))
        }
    };
    lines.text()
}

pub(super) fn position(common: &CommonArgs, output: &Output, position: &Position) -> Result {
    let mut runner = Runner::open(common)?;
    let over_biss = runner.context == Transport::Adapter;
    if position.csv {
        output.write_stdout("t_s,raw,turns,steps,degrees,valid,warning\n")?;
    }
    let (mut wrong, mut good_at) = (0, Instant::now());
    let ended = try_readings(
        &mut runner,
        position,
        || BissJob::Position,
        |runner, came| {
            wrong += crc_errors(runner);
            let reading = match came {
                Ok(BissOutput::Position(reading)) => reading,
                Ok(other) => return Err(unexpected_output(&other)),
                // No line is printed, because the next frame may be valid.
                Err(error) if is_noise(&error) && good_at.elapsed() < NOISE => return Ok(false),
                Err(error) => {
                    if let JobError::Device(Error::WrongWidths { frames, .. }) = &*error {
                        wrong += u64::from(*frames);
                    }
                    return Err(JobFailure::<Biss>::Job(error).into_failure());
                }
            };
            (wrong, good_at) = (wrong + u64::from(reading.crc_errors), Instant::now());
            if position.csv {
                output.write_stdout(&row(&reading))?
            } else {
                show(output, &reading)?
            }
            Ok(true)
        },
    );
    if over_biss && (ended.is_ok() || wrong > 0) {
        write_stderr(&format!("crc errors: {wrong}\n"));
    }
    ended
}

/// Returns whether frames were received but all of them had a wrong checksum.
fn is_noise(error: &JobError) -> bool {
    matches!(error, JobError::Device(Error::Damaged { cause: ReplyDamage::Frame(_), .. }))
}

fn show(output: &Output, reading: &PositionReading) -> Result<()> {
    let t = reading.at.since_start().as_secs_f64();
    let json = json!({
        "t_s": t,
        "raw": reading.position_word().value,
        "frame": reading.frame.map(|frame| frame.to_string()),
        "turns": reading.is_split_known.then_some(reading.turns),
        "steps": reading.is_split_known.then_some(reading.steps),
        "degrees": reading.angle_degrees(),
        "valid": reading.is_valid(),
        "warning": reading.warning,
    });
    let frame = reading.frame.map_or_else(String::new, |frame| format!("  frame {frame}"));
    output.show(
        &json,
        &format!(
            "{t:10.3} s  0x{}  {}{}{frame}\n",
            reading.position_word(),
            describe_position(reading),
            describe_flags(reading)
        ),
    )
}

fn describe_position(reading: &PositionReading) -> String {
    if !reading.is_split_known {
        return format!("{} (turns and steps are not known: set mt= and st= in the link)", reading.position());
    }
    let steps = 1u64 << reading.singleturn_bits;
    format!("turn {}, step {} of {steps}, {:.6}°", reading.turns, reading.steps, reading.degrees_in_turn())
}

fn describe_flags(reading: &PositionReading) -> &'static str {
    match (reading.is_valid(), reading.warning) {
        (false, _) => "  not valid",
        (true, Some(true)) => "  warning",
        (true, _) => "",
    }
}

fn row(reading: &PositionReading) -> String {
    let known = |words: String| if reading.is_split_known { words } else { String::new() };
    format!(
        "{:.6},{},{},{},{},{},{}\n",
        reading.at.since_start().as_secs_f64(),
        reading.position_word().value,
        known(reading.turns.to_string()),
        known(reading.steps.to_string()),
        known(reading.degrees_in_turn().to_string()),
        reading.is_valid(),
        reading.warning.map_or_else(String::new, |warning| warning.to_string()),
    )
}

pub(super) fn read(common: &CommonArgs, output: &Output, item: &str) -> Result {
    let range = super::parse_item(item)?;
    let mut runner = Runner::open(common)?;
    let identity = identity(&mut runner)?;
    let RegisterValues { bytes, unsaved, .. } = read_registers(&mut runner, range)?;
    if let Some(mode) = unsaved {
        output.print_message(&explained::unsaved_warning(mode).terminal_text());
    }
    let meaning = identity
        .description
        .register_at(range.start())
        .and_then(|register| register_text::describe_register(register, range, &bytes));
    let (value, shown) = match bytes.as_slice() {
        [byte] if !item.contains('+') => (json!(byte), format!("0x{byte:02X}")),
        bytes => (json!(hex_compact(bytes)), hex(bytes)),
    };
    let mut json = json!({"item": range.to_string(), "value": value});
    if let (Some(meaning), Some(keys)) = (&meaning, json.as_object_mut()) {
        keys.insert("text".to_owned(), json!(meaning));
    }
    let text = meaning.map_or_else(|| format!("{shown}\n"), |meaning| format!("{shown}  {meaning}\n"));
    output.show(&json, &text)?;
    Ok(Success::Completed)
}
