//! Parses numbers entered for a drive into values and edits.

use super::rows::Row;
use super::ruler::{PositionRangeError, PositionUnit};
use super::staged::Edit;
use super::unit::HiperdriveDevice;
use crate::app::{Text, parse_decimal};
use crate::devices::hiperdrive::protocol::{Length, Percent, PositionScale, ScaleError};
use crate::devices::hiperdrive::state::TEXTS;
use crate::devices::hiperdrive::state::explain;

/// Parses the length of a step. `sign` is −1 for a backward step.
///
/// # Errors
/// Returns an error with the reason if the entry is invalid.
pub fn parse_distance(unit: &HiperdriveDevice, text: &str, measure: PositionUnit, sign: i32) -> Result<i32, Text> {
    let steps = parse_position(unit, text, measure)?;
    if steps == 0 {
        return Err(TEXTS.text("hd_entry.no_step"));
    }
    Ok(steps.saturating_mul(sign))
}

/// Parses a position, which must be within the limits of the selected drive.
///
/// # Errors
/// Returns an error with the reason if the entry is invalid.
pub fn target(unit: &HiperdriveDevice, text: &str, measure: PositionUnit) -> Result<i32, Text> {
    let steps = parse_position(unit, text, measure)?;
    let place = |steps| unit.position_text(unit.drive(), steps);
    match unit.limits(unit.drive()) {
        Some((low, high)) if !(low..=high).contains(&steps) => Err(TEXTS
            .text("hd_refused.outside")
            .with_text("target", place(steps))
            .with_text("low", place(low))
            .with_text("high", place(high))),
        _ => Ok(steps),
    }
}

/// Parses a position without checking it against the limits, for example to enter a limit or set the position.
///
/// # Errors
/// Returns an error with the reason if the entry is invalid.
pub fn parse_position(unit: &HiperdriveDevice, text: &str, measure: PositionUnit) -> Result<i32, Text> {
    if text.trim().is_empty() {
        return Err(TEXTS.text("hd_entry.empty"));
    }
    let value = parse_decimal(text).ok_or_else(|| TEXTS.text("hd_entry.number").with("entry", text.trim()))?;
    if measure == PositionUnit::Steps && value.fract() != 0.0 {
        return Err(TEXTS.text("hd_entry.whole_steps").with("entry", text.trim()));
    }
    unit.ruler(unit.drive()).to_steps(value, measure).map_err(|beyond| match beyond {
        PositionRangeError::NoPitch => TEXTS.text("hd_entry.no_pitch"),
        PositionRangeError::Bits { least, most } => TEXTS
            .text("hd_entry.beyond")
            .with("entry", text.trim())
            .with_number("least", least, 0)
            .with_number("most", most, 0),
    })
}

/// Parses a percentage from 1 to 100.
///
/// # Errors
/// Returns an error with the reason if the entry is invalid.
pub fn percent(text: &str) -> Result<Percent, Text> {
    let digits = text.trim().trim_end_matches('%').trim();
    let percent = digits.parse().ok().filter(|percent| *percent >= 1).and_then(Percent::new);
    percent.ok_or_else(|| TEXTS.text("hd_entry.percent").with("entry", text.trim()))
}

/// Parses a parameter value in decimal or, with the prefix `0x`, in hexadecimal. An empty entry removes the value from
/// a profile.
///
/// # Errors
/// Returns an error with the reason if the entry is invalid.
pub fn parameter(row: &Row, text: &str) -> Result<Edit, Text> {
    let digits: String = text.chars().filter(|own| !matches!(own, ' ' | '\'' | '\u{a0}' | '\u{202f}')).collect();
    let digits = digits.replace('\u{2212}', "-");
    if digits.is_empty() && row.value.is_none() {
        return Ok(Edit::Leave(row.number));
    }
    let value = match digits.strip_prefix("0x").or_else(|| digits.strip_prefix("0X")) {
        Some(hex) => i64::from_str_radix(hex, 16).ok(),
        None => digits.parse().ok(),
    };
    let value = value.ok_or_else(|| TEXTS.text("hd_entry.whole").with("entry", text.trim()))?;
    let checked = row.kind.check_value(row.number, value, row.travel);
    checked.map(|value| Edit::Set(row.number, value)).map_err(|error| explain::out_of_range(&error))
}

/// Parses a length in millimetres, which must be above 0. The result is exact to the nanometre.
///
/// # Errors
/// Returns an error with the reason if the entry is invalid.
pub fn parse_length(text: &str) -> Result<Length, Text> {
    let millimetres = parse_decimal(text).filter(|own| *own > 0.0 && *own <= 1e6);
    let nanometres = millimetres.map(|own| (own * 1e6).round() as u64).filter(|own| *own > 0);
    nanometres
        .map(|nanometres| Length { nanometres })
        .ok_or_else(|| TEXTS.text("hd_entry.length").with("entry", text.trim()))
}

/// Returns the scale that gives a step the required length on a spindle with this pitch.
///
/// # Errors
/// Returns an error with the reason if there is no such scale.
pub fn scale(pitch: Length, step: Length) -> Result<PositionScale, Text> {
    PositionScale::for_spindle(pitch, step).map_err(|error| match error {
        ScaleError::Zero | ScaleError::NoLength => TEXTS.text("hd_entry.length").with("entry", 0),
        ScaleError::TooFine { steps, numerator, denominator } => TEXTS
            .text("hd_entry.too_fine")
            .with("steps", steps)
            .with("numerator", numerator)
            .with("denominator", denominator),
    })
}
