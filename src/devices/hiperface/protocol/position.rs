//! The position word. It is right-aligned, and its five lowest bits are the step within a signal period (manual,
//! "Position lesen").

use std::fmt;

/// Number of position steps per signal period, always 32.
pub const STEPS_PER_PERIOD: u32 = 32;

/// Geometry of an encoder, used to convert steps to an angle or a distance.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Geometry {
    /// A rotary encoder.
    Rotary {
        /// Signal periods per revolution, at least 1.
        periods: u32,
        /// Number of revolutions that the encoder distinguishes. It is 1 for a singleturn encoder.
        turns: u32,
    },
    /// A linear encoder.
    Linear {
        /// Length of a signal period in nanometres, at least 1.
        period_nm: u32,
        /// Coded range in signal periods, or 0 if unknown.
        periods: u32,
    },
}

impl Geometry {
    /// Returns the number of steps per revolution, or `None` for a linear encoder.
    pub fn steps_per_turn(self) -> Option<u64> {
        match self {
            Geometry::Rotary { periods, .. } => Some(u64::from(periods.max(1)) * u64::from(STEPS_PER_PERIOD)),
            Geometry::Linear { .. } => None,
        }
    }

    /// Returns the number of distinct positions, or `None` if it is unknown. Positions count from 0.
    pub fn position_count(self) -> Option<u64> {
        match self {
            Geometry::Rotary { turns, .. } => Some(self.steps_per_turn()?.saturating_mul(u64::from(turns.max(1)))),
            Geometry::Linear { periods: 0, .. } => None,
            Geometry::Linear { periods, .. } => Some(u64::from(periods) * u64::from(STEPS_PER_PERIOD)),
        }
    }

    /// Converts a position word to an angle or a distance.
    pub fn position(self, raw: u32) -> Position {
        let in_range = self.position_count().is_none_or(|range| u64::from(raw) < range);
        match self {
            Geometry::Rotary { .. } => {
                let per_turn = self.steps_per_turn().unwrap_or(1);
                let (turns, steps) = (u64::from(raw) / per_turn, u64::from(raw) % per_turn);
                let degrees = steps as f64 * 360.0 / per_turn as f64;
                Position { raw, in_range, place: Location::Rotary { turns, steps, degrees } }
            }
            Geometry::Linear { period_nm, .. } => {
                let nanometres = f64::from(raw) * f64::from(period_nm) / f64::from(STEPS_PER_PERIOD);
                Position { raw, in_range, place: Location::Linear { millimetres: nanometres * 1e-6 } }
            }
        }
    }
}

impl fmt::Display for Geometry {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Geometry::Rotary { periods, turns: 1 } => write!(f, "{periods} periods, singleturn"),
            Geometry::Rotary { periods, turns } => write!(f, "{periods} periods, {turns} turns"),
            Geometry::Linear { period_nm, .. } => write!(f, "linear, period {} mm", f64::from(*period_nm) * 1e-6),
        }
    }
}

/// Position word, converted with the geometry of its encoder.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Position {
    /// Position word as received.
    pub raw: u32,
    /// Whether the word is within the measuring range of the encoder.
    pub in_range: bool,
    place: Location,
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Location {
    Rotary { turns: u64, steps: u64, degrees: f64 },
    Linear { millimetres: f64 },
}

impl Position {
    /// Returns the number of whole revolutions, or `None` for a linear encoder.
    pub fn turns(self) -> Option<u64> {
        match self.place {
            Location::Rotary { turns, .. } => Some(turns),
            Location::Linear { .. } => None,
        }
    }

    /// Returns the number of steps within the revolution, or `None` for a linear encoder.
    pub fn steps(self) -> Option<u64> {
        match self.place {
            Location::Rotary { steps, .. } => Some(steps),
            Location::Linear { .. } => None,
        }
    }

    /// Returns the angle in degrees, from 0 to just below 360, or `None` for a linear encoder.
    pub fn degrees(self) -> Option<f64> {
        match self.place {
            Location::Rotary { degrees, .. } => Some(degrees),
            Location::Linear { .. } => None,
        }
    }

    /// Returns the distance in millimetres, or `None` for a rotary encoder.
    pub fn millimetres(self) -> Option<f64> {
        match self.place {
            Location::Rotary { .. } => None,
            Location::Linear { millimetres } => Some(millimetres),
        }
    }
}

impl fmt::Display for Position {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.place {
            Location::Rotary { turns, degrees, .. } => write!(f, "turn {turns}, {degrees:.3}°"),
            Location::Linear { millimetres } => write!(f, "{millimetres:.6} mm"),
        }
    }
}

/// Returns the position in `range` that is nearest to `wanted` and has the same five lowest bits as `now`. If two
/// positions are equally near, the lower one is returned. Setting this position preserves the phase between the
/// absolute value and the sine signal, because the five lowest bits equal the five highest bits of the arctangent
/// (manual, "Position setzen").
pub fn nearest_in_phase(now: u32, wanted: u32, range: Option<u64>) -> u32 {
    let phase = u64::from(now % STEPS_PER_PERIOD);
    let wanted = u64::from(wanted);
    let period = u64::from(STEPS_PER_PERIOD);
    let last = range.unwrap_or(1 << 32).clamp(1, 1 << 32) - 1;
    let base = wanted / period * period + phase;
    [base.checked_sub(period), Some(base), base.checked_add(period)]
        .into_iter()
        .flatten()
        .filter(|candidate| *candidate <= last)
        .min_by_key(|candidate| candidate.abs_diff(wanted))
        .and_then(|nearest| u32::try_from(nearest).ok())
        .unwrap_or(now)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn skm36_position_matches_reference() {
        let skm36 = Geometry::Rotary { periods: 128, turns: 4096 };
        assert_eq!(skm36.position_count(), Some(1 << 24));
        let position = skm36.position(0x000E_0531);
        assert_eq!((position.turns(), position.steps()), (Some(224), Some(1329)));
        assert!((position.degrees().unwrap() - 116.806_640_625).abs() < 1e-9);
        assert!(position.in_range);
        assert!(!skm36.position(0x0100_0000).in_range);
    }

    #[test]
    fn step_angle_matches_reference() {
        for (periods, step) in [(16, 0.703125), (128, 0.087890625), (512, 0.0219727), (1024, 0.0109863)] {
            let degrees = Geometry::Rotary { periods, turns: 1 }.position(1).degrees().unwrap();
            assert!((degrees - step).abs() < 1e-7, "{periods}: {degrees}");
        }
    }

    #[test]
    fn linear_encoder_yields_millimetres() {
        let dme = Geometry::Linear { period_nm: 4_000_000, periods: 0 };
        assert_eq!(dme.position(8).millimetres(), Some(1.0));
        assert_eq!(dme.position(8).turns(), None);
        assert!(dme.position(u32::MAX).in_range);
    }

    #[test]
    fn set_position_keeps_phase() {
        // now, wanted, range, expected
        let cases = [
            (0x000E_0531, 0, Some(1 << 24), 17),
            (0x000E_0531, 17, Some(1 << 24), 17),
            (0x000E_0531, 1000, Some(1 << 24), 1009),
            (0x0000_0000, 1008, Some(1 << 24), 992), // 992 and 1024 are equally near
            (0x0000_001F, 0, Some(1 << 24), 31),
            (0x0000_0001, 511, Some(512), 481), // 513 would be beyond the range
            (0x0000_0000, u32::MAX, None, 0xFFFF_FFE0),
        ];
        for (now, wanted, range, expected) in cases {
            assert_eq!(nearest_in_phase(now, wanted, range), expected, "{now:X} {wanted}");
        }
    }
}
