//! How much of the period a capture covers: octants, periods, and how far the samples keep from the ellipse. Validity of a
//! fit follows section 7 of the project's sine/cosine reference (points in at least 6 of 8 octants).

use std::ops::Range;

use super::ellipse::Ellipse;
use super::outliers::kept;

/// What samples do on their ellipse.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Coverage {
    /// Octants of the corrected angle that hold at least one sample, 0 to 8.
    pub octants: u32,
    /// Periods from the lowest to the highest angle, with the fraction.
    pub periods: f64,
    /// Periods from the first to the last sample; negative when the angle falls.
    pub travel_periods: f64,
    /// Distance from the ellipse, rms, as a share of the amplitude.
    pub residual_rms: f64,
    /// Shortest and longest amplitude vector √(sin² + cos²) as measured, in volts.
    pub vector_v: (f64, f64),
}

/// An angle that grows over periods: quarters so far, and the vector inside the quarter.
#[derive(Clone, Copy)]
pub(super) struct Angle {
    quarters: i64,
    sine: f64,
    cosine: f64,
}

impl Angle {
    fn of(sine: f64, cosine: f64) -> Self {
        Angle { quarters: i64::from(quarter(sine, cosine)), sine, cosine }
    }

    /// The same angle moved on, by less than half a period, to these voltages.
    fn moved_to(self, sine: f64, cosine: f64) -> Self {
        let step = (quarter(sine, cosine) - quarter(self.sine, self.cosine)).rem_euclid(4);
        let step = match step {
            3 => -1,
            // Two quarters on or back: the vectors tell by which side the new one is reached sooner.
            2 if self.cosine * sine < self.sine * cosine => -2,
            step => i64::from(step),
        };
        Angle { quarters: self.quarters + step, sine, cosine }
    }

    fn is_ahead_of(&self, other: &Angle) -> bool {
        self.quarters > other.quarters
            || (self.quarters == other.quarters && other.cosine * self.sine > other.sine * self.cosine)
    }

    fn periods(&self) -> f64 {
        let phase = self.sine.atan2(self.cosine) / std::f64::consts::TAU;
        // Whole quarters are counted; of the phase only what is beyond its own quarter counts.
        self.quarters as f64 / 4.0 + phase.rem_euclid(1.0) - f64::from(quarter(self.sine, self.cosine)) / 4.0
    }
}

/// 0 to 3, counted as the angle grows. Made for speed: comparisons without branches.
fn quarter(sine: f64, cosine: f64) -> i32 {
    let upper = sine > 0.0 || (sine == 0.0 && cosine >= 0.0);
    let right = cosine > 0.0 || (cosine == 0.0 && sine <= 0.0);
    match (upper, right) {
        (true, true) => 0,
        (true, false) => 1,
        (false, false) => 2,
        (false, true) => 3,
    }
}

impl Coverage {
    /// Follows the samples in their order; from one to the next the angle must move by less than half a period.
    /// `None` without samples.
    pub fn of(sine: &[f64], cosine: &[f64], ellipse: &Ellipse) -> Option<Self> {
        Coverage::without(sine, cosine, &[], ellipse)
    }

    /// Likewise, without the samples in `left_out`: stretches in their order that do not overlap.
    pub(super) fn without(sine: &[f64], cosine: &[f64], left_out: &[Range<usize>], ellipse: &Ellipse) -> Option<Self> {
        /// Samples summed before their sum is added: less rounding.
        const BLOCK: usize = 4096;
        let correction = ellipse.correction();
        let length = sine.len().min(cosine.len());
        let start = kept(length, left_out).next()?.start;
        let (first_y, first_x) = correction.apply(*sine.get(start)?, *cosine.get(start)?);
        let first = Angle::of(first_y, first_x);
        let (mut here, mut lowest, mut highest) = (first, first, first);
        let mut octants = 0_u32;
        let (mut squares, mut count) = (0.0, 0_usize);
        let (mut least, mut most) = (f64::INFINITY, 0.0_f64);
        let parts = kept(length, left_out).filter_map(|part| Some((sine.get(part.clone())?, cosine.get(part)?)));
        for (ys, xs) in parts.flat_map(|(sine, cosine)| sine.chunks(BLOCK).zip(cosine.chunks(BLOCK))) {
            let mut sum = 0.0;
            for (y, x) in ys.iter().zip(xs) {
                let raw = y * y + x * x;
                least = if raw < least { raw } else { least };
                most = if raw > most { raw } else { most };
                let (y, x) = correction.apply(*y, *x);
                let off = (y * y + x * x).sqrt() - ellipse.amplitude_v;
                sum += off * off;
                here = here.moved_to(y, x);
                octants |= 1 << (((here.quarters & 3) as u32) << 1 | u32::from((y.abs() > x.abs()) ^ (y * x < 0.0)));
                highest = if here.is_ahead_of(&highest) { here } else { highest };
                lowest = if lowest.is_ahead_of(&here) { here } else { lowest };
            }
            squares += sum;
            count += ys.len().min(xs.len());
        }
        Some(Coverage {
            octants: octants.count_ones(),
            periods: highest.periods() - lowest.periods(),
            travel_periods: here.periods() - first.periods(),
            residual_rms: (squares / count as f64).sqrt() / ellipse.amplitude_v,
            vector_v: (least.sqrt(), most.sqrt()),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::TAU;

    const ELLIPSE: Ellipse = Ellipse {
        amplitude_v: 0.5,
        offset_cosine_v: 0.02,
        offset_sine_v: -0.03,
        gain_ratio: 1.05,
        phase_error_rad: 0.05,
    };

    fn coverage(angles: impl Iterator<Item = f64>) -> Coverage {
        let (sine, cosine): (Vec<f64>, Vec<f64>) = angles.map(|periods| ELLIPSE.at(TAU * periods)).unzip();
        Coverage::of(&sine, &cosine, &ELLIPSE).unwrap()
    }

    /// From, to in periods; samples; octants.
    #[test]
    fn periods_are_counted_with_their_fraction_in_both_directions() {
        let cases = [
            (0.0, 1.0, 361, 8),
            (0.1, 3.6, 36, 8),
            (0.9, -7.35, 40, 8),
            (5.01, 5.36, 100, 3),
            (0.26, 0.99, 1000, 6),
            (0.01, 0.12, 50, 1),
            (0.3, 100_000.3, 250_000, 8),
        ];
        for (from, to, count, octants) in cases {
            let step = (to - from) / f64::from(count - 1);
            let told = coverage((0..count).map(|at| from + step * f64::from(at)));
            assert!((told.travel_periods - (to - from)).abs() < 1e-8, "{from} {to}: {told:?}");
            assert!((told.periods - f64::abs(to - from)).abs() < 1e-8, "{from} {to}: {told:?}");
            assert_eq!(told.octants, octants, "{from} {to}");
            // Angles of 100 000 periods lose digits.
            assert!(told.residual_rms < 1e-9);
        }
    }

    #[test]
    fn there_and_back_is_covered_once() {
        let told = coverage((0..1000).map(|at| 0.2 + 1.5 * (TAU * f64::from(at) / 1000.0).sin()));
        assert!((told.periods - 3.0).abs() < 1e-4 && told.travel_periods.abs() < 0.02, "{told:?}");
    }

    /// Section 7: r runs from 0.44595 to 0.53764 V.
    #[test]
    fn the_amplitude_vector_of_section_7() {
        let reference = Ellipse { phase_error_rad: 3.0_f64.to_radians(), ..ELLIPSE };
        let (sine, cosine): (Vec<f64>, Vec<f64>) =
            (0..360).map(|degree| reference.at(f64::to_radians(f64::from(degree)))).unzip();
        let (least, most) = Coverage::of(&sine, &cosine, &reference).unwrap().vector_v;
        assert!((least - 0.44595).abs() < 6e-6 && (most - 0.53764).abs() < 6e-6, "{least} {most}");
    }
}
