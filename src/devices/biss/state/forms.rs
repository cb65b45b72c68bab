//! The input for the procedures, and its conversion.

use crate::app::Text;
use crate::app::number::{parse_in_range, parse_integer};
use crate::devices::biss::protocol::{Layout, PresetValue};
use crate::devices::biss::state::TEXTS;

#[derive(Clone, Debug, PartialEq, Eq)]
pub struct PresetForm {
    /// Entered angle within the revolution, in degrees.
    pub degrees: String,
    pub turns: String,
}

impl Default for PresetForm {
    fn default() -> Self {
        PresetForm { degrees: "0".to_owned(), turns: "0".to_owned() }
    }
}

impl PresetForm {
    pub fn from_value(value: PresetValue, layout: &Layout) -> Self {
        let steps = (1_u64 << layout.singleturn_bits()) as f64;
        let degrees = f64::from(value.singleturn()) * 360.0 / steps;
        PresetForm { degrees: format!("{}", (degrees * 1e6).round() / 1e6), turns: value.multiturn().to_string() }
    }

    /// Returns the step nearest to the entered angle.
    ///
    /// # Errors
    /// Returns an error with the valid range if the entry is invalid.
    pub fn parse_singleturn(&self, layout: &Layout) -> Result<u32, Text> {
        let degrees = parse_in_range(TEXTS.text("preset_card.degrees"), &self.degrees, 0.0, 359.999_999)?;
        let steps = 1_u64 << layout.singleturn_bits();
        // The result is less than the number of steps, so it fits into 32 bits.
        Ok(((degrees / 360.0 * steps as f64).round() as u64 % steps) as u32)
    }

    /// Returns the entered number of revolutions.
    ///
    /// # Errors
    /// Returns an error with the valid range if the entry is invalid.
    pub fn parse_multiturn(&self, layout: &Layout) -> Result<u32, Text> {
        let last = u32::try_from((1_u64 << layout.multiturn_bits()) - 1).unwrap_or(u32::MAX);
        parse_integer(TEXTS.text("preset_card.turns"), &self.turns, 0, last.min(PresetValue::MAX))
    }

    /// Returns the preset value defined by both entries.
    ///
    /// # Errors
    /// Returns an error with the valid range if an entry is invalid. Only the first invalid entry is reported.
    pub fn value(&self, layout: &Layout) -> Result<PresetValue, Text> {
        let (singleturn, multiturn) = (self.parse_singleturn(layout)?, self.parse_multiturn(layout)?);
        PresetValue::new(singleturn, multiturn).ok_or_else(|| TEXTS.text("preset_card.too_wide"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn form(degrees: &str, turns: &str) -> PresetForm {
        PresetForm { degrees: degrees.to_owned(), turns: turns.to_owned() }
    }

    /// Expected steps at 17 bits from section 5.5 of the reference.
    #[test]
    fn converts_degrees_to_published_steps() {
        let layout = Layout::default();
        for (degrees, singleturn) in [("270", 98_304), ("0", 0), ("180", 65_536), ("90", 32_768), ("1", 364)] {
            assert_eq!(form(degrees, "7").value(&layout).unwrap(), PresetValue::new(singleturn, 7).unwrap());
        }
        // Angles within the last half step are rounded up to step 0 of the next revolution.
        assert_eq!(form("359.9999", "0").value(&layout).unwrap().singleturn(), 0);
        assert_eq!(PresetForm::from_value(PresetValue::new(98_304, 7).unwrap(), &layout), form("270", "7"));
    }

    #[test]
    fn reports_impossible_values() {
        let refused = |degrees, turns| form(degrees, turns).value(&Layout::default()).unwrap_err().id();
        for degrees in ["360", "-1", "NaN", "inf", "east"] {
            assert_eq!(refused(degrees, "0"), "entry.number", "{degrees}");
        }
        for turns in ["65536", "-1", "1.5"] {
            assert_eq!(refused("0", turns), "entry.whole", "{turns}");
        }
        assert_eq!((refused("", "0"), refused("0", "")), ("entry.missing", "entry.missing"));
        let (both, layout) = (form("north", "x"), Layout::default());
        assert!(both.parse_singleturn(&layout).is_err() && both.parse_multiturn(&layout).is_err(), "each for itself");
    }
}
