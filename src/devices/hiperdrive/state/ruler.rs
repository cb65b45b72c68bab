//! Converts between the steps of a drive and the user's units: turns, degrees, and millimetres on a spindle.

pub use crate::app::PositionUnit;
use crate::devices::hiperdrive::protocol::{Length, PositionScale};

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Ruler {
    /// Position scale, parameters 154 and 156.
    pub scale: PositionScale,
    /// Pitch of the spindle, if entered by the user.
    pub pitch: Option<Length>,
}

/// Reason why a number is not a valid position.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum PositionRangeError {
    /// The position exceeds 32 bits. The fields are the minimum and the maximum.
    #[error("the position must be between {least} and {most}")]
    Bits { least: f64, most: f64 },
    /// A position in millimetres needs a pitch.
    #[error("the spindle pitch is not known")]
    NoPitch,
}

impl Ruler {
    /// Ruler with the factory scale and no spindle.
    pub const FACTORY: Ruler = Ruler { scale: PositionScale::FACTORY, pitch: None };

    /// Returns the number of steps per unit, or `None` for millimetres if there is no pitch.
    fn steps_per_unit(self, measure: PositionUnit) -> Option<f64> {
        let turn = self.scale.steps_per_turn();
        match measure {
            PositionUnit::Steps => Some(1.0),
            PositionUnit::Turns => Some(turn),
            PositionUnit::Degrees => Some(turn / 360.0),
            PositionUnit::Millimetres => {
                self.pitch.filter(|own| own.nanometres > 0).map(|own| turn * 1e6 / own.nanometres as f64)
            }
        }
    }

    pub fn available_units(self) -> impl Iterator<Item = PositionUnit> {
        PositionUnit::ALL.into_iter().filter(move |measure| self.steps_per_unit(*measure).is_some())
    }

    /// Converts steps to a unit. Returns `None` for millimetres if there is no pitch.
    pub fn from_steps(self, steps: i64, measure: PositionUnit) -> Option<f64> {
        Some(steps as f64 / self.steps_per_unit(measure)?)
    }

    /// Returns the step nearest to a position.
    ///
    /// # Errors
    /// Returns a [`PositionRangeError`] if there is no such step.
    pub fn to_steps(self, value: f64, measure: PositionUnit) -> Result<i32, PositionRangeError> {
        let unit = self.steps_per_unit(measure).ok_or(PositionRangeError::NoPitch)?;
        let steps = (value * unit).round();
        let (least, most) = (f64::from(i32::MIN), f64::from(i32::MAX));
        // Within the range, the cast is exact.
        if (least..=most).contains(&steps) {
            Ok(steps as i32)
        } else {
            Err(PositionRangeError::Bits { least: least / unit, most: most / unit })
        }
    }

    /// Returns the number of decimals needed to distinguish adjacent steps.
    pub fn decimal_places(self, measure: PositionUnit) -> usize {
        let unit = self.steps_per_unit(measure).unwrap_or(1.0);
        // At most 9, because the steps per turn are at most 256 times a five-digit number.
        (0..9).find(|decimals| 10f64.powi(*decimals) >= unit * 0.999_999).map_or(9, |decimals| decimals as usize)
    }

    /// Converts a position in steps to another scale. The result may not fit in 32 bits.
    pub fn rescale_position(self, steps: i64, to: PositionScale) -> i64 {
        // The product of a position and two 16-bit numbers fits into 128 bits.
        let above = i128::from(steps) * i128::from(to.numerator()) * i128::from(self.scale.denominator());
        let below = i128::from(to.denominator()) * i128::from(self.scale.numerator());
        let half = if above < 0 { -below / 2 } else { below / 2 };
        i64::try_from((above + half) / below.max(1)).unwrap_or(if above < 0 { i64::MIN } else { i64::MAX })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SPINDLE: Ruler = Ruler { scale: PositionScale::FACTORY, pitch: Some(Length { nanometres: 4_000_000 }) };

    fn hundredths() -> Ruler {
        // 400 steps per turn of 4 mm (reference, section 5).
        Ruler { scale: PositionScale::new(400, 256).unwrap(), ..SPINDLE }
    }

    #[test]
    fn converts_steps_to_every_unit() {
        let of = |ruler: Ruler, steps, measure| ruler.from_steps(steps, measure).unwrap();
        assert_eq!(of(SPINDLE, 163_840, PositionUnit::Turns), 2.5);
        assert_eq!(of(SPINDLE, -16_384, PositionUnit::Degrees), -90.0);
        assert_eq!(of(SPINDLE, 163_840, PositionUnit::Millimetres), 10.0);
        assert_eq!(of(hundredths(), 1234, PositionUnit::Millimetres), 12.34);
        assert_eq!(Ruler::FACTORY.from_steps(1, PositionUnit::Millimetres), None);
        assert_eq!(Ruler::FACTORY.available_units().count(), 3);
        assert_eq!(SPINDLE.available_units().count(), 4);
    }

    #[test]
    fn rounds_typed_value_to_nearest_step() {
        assert_eq!(hundredths().to_steps(12.344, PositionUnit::Millimetres), Ok(1234));
        assert_eq!(hundredths().to_steps(-0.005, PositionUnit::Millimetres), Ok(-1));
        assert_eq!(SPINDLE.to_steps(90.0, PositionUnit::Degrees), Ok(16_384));
        assert_eq!(Ruler::FACTORY.to_steps(1.0, PositionUnit::Millimetres), Err(PositionRangeError::NoPitch));
        // 32,768 turns do not fit into 32 bits, because 2³¹ / 65536 = 32768.
        let beyond = SPINDLE.to_steps(32_768.0, PositionUnit::Turns).unwrap_err();
        assert!(
            matches!(beyond, PositionRangeError::Bits { least, most } if least == -32_768.0 && most > 32_767.0 && most < 32_768.0)
        );
    }

    #[test]
    fn decimals_distinguish_adjacent_steps() {
        assert_eq!(hundredths().decimal_places(PositionUnit::Millimetres), 2);
        assert_eq!(SPINDLE.decimal_places(PositionUnit::Steps), 0);
        // The scale is 65536 steps per turn, 182.04 per degree, and 16384 per millimetre.
        assert_eq!(SPINDLE.decimal_places(PositionUnit::Turns), 5);
        assert_eq!(SPINDLE.decimal_places(PositionUnit::Degrees), 3);
        assert_eq!(SPINDLE.decimal_places(PositionUnit::Millimetres), 5);
    }

    #[test]
    fn rescales_position() {
        let to = PositionScale::new(400, 256).unwrap();
        // 511 turns are 33 488 896 steps at 65536 per turn, and 204 400 steps at 400 per turn.
        assert_eq!(SPINDLE.rescale_position(33_488_896, to), 204_400);
        assert_eq!(SPINDLE.rescale_position(-33_488_896, to), -204_400);
        assert_eq!(hundredths().rescale_position(204_400, PositionScale::FACTORY), 33_488_896);
        // Half a step is rounded away from zero: 82 steps at 65536 per turn are 0.5005 steps at 400 per turn.
        assert_eq!(
            (SPINDLE.rescale_position(82, to), SPINDLE.rescale_position(81, to), SPINDLE.rescale_position(-82, to)),
            (1, 0, -1)
        );
    }
}
