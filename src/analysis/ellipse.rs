//! Least-squares fit of the ellipse drawn by a pair of sine and cosine signals, and its deviations from a circle:
//! offsets, gain ratio and phase error. See P. L. M. Heydemann, Applied Optics 20, 3382 (1981), and section 7 of the
//! project's sine/cosine reference.
//!
//! Model, with θ the true angle: x = R·cos θ + p (cosine channel) and y = (R·sin θ·cos α − R·cos θ·sin α)/r + q (sine
//! channel). The fitted equation is A·x² + B·y² + C·xy + D·x + E·y = 1, after the origin was moved to the centre of the
//! ellipse. The equation is best conditioned there, and signals with a large mean level can be fitted as well.

use nalgebra::{SMatrix, SVector};

use super::moments::Moments;

#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ellipse {
    /// R: peak amplitude of the cosine channel, in the unit of the samples (volts).
    pub amplitude_v: f64,
    /// p: mean level of the cosine channel in volts.
    pub offset_cosine_v: f64,
    /// q: mean level of the sine channel in volts.
    pub offset_sine_v: f64,
    /// r: ratio of the cosine amplitude to the sine amplitude, above 0.
    pub gain_ratio: f64,
    /// α: lag of the sine behind its nominal position, in radians, within ±π/2. Nominally, the sine is a quarter period
    /// after the cosine.
    pub phase_error_rad: f64,
}

#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum FitError {
    /// There are too few points. An ellipse has five parameters, and one more point is needed to assess the fit.
    #[error("{points} points are too few: at least {least} are required", least = MIN_POINTS)]
    TooFew { points: usize },
    #[error("sample {index} is not a finite number")]
    NotFinite {
        /// Sample index, counted from 0.
        index: usize,
    },
    #[error("all points are equal")]
    Constant,
    #[error("the {} channel does not change", .0.keyword())]
    Dead(SignalChannel),
    /// Both channels carry the same signal, or one channel carries the inverse of the other.
    #[error("the points lie on a line")]
    Line,
    /// There are fewer than six distinct points, or more than one ellipse passes through them.
    #[error("the points do not determine a single ellipse")]
    Ambiguous,
    /// The best-fitting curve is a parabola or a hyperbola, or the points are too close to the centre.
    #[error("the points do not lie on an ellipse")]
    NotAnEllipse,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SignalChannel {
    Sine,
    Cosine,
}

pub const MIN_POINTS: usize = 6;

/// A channel whose range is below this fraction of the other channel's range is dead. Its noise may reach this range.
const DEAD_CHANNEL_FRACTION: f64 = 0.05;
/// Points lie on a line if the ratio of the variance across the line to that along the line is below this value.
const LINE_VARIANCE_RATIO: f64 = 1e-4;
/// Minimum ratio of the smallest to the largest eigenvalue of the normal equations. Below it, the solution is not
/// unique.
const MIN_EIGENVALUE_RATIO: f64 = 1e-13;
/// Number of times that the origin is moved to the centre of the latest ellipse.
const CENTRING_PASSES: usize = 4;

impl SignalChannel {
    pub const fn keyword(self) -> &'static str {
        match self {
            SignalChannel::Sine => "sine",
            SignalChannel::Cosine => "cosine",
        }
    }
}

/// Coefficients of A·x² + B·y² + C·xy + D·x + E·y = 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ConicCoefficients {
    pub a: f64,
    pub b: f64,
    pub c: f64,
    pub d: f64,
    pub e: f64,
}

impl ConicCoefficients {
    /// Returns the ellipse by Heydemann's formulae, or `None` if the curve is not an ellipse around the origin.
    pub fn to_ellipse(&self) -> Option<Ellipse> {
        let ConicCoefficients { a, b, c, d, e } = *self;
        if a <= 0.0 || b <= 0.0 || c * c >= 4.0 * a * b {
            return None;
        }
        let sin = c / (2.0 * (a * b).sqrt());
        let cos = (1.0 - sin * sin).sqrt();
        let r = (b / a).sqrt();
        let determinant = c * c - 4.0 * a * b;
        let p = (2.0 * b * d - e * c) / determinant;
        let q = (2.0 * a * e - d * c) / determinant;
        let radius = (p * p + r * r * q * q + 2.0 * r * p * q * sin + 1.0 / a).sqrt() / cos;
        let ellipse = Ellipse {
            amplitude_v: radius,
            offset_cosine_v: p,
            offset_sine_v: q,
            gain_ratio: r,
            phase_error_rad: sin.asin(),
        };
        [radius, p, q, r].iter().all(|value| value.is_finite()).then_some(ellipse)
    }
}

impl Ellipse {
    /// Fits an ellipse to points given as sine and cosine in volts, in two passes over the samples. If the slices
    /// differ in length, surplus values are ignored.
    ///
    /// # Errors
    /// Returns a [`FitError`] if the points do not determine an ellipse. The caller must check that they cover the
    /// period.
    pub fn fit(sine: &[f64], cosine: &[f64]) -> Result<Self, FitError> {
        Ellipse::from_moments(&Moments::from_samples(sine, cosine)?)
    }

    /// Fits an ellipse to points given by their moments.
    ///
    /// # Errors
    /// Returns the same errors as [`fit`](Self::fit).
    pub fn from_moments(moments: &Moments) -> Result<Self, FitError> {
        if moments.count() < MIN_POINTS {
            return Err(FitError::TooFew { points: moments.count() });
        }
        let around_mean = moments.central_moments();
        ensure_nonzero_area(&around_mean)?;
        let mut moments = around_mean;
        let mut found = solve_normal_equations(&moments)?;
        for _ in 1..CENTRING_PASSES {
            // After a poor start, the centre may be outside the ellipse. In this case, the fit around the mean is kept.
            let moved = moments.with_origin(found.offset_cosine_v, found.offset_sine_v);
            let Ok(better) = solve_normal_equations(&moved) else { break };
            (moments, found) = (moved, better);
        }
        Ok(moments.ellipse_in_volts(&found))
    }

    pub fn point_at(&self, angle: f64) -> (f64, f64) {
        let lagging = (angle - self.phase_error_rad).sin();
        (
            self.amplitude_v * lagging / self.gain_ratio + self.offset_sine_v,
            self.amplitude_v * angle.cos() + self.offset_cosine_v,
        )
    }

    /// Returns the circle on which the corrected signals lie.
    pub fn corrected_ellipse(&self) -> Ellipse {
        let Ellipse { amplitude_v, .. } = *self;
        Ellipse { amplitude_v, offset_cosine_v: 0.0, offset_sine_v: 0.0, gain_ratio: 1.0, phase_error_rad: 0.0 }
    }

    /// Returns points of the outline as (cosine, sine) in volts. The first point is repeated at the end.
    pub fn outline_points(&self, points: usize) -> Vec<(f64, f64)> {
        let point = |at: usize| {
            let (sine, cosine) = self.point_at(at as f64 / points as f64 * std::f64::consts::TAU);
            (cosine, sine)
        };
        (0..=points).map(point).collect()
    }

    pub fn amplitude_sine_v(&self) -> f64 {
        self.amplitude_v / self.gain_ratio
    }

    pub fn phase_error_deg(&self) -> f64 {
        self.phase_error_rad.to_degrees()
    }

    pub fn correction(&self) -> EllipseCorrection {
        let (sin, cos) = self.phase_error_rad.sin_cos();
        EllipseCorrection {
            p: self.offset_cosine_v,
            q: self.offset_sine_v,
            tan: sin / cos,
            scale: self.gain_ratio / cos,
        }
    }
}

/// Correction that maps samples on an ellipse to a zero-centred circle with the amplitude of the cosine.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EllipseCorrection {
    p: f64,
    q: f64,
    tan: f64,
    scale: f64,
}

impl EllipseCorrection {
    /// Returns the corrected (sine, cosine) in volts: x' = x − p, y' = ((x − p)·sin α + r·(y − q))/cos α.
    pub fn apply(&self, sine: f64, cosine: f64) -> (f64, f64) {
        let x = cosine - self.p;
        (x * self.tan + self.scale * (sine - self.q), x)
    }

    /// Returns how much the corrected sine changes with the cosine and with the sine. The corrected cosine changes
    /// exactly as the cosine does.
    pub(super) fn correction_factors(&self) -> (f64, f64) {
        (self.tan, self.scale)
    }
}

/// Rejects points that enclose no area.
///
/// # Errors
/// Returns the reason for the rejection.
fn ensure_nonzero_area(around_mean: &Moments) -> Result<(), FitError> {
    let (range_x, range_y) = around_mean.ranges();
    let most = range_x.max(range_y);
    // The limit is relative to the level, because a constant 2.5 V still varies by a few units in the last place.
    if most <= around_mean.max_abs_voltage() * 1e-9 {
        return Err(FitError::Constant);
    }
    if range_x < DEAD_CHANNEL_FRACTION * most {
        return Err(FitError::Dead(SignalChannel::Cosine));
    }
    if range_y < DEAD_CHANNEL_FRACTION * most {
        return Err(FitError::Dead(SignalChannel::Sine));
    }
    let (xx, xy, yy) = (around_mean.sum(2, 0), around_mean.sum(1, 1), around_mean.sum(0, 2));
    // Each channel is taken relative to its own spread. Otherwise, a small gain would look like a line.
    let correlation = (xy / (xx * yy).sqrt()).abs();
    if 1.0 - correlation < LINE_VARIANCE_RATIO { Err(FitError::Line) } else { Ok(()) }
}

/// Builds and solves the 5 × 5 normal equations, in the moments' scaled unit.
fn solve_normal_equations(moments: &Moments) -> Result<Ellipse, FitError> {
    /// Powers of x and y for the coefficients A to E.
    const POWERS: [(usize, usize); 5] = [(2, 0), (0, 2), (1, 1), (1, 0), (0, 1)];
    let power = |column: usize| POWERS.get(column).copied().unwrap_or_default();
    let normal = SMatrix::<f64, 5, 5>::from_fn(|row, column| {
        let ((i, j), (k, l)) = (power(row), power(column));
        moments.sum(i + k, j + l)
    });
    let right = SVector::<f64, 5>::from_fn(|row, _| {
        let (i, j) = power(row);
        moments.sum(i, j)
    });
    let eigenvalues = normal.symmetric_eigenvalues();
    if eigenvalues.min() <= MIN_EIGENVALUE_RATIO * eigenvalues.max() {
        return Err(FitError::Ambiguous);
    }
    let solution = normal.cholesky().ok_or(FitError::Ambiguous)?.solve(&right);
    let [a, b, c, d, e] = solution.into();
    ConicCoefficients { a, b, c, d, e }.to_ellipse().ok_or(FitError::NotAnEllipse)
}

#[cfg(test)]
#[path = "ellipse/tests.rs"]
mod tests;
