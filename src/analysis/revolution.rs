//! Comparison of a capture with a reference encoder. The result is the non-linearity over one revolution, as measured
//! and after correction. The measured angle is interpolated from sine and cosine, as in a drive. See section 6 of the
//! project's sine/cosine reference.

use std::f64::consts::TAU;
use std::ops::Range;

use super::ellipse::Ellipse;
use super::nonlinearity::{Nonlinearity, NonlinearityError, compute_nonlinearity};
use super::outliers::remaining_ranges;

/// Nonlinearity with and without the correction of the ellipse.
#[derive(Clone, Debug, PartialEq)]
pub struct Revolution {
    pub raw: Nonlinearity,
    /// Nonlinearity with offsets, gain ratio and phase error corrected.
    pub corrected: Nonlinearity,
}

#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum RevolutionError {
    /// The samples or the reference are unsuitable.
    #[error(transparent)]
    Nonlinearity(#[from] NonlinearityError),
    /// The signals do not match the reference for the given number of periods per revolution.
    #[error("the capture has {found:.1} periods in a revolution of the reference, not {given}")]
    Periods {
        /// Number of periods counted over one revolution of the reference.
        found: f64,
        given: u32,
    },
}

/// Maximum relative deviation of the counted number of periods from the given one.
const MAX_PERIOD_DEVIATION: f64 = 0.02;

impl Revolution {
    /// Compares sine and cosine in volts with the reference angle in mechanical degrees. The reference may be wrapped
    /// or unwrapped and may turn in either direction. Samples in `left_out` are ignored, as are samples taken while the
    /// reference is at rest.
    ///
    /// # Errors
    /// Returns a [`RevolutionError`] if the signals and the reference are unsuitable or do not match.
    pub fn from_samples(
        sine: &[f64],
        cosine: &[f64],
        reference_deg: &[f64],
        left_out: &[Range<usize>],
        ellipse: &Ellipse,
        periods: u32,
    ) -> Result<Self, RevolutionError> {
        if periods == 0 || reference_deg.iter().any(|angle| !angle.is_finite()) {
            return Err(NonlinearityError::NotFinite.into());
        }
        let correction = ellipse.correction();
        let count = sine.len().min(cosine.len()).min(reference_deg.len());
        let (mut raw, mut corrected, mut shaft) =
            (AngleUnwrapper::new(TAU), AngleUnwrapper::new(TAU), AngleUnwrapper::new(360.0));
        let (mut as_measured, mut as_corrected, mut reference) = (Vec::new(), Vec::new(), Vec::new());
        for at in remaining_ranges(count, left_out).flatten() {
            let (Some(y), Some(x), Some(angle)) = (sine.get(at), cosine.get(at), reference_deg.get(at)) else { break };
            let (own_y, own_x) = correction.apply(*y, *x);
            let (measured, own) = (raw.next(y.atan2(*x)), corrected.next(own_y.atan2(own_x)));
            let angle = shaft.next(*angle);
            if reference.last() != Some(&angle) {
                reference.push(angle);
                as_measured.push(measured);
                as_corrected.push(own);
            }
        }
        let travel = |values: &[f64]| values.last().zip(values.first()).map_or(0.0, |(last, first)| last - first);
        let (turned, revolved) = (travel(&as_corrected) / TAU, travel(&reference) / 360.0);
        let found = turned / revolved;
        if !found.is_finite() {
            return Err(NonlinearityError::TooLittle.into());
        }
        // Less than a period does not reveal the number of periods per revolution.
        if turned.abs() >= 1.0
            && (found.abs() / f64::from(periods) - 1.0).abs() > MAX_PERIOD_DEVIATION.max(1.0 / turned.abs())
        {
            return Err(RevolutionError::Periods { found: found.abs(), given: periods });
        }
        // A reference that is mounted in reverse counts in the other direction.
        let factor = 360.0 / TAU / f64::from(periods) * found.signum();
        let mechanical = |angles: &[f64]| angles.iter().map(|angle| angle * factor).collect::<Vec<f64>>();
        Ok(Revolution {
            raw: compute_nonlinearity(&mechanical(&as_measured), &reference, periods)?,
            corrected: compute_nonlinearity(&mechanical(&as_corrected), &reference, periods)?,
        })
    }
}

/// State for unwrapping a measured angle.
struct AngleUnwrapper {
    whole: f64,
    last: Option<f64>,
}

impl AngleUnwrapper {
    fn new(whole: f64) -> Self {
        AngleUnwrapper { whole, last: None }
    }

    fn next(&mut self, angle: f64) -> f64 {
        let last = self.last.unwrap_or(angle);
        let step = angle - last;
        let next = last + step - self.whole * (step / self.whole).round();
        self.last = Some(next);
        next
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const ELLIPSE: Ellipse =
        Ellipse { amplitude_v: 0.5, offset_cosine_v: 0.005, offset_sine_v: 0.0, gain_ratio: 1.0, phase_error_rad: 0.0 };

    /// Returns 1.1 revolutions of 128 periods with an eccentricity of 0.02°.
    fn made(sign: f64) -> (Vec<f64>, Vec<f64>, Vec<f64>) {
        let (mut sine, mut cosine, mut reference) = (vec![], vec![], vec![]);
        for at in 0..20_000 {
            let turn = 1.1 * f64::from(at) / 20_000.0;
            let (y, x) = ELLIPSE.point_at(TAU * 128.0 * (turn + 0.02 / 360.0 * (TAU * turn).sin()));
            sine.push(sign * y);
            cosine.push(x);
            reference.push((360.0 * turn + 300.0) % 360.0);
        }
        (sine, cosine, reference)
    }

    #[test]
    fn separates_nonlinearity_in_either_direction() {
        let spike = std::iter::once(7_777..7_778).collect::<Vec<_>>();
        for sign in [1.0, -1.0] {
            let (mut sine, cosine, reference) = made(sign);
            sine[7_777] = 3.0;
            let told = Revolution::from_samples(&sine, &cosine, &reference, &spike, &ELLIPSE, 128).unwrap();
            assert!((told.raw.integral_deg - 0.02).abs() < 2e-5, "{}", told.raw.integral_deg);
            // An offset of 1 % is ±0.5730 electrical degrees (section 6).
            assert!((told.raw.differential_deg - 0.573 / 128.0).abs() < 3e-5, "{}", told.raw.differential_deg);
            assert!(told.corrected.differential_deg < 1e-5, "{}", told.corrected.differential_deg);
            assert!((told.corrected.integral_deg - 0.02).abs() < 2e-5, "{}", told.corrected.integral_deg);
        }
    }

    #[test]
    fn reports_wrong_period_count() {
        let (sine, cosine, reference) = made(1.0);
        let told = Revolution::from_samples(&sine, &cosine, &reference, &[], &ELLIPSE, 100);
        let Err(RevolutionError::Periods { found, given: 100 }) = told else { panic!("{told:?}") };
        assert!((found - 128.0).abs() < 0.1, "{found}");
    }

    #[test]
    fn accepts_coarse_but_not_constant_reference() {
        let (sine, cosine, mut reference) = made(1.0);
        let standing = vec![12.0; reference.len()];
        let told = Revolution::from_samples(&sine, &cosine, &standing, &[], &ELLIPSE, 128);
        assert_eq!(told, Err(NonlinearityError::TooLittle.into()));
        // Steps of 0.04°, two samples each.
        reference.iter_mut().for_each(|angle| *angle = (*angle / 0.04).floor() * 0.04);
        let told = Revolution::from_samples(&sine, &cosine, &reference, &[], &ELLIPSE, 128).unwrap();
        assert!((told.raw.integral_deg - 0.02).abs() < 2e-3, "{}", told.raw.integral_deg);
        for (reference, periods) in [(vec![f64::NAN; 9], 128), (vec![1.0; 9], 0)] {
            let told = Revolution::from_samples(&sine, &cosine, &reference, &[], &ELLIPSE, periods);
            assert_eq!(told, Err(NonlinearityError::NotFinite.into()));
        }
        assert!(Revolution::from_samples(&[], &[], &[], &[], &ELLIPSE, 128).is_err());
    }
}
