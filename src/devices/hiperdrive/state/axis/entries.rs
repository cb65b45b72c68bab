//! Entries in the axis set-up: pitch, resolution, reference position and limits, with the values that result from them.

use super::{DriveFacts, labels};
use crate::app::number::parse_in_range;
use crate::app::texts::localize_number;
use crate::app::{Language, Text};
use crate::devices::hiperdrive::protocol::{Family, Length, PositionScale, nearest_reference};
use crate::devices::hiperdrive::state::TEXTS;
use crate::devices::hiperdrive::state::ruler::{PositionRangeError, PositionUnit, Ruler};

/// Values in millimetres as typed by the user.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct LengthEntries {
    /// Pitch of the spindle in millimetres per turn.
    pub pitch: String,
    /// Length of a step in millimetres.
    pub resolution: String,
    pub reference: String,
    pub lower: String,
    pub upper: String,
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LimitsPreview {
    /// Position scale to write to parameters 154 and 156.
    pub scale: PositionScale,
    pub ruler: Ruler,
    /// Lower limit during the set-up, given by the travel of the drive.
    pub lower: i32,
    /// Upper limit during the set-up, given by the travel of the drive.
    pub upper: i32,
    /// What the current limits would be in millimetres under the new scale, if their numbers of steps stayed the same.
    pub unchanged: Option<(f64, f64)>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ReferencePosition {
    /// Position that the user entered.
    pub asked: i32,
    /// Position as the drive accepts it, a multiple of 64 steps.
    pub becomes: i32,
}

impl LengthEntries {
    /// Creates the initial entries from the known spindle data. An unconfirmed pitch is not proposed, since it could
    /// give wrong lengths.
    pub(super) fn new(ruler: Option<Ruler>) -> Self {
        let known = ruler.and_then(|own| Some((own.pitch?, own)));
        let pitch = known.map(|(pitch, _)| trimmed_number(pitch.nanometres as f64 / 1e6)).unwrap_or_default();
        let step = known.filter(|(_, own)| own.scale != PositionScale::FACTORY);
        let resolution = step.and_then(|(_, own)| own.from_steps(1, PositionUnit::Millimetres)).map(trimmed_number);
        let resolution = resolution.unwrap_or_else(|| "0.01".to_owned());
        LengthEntries { pitch, resolution, reference: "0".to_owned(), ..LengthEntries::default() }
    }

    /// Returns the entries with the decimal separator of this language.
    pub fn localized(&self, language: Language) -> Self {
        let shown = |text: &String| localize_number(text, language);
        LengthEntries {
            pitch: shown(&self.pitch),
            resolution: shown(&self.resolution),
            reference: shown(&self.reference),
            lower: shown(&self.lower),
            upper: shown(&self.upper),
        }
    }

    /// Returns the pitch of the spindle.
    ///
    /// # Errors
    /// Returns an error with the reason if the entry is invalid.
    pub fn parse_pitch(&self) -> Result<Length, Text> {
        parse_length("hd_axis.pitch", &self.pitch, 1000.0)
    }

    /// Calculates the values that result from the entered pitch and resolution.
    ///
    /// # Errors
    /// Returns an error with the reason if an entry is invalid.
    pub fn preview(&self, seen: &DriveFacts) -> Result<LimitsPreview, Text> {
        let (pitch, step) = (self.parse_pitch()?, parse_length("hd_axis.resolution", &self.resolution, 100.0)?);
        let scale = PositionScale::for_spindle(pitch, step).map_err(|why| labels::scale(&why))?;
        let ruler = Ruler { scale, pitch: Some(pitch) };
        let turns = seen.family.unwrap_or(Family::Short).factory_turns();
        // With very fine steps, part of the travel does not fit into 32 bits.
        let lower = scale.steps_of_turns(-turns).unwrap_or(i32::MIN);
        let upper = scale.steps_of_turns(turns).unwrap_or(i32::MAX);
        let unchanged = seen.limits.and_then(|(low, high)| {
            let mm = |steps: i32| ruler.from_steps(steps.into(), PositionUnit::Millimetres);
            Some((mm(low)?, mm(high)?))
        });
        Ok(LimitsPreview { scale, ruler, lower, upper, unchanged })
    }

    /// Returns the position number to assign to the current location of the axis.
    ///
    /// # Errors
    /// Returns an error with the reason if the number is invalid or outside the limits.
    pub fn parse_reference(&self, ruler: Option<Ruler>, limits: Option<(i32, i32)>) -> Result<ReferencePosition, Text> {
        let asked = position("hd_axis.reference", &self.reference, ruler)?;
        let (low, high) = limits.ok_or_else(|| TEXTS.text("hd_axis.unread"))?;
        let becomes = nearest_reference(asked).filter(|own| (low..=high).contains(own));
        let becomes = becomes.ok_or_else(|| {
            let mm = |steps: i32| labels::millimetres_text(ruler, steps.into());
            TEXTS.text("hd_axis.reference_outside").with_text("low", mm(low)).with_text("high", mm(high))
        })?;
        Ok(ReferencePosition { asked, becomes })
    }

    /// Returns the lower limit.
    ///
    /// # Errors
    /// Returns an error with the reason if the entry is invalid.
    pub fn lower_limit(&self, ruler: Option<Ruler>) -> Result<i32, Text> {
        position("hd_axis.lower", &self.lower, ruler)
    }

    /// Returns the upper limit.
    ///
    /// # Errors
    /// Returns an error with the reason if the entry is invalid.
    pub fn upper_limit(&self, ruler: Option<Ruler>) -> Result<i32, Text> {
        position("hd_axis.upper", &self.upper, ruler)
    }
}

fn trimmed_number(value: f64) -> String {
    let text = format!("{value:.6}");
    text.trim_end_matches('0').trim_end_matches('.').to_owned()
}

/// Formats a position for an input field, in millimetres with enough decimals to distinguish adjacent steps.
pub(super) fn format_steps(ruler: Ruler, steps: i32) -> Option<String> {
    let decimals = ruler.decimal_places(PositionUnit::Millimetres);
    Some(format!("{:.decimals$}", ruler.from_steps(steps.into(), PositionUnit::Millimetres)?))
}

fn parse_length(what: &'static str, text: &str, most: f64) -> Result<Length, Text> {
    let millimetres = parse_in_range(TEXTS.text(what), text, 0.001, most)?;
    // The result is between a thousand and a thousand million.
    Ok(Length { nanometres: (millimetres * 1e6).round() as u64 })
}

fn position(what: &'static str, text: &str, ruler: Option<Ruler>) -> Result<i32, Text> {
    let ruler = ruler.ok_or_else(|| TEXTS.text("hd_axis.unread"))?;
    let value = parse_in_range(TEXTS.text(what), text, -1e6, 1e6)?;
    ruler.to_steps(value, PositionUnit::Millimetres).map_err(|why| match why {
        PositionRangeError::NoPitch => TEXTS.text("hd_axis.unread"),
        PositionRangeError::Bits { least, most } => TEXTS
            .text("hd_axis.beyond")
            .with_text("what", TEXTS.text(what))
            .with_number("least", least, 0)
            .with_number("most", most, 0),
    })
}
