//! Tests that injected errors are found, and that other deviations are not mistaken for errors.

use super::*;
use crate::analysis::ellipse::{FitError, SignalChannel};
use crate::analysis::signal_analysis::{Analysis, AnalysisError};

const CIRCLE: Ellipse =
    Ellipse { amplitude_v: 0.5, offset_cosine_v: 0.0, offset_sine_v: 0.0, gain_ratio: 1.0, phase_error_rad: 0.0 };

const REFERENCE: Ellipse = Ellipse {
    amplitude_v: 0.5,
    offset_cosine_v: 0.02,
    offset_sine_v: -0.03,
    gain_ratio: 1.05,
    phase_error_rad: 0.052_359_877_559_829_89, // 3°
};

struct Made {
    time: Vec<f64>,
    sine: Vec<f64>,
    cosine: Vec<f64>,
}

/// Returns samples of a motion whose angle is disturbed, in radians. `motion` converts a fraction of the time to
/// periods.
fn made(ellipse: &Ellipse, count: usize, motion: impl Fn(f64) -> f64, disturbed: impl Fn(f64) -> f64) -> Made {
    let time: Vec<f64> = (0..count).map(|at| at as f64 / count as f64).collect();
    let angle = |t: &f64| TAU * motion(*t);
    let (sine, cosine) = time.iter().map(|t| ellipse.point_at(angle(t) + disturbed(angle(t)))).unzip();
    Made { time, sine, cosine }
}

impl Made {
    fn add_noise(mut self, rms: f64, seed: u64) -> Self {
        let mut random = fastrand::Rng::with_seed(seed);
        for value in self.sine.iter_mut().chain(&mut self.cosine) {
            // The sum of twelve uniformly distributed numbers has a variance of 1.
            *value += rms * ((0..12).map(|_| random.f64()).sum::<f64>() - 6.0);
        }
        self
    }

    fn analysed(&self) -> Result<Analysis, AnalysisError> {
        Analysis::from_samples(Samples { time_s: &self.time, sine_v: &self.sine, cosine_v: &self.cosine })
    }
}

/// Peak-to-peak values of the raw error match section 6, in electrical degrees.
#[test]
fn raw_errors_match_section_6() {
    let rows = [
        ("sine offset 1 %", Ellipse { offset_sine_v: 0.005, ..CIRCLE }, 1.1459),
        ("both offsets 1 %", Ellipse { offset_sine_v: 0.005, offset_cosine_v: 0.005, ..CIRCLE }, 1.6206),
        ("gain 1 %", Ellipse { gain_ratio: 1.01, ..CIRCLE }, 0.5701),
        ("gain 10 %", Ellipse { gain_ratio: 1.1, ..CIRCLE }, 5.4588),
        ("phase 1°", Ellipse { phase_error_rad: 1.0_f64.to_radians(), ..CIRCLE }, 1.0),
    ];
    for (label, ellipse, expected) in rows {
        for periods in [1.0, 3.7, -2.5, 400.0] {
            let told = made(&ellipse, 8000, |t| 0.1 + periods * t, |_| 0.0).analysed().unwrap();
            // The largest of 720 points is below the peak by at most a few parts in 1e5.
            assert!(
                (told.error.raw_peak_to_peak_deg() - expected).abs() < 2e-4,
                "{label}: {}",
                told.error.raw_peak_to_peak_deg()
            );
            assert!(told.error.corrected_pp_deg < 1e-6, "{label}: {:?}", told.error.corrected_pp_deg);
            assert!(matches!(told.error.basis, ErrorBasis::Motion { .. }), "{label}, {periods} periods");
        }
    }
    let offset = made(&rows[0].1, 1000, |t| t, |_| 0.0).analysed().unwrap();
    let [first, second, ..] = harmonic_amplitudes(&offset.error.raw_deg);
    assert!((first - 0.573).abs() < 1e-4 && second < 0.003, "{first} {second}");
}

/// The error of the ellipse in section 7 is 353.9708° − 360° at 0°. Its peak-to-peak value of 9.97087° was computed
/// with Python at 720 angles.
#[test]
fn corrects_reference_error() {
    let told = made(&REFERENCE, 360, |t| t, |_| 0.0).analysed().unwrap();
    let by_points = (0..720).map(|at| {
        let angle = f64::from(at).to_radians() / 2.0;
        let (y, x) = (
            (0.5 * angle.sin() * REFERENCE.phase_error_rad.cos() - 0.5 * angle.cos() * REFERENCE.phase_error_rad.sin())
                / 1.05
                - 0.03,
            0.5 * angle.cos() + 0.02,
        );
        ((y.atan2(x) - angle).to_degrees() + 180.0).rem_euclid(360.0) - 180.0
    });
    let (low, high) = by_points.fold((f64::MAX, f64::MIN), |(low, high), value| (low.min(value), high.max(value)));
    assert!(
        (told.error.raw_peak_to_peak_deg() - (high - low)).abs() < 1e-6,
        "{} {}",
        told.error.raw_peak_to_peak_deg(),
        high - low
    );
    assert!((high - low - 9.970_872_586_9).abs() < 1e-9 && (low + 7.6606).abs() < 2e-4, "{low}");
    assert!(told.error.corrected_pp_deg < 1e-9);
}

/// An angle error of 0.3° at the fourth harmonic appears in both the raw and the corrected curve. The noise of 1 mV in
/// 0.5 V is 0.115° per sample, which changes an amplitude determined from n samples by 0.115°·√(2/n).
#[test]
fn does_not_correct_harmonics() {
    for (count, periods) in [(2000, 1.0), (5000, 17.3), (200_000, 999.0)] {
        let amplitude = 0.3_f64.to_radians();
        // Over a single period, acceleration cannot be distinguished from an error, so that motion is uniform.
        let motion = |t: f64| periods * t + if periods > 2.0 { 0.1 * t * t } else { 0.0 };
        let capture = made(&REFERENCE, count, motion, |angle| amplitude * (4.0 * angle).sin()).add_noise(1e-3, 3);
        let told = capture.analysed().unwrap();
        let left = harmonic_amplitudes(&told.error.corrected_deg);
        assert!((left[3] - 0.3).abs() < 0.03, "{count}: {left:?}");
        assert!(left.iter().enumerate().all(|(at, value)| at == 3 || *value < 0.05), "{count}: {left:?}");
        assert!((told.error.corrected_pp_deg - 0.6).abs() < 0.1, "{count}: {}", told.error.corrected_pp_deg);
        let ErrorBasis::Motion { noise_deg } = told.error.basis else { panic!("{count}: {:?}", told.error.basis) };
        assert!((noise_deg - 0.115).abs() < 0.02, "{count}: {noise_deg}");
        assert!((told.coverage.residual_rms - 0.002).abs() < 3e-4, "{count}: {}", told.coverage.residual_rms);
    }
}

#[test]
fn uneven_motion_causes_no_error() {
    let there_and_back = made(&REFERENCE, 5000, |t| 3.0 * (TAU * t).sin(), |_| 0.0).add_noise(1e-3, 4);
    let told = there_and_back.analysed().unwrap();
    assert_eq!(told.error.basis, ErrorBasis::Ellipse);
    assert!(told.error.corrected_pp_deg < 0.5, "{}", told.error.corrected_pp_deg);
    assert!((told.coverage.periods - 6.0).abs() < 0.01);
    let six = made(&REFERENCE, 6, |t| t, |_| 0.0).analysed().unwrap();
    assert!(six.error.corrected_pp_deg < 1e-9 && six.error.raw_peak_to_peak_deg() > 9.0);
    assert!((six.coverage.periods - 5.0 / 6.0).abs() < 1e-12);
}

#[test]
fn assumes_even_spacing_without_times() {
    let mut capture = made(&REFERENCE, 500, |t| 2.5 * t, |_| 0.0);
    capture.time.fill(0.0);
    let told = capture.analysed().unwrap();
    assert!(told.error.corrected_pp_deg < 1e-6);
    assert_eq!((told.duration_s, told.frequency_hz()), (None, None));
}

#[test]
fn rejects_partial_period() {
    let quarter = made(&REFERENCE, 500, |t| 0.03 + 0.3 * t, |_| 0.0);
    assert!(matches!(quarter.analysed(), Err(AnalysisError::Coverage { octants: 3 })), "{:?}", quarter.analysed());
    let resting = made(&REFERENCE, 500, |_| 0.2, |_| 0.0);
    assert_eq!(resting.analysed(), Err(AnalysisError::Fit(FitError::Constant)));
    let noise = resting.add_noise(1e-3, 5).analysed();
    assert_eq!(noise, Err(AnalysisError::AtRest));
    let mut dead = made(&REFERENCE, 500, |t| 3.0 * t, |_| 0.0);
    dead.sine.fill(0.0);
    let told = dead.add_noise(1e-3, 6).analysed();
    assert_eq!(told, Err(AnalysisError::Fit(FitError::Dead(SignalChannel::Sine))));
}
