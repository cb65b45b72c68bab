//! The command `position`, which reads IN words and converts them to turns, steps and degrees.

use serde_json::json;

use super::DisturbanceLevel;
use super::inspect::mode_name;
use super::run::{Runner, identity, programs};
use crate::cli::Result;
use crate::cli::args::{CommonArgs, Position};
use crate::cli::output::Output;
use crate::cli::positions::print_readings;
use crate::devices::interbus::jobs::{InterbusJob, InterbusOutput};
use crate::devices::interbus::procedures::WordReading;
use crate::devices::interbus::protocol::{CamNumber, StartupMode};
use crate::result_of;

/// Reads positions. The encoder is identified once to learn its gear, and then only the IN word is read.
pub(super) fn position(common: &CommonArgs, output: &Output, position: &Position) -> Result {
    let mut runner = Runner::open(common)?;
    DisturbanceLevel::Reading.print_effect(output);
    let identity = identity(&mut runner)?;
    if let StartupMode::Cams(_) = identity.mode {
        // Reads only the window shift, which determines the bits of the position in the word.
        programs(&mut runner, Vec::new())?;
    }
    if position.csv {
        output.write_stdout("t_s,raw,turns,steps,degrees,valid\n")?;
    }
    let job = || InterbusJob::Position;
    print_readings(&mut runner, position, job, |came| {
        let reading = result_of!(came, InterbusOutput::Position(reading) => reading);
        if position.csv { output.write_stdout(&row(&reading)) } else { show(output, &reading) }
    })
}

fn show(output: &Output, reading: &WordReading) -> Result<()> {
    let t = reading.at.since_start().as_secs_f64();
    let place = reading.turn_position();
    let cams = reading.cams().map(|own| active_outputs(own.outputs));
    let mut json = json!({
        "t_s": t,
        "raw": reading.word,
        "turns": place.map(|place| place.turns),
        "steps": place.map(|place| place.steps),
        "degrees": place.map(|place| place.degrees),
        "valid": reading.is_valid(),
        "position": reading.position(),
        "mode": reading.mode.map(mode_name),
    });
    if let Some(keys) = json.as_object_mut() {
        if let Some(cams) = &cams {
            keys.insert("cams".to_owned(), json!(cams));
        }
        if let Some(rpm) = reading.rpm() {
            keys.insert("rpm".to_owned(), json!(rpm));
        }
    }
    output.show(&json, &format!("{t:10.3} s  0x{:08X}  {}\n", reading.word, describe_reading(reading, cams.as_deref())))
}

fn active_outputs(outputs: u8) -> Vec<u8> {
    CamNumber::all().map(CamNumber::get).filter(|cam| outputs >> cam & 1 != 0).collect()
}

fn describe_reading(reading: &WordReading, cams: Option<&[u8]>) -> String {
    if !reading.is_valid() {
        return "not valid".to_owned();
    }
    if let Some(rpm) = reading.rpm() {
        return format!("{rpm} 1/min");
    }
    let position = match (reading.position(), reading.turn_position()) {
        (Some(position), Some(place)) => {
            format!("position {position}: turn {}, step {}, {:.3}°", place.turns, place.steps, place.degrees)
        }
        (Some(position), None) => format!("position {position}, outside the measuring range"),
        (None, _) => "no whole position under the window".to_owned(),
    };
    match cams {
        None => position,
        Some([]) => "position; no cam on".to_string(),
        Some(cams) => {
            let cams = cams.iter().map(ToString::to_string).collect::<Vec<_>>().join(", ");
            format!("position; cams on: {cams}")
        }
    }
}

fn row(reading: &WordReading) -> String {
    let place = reading.turn_position();
    let column = |number: Option<String>| number.unwrap_or_default();
    format!(
        "{:.6},{},{},{},{},{}\n",
        reading.at.since_start().as_secs_f64(),
        reading.word,
        column(place.map(|place| place.turns.to_string())),
        column(place.map(|place| place.steps.to_string())),
        column(place.map(|place| place.degrees.to_string())),
        reading.is_valid(),
    )
}
