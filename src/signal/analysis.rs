//! All there is to say about a capture of sine and cosine: the ellipse (Heydemann 1981), how well it fits, how much of the
//! period it covers, and the position error it stands for. Sections 2, 6 and 7 of the project's sine/cosine reference.
//! Single samples far off are left out of all of it, and told.

use super::coverage::Coverage;
use super::ellipse::{Ellipse, FitError};
use super::outliers::{self, Found, Outliers};
use super::position_error::{PositionError, Samples};

/// Fewest octants of a period that must hold samples (U).
pub const LEAST_OCTANTS: u32 = 6;
/// Rms distance from the ellipse, as a share of the amplitude, beyond which there is none: a cloud of noise around one
/// point has 0.4 and more, a signal with a residual of 0.02 is already bad.
pub const LARGEST_RESIDUAL: f64 = 0.25;

/// The result.
#[derive(Clone, Debug, PartialEq)]
pub struct Analysis {
    /// The ellipse.
    pub ellipse: Ellipse,
    /// What the samples do on it.
    pub coverage: Coverage,
    /// The position error over one period.
    pub error: PositionError,
    /// Samples, with those that were left out.
    pub samples: usize,
    /// Time from the first to the last sample in seconds; `None` without growing times.
    pub duration_s: Option<f64>,
    /// Samples that were left out because they are far off, with the ellipse as it would be with them; `None` where none
    /// were.
    pub outliers: Option<Outliers>,
}

/// Why a capture cannot be analysed.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum AnalysisError {
    /// The samples determine no ellipse.
    #[error(transparent)]
    Fit(#[from] FitError),
    /// The capture covers too little of a period for its ellipse to be trusted.
    #[error("samples in {octants} of 8 octants where {least} are needed", least = LEAST_OCTANTS)]
    Coverage {
        /// Octants that hold samples.
        octants: u32,
    },
    /// The samples are too far from the ellipse to be a sine and a cosine.
    #[error("the samples are {share:.2} of the amplitude off the ellipse")]
    NoSignal {
        /// Rms distance as a share of the amplitude.
        share: f64,
    },
}

impl Analysis {
    /// Analyses samples; of columns that are not equally long, what is over is left out.
    ///
    /// # Errors
    /// [`AnalysisError`] where they determine no ellipse or cover less than six octants of a period.
    pub fn of(samples: Samples<'_>) -> Result<Self, AnalysisError> {
        Self::attempt(samples).map_err(|error| match error {
            // One spark on a dead channel makes it look alive, and what it gives then says nothing about the cause.
            AnalysisError::Fit(FitError::NotAnEllipse)
            | AnalysisError::Coverage { .. }
            | AnalysisError::NoSignal { .. } => {
                outliers::dead(samples.sine_v, samples.cosine_v).map_or(error, |channel| FitError::Dead(channel).into())
            }
            error => error,
        })
    }

    fn attempt(samples: Samples<'_>) -> Result<Self, AnalysisError> {
        let Samples { time_s, sine_v, cosine_v } = samples;
        let all = Ellipse::fit(sine_v, cosine_v);
        if let Err(error @ (FitError::TooFew { .. } | FitError::NotFinite { .. } | FitError::Constant)) = all {
            return Err(error.into());
        }
        let (ellipse, outliers) = match outliers::find(sine_v, cosine_v, all.as_ref().ok()) {
            Found::Nothing => (all?, None),
            Found::Outliers(ellipse, outliers) => (ellipse, Some(outliers)),
        };
        let left_out = outliers.as_ref().map_or(&[][..], |outliers| &outliers.stretches);
        let coverage = Coverage::without(sine_v, cosine_v, left_out, &ellipse).ok_or(FitError::TooFew { points: 0 })?;
        if coverage.residual_rms > LARGEST_RESIDUAL {
            return Err(AnalysisError::NoSignal { share: coverage.residual_rms });
        }
        if coverage.octants < LEAST_OCTANTS {
            return Err(AnalysisError::Coverage { octants: coverage.octants });
        }
        let duration = time_s.last().zip(time_s.first()).map(|(last, first)| last - first);
        Ok(Analysis {
            error: PositionError::of(samples, left_out, &ellipse, &coverage),
            ellipse,
            coverage,
            samples: sine_v.len().min(cosine_v.len()),
            duration_s: duration.filter(|duration| duration.is_finite() && *duration > 0.0),
            outliers,
        })
    }

    /// Periods a second on average; negative when the angle falls, `None` without times.
    pub fn frequency_hz(&self) -> Option<f64> {
        self.duration_s.map(|duration| self.coverage.travel_periods / duration)
    }
}
