//! Tests of the fit with the values of section 7 of the reference, and with signals of known parameters.

use std::f64::consts::TAU;

use super::*;

const REFERENCE: Ellipse = Ellipse {
    amplitude_v: 0.5,
    offset_cosine_v: 0.02,
    offset_sine_v: -0.03,
    gain_ratio: 1.05,
    phase_error_rad: 0.052_359_877_559_829_89, // 3°
};

/// Returns samples of the model at evenly spaced angles, beginning at `start` periods.
fn signals(ellipse: &Ellipse, count: usize, start: f64, periods: f64) -> (Vec<f64>, Vec<f64>) {
    (0..count).map(|i| ellipse.point_at(TAU * (start + periods * i as f64 / count as f64))).unzip()
}

#[track_caller]
fn assert_close(found: &Ellipse, expected: &Ellipse, tolerance: f64) {
    let values = |e: &Ellipse| [e.amplitude_v, e.offset_cosine_v, e.offset_sine_v, e.gain_ratio, e.phase_error_rad];
    for (found, expected) in values(found).into_iter().zip(values(expected)) {
        assert!((found - expected).abs() <= tolerance, "{found} instead of {expected}");
    }
}

/// The coefficients of `Test` in section 7 were computed with Python.
#[test]
fn reference_coefficients_yield_ellipse() {
    let conic =
        ConicCoefficients { a: 4.032_438_057, b: 4.445_762_958, c: 0.443_187_154, d: -0.148_001_908, e: 0.257_882_034 };
    assert_close(&conic.to_ellipse().unwrap(), &REFERENCE, 1e-9);
}

#[test]
fn model_voltages_match_section_7() {
    let rows = [
        (0.0, 0.52, -0.054_922),
        (40.0, 0.403_022_2, 0.256_578_6),
        (90.0, 0.02, 0.445_538),
        (180.0, -0.48, -0.005_078),
        (270.0, 0.02, -0.505_538),
    ];
    for (degrees, x, y) in rows {
        let (sine, cosine) = REFERENCE.point_at(f64::to_radians(degrees));
        assert!((cosine - x).abs() < 5e-7 && (sine - y).abs() < 5e-7, "{degrees}: {cosine} {sine}");
    }
}

#[test]
fn fit_recovers_parameters() {
    for count in [360, 6] {
        let (sine, cosine) = signals(&REFERENCE, count, 0.0, 1.0);
        let found = Ellipse::fit(&sine, &cosine).unwrap();
        assert_close(&found, &REFERENCE, 1e-13);
        let correction = found.correction();
        for (i, (sine, cosine)) in sine.iter().zip(&cosine).enumerate() {
            let (y, x) = correction.apply(*sine, *cosine);
            let off = y.atan2(x).to_degrees() - 360.0 * i as f64 / count as f64;
            assert!(((off + 180.0).rem_euclid(360.0) - 180.0).abs() < 1e-11, "{i}: {off}");
            assert!((y.hypot(x) - 0.5).abs() < 1e-13);
        }
    }
}

/// For 1 mV rms of noise on 360 points, section 7 states deviations of 1e-5 V, 4e-5 V, 6e-4, 0.0083° and 1e-4 V. A
/// parameter fitted to n points scatters by about σ·√(2/n) = 7.5e-5 V. The limits are five times this value, and twice
/// as much for α and r.
#[test]
fn noise_shifts_parameters_as_predicted() {
    let mut random = fastrand::Rng::with_seed(7);
    for _ in 0..50 {
        let (mut sine, mut cosine) = signals(&REFERENCE, 360, random.f64(), 1.0);
        for value in sine.iter_mut().chain(&mut cosine) {
            // The sum of twelve uniformly distributed numbers has a variance of 1.
            *value += 1e-3 * ((0..12).map(|_| random.f64()).sum::<f64>() - 6.0);
        }
        let found = Ellipse::fit(&sine, &cosine).unwrap();
        let scatter = 1e-3 * (2.0 / 360.0_f64).sqrt();
        assert!((found.amplitude_v - 0.5).abs() < 5.0 * scatter, "{found:?}");
        assert!((found.offset_cosine_v - 0.02).abs() < 5.0 * scatter, "{found:?}");
        assert!((found.offset_sine_v + 0.03).abs() < 5.0 * scatter, "{found:?}");
        assert!((found.gain_ratio - 1.05).abs() < 20.0 * scatter, "{found:?}");
        assert!((found.phase_error_rad - REFERENCE.phase_error_rad).abs() < 20.0 * scatter, "{found:?}");
    }
}

#[test]
fn fit_is_independent_of_unit_and_offset() {
    // Converter counts, a signal of millivolts on 2.5 V, and ten thousand samples of a shaft at rest.
    let wide = Ellipse { amplitude_v: 31_000.0, offset_cosine_v: 32_768.0, offset_sine_v: 32_700.0, ..REFERENCE };
    let (sine, cosine) = signals(&wide, 1000, 0.0, 1.0);
    assert_close(&Ellipse::fit(&sine, &cosine).unwrap(), &wide, 1e-8);
    let small = Ellipse { amplitude_v: 0.002, offset_cosine_v: 2.5, offset_sine_v: 2.5, ..REFERENCE };
    let (sine, cosine) = signals(&small, 1000, 0.0, 3.7);
    assert_close(&Ellipse::fit(&sine, &cosine).unwrap(), &small, 1e-9);
    let (mut sine, mut cosine) = signals(&REFERENCE, 1000, 0.0, 1.0);
    sine.extend(vec![sine[100]; 10_000]);
    cosine.extend(vec![cosine[100]; 10_000]);
    assert_close(&Ellipse::fit(&sine, &cosine).unwrap(), &REFERENCE, 1e-10);
}

#[test]
fn chunked_fit_equals_single_fit() {
    let (sine, cosine) = signals(&REFERENCE, 20_000, 0.1, 12.3);
    let mut moments = Moments::new(super::super::moments::Scale::new(0.0, 0.0, 0.5));
    for (sine, cosine) in sine.chunks(333).zip(cosine.chunks(333)) {
        moments.add_samples(sine, cosine).unwrap();
    }
    assert_eq!(moments.count(), 20_000);
    assert_close(&Ellipse::from_moments(&moments).unwrap(), &REFERENCE, 1e-12);
}

#[test]
fn rejects_data_without_ellipse() {
    let (sine, cosine) = signals(&REFERENCE, 360, 0.0, 1.0);
    let zeros = vec![0.0; 360];
    let noisy: Vec<f64> = (0..360).map(|i| 1.25 + 0.001 * f64::from(i % 7)).collect();
    let minus: Vec<f64> = sine.iter().map(|value| 0.1 - 2.0 * value).collect();
    let square = |i: usize, quarter: usize| [0.5, 0.5, -0.5, -0.5][(i + quarter) % 4];
    let corners: (Vec<f64>, Vec<f64>) = (0..360).map(|i| (square(i, 0), square(i, 1))).unzip();
    let mut broken = sine.clone();
    broken[123] = f64::NAN;
    let mut endless = cosine.clone();
    endless[5] = f64::INFINITY;
    let arms: Vec<f64> = (0..360).map(|i| f64::from(i - 180) / 100.0).collect();
    let hyperbola: Vec<f64> = arms.iter().enumerate().map(|(i, t)| [1.0, -1.0][i % 2] * (1.0 + t * t).sqrt()).collect();
    let cases: [(&str, &[f64], &[f64], FitError); 13] = [
        ("nothing", &[], &[], FitError::TooFew { points: 0 }),
        ("five points", &sine[..5], &cosine[..5], FitError::TooFew { points: 5 }),
        ("one channel ends early", &sine[..4], &cosine, FitError::TooFew { points: 4 }),
        ("constant", &vec![1.3; 360], &vec![2.7; 360], FitError::Constant),
        ("no voltage", &zeros, &zeros, FitError::Constant),
        ("dead sine", &noisy, &cosine, FitError::Dead(SignalChannel::Sine)),
        ("dead cosine", &sine, &zeros, FitError::Dead(SignalChannel::Cosine)),
        ("the same twice", &sine, &sine, FitError::Line),
        ("the opposite", &sine, &minus, FitError::Line),
        ("four places", &corners.0, &corners.1, FitError::Ambiguous),
        ("not a number", &broken, &cosine, FitError::NotFinite { index: 123 }),
        ("infinite", &sine, &endless, FitError::NotFinite { index: 5 }),
        ("a hyperbola", &arms, &hyperbola, FitError::NotAnEllipse),
    ];
    for (label, sine, cosine, expected) in cases {
        assert_eq!(Ellipse::fit(sine, cosine), Err(expected), "{label}");
    }
}

#[test]
fn outline_encircles_center_once() {
    let ellipse = Ellipse {
        amplitude_v: 0.5,
        offset_cosine_v: 0.25,
        offset_sine_v: -0.125,
        gain_ratio: 2.0,
        phase_error_rad: 0.0,
    };
    let near = |points: Vec<(f64, f64)>, expected: [(f64, f64); 5]| {
        assert_eq!(points.len(), 5);
        for ((x, y), (own_x, own_y)) in points.into_iter().zip(expected) {
            assert!((x - own_x).abs() < 1e-12 && (y - own_y).abs() < 1e-12, "{x} {y}");
        }
    };
    near(ellipse.outline_points(4), [(0.75, -0.125), (0.25, 0.125), (-0.25, -0.125), (0.25, -0.375), (0.75, -0.125)]);
    near(ellipse.corrected_ellipse().outline_points(4), [(0.5, 0.0), (0.0, 0.5), (-0.5, 0.0), (0.0, -0.5), (0.5, 0.0)]);
}
