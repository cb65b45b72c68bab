//! How much of the ellipse a capture covers: octants, periods, and the distance of the samples from the ellipse. A fit
//! is valid if the points lie in at least 6 of 8 octants. See section 7 of the project's sine/cosine reference.

use std::ops::Range;

use super::ellipse::Ellipse;
use super::outliers::remaining_ranges;

/// Path of the samples along an ellipse and their distance from it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Coverage {
    /// Number of octants, 0 to 8, in which the corrected angle has at least one sample.
    pub octants: u32,
    /// Number of periods between the lowest and the highest angle, including fractions.
    pub periods: f64,
    /// Number of periods from the first to the last sample, not counting gaps. It is negative if the angle decreases.
    pub travel_periods: f64,
    /// Total path in both directions in periods, not counting gaps.
    pub path_periods: f64,
    /// Number of reversals by more than half a period.
    pub reversals: usize,
    /// RMS distance from the ellipse, as a fraction of the amplitude.
    pub residual_rms: f64,
    /// Shortest and longest amplitude vector √(sin² + cos²) as measured, in volts.
    pub vector_v: (f64, f64),
}

/// Continuous angle over several periods, stored as the number of whole quarters and the vector within the current
/// quarter.
#[derive(Clone, Copy)]
pub(super) struct UnwrappedAngle {
    quarters: i64,
    sine: f64,
    cosine: f64,
}

impl UnwrappedAngle {
    fn from_sample(sine: f64, cosine: f64) -> Self {
        UnwrappedAngle { quarters: i64::from(quadrant_index(sine, cosine)), sine, cosine }
    }

    /// Returns the angle after the signals have moved to the given voltages, by less than half a period.
    fn advanced_to(self, sine: f64, cosine: f64) -> Self {
        let step = (quadrant_index(sine, cosine) - quadrant_index(self.sine, self.cosine)).rem_euclid(4);
        let step = match step {
            3 => -1,
            // Two quarters forward or back: the vectors show which direction is shorter.
            2 if self.cosine * sine < self.sine * cosine => -2,
            step => i64::from(step),
        };
        UnwrappedAngle { quarters: self.quarters + step, sine, cosine }
    }

    fn is_ahead_of(&self, other: &UnwrappedAngle) -> bool {
        self.quarters > other.quarters
            || (self.quarters == other.quarters && other.cosine * self.sine > other.sine * self.cosine)
    }

    fn periods(&self) -> f64 {
        let phase = self.sine.atan2(self.cosine) / std::f64::consts::TAU;
        // Whole quarters are counted. Only the part of the phase within the current quarter is added.
        self.quarters as f64 / 4.0 + phase.rem_euclid(1.0) - f64::from(quadrant_index(self.sine, self.cosine)) / 4.0
    }
}

/// Path of an angle: its extremes, total length and reversals.
struct AnglePath {
    top: UnwrappedAngle,
    bottom: UnwrappedAngle,
    high: UnwrappedAngle,
    low: UnwrappedAngle,
    /// Angle at the start of the section. `turned` is the angle at the last reversal, and `here` is the current angle.
    section_start: UnwrappedAngle,
    turned: UnwrappedAngle,
    here: UnwrappedAngle,
    direction: Direction,
    travel: f64,
    path: f64,
    reversals: usize,
}

#[derive(Clone, Copy, PartialEq)]
enum Direction {
    Unknown,
    Up,
    Down,
}

impl AnglePath {
    /// Number of quarter periods by which an angle must move back to count as a reversal. Noise causes smaller
    /// movements.
    const REVERSAL_QUARTERS: i64 = 3;

    fn starting_at(first: UnwrappedAngle) -> Self {
        AnglePath {
            top: first,
            bottom: first,
            high: first,
            low: first,
            section_start: first,
            turned: first,
            here: first,
            direction: Direction::Unknown,
            travel: 0.0,
            path: 0.0,
            reversals: 0,
        }
    }

    fn extend_to(&mut self, here: UnwrappedAngle) {
        self.here = here;
        self.high = if here.is_ahead_of(&self.high) { here } else { self.high };
        self.low = if self.low.is_ahead_of(&here) { here } else { self.low };
        if self.direction != Direction::Down && self.high.quarters - here.quarters >= Self::REVERSAL_QUARTERS {
            self.turn_at(self.high, Direction::Down);
            self.low = here;
        } else if self.direction != Direction::Up && here.quarters - self.low.quarters >= Self::REVERSAL_QUARTERS {
            self.turn_at(self.low, Direction::Up);
            self.high = here;
        }
    }

    /// Records a change of direction at the angle `at`.
    fn turn_at(&mut self, at: UnwrappedAngle, direction: Direction) {
        self.update_extremes();
        if self.direction != Direction::Unknown {
            self.path += (at.periods() - self.turned.periods()).abs();
            self.turned = at;
            self.reversals += 1;
        }
        self.direction = direction;
    }

    /// Starts a new section at the given angle, which follows a gap.
    fn begin_at(&mut self, here: UnwrappedAngle) {
        self.end_section();
        (self.high, self.low, self.section_start, self.turned, self.here) = (here, here, here, here, here);
        self.direction = Direction::Unknown;
    }

    fn finish_at_gap(mut self) -> Self {
        self.end_section();
        self
    }

    fn end_section(&mut self) {
        self.update_extremes();
        self.path += (self.here.periods() - self.turned.periods()).abs();
        self.travel += self.here.periods() - self.section_start.periods();
    }

    fn update_extremes(&mut self) {
        self.top = if self.high.is_ahead_of(&self.top) { self.high } else { self.top };
        self.bottom = if self.bottom.is_ahead_of(&self.low) { self.low } else { self.bottom };
    }
}

/// Splits a range of samples before each index in `breaks` that lies inside the range.
fn split_at_breaks(part: Range<usize>, breaks: &[usize]) -> impl Iterator<Item = Range<usize>> {
    let inside = breaks.get(breaks.partition_point(|at| *at <= part.start)..).unwrap_or_default();
    let inside = inside.get(..inside.partition_point(|at| *at < part.end)).unwrap_or_default();
    let starts = std::iter::once(part.start).chain(inside.iter().copied());
    starts.zip(inside.iter().copied().chain(std::iter::once(part.end))).map(|(start, end)| start..end)
}

/// Returns the quadrant, 0 to 3, counted in the direction of increasing angle. It avoids branches for speed.
fn quadrant_index(sine: f64, cosine: f64) -> i32 {
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
    /// Measures how the samples cover the ellipse. The angle must change by less than half a period between consecutive
    /// samples. Returns `None` without samples.
    pub fn measure(sine: &[f64], cosine: &[f64], ellipse: &Ellipse) -> Option<Self> {
        Coverage::measure_excluding(sine, cosine, &[], &[], ellipse)
    }

    /// Measures how the samples cover the ellipse, excluding the ranges in `left_out`, which must be ordered and must
    /// not overlap. Each index in `breaks` is the first sample after a gap, across which the angle is not followed.
    pub(super) fn measure_excluding(
        sine: &[f64],
        cosine: &[f64],
        left_out: &[Range<usize>],
        breaks: &[usize],
        ellipse: &Ellipse,
    ) -> Option<Self> {
        /// Number of squares in a partial sum. Partial sums reduce rounding errors.
        const BLOCK: usize = 4096;
        let correction = ellipse.correction();
        let length = sine.len().min(cosine.len());
        let start = remaining_ranges(length, left_out).next()?.start;
        let (first_y, first_x) = correction.apply(*sine.get(start)?, *cosine.get(start)?);
        let first = UnwrappedAngle::from_sample(first_y, first_x);
        let (mut here, mut way) = (first, AnglePath::starting_at(first));
        let mut octants = 0_u32;
        let (mut squares, mut count) = (0.0, 0_usize);
        let (mut least, mut most) = (f64::INFINITY, 0.0_f64);
        let parts = remaining_ranges(length, left_out).flat_map(|part| split_at_breaks(part, breaks));
        let parts = parts.filter_map(|part| Some((part.start, sine.get(part.clone())?, cosine.get(part)?)));
        let mut seen = 0;
        for (start, sine, cosine) in parts {
            // Samples before a break may have been left out.
            let begun = breaks.partition_point(|at| *at <= start);
            let mut begins = begun > std::mem::replace(&mut seen, begun);
            for (ys, xs) in sine.chunks(BLOCK).zip(cosine.chunks(BLOCK)) {
                let mut sum = 0.0;
                for (y, x) in ys.iter().zip(xs) {
                    let raw = y * y + x * x;
                    least = if raw < least { raw } else { least };
                    most = if raw > most { raw } else { most };
                    let (y, x) = correction.apply(*y, *x);
                    let off = (y * y + x * x).sqrt() - ellipse.amplitude_v;
                    sum += off * off;
                    here = here.advanced_to(y, x);
                    octants |=
                        1 << (((here.quarters & 3) as u32) << 1 | u32::from((y.abs() > x.abs()) ^ (y * x < 0.0)));
                    if std::mem::take(&mut begins) {
                        way.begin_at(here);
                    }
                    way.extend_to(here);
                }
                squares += sum;
                count += ys.len().min(xs.len());
            }
        }
        let way = way.finish_at_gap();
        Some(Coverage {
            octants: octants.count_ones(),
            periods: way.top.periods() - way.bottom.periods(),
            travel_periods: way.travel,
            path_periods: way.path,
            reversals: way.reversals,
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
        let (sine, cosine): (Vec<f64>, Vec<f64>) = angles.map(|periods| ELLIPSE.point_at(TAU * periods)).unzip();
        Coverage::measure(&sine, &cosine, &ELLIPSE).unwrap()
    }

    #[test]
    fn counts_fractional_periods_both_ways() {
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
            // Angles of 100 000 periods lose precision.
            assert!(told.residual_rms < 1e-9);
        }
    }

    #[test]
    fn return_travel_counts_once() {
        let told = coverage((0..1000).map(|at| 0.2 + 1.5 * (TAU * f64::from(at) / 1000.0).sin()));
        assert!((told.periods - 3.0).abs() < 1e-4 && told.travel_periods.abs() < 0.02, "{told:?}");
        // Up by 1.5, down by 3, up by 1.5 except for the last step.
        assert_eq!(told.reversals, 2);
        assert!((told.path_periods - 6.0).abs() < 0.02, "{told:?}");
        let steady = coverage((0..1000).map(|at| 0.2 - 0.013 * f64::from(at)));
        assert!(steady.reversals == 0 && (steady.path_periods - 12.987).abs() < 1e-8, "{steady:?}");
    }

    #[test]
    fn ignores_motion_within_gap() {
        // 2.7 periods, a jump of 40.4 periods, then 1.1 periods back. The first sample after the jump is left out.
        let angles =
            (0..100).map(|at| 0.1 + 0.027 * f64::from(at)).chain((0..100).map(|at| 43.2 - 0.011 * f64::from(at)));
        let (sine, cosine): (Vec<f64>, Vec<f64>) = angles.map(|periods| ELLIPSE.point_at(TAU * periods)).unzip();
        let told = Coverage::measure_excluding(&sine, &cosine, &[100..101, 150..152], &[100], &ELLIPSE).unwrap();
        assert!((told.travel_periods - (99.0 * 0.027 - 98.0 * 0.011)).abs() < 1e-8, "{told:?}");
        assert!((told.path_periods - (99.0 * 0.027 + 98.0 * 0.011)).abs() < 1e-8, "{told:?}");
        assert_eq!((told.reversals, told.octants), (0, 8), "which way it went in between is not known");
    }

    /// The amplitude vector r runs from 0.44595 to 0.53764 V (section 7).
    #[test]
    fn amplitude_vector_matches_section_7() {
        let reference = Ellipse { phase_error_rad: 3.0_f64.to_radians(), ..ELLIPSE };
        let (sine, cosine): (Vec<f64>, Vec<f64>) =
            (0..360).map(|degree| reference.point_at(f64::to_radians(f64::from(degree)))).unzip();
        let (least, most) = Coverage::measure(&sine, &cosine, &reference).unwrap().vector_v;
        assert!((least - 0.44595).abs() < 6e-6 && (most - 0.53764).abs() < 6e-6, "{least} {most}");
    }
}
