//! Tests with captures that have outliers, and with captures that only appear to have them.

use std::f64::consts::TAU;

use super::*;
use crate::analysis::position_error::{ErrorBasis, Samples};
use crate::analysis::signal_analysis::{Analysis, AnalysisError};

const ELLIPSE: Ellipse =
    Ellipse { amplitude_v: 0.5, offset_cosine_v: 0.02, offset_sine_v: -0.03, gain_ratio: 1.05, phase_error_rad: 0.05 };

struct Made {
    sine: Vec<f64>,
    cosine: Vec<f64>,
}

/// Returns `count` samples over the given number of periods, with noise of the given standard deviation in volts.
fn made(count: usize, periods: f64, noise_v: f64) -> Made {
    let mut random = fastrand::Rng::with_seed(7);
    let mut noise = || noise_v * ((0..12).map(|_| random.f64()).sum::<f64>() - 6.0);
    let (sine, cosine) = (0..count)
        .map(|at| ELLIPSE.point_at(TAU * periods * at as f64 / count as f64))
        .map(|(sine, cosine)| (sine + noise(), cosine + noise()))
        .unzip();
    Made { sine, cosine }
}

impl Made {
    fn analysed(&self) -> Result<Analysis, AnalysisError> {
        Analysis::from_samples(Samples { time_s: &[], sine_v: &self.sine, cosine_v: &self.cosine })
    }

    #[track_caller]
    fn assert_ellipse_fits(&self, tolerance: f64) -> Outliers {
        let analysis = self.analysed().unwrap();
        let (found, put) = (analysis.ellipse, ELLIPSE);
        for (found, put) in [
            (found.amplitude_v, put.amplitude_v),
            (found.offset_cosine_v, put.offset_cosine_v),
            (found.offset_sine_v, put.offset_sine_v),
            (found.gain_ratio, put.gain_ratio),
            (found.phase_error_rad, put.phase_error_rad),
        ] {
            assert!((found - put).abs() < tolerance, "{analysis:?}");
        }
        analysis.outliers.unwrap()
    }
}

#[test]
fn excludes_single_spike() {
    let mut capture = made(360, 1.0, 0.0);
    capture.sine[100] = 5.0;
    let told = capture.assert_ellipse_fits(1e-9);
    assert_eq!((told.excluded_ranges.first(), told.count, told.longest), (Some(&(100..101)), 1, 1));
    // The sine changes from 0.45 V to 5 V. On the corrected circle, the change is multiplied by r/cos α and points
    // mostly outward.
    assert!(told.farthest_v > 4.0 && told.farthest_v < 5.2, "{told:?}");
    let (raw, _) = told.all.expect("the ellipse through all of them is there to be seen");
    assert!((raw.amplitude_v - 0.5).abs() > 0.01, "{raw:?}");
}

/// With 1 mV of noise on 100 000 samples, a parameter scatters by 1 mV·√(2/100 000) = 4.5 µV. Relative to 0.5 V, r and
/// α scatter by twice this value. The limits are six times the scatter.
#[test]
fn spikes_do_not_change_long_fit() {
    let mut capture = made(100_000, 100.0, 1e-3);
    for at in 0..40 {
        capture.cosine[at * 2_399 + 17] += if at % 2 == 0 { 0.4 } else { -3.0 };
    }
    // A contact that opens for 30 samples, and sparks at both ends of the capture.
    for at in (50_000..50_030).chain([0, 99_999]) {
        (capture.sine[at], capture.cosine[at]) = (0.0, 0.0);
    }
    let told = capture.assert_ellipse_fits(6.0 * 1.8e-5);
    // Some sparks move the sample along the ellipse instead of away from it.
    assert!(told.count <= 72 && told.count >= 66, "{}", told.count);
    assert_eq!(told.longest, 30);
    assert_eq!((told.excluded_ranges.first(), told.excluded_ranges.last()), (Some(&(0..1)), Some(&(99_999..100_000))));
    let analysis = capture.analysed().unwrap();
    assert!((analysis.coverage.periods - 100.0).abs() < 0.01, "{:?}", analysis.coverage);
    assert!((analysis.coverage.residual_rms - 0.002).abs() < 0.0002, "{:?}", analysis.coverage);
    assert!(matches!(analysis.error.basis, ErrorBasis::Motion { .. }), "{:?}", analysis.error.basis);
    // Noise of 1 mV in 0.5 V corresponds to 0.11°. The remaining error is far smaller.
    assert!(analysis.error.corrected_pp_deg < 0.02, "{}", analysis.error.corrected_pp_deg);
    assert_eq!(analysis.samples, 100_000);
}

#[test]
fn finds_spike_despite_ruined_fit() {
    let mut capture = made(400, 3.0, 5e-4);
    for at in [3, 200, 201, 399] {
        (capture.sine[at], capture.cosine[at]) = (-80.0, 120.0);
    }
    let told = capture.assert_ellipse_fits(5e-4);
    assert_eq!(told.excluded_ranges, [3..4, 200..202, 399..400]);
}

#[test]
fn signal_samples_are_not_outliers() {
    let third = |share: f64| {
        let mut capture = made(20_000, 20.0, 5e-4);
        for (at, value) in capture.sine.iter_mut().enumerate() {
            *value += share * 0.5 * (3.0 * TAU * 20.0 * at as f64 / 20_000.0).sin();
        }
        capture
    };
    let mut often = made(20_000, 20.0, 5e-4);
    (0..20_000).step_by(10).for_each(|at| often.sine[at] += 0.3);
    let rest = |share: usize| {
        // The shaft is at rest and turns during the last part only.
        let (still, turning) = (made(100_000, 0.0, 5e-4), made(100_000 / share, 10.0, 5e-4));
        Made { sine: [still.sine, turning.sine].concat(), cosine: [still.cosine, turning.cosine].concat() }
    };
    let cases = [
        ("noise of 5 %", made(100_000, 33.0, 0.025)),
        ("a third harmonic of 10 %", third(0.1)),
        ("every tenth sample", often),
        ("it stood for most of the time", rest(30)),
        ("it stood for nearly all of the time", rest(1_000)),
        ("few points", made(49, 1.0, 0.0)),
    ];
    for (label, capture) in cases {
        let analysis = capture.analysed().unwrap_or_else(|error| panic!("{label}: {error}"));
        assert_eq!(analysis.outliers, None, "{label}");
    }
}

#[test]
fn spike_does_not_revive_dead_channel() {
    let mut capture = made(5_000, 5.0, 5e-4);
    capture.sine.iter_mut().for_each(|value| *value = 2e-4 * value.signum());
    capture.sine[2_345] = 4.0;
    assert_eq!(capture.analysed(), Err(FitError::Dead(SignalChannel::Sine).into()));
    // A spark does not make a working channel appear dead either.
    let mut capture = made(5_000, 5.0, 5e-4);
    capture.sine[2_345] = 40.0;
    assert_eq!(capture.assert_ellipse_fits(1e-4).count, 1);
}

#[test]
fn kept_ranges_complement_excluded_ranges() {
    type Ends = [(usize, usize)];
    let cases: [(usize, &Ends, &Ends); 4] = [
        (10, &[], &[(0, 10)]),
        (10, &[(0, 2), (5, 6), (8, 10)], &[(2, 5), (6, 8)]),
        (3, &[(0, 3)], &[]),
        (0, &[], &[]),
    ];
    for (length, left_out, expected) in cases {
        let left_out: Vec<Range<usize>> = left_out.iter().map(|(start, end)| *start..*end).collect();
        let found: Vec<(usize, usize)> =
            remaining_ranges(length, &left_out).map(|part| (part.start, part.end)).collect();
        assert_eq!(found, expected);
    }
}
