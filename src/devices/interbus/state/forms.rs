//! Converts typed entries to values and edits.

use super::format;
use super::staged::Edit;
use crate::app::Text;
use crate::app::number::parse_decimal as decimal;
use crate::devices::interbus::profile::{Parameters, Scale, Unit};
use crate::devices::interbus::protocol::{Parameter, Value};
use crate::devices::interbus::state::TEXTS;

/// Parses a whole number whose digits may be separated by blanks or apostrophes.
pub fn parse_number(text: &str) -> Result<u32, Text> {
    let digits: String = text.chars().filter(|own| !matches!(own, ' ' | '\'' | '\u{a0}' | '\u{202f}')).collect();
    let number = match digits.strip_prefix("0x").or_else(|| digits.strip_prefix("0X")) {
        Some(hex) => u32::from_str_radix(hex, 16).ok(),
        None => digits.parse().ok(),
    };
    number.ok_or_else(|| TEXTS.text("ib_entry.number").with("entry", text.trim()))
}

/// Parses a parameter entry into an edit. The edit itself checks whether the value is compatible with other parameters.
///
/// # Errors
/// Returns an error with a message if the entry is not a number.
pub fn parse_parameter_edit(parameter: Parameter, text: &str, now: &Parameters) -> Result<Edit, Text> {
    let value = parse_number(text)?;
    Ok(match parameter {
        Parameter::Steps => Edit::Gear { steps: check_in_range(parameter, value, now)?, revolutions: now.revolutions },
        Parameter::Turns => Edit::Revolutions(check_in_range(parameter, value, now)?),
        Parameter::Preset => Edit::Preset(check_in_range(parameter, value, now)?),
        Parameter::ZeroShift => Edit::ZeroShift(check_in_range(parameter, value, now)?),
        Parameter::Direction | Parameter::Default => {
            return Err(TEXTS.text("ib_entry.number").with("entry", text.trim()));
        }
    })
}

/// Parses a preset entry. An empty entry means the stored preset.
///
/// # Errors
/// Returns an error with a message if the entry is not a number or is beyond the measuring range.
pub fn parse_preset(text: &str, now: &Parameters) -> Result<u32, Text> {
    if text.trim().is_empty() {
        return Ok(now.preset);
    }
    check_in_range(Parameter::Preset, parse_number(text)?, now)
}

/// Parses the number of steps by which to shift a program. A negative number shifts it to earlier positions.
///
/// # Errors
/// Returns an error with a message if the entry is not a number.
pub fn parse_offset(text: &str) -> Result<i64, Text> {
    let entry = text.trim().replace('\u{2212}', "-");
    entry.parse::<i32>().map(i64::from).map_err(|_| TEXTS.text("ib_entry.number").with("entry", text.trim()))
}

/// Formats a position for an entry field, in the unit of the scale.
pub fn format_position(step: u32, scale: &Scale, range: u32) -> String {
    match scale.unit() {
        Unit::Steps if scale.zero() == 0 => step.to_string(),
        _ => format!("{:.*}", scale.decimal_places(), scale.value(step, range)),
    }
}

/// Parses a position in the unit of the scale and returns the nearest step.
///
/// # Errors
/// Returns an error with a message if the entry is not a number or is beyond the measuring range.
pub fn parse_position(text: &str, scale: &Scale, range: u32) -> Result<u32, Text> {
    let refused = || TEXTS.text("ib_entry.position").with("entry", text.trim());
    let value = decimal(text).ok_or_else(refused)?;
    let placed = scale.round_position(value, range).map_err(|error| {
        TEXTS
            .text("ib_entry.outside")
            .with_number("value", error.value, scale.decimal_places())
            .with_number("least", error.least, scale.decimal_places())
            .with_number("most", error.most, scale.decimal_places())
            .with("unit", scale.unit().symbol())
    })?;
    Ok(placed.step)
}

/// Returns the initial scale for a unit. For degrees, the measuring range is one turn of the machine.
pub fn default_scale(unit: Unit, zero: u32, range: u32) -> Scale {
    let steps = match unit {
        Unit::Degrees => f64::from(range.max(1)),
        Unit::Steps | Unit::Millimetres => 1.0,
    };
    Scale::new(unit, steps, zero).unwrap_or_default()
}

/// Returns the number of steps per turn of the machine or per millimetre, or `None` if the unit is the step.
pub fn steps_per_unit(scale: &Scale) -> Option<f64> {
    match scale.unit() {
        Unit::Steps => None,
        Unit::Degrees => Some(scale.steps_per_unit() * 360.0),
        Unit::Millimetres => Some(scale.steps_per_unit()),
    }
}

/// Parses the number of steps per turn or per millimetre and returns the scale.
///
/// # Errors
/// Returns an error with a message if the entry is not a number above 0.
pub fn scale(unit: Unit, text: &str, zero: u32) -> Result<Scale, Text> {
    let refused = || TEXTS.text("ib_entry.scale").with("entry", text.trim());
    let steps = decimal(text).ok_or_else(refused)?;
    Scale::new(unit, steps, zero).map_err(|_| refused())
}

/// Returns the scale with machine zero at the encoder position that was entered.
///
/// # Errors
/// Returns an error with a message if the entry is not a position within the measuring range.
pub fn scale_with_zero(own: &Scale, text: &str, range: u32) -> Result<Scale, Text> {
    let zero = parse_number(text)?;
    let last = range.saturating_sub(1);
    if zero > last {
        let text = TEXTS.text("ib_entry.range").with_text("what", TEXTS.text("ib_scale.zero")).with("value", zero);
        return Err(text.with("low", 0).with("high", last));
    }
    Scale::new(own.unit(), steps_per_unit(own).unwrap_or(1.0), zero)
        .map_err(|_| TEXTS.text("ib_entry.scale").with("entry", text))
}

fn check_in_range(parameter: Parameter, value: u32, now: &Parameters) -> Result<u32, Text> {
    let range = match now.gear() {
        Ok(gear) => parameter.valid_range(gear),
        Err(_) => parameter.range_with_any_gear(),
    };
    if range.contains(&value) && Value::new(value).is_some() {
        return Ok(value);
    }
    Err(TEXTS
        .text("ib_entry.range")
        .with_text("what", format::parameter(parameter))
        .with("value", value)
        .with("low", range.start())
        .with("high", range.end()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::devices::interbus::profile::Direction;

    fn now() -> Parameters {
        Parameters { steps: 4096, revolutions: 1, direction: Direction::Clockwise, preset: 7, zero_shift: 0 }
    }

    #[test]
    fn rejects_numbers_beyond_limits() {
        assert_eq!(parse_number(" 33 554 431 "), Ok(33_554_431));
        assert_eq!(parse_number("0x1FF"), Ok(511));
        assert!(parse_number("-1").is_err() && parse_number("1.5").is_err() && parse_number("").is_err());
        let edit = |parameter: Parameter, text: &str| super::parse_parameter_edit(parameter, text, &now());
        assert_eq!(edit(Parameter::Turns, "4096"), Ok(Edit::Revolutions(4096)));
        assert_eq!(edit(Parameter::Preset, "4095"), Ok(Edit::Preset(4095)));
        // According to reference 3, a preset is below the number of steps, of which there are at most 8192 per turn.
        let refused = edit(Parameter::Preset, "4096").unwrap_err().to_string_in(crate::app::Language::English);
        assert_eq!(refused, "Preset value: 4096 is outside the range 0 to 4095.");
        assert!(edit(Parameter::Steps, "8193").is_err() && edit(Parameter::Steps, "8192").is_ok());
        assert!(edit(Parameter::Turns, "4097").is_err() && edit(Parameter::Turns, "0").is_err());
        assert_eq!((parse_preset("", &now()), parse_preset("12", &now())), (Ok(7), Ok(12)));
        assert!(parse_preset("4096", &now()).is_err());
    }
}
