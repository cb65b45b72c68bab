//! The `position` command: a drive's position, converted with its scale.

use serde_json::json;

use super::inspect::state_keyword;
use super::run::{Runner, drive, value};
use crate::cli::Result;
use crate::cli::args::{CommonArgs, Position};
use crate::cli::output::Output;
use crate::cli::positions::print_readings;
use crate::devices::hiperdrive::jobs::{HiperdriveJob, HiperdriveOutput};
use crate::devices::hiperdrive::procedures::DriveReading;
use crate::devices::hiperdrive::protocol::drive_parameter::{DENOMINATOR, NUMERATOR};
use crate::devices::hiperdrive::protocol::{DriveNumber, ParameterNumber, PositionScale, StatusBit, Value};
use crate::devices::hiperdrive::state::explain as explained;
use crate::result_of;

/// Reads and prints the position. The scale is read once, and afterwards only parameters 105 to 107 are read.
pub(super) fn position(common: &CommonArgs, output: &Output, position: &Position) -> Result {
    let mut runner = Runner::open(common)?;
    let drive = drive(&position.own.read()?);
    let (numerator, denominator) =
        (read_word(&mut runner, NUMERATOR, drive)?, read_word(&mut runner, DENOMINATOR, drive)?);
    let scale = numerator.zip(denominator).and_then(|(one, other)| PositionScale::new(one, other).ok());
    if position.csv {
        output.write_stdout("t_s,raw,turns,steps,degrees,valid\n")?;
    }
    let job = || HiperdriveJob::Position(drive);
    print_readings(&mut runner, position, job, |came| {
        let reading = result_of!(came, HiperdriveOutput::Position(reading) => reading);
        let place = scale.map(|scale| TurnPosition::split(reading.actual.position, scale));
        if position.csv { output.write_stdout(&row(&reading, place)) } else { show(output, &reading, place) }
    })
}

fn read_word(runner: &mut Runner, number: u16, drive: DriveNumber) -> Result<Option<u16>> {
    let Some(number) = ParameterNumber::for_drive(number, drive) else { return Ok(None) };
    Ok(match value(runner, number)? {
        Value::Number(part) => u16::try_from(part).ok(),
        Value::Text(_) => None,
    })
}

/// A position split into turns and steps.
#[derive(Clone, Copy, Debug, PartialEq)]
struct TurnPosition {
    /// Number of whole turns. A position of −1 step is in turn −1.
    turns: i64,
    /// Steps within the turn, fractional if a turn is not a whole number of steps.
    steps: f64,
    degrees: f64,
}

impl TurnPosition {
    /// Splits a position. A turn has 256 · numerator / denominator steps (reference, section 5).
    fn split(position: i32, scale: PositionScale) -> Self {
        let (numerator, denominator) = (i64::from(scale.numerator()), i64::from(scale.denominator()));
        // Fractions of a step make a turn a whole number.
        let (turn, parts) = (256 * numerator, i64::from(position) * denominator);
        let rest = parts.rem_euclid(turn);
        // The values are at most 256 · 65535, which `f64` represents exactly.
        let (exact, turn_parts, step_parts) = (rest as f64, turn as f64, denominator as f64);
        TurnPosition { turns: parts.div_euclid(turn), steps: exact / step_parts, degrees: 360.0 * exact / turn_parts }
    }

    /// Returns the steps as JSON, as an integer where possible.
    fn steps_json(self) -> serde_json::Value {
        // The value is at most 2^24, so the cast is exact.
        if self.steps.fract() == 0.0 { json!(self.steps as i64) } else { json!(self.steps) }
    }
}

/// Returns whether the drive is present and its reference is set.
fn is_valid(reading: &DriveReading) -> bool {
    let status = reading.actual.status;
    status.is_present() && status.is_set(StatusBit::ReferenceSet)
}

fn show(output: &Output, reading: &DriveReading, place: Option<TurnPosition>) -> Result<()> {
    let t = reading.at.since_start().as_secs_f64();
    let actual = reading.actual;
    let state = actual.status.state();
    let json = json!({
        "t_s": t,
        "raw": actual.position,
        "turns": place.map(|place| place.turns),
        "steps": place.map(TurnPosition::steps_json),
        "degrees": place.map(|place| place.degrees),
        "valid": is_valid(reading),
        "drive": reading.drive.get(),
        "speed": actual.speed,
        "state": state_keyword(state),
    });
    let words = match place {
        _ if !is_valid(reading) => "not valid".to_owned(),
        Some(place) => format!("turn {}, step {}, {:.3}°", place.turns, place.steps, place.degrees),
        None => "its scaling (154, 156) is not valid".to_owned(),
    };
    let state = explained::state_text(state).terminal_text();
    output.show(&json, &format!("{t:10.3} s  {:>11}  {words}  ({state})\n", actual.position))
}

fn row(reading: &DriveReading, place: Option<TurnPosition>) -> String {
    let column = |number: Option<String>| number.unwrap_or_default();
    format!(
        "{:.6},{},{},{},{},{}\n",
        reading.at.since_start().as_secs_f64(),
        reading.actual.position,
        column(place.map(|place| place.turns.to_string())),
        column(place.map(|place| place.steps.to_string())),
        column(place.map(|place| place.degrees.to_string())),
        is_valid(reading),
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    /// At 65536 steps per turn, −1 is step 65535 in turn −1, and 163840 is 2.5 turns. At 400 steps of 0.01 mm, 1000 is
    /// 2.5 turns. At 256 · 10 / 3 = 853.33 steps, −1 is step 852.33 in turn −1.
    #[test]
    fn splits_position_into_turns_and_steps() {
        let place = |position, numerator, denominator| {
            let TurnPosition { turns, steps, degrees } =
                TurnPosition::split(position, PositionScale::new(numerator, denominator).unwrap());
            (turns, (steps * 1000.0).round() / 1000.0, (degrees * 1000.0).round() / 1000.0)
        };
        assert_eq!(place(0, 256, 1), (0, 0.0, 0.0));
        assert_eq!(place(-1, 256, 1), (-1, 65_535.0, 359.995));
        assert_eq!(place(163_840, 256, 1), (2, 32_768.0, 180.0));
        assert_eq!(place(1000, 400, 256), (2, 200.0, 180.0));
        assert_eq!(place(-1, 10, 3), (-1, 852.333, 359.578));
        assert_eq!(place(i32::MIN, 65_535, 1), (-129, 16_744_192.0, 359.297));
        assert_eq!(TurnPosition::split(-1, PositionScale::FACTORY).steps_json(), json!(65_535));
    }
}
