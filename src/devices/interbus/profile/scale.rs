//! Converts encoder steps to machine positions in degrees or millimetres.

/// Unit of a machine position.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Unit {
    /// Encoder steps.
    #[default]
    Steps,
    /// Degrees, for a machine that rotates.
    Degrees,
    /// Millimetres, for a machine with linear travel.
    Millimetres,
}

/// How machine positions relate to encoder positions.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Scale {
    unit: Unit,
    steps: f64,
    /// Encoder position at machine zero.
    zero: u32,
}

/// A machine position that was rounded to encoder steps.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RoundedPosition {
    /// Nearest encoder step.
    pub step: u32,
    /// Rounding error in the unit of the scale.
    pub off: f64,
}

/// Error for a position outside the measuring range.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[error("{value} is outside the range {least} to {most}")]
pub struct OutsideRangeError {
    /// Requested position in the unit of the scale.
    pub value: f64,
    /// Smallest position in the measuring range, in the unit of the scale.
    pub least: f64,
    /// Largest position in the measuring range, in the unit of the scale.
    pub most: f64,
}

/// Error for an invalid number of steps per unit.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("the number of steps per unit must be greater than 0")]
pub struct ScaleError;

/// Maximum number of decimals that are displayed.
const MAX_DECIMALS: usize = 6;
/// Tolerance within which two computed numbers are considered equal.
const EQUALITY_TOLERANCE: f64 = 1e-9;
/// Upper limit for the number of steps per unit and for the length of the range in units.
const MAX_SCALE_VALUE: f64 = 1e12;

impl Default for Scale {
    /// Returns a scale in encoder steps that starts at 0.
    fn default() -> Self {
        Scale { unit: Unit::Steps, steps: 1.0, zero: 0 }
    }
}

impl Unit {
    /// All units.
    pub const ALL: [Unit; 3] = [Unit::Steps, Unit::Degrees, Unit::Millimetres];

    /// Returns the unit symbol, or an empty string for steps.
    pub const fn symbol(self) -> &'static str {
        match self {
            Unit::Steps => "",
            Unit::Degrees => "°",
            Unit::Millimetres => " mm",
        }
    }
}

impl Scale {
    /// Creates a scale in degrees. `steps_in_turn` is the number of steps in a turn of the machine, and `zero` is the
    /// encoder position at machine zero.
    ///
    /// # Errors
    /// Returns [`ScaleError`] if `steps_in_turn` is not above 0.
    pub fn in_degrees(steps_in_turn: f64, zero: u32) -> Result<Self, ScaleError> {
        Scale::new(Unit::Degrees, steps_in_turn, zero)
    }

    /// Creates a scale in millimetres. `steps_in_one` is the number of steps per millimetre, and `zero` is the encoder
    /// position at machine zero.
    ///
    /// # Errors
    /// Returns [`ScaleError`] if `steps_in_one` is not above 0.
    pub fn in_millimetres(steps_in_one: f64, zero: u32) -> Result<Self, ScaleError> {
        Scale::new(Unit::Millimetres, steps_in_one, zero)
    }

    /// Creates a scale. `steps` is the number of steps per turn or per millimetre, and is ignored if the unit is
    /// [`Unit::Steps`].
    ///
    /// # Errors
    /// Returns [`ScaleError`] if `steps` is used and not above 0.
    pub fn new(unit: Unit, steps: f64, zero: u32) -> Result<Self, ScaleError> {
        let steps = match unit {
            Unit::Steps => 1.0,
            Unit::Degrees => steps / 360.0,
            Unit::Millimetres => steps,
        };
        let is_scale = steps.is_finite() && steps > 1.0 / MAX_SCALE_VALUE && steps < MAX_SCALE_VALUE;
        if is_scale { Ok(Scale { unit, steps, zero }) } else { Err(ScaleError) }
    }

    /// Returns the unit of the scale.
    pub const fn unit(&self) -> Unit {
        self.unit
    }

    /// Returns the number of encoder steps per degree or per millimetre.
    pub const fn steps_per_unit(&self) -> f64 {
        self.steps
    }

    /// Returns the encoder position at machine zero.
    pub const fn zero(&self) -> u32 {
        self.zero
    }

    /// Returns whether the scale wraps at the end of the measuring range. Steps always wrap. Degrees wrap if the range
    /// is a whole number of machine turns.
    pub fn wraps_around(&self, range: u32) -> bool {
        match self.unit {
            Unit::Steps => true,
            Unit::Millimetres => false,
            Unit::Degrees => {
                let turns = f64::from(range) / (self.steps * 360.0);
                turns > 0.5 && (turns - turns.round()).abs() < EQUALITY_TOLERANCE * turns.max(1.0)
            }
        }
    }

    /// Converts an encoder position to the unit of the scale.
    pub fn value(&self, step: u32, range: u32) -> f64 {
        let from_zero = f64::from(step) - f64::from(self.zero);
        self.round_to_step(from_zero, range) / self.steps
    }

    /// Returns the length of the measuring range in the unit of the scale.
    pub fn range_length(&self, range: u32) -> f64 {
        f64::from(range) / self.steps
    }

    /// Returns the encoder step nearest to a machine position. Only positions in degrees that wrap may be beyond the
    /// measuring range.
    ///
    /// # Errors
    /// Returns [`OutsideRangeError`] with the limits if the position is outside the measuring range.
    pub fn round_position(&self, value: f64, range: u32) -> Result<RoundedPosition, OutsideRangeError> {
        let outside = || {
            let first = if self.wraps_around(range) { 0.0 } else { self.value(0, range) };
            OutsideRangeError { value, least: first, most: first + self.range_length(range) - 1.0 / self.steps }
        };
        if range == 0 || !value.is_finite() || value.abs() > MAX_SCALE_VALUE {
            return Err(outside());
        }
        let from_zero = value * self.steps;
        if self.unit == Unit::Steps && !(0.0..f64::from(range)).contains(&from_zero) {
            return Err(outside());
        }
        let exact = f64::from(self.zero) + from_zero;
        let nearest = exact.round();
        let off = (nearest - exact) / self.steps;
        let step = if self.wraps_around(range) { nearest.rem_euclid(f64::from(range)) } else { nearest };
        if (0.0..f64::from(range)).contains(&step) {
            // The step is below the range, which has at most 25 bits.
            Ok(RoundedPosition { step: step as u32, off })
        } else {
            Err(outside())
        }
    }

    /// Returns the number of decimals needed to tell adjacent steps apart.
    pub fn decimal_places(&self) -> usize {
        let one = 1.0 / self.steps;
        let tells = |decimals: &usize| {
            let shown = one * 10_f64.powi(*decimals as i32);
            shown >= 2.0 || (shown - shown.round()).abs() < EQUALITY_TOLERANCE && shown > 0.5
        };
        (0..MAX_DECIMALS).find(tells).unwrap_or(MAX_DECIMALS)
    }

    fn round_to_step(&self, from_zero: f64, range: u32) -> f64 {
        if self.wraps_around(range) && range > 0 { from_zero.rem_euclid(f64::from(range)) } else { from_zero }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rounds_units_to_nearest_step() {
        let degrees = |steps, zero| Scale::in_degrees(steps, zero).unwrap();
        let millimetres = |steps, zero| Scale::in_millimetres(steps, zero).unwrap();
        // Each row contains a scale, a range, a value, the nearest step and the rounding error. 8192 / 360 is 22.7556,
        // so 10° are 227.56 steps, and step 228 is at 10.01953°.
        for (scale, range, value, step, off) in [
            (degrees(8192.0, 0), 8192, 10.0, 228, 0.019_531_25),
            (degrees(8192.0, 0), 8192, 360.0, 0, 0.0),
            (degrees(8192.0, 0), 8192, -90.0, 6144, 0.0),
            (degrees(8192.0, 8000), 8192, 90.0, 1856, 0.0),
            (degrees(1000.0, 0), 3000, 725.0, 2014, 0.04),
            (degrees(1000.0, 0), 2500, 800.0, 2222, -0.08),
            (millimetres(10.0, 500), 10_000, -50.0, 0, 0.0),
            (millimetres(10.0, 500), 10_000, 12.34, 623, -0.04),
            (millimetres(0.5, 0), 100, 3.0, 2, 1.0),
            (Scale::default(), 1000, 999.0, 999, 0.0),
            (Scale::new(Unit::Steps, 0.0, 900).unwrap(), 1000, 250.0, 150, 0.0),
        ] {
            let placed = scale.round_position(value, range).unwrap();
            assert_eq!(placed.step, step, "{scale:?} {value}");
            assert!((placed.off - off).abs() < 1e-9, "{scale:?} {value}: {}", placed.off);
            let shown = scale.value(step, range);
            let apart = (shown - value - off).rem_euclid(if scale.wraps_around(range) {
                scale.range_length(range)
            } else {
                1e9
            });
            assert!(apart < 1e-6 || apart > scale.range_length(range) - 1e-6, "{scale:?} {value}: {shown}");
        }
    }

    #[test]
    fn range_error_names_limits() {
        for (scale, range, value, least, most) in [
            (Scale::default(), 1000, 1000.0, 0.0, 999.0),
            (Scale::new(Unit::Steps, 1.0, 10).unwrap(), 1000, -1.0, 0.0, 999.0),
            (Scale::in_millimetres(10.0, 500).unwrap(), 10_000, 950.0, -50.0, 949.9),
            (Scale::in_degrees(1000.0, 0).unwrap(), 2500, 900.0, 0.0, 899.64),
            (Scale::default(), 1000, f64::NAN, 0.0, 999.0),
            (Scale::in_degrees(1000.0, 0).unwrap(), 1000, f64::INFINITY, 0.0, 359.64),
        ] {
            let outside = scale.round_position(value, range).unwrap_err();
            assert!((outside.least - least).abs() < 1e-9 && (outside.most - most).abs() < 1e-9, "{outside}");
        }
        for steps in [0.0, -1.0, f64::NAN, f64::INFINITY] {
            assert_eq!(Scale::in_degrees(steps, 0), Err(ScaleError), "{steps}");
        }
    }

    #[test]
    fn decimals_distinguish_adjacent_steps() {
        for (steps, decimals) in [(360.0, 0), (3600.0, 1), (8192.0, 2), (720.0, 1), (180.0, 0), (33_554_432.0, 6)] {
            assert_eq!(Scale::in_degrees(steps, 0).unwrap().decimal_places(), decimals, "{steps}");
        }
        assert_eq!(Scale::default().decimal_places(), 0);
        assert_eq!(Scale::in_millimetres(10.0, 0).unwrap().decimal_places(), 1);
        assert_eq!(Scale::in_millimetres(0.5, 0).unwrap().decimal_places(), 0);
    }
}
