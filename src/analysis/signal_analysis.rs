//! Complete analysis of a sine/cosine capture: the ellipse (Heydemann 1981), the quality of its fit, its coverage of
//! the period, and the resulting position error. Isolated outliers are reported and excluded from all results. See
//! sections 2, 6 and 7 of the project's sine/cosine reference.

use super::continuity::Continuity;
use super::coverage::Coverage;
use super::ellipse::{Ellipse, FitError};
use super::outliers::{self, OutlierResult, Outliers};
use super::position_error::{PositionError, Samples};

/// Minimum number of octants of a period that must contain samples (U).
pub const MIN_OCTANTS: u32 = 6;
/// Maximum RMS distance from the ellipse, relative to the amplitude. Above it, the samples do not form an ellipse. A
/// cloud of noise around one point has 0.4 or more, while a residual of 0.02 already indicates a poor signal.
pub const LARGEST_RESIDUAL: f64 = 0.25;

/// Maximum median angle between samples in degrees. Beyond it, the direction is uncertain: with fewer than four samples
/// per period, noise or a varying speed can easily increase the angle to half a period (U).
const LARGEST_STEP_DEG: f64 = 90.0;

#[derive(Clone, Debug, PartialEq)]
pub struct Analysis {
    pub ellipse: Ellipse,
    pub coverage: Coverage,
    pub continuity: Continuity,
    /// Median angle between consecutive samples in degrees, 0 to 180.
    pub step_deg: f64,
    pub error: PositionError,
    /// Number of samples, including excluded ones.
    pub samples: usize,
    /// Time between the first and last sample in seconds, or `None` if the times do not increase.
    pub duration_s: Option<f64>,
    /// Excluded outliers with the ellipse that includes them, or `None` without outliers.
    pub outliers: Option<Outliers>,
}

#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum AnalysisError {
    /// The samples do not determine an ellipse.
    #[error(transparent)]
    Fit(#[from] FitError),
    /// The capture covers too little of a period for a reliable ellipse.
    #[error("the samples cover {octants} of 8 octants, but at least {least} are required", least = MIN_OCTANTS)]
    Coverage { octants: u32 },
    /// All samples lie around one point away from zero, so there is a signal and the shaft is at rest.
    #[error("all samples are close to a single point")]
    AtRest,
    /// The samples are too far from the ellipse to be a sine and a cosine.
    #[error("the samples deviate from the ellipse by {share:.2} of the amplitude")]
    NoSignal {
        /// RMS distance from the ellipse as a fraction of the amplitude.
        share: f64,
    },
}

impl Analysis {
    /// Analyses samples. If columns differ in length, surplus values are ignored.
    ///
    /// # Errors
    /// Returns an [`AnalysisError`] if the samples do not determine an ellipse or cover fewer than six octants of a
    /// period.
    pub fn from_samples(samples: Samples<'_>) -> Result<Self, AnalysisError> {
        Self::try_from_samples(samples).map_err(|error| match error {
            // These errors already name the cause. Equal points may also come from a dead cable.
            AnalysisError::Fit(FitError::TooFew { .. } | FitError::NotFinite { .. } | FitError::Constant) => error,
            _ if is_at_rest(samples.sine_v, samples.cosine_v) => AnalysisError::AtRest,
            // A single spark on a dead channel makes it look alive. The resulting error would hide the cause.
            AnalysisError::Fit(FitError::NotAnEllipse)
            | AnalysisError::Coverage { .. }
            | AnalysisError::NoSignal { .. } => outliers::dead_channel(samples.sine_v, samples.cosine_v)
                .map_or(error, |channel| FitError::Dead(channel).into()),
            error => error,
        })
    }

    fn try_from_samples(samples: Samples<'_>) -> Result<Self, AnalysisError> {
        let Samples { time_s, sine_v, cosine_v } = samples;
        let all = Ellipse::fit(sine_v, cosine_v);
        if let Err(error @ (FitError::TooFew { .. } | FitError::NotFinite { .. } | FitError::Constant)) = all {
            return Err(error.into());
        }
        let (ellipse, outliers) = match outliers::find(sine_v, cosine_v, all.as_ref().ok()) {
            OutlierResult::Nothing => (all?, None),
            OutlierResult::Outliers(ellipse, outliers) => (ellipse, Some(outliers)),
        };
        let left_out = outliers.as_ref().map_or(&[][..], |outliers| &outliers.excluded_ranges);
        let continuity = Continuity::from_times(time_s);
        let coverage = Coverage::measure_excluding(sine_v, cosine_v, left_out, &continuity.breaks, &ellipse);
        let coverage = coverage.ok_or(FitError::TooFew { points: 0 })?;
        if coverage.residual_rms > LARGEST_RESIDUAL {
            return Err(AnalysisError::NoSignal { share: coverage.residual_rms });
        }
        if coverage.octants < MIN_OCTANTS {
            return Err(AnalysisError::Coverage { octants: coverage.octants });
        }
        let duration = time_s.last().zip(time_s.first()).map(|(last, first)| last - first);
        Ok(Analysis {
            error: PositionError::from_samples(samples, left_out, &ellipse, &coverage),
            coverage,
            continuity,
            step_deg: step_deg(sine_v, cosine_v, &ellipse),
            samples: sine_v.len().min(cosine_v.len()),
            duration_s: duration.filter(|duration| duration.is_finite() && *duration > 0.0),
            outliers,
            ellipse,
        })
    }

    /// Returns the average number of periods per second over continuous sections. It is negative if the angle
    /// decreases. If the direction has changed, the result is the positive mean of both directions. Returns `None`
    /// without times.
    pub fn frequency_hz(&self) -> Option<f64> {
        let Coverage { path_periods, travel_periods, reversals, .. } = self.coverage;
        self.continuity.continuous_s.map(|seconds| if reversals > 0 { path_periods } else { travel_periods } / seconds)
    }

    /// Returns whether there are enough samples per period to track the angle. Otherwise, the frequency is unknown.
    pub fn is_angle_tracked(&self) -> bool {
        self.step_deg <= LARGEST_STEP_DEG
    }
}

/// Returns whether the samples scatter only slightly around a point other than zero.
fn is_at_rest(sine_v: &[f64], cosine_v: &[f64]) -> bool {
    /// Maximum RMS scatter of one channel at rest, relative to the distance of the point from zero. It corresponds to
    /// 6° (U).
    const MAX_REST_SCATTER: f64 = 0.1;
    /// Minimum distance from zero in volts. Below it, there may be no signal (U).
    const MIN_REST_DISTANCE_V: f64 = 0.1;
    let of = |values: &[f64]| {
        let count = values.len().max(1) as f64;
        let mean = values.iter().sum::<f64>() / count;
        (mean, (values.iter().map(|value| (value - mean) * (value - mean)).sum::<f64>() / count).sqrt())
    };
    let ((sine, sine_rms), (cosine, cosine_rms)) = (of(sine_v), of(cosine_v));
    let away = sine.hypot(cosine);
    away >= MIN_REST_DISTANCE_V && sine_rms.max(cosine_rms) <= MAX_REST_SCATTER * away
}

/// Returns the median angle between consecutive samples, in degrees.
fn step_deg(sine_v: &[f64], cosine_v: &[f64], ellipse: &Ellipse) -> f64 {
    const SAMPLED_VALUES: usize = 1 << 13;
    let correction = ellipse.correction();
    // An odd stride does not fall in step with a period of 2ⁿ samples.
    let stride = (sine_v.len() / SAMPLED_VALUES) | 1;
    let step = |pair: (&[f64], &[f64])| match pair {
        ([y, later_y], [x, later_x]) => {
            let (y, x) = correction.apply(*y, *x);
            let (later_y, later_x) = correction.apply(*later_y, *later_x);
            Some((later_y * x - later_x * y).atan2(later_x * x + later_y * y).abs().to_degrees())
        }
        _ => None,
    };
    let mut steps: Vec<f64> = sine_v.windows(2).zip(cosine_v.windows(2)).step_by(stride).filter_map(step).collect();
    let middle = steps.len() / 2;
    if middle < steps.len() { *steps.select_nth_unstable_by(middle, f64::total_cmp).1 } else { 0.0 }
}
