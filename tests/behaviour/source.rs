//! The virtual sine/cosine source and the analysis: the analysis must return the values set on the source.

use encoder_studio::analysis::SampleTime;
use encoder_studio::analysis::diagnosis::{Diagnosis, FindingKind, Record, diagnose};
use encoder_studio::analysis::nonlinearity::compute_nonlinearity;
use encoder_studio::analysis::position_error::Samples;
use encoder_studio::analysis::quality::Limits;
use encoder_studio::analysis::signal_analysis::{Analysis, AnalysisError};
use encoder_studio::analysis::wiring::{Wire, Wires};
use encoder_studio::sim::sine_cosine::{ReferenceLevel, Settings, Source};

/// Returns 1.5 s of a shaft that turns once per second, with 512 periods per revolution, sampled at 50 kHz.
fn recorded(settings: Settings) -> (Vec<f64>, Wires) {
    let settings = Settings { periods: 512.0, rate_hz: 50_000.0, ..settings };
    let source = Source::new(settings.validate().unwrap(), SampleTime::ORIGIN);
    let time = (0..75_000).map(|at| source.time(at).unwrap().seconds_since(SampleTime::ORIGIN)).collect();
    (time, source.samples_from(0, 75_000).unwrap())
}

fn diagnosed(settings: Settings) -> (Result<Analysis, AnalysisError>, Diagnosis) {
    let (time_s, wires) = recorded(settings);
    let (sine_v, cosine_v) = (wires.sine_v(), wires.cosine_v());
    let samples = Samples { time_s: &time_s, sine_v: &sine_v, cosine_v: &cosine_v };
    let analysis = Analysis::from_samples(samples);
    let references_v = Some((wires.refsin_v.as_slice(), wires.refcos_v.as_slice()));
    let record = Record { samples, references_v, periods: Some(512) };
    let told = diagnose(&record, analysis.as_ref(), &Limits::HIPERFACE);
    (analysis, told)
}

#[track_caller]
fn near(found: f64, expected: f64, tolerance: f64) {
    assert!((found - expected).abs() <= tolerance, "{found} instead of {expected}");
}

#[test]
fn recovers_parameters() {
    let (analysis, told) = diagnosed(Settings {
        amplitude_v: 0.48,
        offset_sine_v: 0.015,
        offset_cosine_v: -0.01,
        gain_ratio: 1.06,
        phase_error_deg: -2.5,
        speed_rpm: -60.0,
        ..Settings::default()
    });
    let ellipse = analysis.unwrap().ellipse;
    // Noise of 0.5 mV on 75 000 samples gives σ·√(2/n) = 2.6 µV. The limits are five times that, the relative ones as
    // fractions of 0.5 V.
    near(ellipse.amplitude_v, 0.48, 1.3e-5);
    near(ellipse.offset_sine_v, 0.015, 1.3e-5);
    near(ellipse.offset_cosine_v, -0.01, 1.3e-5);
    near(ellipse.gain_ratio, 1.06, 4e-5);
    near(ellipse.phase_error_deg(), -2.5, 0.003);
    assert_eq!(told.findings, []);
}

#[test]
fn diagnoses_each_injected_fault() {
    let base = Settings::default;
    type IsExpectedFinding = fn(&FindingKind) -> bool;
    let cases: [(&str, Settings, IsExpectedFinding); 10] = [
        ("hum", Settings { hum_v: 0.01, ..base() }, |what| {
            matches!(what, FindingKind::Hum { mains_hz: 50.0, common: true, .. })
        }),
        ("a drive", Settings { interference_v: 0.01, ..base() }, |what| {
            matches!(what, FindingKind::Interference { frequency_hz: 7_999.0..8_001.0, volts: 0.0098..0.0102, .. })
        }),
        ("noise", Settings { noise_v: 0.008, ..base() }, |what| {
            matches!(what, FindingKind::Noise { volts: 0.0078..0.0082, .. })
        }),
        ("a harmonic", Settings { third_harmonic_percent: 1.5, ..base() }, |what| {
            matches!(what, FindingKind::Harmonics { order: 4, share: 0.0145..0.0155 })
        }),
        ("modulation", Settings { modulation_percent: 5.0, ..base() }, |what| {
            matches!(what, FindingKind::Modulation { share: 0.049..0.051 })
        }),
        ("the level", Settings { level_v: 1.5, ..base() }, |what| {
            matches!(what, FindingKind::Level { wire: Wire::Refsin, .. })
        }),
        ("an offset", Settings { offset_sine_v: 0.04, ..base() }, |what| matches!(what, FindingKind::Limit(_))),
        ("an open wire", Settings { open_wire: Some(Wire::Cos), ..base() }, |what| {
            matches!(what, FindingKind::Dead { .. })
        }),
        (
            "an open wire of a pair",
            Settings {
                open_wire: Some(Wire::Refsin),
                references: ReferenceLevel::Complement,
                terminated: false,
                ..base()
            },
            |what| matches!(what, FindingKind::Half { .. }),
        ),
        ("no rotation", Settings { amplitude_v: 0.0, noise_v: 0.0, ..base() }, |what| {
            matches!(what, FindingKind::Still)
        }),
    ];
    for (label, settings, is_it) in cases {
        let (_, told) = diagnosed(settings);
        assert!(told.findings.first().is_some_and(|finding| is_it(&finding.kind)), "{label}: {told:?}");
    }
}

/// An eccentricity of 100″ is an integral nonlinearity of 100″. An offset of 1 % causes ±0.573 electrical degrees,
/// which are 4.03″ at 512 periods.
#[test]
fn eccentricity_is_inl_and_offset_is_dnl() {
    let settings = Settings { eccentricity_arcsec: 100.0, offset_sine_v: 0.005, noise_v: 0.0, ..Settings::default() };
    let (_, wires) = recorded(settings);
    let unwrapped = |angles: Vec<f64>, whole: f64| {
        let mut last = 0.0;
        let follow = |angle: &f64| {
            last += (angle - last + whole / 2.0).rem_euclid(whole) - whole / 2.0;
            last
        };
        angles.iter().map(follow).collect::<Vec<f64>>()
    };
    let angles = wires.sine_v().iter().zip(wires.cosine_v()).map(|(y, x)| y.atan2(x).to_degrees()).collect();
    let measured: Vec<f64> = unwrapped(angles, 360.0).iter().map(|angle| angle / 512.0).collect();
    let told = compute_nonlinearity(&measured, &unwrapped(wires.reference_deg, 360.0), 512).unwrap();
    near(told.integral_deg * 3_600.0, 100.0, 0.2);
    near(told.differential_deg * 3_600.0, 4.03, 0.05);
}
