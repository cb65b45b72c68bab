//! Parsing of numbers typed in the Signals tab. The error messages state the valid values.

use crate::app::Text;
use crate::app::number::{MAX_PERIODS, parse_integer};
use crate::signals::state::TEXTS;

/// Parses the number of signal periods per revolution.
///
/// # Errors
/// Returns an error if the entry is invalid.
pub fn parse_periods(text: &str) -> Result<u32, Text> {
    parse_integer(TEXTS.text("quality.periods_per_turn"), text, 1, MAX_PERIODS)
}

/// Parses a finite number with a decimal point or comma.
///
/// # Errors
/// Returns an error if the entry is invalid.
pub fn parse_number(text: &str) -> Result<f64, Text> {
    crate::app::parse_decimal(text).ok_or_else(|| TEXTS.text("signals.bad_number").with("entry", text))
}

/// Parses the volts per unit of a table.
///
/// # Errors
/// Returns an error if the entry is invalid.
pub fn volts_per_unit(text: &str) -> Result<f64, Text> {
    let refused = || TEXTS.text("signals.bad_volts").with("entry", text);
    parse_number(text).ok().filter(|volts| *volts != 0.0).ok_or_else(refused)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn accepts_common_number_notations() {
        for (text, value) in [("1", 1.0), (" 0,5 ", 0.5), ("-2.5", -2.5), ("1e-3", 0.001), ("+7", 7.0)] {
            assert_eq!(parse_number(text), Ok(value), "{text}");
        }
        for text in ["", " ", "NaN", "inf", "1e999", "1,2,3", "0x10", "five", "--1", "."] {
            assert!(parse_number(text).is_err(), "{text}");
        }
        assert_eq!(volts_per_unit("0,001"), Ok(0.001));
        for text in ["0", "-0.0", "1e-999", "x"] {
            assert!(volts_per_unit(text).is_err(), "{text}");
        }
    }

    #[test]
    fn periods_are_integers_in_range() {
        for (text, value) in [("1", 1), (" 1024 ", 1024), ("65536", 65_536)] {
            assert_eq!(parse_periods(text), Ok(value), "{text}");
        }
        for text in ["", "0", "-5", "+5", "65537", "99999999999", "10.0", "1e3", "x"] {
            assert!(parse_periods(text).is_err(), "{text}");
        }
    }
}
