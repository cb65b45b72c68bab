//! Phase within one signal period, calculated from a sine and a cosine value. The calculation is exact or uses a
//! one-octant table, like the interrupt routine of a drive. Follows SICK 8010701, interpolation of the process data
//! channel; the formulae are in section 3 of the project's sine/cosine reference.

use std::f64::consts::{FRAC_PI_4, TAU};

/// Electrical degrees per signal period.
pub const DEGREES: f64 = 360.0;

/// A position inside one signal period, from 0 up to but not including 1.
#[derive(Clone, Copy, Debug, PartialEq, PartialOrd)]
pub struct Phase(f64);

impl Phase {
    /// Returns the phase of a position in periods, which may be negative. Returns `None` if the position is not finite.
    pub fn from_periods(periods: f64) -> Option<Self> {
        // The remainder of a tiny negative number such as -1e-20 rounds to 1.
        let phase = periods.rem_euclid(1.0);
        if !periods.is_finite() { None } else { Some(Phase(if phase >= 1.0 { 0.0 } else { phase })) }
    }

    pub fn to_periods(self) -> f64 {
        self.0
    }

    /// Returns the phase in electrical degrees, 0 ≤ φ < 360.
    pub fn to_degrees(self) -> f64 {
        self.0 * DEGREES
    }

    /// Returns the step that contains the phase if a period is divided into 2^`bits` steps, as in an interpolating
    /// counter. A lower resolution yields the upper bits of the same step. `bits` is limited to 32.
    pub fn step(self, bits: u32) -> u32 {
        let bits = bits.min(32);
        let steps = 1_u64 << bits;
        // A step fits into 32 bits, and the product is below `steps` because φ is below 1.
        ((self.0 * steps as f64) as u64).min(steps - 1) as u32
    }

    /// Returns the nearest of the 2^`bits` steps in one period, wrapping to 0 after the last step. `bits` is limited to
    /// 32.
    pub fn nearest_step(self, bits: u32) -> u32 {
        let steps = 1_u64 << bits.min(32);
        ((self.0 * steps as f64).round() as u64 % steps) as u32
    }
}

/// Returns the exact phase of two offset-free voltages. Returns `None` if both voltages are zero or one is not a
/// number.
pub fn from_voltages(sine: f64, cosine: f64) -> Option<Phase> {
    if sine == 0.0 && cosine == 0.0 { None } else { Phase::from_periods(sine.atan2(cosine) / TAU) }
}

/// Table of arctangents at evenly spaced nodes from 0 to 1, with linear interpolation between them.
#[derive(Clone, Debug, PartialEq)]
pub struct OctantTable(Vec<f64>);

impl OctantTable {
    /// Number of intervals that the manual considers sufficient. The largest error is 1/79 255 of a period.
    pub const INTERVALS: usize = 32;

    /// Creates a table with the given number of intervals, at least one.
    pub fn new(intervals: usize) -> Self {
        let intervals = intervals.max(1);
        OctantTable((0..=intervals).map(|node| (node as f64 / intervals as f64).atan()).collect())
    }

    /// Returns the phase according to the table. Returns `None` if both voltages are zero or one is not finite.
    pub fn phase(&self, sine: f64, cosine: f64) -> Option<Phase> {
        let (a, b) = (sine.abs(), cosine.abs());
        if (a == 0.0 && b == 0.0) || !a.is_finite() || !b.is_finite() {
            return None;
        }
        let mut angle = self.atan(if a > b { b / a } else { a / b });
        if a > b {
            angle = TAU / 4.0 - angle;
        }
        if cosine < 0.0 {
            angle = TAU / 2.0 - angle;
        }
        if sine < 0.0 {
            angle = TAU - angle;
        }
        Phase::from_periods(angle / TAU)
    }

    /// Returns the largest error of linear interpolation between two nodes, in radians. For nodes at a distance h, this
    /// error is h²/8 · 3√3/8.
    pub fn max_error_rad(&self) -> f64 {
        let spacing = 1.0 / (self.0.len() - 1) as f64;
        spacing * spacing / 8.0 * (3.0 * 3.0_f64.sqrt() / 8.0)
    }

    fn atan(&self, t: f64) -> f64 {
        let place = t * (self.0.len() - 1) as f64;
        let node = place as usize;
        match self.0.get(node..node + 2) {
            Some([low, high]) => low + (high - low) * (place - node as f64),
            _ => FRAC_PI_4,
        }
    }
}

impl Default for OctantTable {
    fn default() -> Self {
        OctantTable::new(Self::INTERVALS)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Reference values from section 3: sine, cosine, exact degrees, table degrees, phase, the phase's five upper bits,
    /// nearest of 65 536 steps.
    const GOLDEN: [(f64, f64, f64, f64, f64, u32, u32); 9] = [
        (0.0, 0.5, 0.0, 0.0, 0.0, 0, 0x0000),
        (0.5, 0.0, 90.0, 90.0, 0.25, 8, 0x4000),
        (0.0, -0.5, 180.0, 180.0, 0.5, 16, 0x8000),
        (-0.5, 0.0, 270.0, 270.0, 0.75, 24, 0xC000),
        (0.25, 0.433_012_702, 30.0, 29.99547, 0.083_333, 2, 0x1555),
        (0.433_012_702, -0.25, 120.0, 119.99547, 0.333_333, 10, 0x5555),
        (-0.353_553_391, -0.353_553_391, 225.0, 225.0, 0.625, 20, 0xA000),
        (0.1, 0.489_897_95, 11.53696, 11.53435, 0.032_047, 1, 0x0834),
        (-0.2, 0.458_257_57, 336.42182, 336.42238, 0.934_505, 29, 0xEF3C),
    ];

    #[test]
    fn angles_match_section_3() {
        let table = OctantTable::default();
        for (sine, cosine, degrees, by_table, phase, five, sixteen) in GOLDEN {
            let told = from_voltages(sine, cosine).unwrap();
            assert!((told.to_degrees() - degrees).abs() < 6e-6, "{degrees}: {told:?}");
            assert!((told.to_periods() - phase).abs() < 6e-7, "{degrees}: {told:?}");
            assert_eq!((told.step(5), told.nearest_step(16)), (five, sixteen), "{degrees}");
            let told = table.phase(sine, cosine).unwrap();
            assert!((told.to_degrees() - by_table).abs() < 6e-6, "{degrees}: {told:?}");
        }
    }

    #[test]
    fn table_accuracy_matches_section_3() {
        for (intervals, error, fraction) in [(16, 3.17e-4, 19_830.0), (32, 7.93e-5, 79_255.0), (64, 1.98e-5, 317_064.0)]
        {
            let table = OctantTable::new(intervals);
            let largest = table.max_error_rad();
            assert!((largest / error - 1.0).abs() < 3e-3, "{intervals}");
            assert!((TAU / largest / fraction - 1.0).abs() < 3e-3, "{intervals}: {}", TAU / largest);
            for step in 0..20_000 {
                let angle = TAU * f64::from(step) / 20_000.0;
                let told = table.phase(angle.sin(), angle.cos()).unwrap().to_periods() * TAU;
                let off = (told - angle + TAU / 2.0).rem_euclid(TAU) - TAU / 2.0;
                assert!(off.abs() <= largest * 1.000_001, "{intervals} intervals at {angle}: {off}");
            }
        }
    }

    #[test]
    fn zero_signal_has_no_angle() {
        let table = OctantTable::default();
        for (sine, cosine) in [(0.0, 0.0), (-0.0, 0.0), (f64::NAN, 0.5), (0.5, f64::NAN)] {
            assert_eq!((from_voltages(sine, cosine), table.phase(sine, cosine)), (None, None), "{sine} {cosine}");
        }
        assert_eq!(table.phase(f64::INFINITY, 1.0), None);
    }

    #[test]
    fn phase_stays_below_one() {
        assert_eq!(Phase::from_periods(-1e-20), Phase::from_periods(0.0));
        assert_eq!(Phase::from_periods(3.25).unwrap().to_periods(), 0.25);
        assert_eq!(Phase::from_periods(-0.25).unwrap().to_degrees(), 270.0);
        assert_eq!(Phase::from_periods(1.0 - f64::EPSILON / 2.0).unwrap().step(32), u32::MAX);
        assert_eq!(Phase::from_periods(1.0 - f64::EPSILON / 2.0).unwrap().nearest_step(16), 0);
        assert_eq!(Phase::from_periods(f64::NAN), None);
    }
}
