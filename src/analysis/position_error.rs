//! Position error over one signal period, before and after the correction, with its harmonics, in electrical degrees.
//! See SICK 8010701, definitions of errors (the effects of offset, gain, phase and harmonics inside a period), and
//! section 6 of the project's sine/cosine reference.
//!
//! Without a reference encoder, the motion itself is the reference. Over a few periods a shaft follows a straight line
//! or a parabola in time, so deviations that repeat with the period are errors. Both are fitted at once: a motion for
//! each segment of the capture, and eight harmonics of the corrected angle for all segments. If the motion does not fit
//! such a curve, or is too short, the distance from the ellipse serves as the error. A disturbance changes both by the
//! same amount.

use std::f64::consts::TAU;
use std::ops::Range;

use nalgebra::{SMatrix, SVector};

use super::coverage::Coverage;
use super::ellipse::{Ellipse, EllipseCorrection};
use super::outliers::remaining_ranges;

/// Number of harmonics that are fitted to the error over a period.
pub const HARMONICS: usize = 8;

#[derive(Clone, Debug, PartialEq)]
pub struct PositionError {
    /// Measured error in electrical degrees at [`POINTS`] equidistant angles, with a mean of zero.
    pub raw_deg: Vec<f64>,
    /// Remaining error after correction, in electrical degrees at the same angles.
    pub corrected_deg: Vec<f64>,
    pub basis: ErrorBasis,
    /// Peak to peak of the remaining error, in electrical degrees.
    pub corrected_pp_deg: f64,
}

/// How the remaining error was measured.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ErrorBasis {
    /// The motion was steady. The error is the deviation of the samples from it, and the noise is the part that the
    /// harmonics do not explain.
    Motion { noise_deg: f64 },
    /// The distance from the ellipse was used, because the motion was not steady or the capture was too short.
    Ellipse,
}

pub const POINTS: usize = 720;

/// Number of terms: a sine and a cosine for each harmonic.
const TERMS: usize = 2 * HARMONICS;
/// Number of periods in a segment. Each segment is fitted with its own motion.
const SEGMENT_PERIODS: f64 = 4.0;
/// Maximum number of segments examined, distributed over the capture.
const SEGMENTS: usize = 32;
/// Maximum number of samples per segment. A segment with more samples is thinned out.
const SEGMENT_SAMPLES: usize = 4096;
/// Minimum number of samples for a fit of the motion with all harmonics.
const MIN_SAMPLES: usize = 3 * TERMS;
/// Minimum number of periods. With fewer, harmonics and motion cannot be separated.
const MIN_PERIODS: f64 = 0.95;
/// Ratio of the noise to the value expected from the distance to the ellipse, above which the motion counts as
/// unsteady.
const UNSTEADY_NOISE_RATIO: f64 = 3.0;

type Normal = SMatrix<f64, TERMS, TERMS>;
type Terms = SVector<f64, TERMS>;

#[derive(Clone, Copy, Debug)]
pub struct Samples<'a> {
    /// Times in seconds. If they do not increase, they are ignored, and the samples are treated as equidistant.
    pub time_s: &'a [f64],
    pub sine_v: &'a [f64],
    pub cosine_v: &'a [f64],
}

impl PositionError {
    /// Calculates the error of samples relative to their ellipse. The samples in the ranges of `left_out` are excluded.
    /// The ranges must be ordered and must not overlap.
    pub(super) fn from_samples(
        samples: Samples<'_>,
        left_out: &[Range<usize>],
        ellipse: &Ellipse,
        coverage: &Coverage,
    ) -> Self {
        let expected_deg = coverage.residual_rms.to_degrees();
        let found = fit_harmonics(&samples, left_out, ellipse, coverage.periods)
            .filter(|(_, noise_deg)| *noise_deg <= UNSTEADY_NOISE_RATIO * expected_deg.max(0.01));
        let corrected_deg: Vec<f64> = match &found {
            Some((terms, _)) => sample_angles().map(|angle| harmonics_at(angle).dot(terms).to_degrees()).collect(),
            None => vec![0.0; POINTS],
        };
        let of_ellipse = sample_angles().map(|angle| {
            let (sine, cosine) = ellipse.point_at(angle);
            (sine.atan2(cosine) - angle + TAU / 2.0).rem_euclid(TAU) - TAU / 2.0
        });
        let mut raw_deg: Vec<f64> =
            of_ellipse.zip(&corrected_deg).map(|(error, left)| error.to_degrees() + left).collect();
        let mean = raw_deg.iter().sum::<f64>() / POINTS as f64;
        raw_deg.iter_mut().for_each(|error| *error -= mean);
        let (basis, corrected_pp_deg) = match found {
            Some((_, noise_deg)) => (ErrorBasis::Motion { noise_deg }, peak_to_peak(&corrected_deg)),
            // This is the peak to peak of a single sine with this rms.
            None => (ErrorBasis::Ellipse, 2.0 * 2.0_f64.sqrt() * expected_deg),
        };
        PositionError { raw_deg, corrected_deg, basis, corrected_pp_deg }
    }

    pub fn raw_peak_to_peak_deg(&self) -> f64 {
        peak_to_peak(&self.raw_deg)
    }
}

/// Returns the peak amplitudes of the first harmonics of a curve over one period, in the unit of the curve.
pub fn harmonic_amplitudes(curve: &[f64]) -> [f64; HARMONICS] {
    let count = curve.len().max(1) as f64;
    let mut order = 0.0;
    [0.0; HARMONICS].map(|_| {
        order += 1.0;
        let angle = |at: usize| TAU * order * at as f64 / count;
        let (sine, cosine) = curve.iter().enumerate().fold((0.0, 0.0), |(sine, cosine), (at, value)| {
            (sine + value * angle(at).sin(), cosine + value * angle(at).cos())
        });
        2.0 / count * f64::hypot(sine, cosine)
    })
}

fn sample_angles() -> impl Iterator<Item = f64> {
    (0..POINTS).map(|at| TAU * at as f64 / POINTS as f64)
}

fn peak_to_peak(curve: &[f64]) -> f64 {
    let (low, high) =
        curve.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), value| (low.min(*value), high.max(*value)));
    (high - low).max(0.0)
}

fn harmonics_at(angle: f64) -> Terms {
    let (sine, cosine) = angle.sin_cos();
    let (mut s, mut c) = (0.0, 1.0);
    let mut terms = Terms::zeros();
    for pair in terms.as_mut_slice().chunks_exact_mut(2) {
        (s, c) = (s * cosine + c * sine, c * cosine - s * sine);
        if let [first, second] = pair {
            (*first, *second) = (s, c);
        }
    }
    terms
}

/// Returns the harmonics in radians and the RMS residual in degrees. Returns `None` if there are too few samples.
fn fit_harmonics(
    samples: &Samples<'_>,
    left_out: &[Range<usize>],
    ellipse: &Ellipse,
    periods: f64,
) -> Option<(Terms, f64)> {
    let count = samples.sine_v.len().min(samples.cosine_v.len());
    if count < MIN_SAMPLES || periods < MIN_PERIODS {
        return None;
    }
    let timed = samples.time_s.len() >= count && samples.time_s.windows(2).all(|pair| matches!(pair, [a, b] if a < b));
    let segments = ((periods / SEGMENT_PERIODS) as usize).clamp(1, SEGMENTS.min(count / MIN_SAMPLES).max(1));
    let length = if segments == 1 && periods < 2.0 * SEGMENT_PERIODS {
        count
    } else {
        ((count as f64 * SEGMENT_PERIODS / periods) as usize).clamp(MIN_SAMPLES.min(count), count)
    };
    let bends = periods >= 2.0;
    let correction = ellipse.correction();
    let mut sums =
        NormalEquations { normal: Normal::zeros(), right: Terms::zeros(), squares: 0.0, count: 0, motions: 0 };
    for segment in 0..segments {
        let start = if segments == 1 { 0 } else { (count - length) * segment / (segments - 1) };
        sums.add_segment(&Segment::fit_segment(samples, left_out, start..start + length, timed), &correction, bends);
    }
    sums.solve()
}

/// A range of consecutive samples to which a separate motion is fitted.
struct Segment {
    times: Vec<f64>,
    sine: Vec<f64>,
    cosine: Vec<f64>,
}

impl Segment {
    fn fit_segment(samples: &Samples<'_>, left_out: &[Range<usize>], range: Range<usize>, timed: bool) -> Self {
        let from = left_out.partition_point(|stretch| stretch.end <= range.start);
        let inside = left_out.iter().skip(from).take_while(|stretch| stretch.start < range.end);
        // Convert an index to one within the range.
        let own = |index: usize| index.clamp(range.start, range.end) - range.start;
        let inside: Vec<Range<usize>> = inside.map(|stretch| own(stretch.start)..own(stretch.end)).collect();
        let parts = |values: &[f64]| {
            let values = values.get(range.clone()).unwrap_or_default();
            remaining_ranges(values.len(), &inside)
                .flat_map(|part| values.get(part).unwrap_or_default())
                .copied()
                .collect()
        };
        let times = match timed {
            true => parts(samples.time_s),
            false => remaining_ranges(range.len(), &inside).flatten().map(|at| at as f64).collect(),
        };
        Segment { times, sine: parts(samples.sine_v), cosine: parts(samples.cosine_v) }
    }
}

/// Normal equations for the harmonics, from which the motions have been eliminated.
struct NormalEquations {
    normal: Normal,
    right: Terms,
    squares: f64,
    count: usize,
    motions: usize,
}

impl NormalEquations {
    fn add_segment(&mut self, segment: &Segment, correction: &EllipseCorrection, bends: bool) {
        let Segment { times, sine, cosine } = segment;
        let stride = (times.len() / SEGMENT_SAMPLES).max(1);
        let (Some(begin), Some(end)) = (times.first(), times.last()) else { return };
        let (middle, half) = ((begin + end) / 2.0, ((end - begin) / 2.0).max(f64::MIN_POSITIVE));
        // Terms of the motion: 1, t, t² with t from −1 to 1.
        let mut motion = SMatrix::<f64, 3, 3>::zeros();
        let mut mixed = SMatrix::<f64, 3, TERMS>::zeros();
        let mut of_motion = SVector::<f64, 3>::zeros();
        let mut normal = Normal::zeros();
        let mut right = Terms::zeros();
        let (mut turned, mut last) = (0.0, None);
        for ((time, y), x) in times.iter().zip(sine).zip(cosine).step_by(stride) {
            let (y, x) = correction.apply(*y, *x);
            let angle = y.atan2(x);
            let step = angle - last.unwrap_or(angle);
            turned += step - TAU * (step / TAU).round();
            last = Some(angle);
            let t = (time - middle) / half;
            let powers = SVector::<f64, 3>::new(1.0, t, if bends { t * t } else { 0.0 });
            let terms = harmonics_at(angle);
            motion += powers * powers.transpose();
            mixed += powers * terms.transpose();
            of_motion += powers * turned;
            normal.syger(1.0, &terms, &terms, 1.0);
            right += terms * turned;
            self.squares += turned * turned;
            self.count += 1;
        }
        normal.fill_upper_triangle_with_lower_triangle();
        if !bends && let Some(unused) = motion.get_mut((2, 2)) {
            *unused = 1.0;
        }
        let Some(motion) = motion.cholesky() else { return };
        self.normal += normal - mixed.transpose() * motion.solve(&mixed);
        self.right += right - mixed.transpose() * motion.solve(&of_motion);
        self.squares -= of_motion.dot(&motion.solve(&of_motion));
        self.motions += if bends { 3 } else { 2 };
    }

    fn solve(self) -> Option<(Terms, f64)> {
        /// Smallest significant eigenvalue, as a fraction of the largest one. If there are few samples per period, high
        /// harmonics cannot be distinguished from low ones.
        const MIN_EIGENVALUE_SHARE: f64 = 1e-4;
        let parts = self.normal.symmetric_eigen();
        let largest = parts.eigenvalues.max();
        let mut terms = Terms::zeros();
        for (value, vector) in parts.eigenvalues.iter().zip(parts.eigenvectors.column_iter()) {
            if *value > MIN_EIGENVALUE_SHARE * largest {
                terms += vector * (vector.dot(&self.right) / value);
            }
        }
        let left = (self.squares - terms.dot(&self.right)).max(0.0);
        let free = self.count.checked_sub(self.motions + TERMS).filter(|free| *free > 0)?;
        let noise = (left / free as f64).sqrt().to_degrees();
        noise.is_finite().then_some((terms, noise))
    }
}

#[cfg(test)]
#[path = "position_error/tests.rs"]
mod tests;
