//! Comparison of a capture with a second measurement of the same shaft. A reference encoder yields DNL and INL. An
//! absolute position yields its offset from the analogue position. See SICK 8010701, definitions of errors and forming
//! the absolute position, and sections 4 and 6 of the project's sine/cosine reference.

use super::quantities::{Quantity, Unit};
use crate::analysis::arctan::{Phase, from_voltages};
use crate::analysis::capture::Capture;
use crate::analysis::nonlinearity::{Deviation, Nonlinearity};
use crate::analysis::outliers::remaining_ranges;
use crate::analysis::revolution::{Revolution, RevolutionError};
use crate::analysis::signal_analysis::Analysis;
use crate::analysis::synchronise::{STEPS, measure_offset};
use crate::app::Text;
use crate::signals::state::TEXTS;

#[derive(Clone, Debug, PartialEq)]
pub struct Nonlinearities {
    pub raw: DeviationCurves,
    /// Values after the correction of offsets, gain ratio and phase error.
    pub corrected: DeviationCurves,
    /// Number of revolutions covered by the samples. The INL applies to a whole revolution if this is at least 1.
    pub revolutions: f64,
}

/// DNL and INL of the raw or the corrected signals.
#[derive(Clone, Debug, PartialEq)]
pub struct DeviationCurves {
    /// DNL in mechanical degrees, as a ± value.
    pub differential_deg: f64,
    /// INL in mechanical degrees, as a ± value.
    pub integral_deg: f64,
    /// Total deviation by reference angle, both in mechanical degrees. Each section of the curve is represented by its
    /// minimum and maximum.
    pub deviation: Vec<(f64, f64)>,
    /// Deviation averaged over a period, by reference angle. Both are in mechanical degrees.
    pub mean: Vec<(f64, f64)>,
}

/// The offset of an absolute position from the analogue position.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AbsoluteOffset {
    /// Mean lead of the absolute position over the analogue position, in 1/32 of a period.
    pub offset_steps: f64,
    /// Largest deviation of a single sample from the mean lead, in 1/32 of a period.
    pub farthest_steps: f64,
    pub samples: usize,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum OffsetError {
    NoSignal,
    Scattered,
}

impl OffsetError {
    pub fn text(self) -> Text {
        TEXTS.text(match self {
            OffsetError::NoSignal => "synchronise.no_signal",
            OffsetError::Scattered => "synchronise.scattered",
        })
    }
}

/// Number of sections into which a curve is divided for drawing.
const CURVE_SECTIONS: usize = 512;

/// Returns DNL and INL of a capture, or `None` if it has no reference angle.
pub(super) fn compute_nonlinearities(
    capture: &Capture,
    analysis: &Analysis,
    periods: u32,
) -> Option<Result<Nonlinearities, RevolutionError>> {
    let reference = capture.reference_deg.as_ref()?;
    let left_out = analysis.outliers.as_ref().map_or(&[][..], |outliers| &outliers.excluded_ranges);
    let revolution =
        Revolution::from_samples(&capture.sine_v, &capture.cosine_v, reference, left_out, &analysis.ellipse, periods);
    Some(revolution.map(|revolution| Nonlinearities {
        revolutions: revolution.raw.revolutions,
        raw: DeviationCurves::from_nonlinearity(&revolution.raw),
        corrected: DeviationCurves::from_nonlinearity(&revolution.corrected),
    }))
}

impl DeviationCurves {
    fn from_nonlinearity(nonlinearity: &Nonlinearity) -> Self {
        let (mut deviation, mut mean) = (Vec::new(), Vec::new());
        let whole = |own: &Deviation| own.differential_deg + own.integral_deg;
        for stretch in nonlinearity.curve.chunks(nonlinearity.curve.len().div_ceil(CURVE_SECTIONS).max(1)) {
            let least = stretch.iter().min_by(|a, b| whole(a).total_cmp(&whole(b)));
            let most = stretch.iter().max_by(|a, b| whole(a).total_cmp(&whole(b)));
            deviation.extend([least, most].into_iter().flatten().map(|own| (own.reference_deg, whole(own))));
            mean.extend(stretch.first().map(|own| (own.reference_deg, own.integral_deg)));
        }
        let Nonlinearity { differential_deg, integral_deg, .. } = *nonlinearity;
        DeviationCurves { differential_deg, integral_deg, deviation, mean }
    }
}

/// Returns DNL and INL for display, as ± values.
pub fn nonlinearity_quantities(nonlinearities: &Nonlinearities) -> Vec<Quantity> {
    const ARC_SECONDS: f64 = 3600.0;
    let plus_minus = |word, degrees: f64| {
        Quantity::new(word, degrees, 5, Unit::Degrees).with_secondary_value(degrees * ARC_SECONDS, 2, Unit::ArcSeconds)
    };
    vec![
        plus_minus("nonlinearity.dnl_raw", nonlinearities.raw.differential_deg),
        plus_minus("nonlinearity.dnl_corrected", nonlinearities.corrected.differential_deg),
        plus_minus("nonlinearity.inl_raw", nonlinearities.raw.integral_deg),
        plus_minus("nonlinearity.inl_corrected", nonlinearities.corrected.integral_deg),
        Quantity::new("nonlinearity.revolutions", nonlinearities.revolutions, 2, Unit::One),
    ]
}

/// Returns the offset of the absolute position in a capture, or `None` without an absolute position. Samples excluded
/// by the ellipse fit are ignored.
pub(super) fn absolute_offset(
    capture: &Capture,
    analysis: Option<&Analysis>,
) -> Option<Result<AbsoluteOffset, OffsetError>> {
    let absolute = capture.absolute.as_ref()?;
    let left_out = analysis.and_then(|own| own.outliers.as_ref()).map_or(&[][..], |outliers| &outliers.excluded_ranges);
    let count = absolute.len().min(capture.sine_v.len()).min(capture.cosine_v.len());
    let sample = |at: usize| -> Option<(u64, Phase)> {
        let steps = absolute.get(at)?.rem_euclid(STEPS as i64).unsigned_abs();
        Some((steps, from_voltages(*capture.sine_v.get(at)?, *capture.cosine_v.get(at)?)?))
    };
    let samples = || remaining_ranges(count, left_out).flatten().filter_map(sample);
    if samples().next().is_none() {
        return Some(Err(OffsetError::NoSignal));
    }
    let Some(offset_steps) = measure_offset(samples()) else { return Some(Err(OffsetError::Scattered)) };
    let off = |(steps, phase): (u64, Phase)| {
        let periods = (steps as f64 - offset_steps) / STEPS as f64 - phase.to_periods();
        (periods - periods.round()).abs() * STEPS as f64
    };
    let farthest_steps = samples().map(off).fold(0.0, f64::max);
    Some(Ok(AbsoluteOffset { offset_steps, farthest_steps, samples: samples().count() }))
}

#[cfg(test)]
mod tests {
    use std::f64::consts::TAU;

    use super::*;

    /// Returns a capture of 1.25 revolutions of 64 periods, with 1 % sine offset, an eccentricity of 0.01°, and an
    /// absolute position that is 3 steps ahead.
    fn capture() -> Capture {
        let count = 20_000;
        let turn = |at: i32| 1.25 * f64::from(at) / f64::from(count);
        let measured = |at: i32| 64.0 * (turn(at) + 0.01 / 360.0 * (TAU * turn(at)).sin());
        Capture {
            sine_v: (0..count).map(|at| 0.5 * (TAU * measured(at)).sin() + 0.005).collect(),
            cosine_v: (0..count).map(|at| 0.5 * (TAU * measured(at)).cos()).collect(),
            reference_deg: Some((0..count).map(|at| 360.0 * turn(at)).collect()),
            absolute: Some((0..count).map(|at| (32.0 * measured(at) + 3.0).floor() as i64 - 320).collect()),
            ..Capture::default()
        }
    }

    fn analysed(capture: &Capture) -> Analysis {
        let samples = crate::analysis::position_error::Samples {
            time_s: &capture.time_s,
            sine_v: &capture.sine_v,
            cosine_v: &capture.cosine_v,
        };
        Analysis::from_samples(samples).unwrap()
    }

    #[test]
    fn shows_nonlinearity_in_degrees_and_arcseconds() {
        let capture = capture();
        let analysis = analysed(&capture);
        let told = compute_nonlinearities(&capture, &analysis, 64).unwrap().unwrap();
        let list = nonlinearity_quantities(&told);
        // Section 6: an offset of 1 % causes ±0.573 electrical degrees, which is 32.23″ for 64 periods. 0.01° is 36″.
        for (at, seconds, tolerance) in [(0, 32.23, 0.2), (1, 0.0, 0.2), (2, 36.0, 0.2), (3, 36.0, 0.2)] {
            let (found, _, unit) = list[at].also.unwrap();
            assert!((found - seconds).abs() < tolerance && unit == Unit::ArcSeconds, "{:?}", list[at]);
        }
        assert!((list[4].value - 1.25).abs() < 0.02, "{:?}", list[4]);
        assert_eq!(told.raw.mean.len() * 2, told.raw.deviation.len());
        assert!(told.raw.mean.len() <= CURVE_SECTIONS && told.raw.mean.len() > CURVE_SECTIONS / 2);
        let most = told.raw.deviation.iter().map(|(_, deviation)| *deviation).fold(0.0, f64::max);
        // The extremes of both parts coincide somewhere. The mean of a sine over 1.25 turns is 1/(2.5·π).
        assert!((most - (0.01 * (1.0 - 0.127_324) + 0.573 / 64.0)).abs() < 2e-4, "{most}");
    }

    #[test]
    fn nonlinearity_requires_reference() {
        let mut capture = capture();
        let analysis = analysed(&capture);
        assert!(matches!(compute_nonlinearities(&capture, &analysis, 100), Some(Err(RevolutionError::Periods { .. }))));
        capture.reference_deg = None;
        assert_eq!(compute_nonlinearities(&capture, &analysis, 64), None);
    }

    #[test]
    fn absolute_position_leads_by_offset() {
        let mut capture = capture();
        let analysis = analysed(&capture);
        let told = absolute_offset(&capture, Some(&analysis)).unwrap().unwrap();
        // Rounding down subtracts half a step on average. An offset of 1 % shifts the phase by 0.57°, or 0.05 steps.
        assert!((told.offset_steps - 2.5).abs() < 0.01, "{told:?}");
        assert!((told.farthest_steps - 0.55).abs() < 0.02, "{told:?}");
        assert_eq!(told.samples, 20_000);
        let backwards = capture.absolute.as_ref().unwrap().iter().map(|steps| -steps).collect();
        capture.absolute = Some(backwards);
        assert_eq!(absolute_offset(&capture, None), Some(Err(OffsetError::Scattered)));
        capture.sine_v.fill(0.0);
        capture.cosine_v.fill(0.0);
        assert_eq!(absolute_offset(&capture, None), Some(Err(OffsetError::NoSignal)));
        capture.absolute = None;
        assert_eq!(absolute_offset(&capture, None), None);
    }
}
