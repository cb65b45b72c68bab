//! Tests that compare the voltages with the tables in the reference and with results from Python.

use super::*;

/// Settings without noise.
fn noiseless_settings() -> Settings {
    Settings { noise_v: 0.0, ..Settings::default() }
}

fn source(settings: Settings) -> Source {
    Source::new(settings.validate().unwrap(), SampleTime::ORIGIN)
}

#[track_caller]
fn near(found: f64, expected: f64, tolerance: f64) {
    assert!((found - expected).abs() <= tolerance, "{found} instead of {expected}");
}

/// Voltages from section 7 of the reference for R = 0.5, p = 0.02, q = −0.03, r = 1.05 and α = 3°. At 10 rev/min and 60
/// Hz, the shaft turns by 1° per sample.
#[test]
fn samples_match_reference() {
    let source = source(Settings {
        periods: 1.0,
        speed_rpm: 10.0,
        rate_hz: 60.0,
        offset_sine_v: -0.03,
        offset_cosine_v: 0.02,
        gain_ratio: 1.05,
        phase_error_deg: 3.0,
        ..noiseless_settings()
    });
    let wires = source.samples_from(0, 361).unwrap();
    let cases = [
        (0, 0.520000, -0.054922),
        (40, 0.4030222, 0.2565786),
        (90, 0.020000, 0.445538),
        (180, -0.480000, -0.005078),
        (270, 0.020000, -0.505538),
        (360, 0.520000, -0.054922),
    ];
    for (degree, cosine, sine) in cases {
        // A sample takes 16 666 667 ns, so it exceeds a degree by 20 parts in 10⁹.
        near(wires.cosine_v()[degree], cosine, 1e-6);
        near(wires.sine_v()[degree], sine, 1e-6);
        assert_eq!((wires.refsin_v[degree], wires.refcos_v[degree]), (2.5, 2.5));
    }
    near(wires.reference_deg[40], 40.0, 1e-6);
}

#[test]
fn sample_ranges_are_reproducible_after_days() {
    let settings = Settings { interference_v: 0.01, hum_v: 0.02, speed_rpm: 1234.567, ..Settings::default() };
    let mut source = source(settings.clone());
    let whole = source.samples_from(0, 3000).unwrap();
    let part = source.samples_from(1234, 500).unwrap();
    assert_eq!(part.sin_v, whole.sin_v[1234..1734]);
    assert_eq!(part.refcos_v, whole.refcos_v[1234..1734]);
    // Ten days at 100 kHz. The expected values are calculated in whole numbers from the start.
    let days = 86_400_000_000;
    assert_eq!(source.time(days).unwrap(), SampleTime::from_nanoseconds(864_000_000_000_000));
    let turn = 1_234_567_i128 * 10_000 * i128::from(days) % 60_000_000_000_000;
    let late = source.samples_from(days, 1).unwrap();
    near(late.reference_deg[0], 360.0 * turn as f64 / 6e13, 1e-9);
    // Ten days are a whole number of periods of 8 kHz and 50 Hz, so the added signals are zero. The noise is 0.5 mV.
    let angle = TAU * (turn * 1024 % 60_000_000_000_000) as f64 / 6e13;
    near(late.sine_v()[0], 0.5 * angle.sin(), 0.003);
    source.change_settings(days, settings.validate().unwrap());
    assert_eq!(source.samples_from(days, 1).unwrap(), late, "a change to the same changes nothing");
}

#[test]
fn angle_is_continuous_across_settings() {
    // 60 rev/min at 1000 samples per second is 0.36° per sample.
    let slow = Settings { rate_hz: 1_000.0, ..noiseless_settings() };
    let mut source = source(slow.clone());
    let fast = Settings { speed_rpm: -600.0, rate_hz: 10_000.0, offset_cosine_v: 0.1, ..slow };
    source.change_settings(500, fast.clone().validate().unwrap());
    assert_eq!(source.settings(), Some(&fast));
    let wires = source.samples_from(499, 4).unwrap();
    for (found, expected) in wires.reference_deg.iter().zip([179.64, 180.0, 179.64, 179.28]) {
        near(*found, expected, 1e-9);
    }
    assert_eq!(source.time(500).unwrap(), SampleTime::from_nanoseconds(500_000_000));
    assert_eq!(source.time(501).unwrap(), SampleTime::from_nanoseconds(500_100_000));
    // Sample 500 is half a turn later, which is 512 whole periods, so the cosine is 1.
    near(wires.cosine_v()[1], 0.6, 1e-9);
    assert_eq!(source.samples_from(0, 10_000).unwrap().len(), 10_000);
    // Of two changes at the same sample, the later one applies. A change before the latest one replaces it at the same
    // sample.
    source.change_settings(500, Settings { speed_rpm: 0.0, ..fast.clone() }.validate().unwrap());
    source.change_settings(3, Settings { speed_rpm: 0.0, ..fast }.validate().unwrap());
    near(source.samples_from(9_000, 1).unwrap().reference_deg[0], 180.0, 1e-9);
}

#[test]
fn discards_old_changes() {
    let mut source = source(noiseless_settings());
    for at in 1..=200 {
        source.change_settings(at * 10, noiseless_settings().validate().unwrap());
    }
    assert_eq!(source.samples_from(100, 10), None);
    assert_eq!(source.time(0), None);
    assert_eq!(source.samples_from(1_990, 100).unwrap().len(), 100);
}

#[test]
fn noise_is_uncorrelated_between_wires() {
    let settings = Settings { amplitude_v: 0.0, noise_v: 0.01, ..Settings::default() };
    let wires = source(settings.clone()).samples_from(0, 40_000).unwrap();
    let columns = [&wires.sin_v, &wires.refsin_v, &wires.cos_v, &wires.refcos_v];
    let product = |a: &[f64], b: &[f64]| {
        a.iter().zip(b).map(|(a, b)| (a - 2.5) * (b - 2.5)).sum::<f64>() / 40_000.0 / (0.01 * 0.01 / 2.0)
    };
    for (at, column) in columns.iter().enumerate() {
        // The variance of 40 000 numbers scatters by √(2/40 000) = 0.7 %, and a correlation by 0.5 %. The limit is five
        // times as high.
        near(product(column, column), 1.0, 0.035);
        near(column.iter().sum::<f64>() / 40_000.0, 2.5, 5.0 * 0.01 / 40_000.0_f64.sqrt());
        for other in columns.iter().skip(at + 1) {
            near(product(column, other), 0.0, 0.025);
        }
        // The noise does not correlate with itself one sample later.
        near(product(&column[1..], &column[..39_999]), 0.0, 0.025);
    }
    let other = source(Settings { seed: 2, ..settings }).samples_from(0, 40_000).unwrap();
    near(product(&wires.sin_v, &other.sin_v), 0.0, 0.025);
}

#[test]
fn open_wire_follows_termination() {
    // A quarter of a period later, the sine is 0.5 V and the cosine is 0.
    let at = |open: Wire, terminated, references| {
        let settings = Settings {
            periods: 1.0,
            speed_rpm: 15.0,
            rate_hz: 10.0,
            open_wire: Some(open),
            terminated,
            references,
            ..noiseless_settings()
        };
        let wires = source(settings).samples_from(10, 1).unwrap();
        (wires.sine_v()[0], wires.sin_v[0], wires.refsin_v[0])
    };
    use ReferenceLevel::{Complement, Level};
    let cases = [
        (Wire::Sin, true, Level, (0.0, 2.5, 2.5)),
        (Wire::Refsin, true, Level, (0.0, 3.0, 3.0)),
        (Wire::Refsin, false, Level, (0.5, 3.0, 2.5)),
        (Wire::Sin, false, Complement, (0.25, 2.5, 2.25)),
        (Wire::Sin, true, Complement, (0.0, 2.25, 2.25)),
        (Wire::Refcos, true, Complement, (0.5, 2.75, 2.25)),
    ];
    for (wire, terminated, references, expected) in cases {
        let found = at(wire, terminated, references);
        near(found.0, expected.0, 1e-9);
        near(found.1, expected.1, 1e-9);
        near(found.2, expected.2, 1e-9);
    }
}

/// Expected values from Python: 0.5·(cos θ − 0.04·cos 3θ) and so on, at θ = 2π·(16·0.3 + 16·100/1296000·sin(2π·0.3))
/// and 0.3 turns, with the amplitude 1 + 0.1·cos(2π·0.3).
#[test]
fn simulates_harmonics_modulation_and_eccentricity() {
    let settings = Settings {
        periods: 16.0,
        speed_rpm: 60.0,
        rate_hz: 1_000.0,
        third_harmonic_percent: 4.0,
        modulation_percent: 10.0,
        eccentricity_arcsec: 100.0,
        ..noiseless_settings()
    };
    let wires = source(settings).samples_from(300, 1).unwrap();
    near(wires.sine_v()[0], -0.448_673_821, 1e-9);
    near(wires.cosine_v()[0], 0.169_058_171, 1e-9);
}

#[test]
fn only_hum_is_in_phase() {
    let settings = Settings { speed_rpm: 0.0, amplitude_v: 0.0, ..noiseless_settings() };
    // A quarter of a period takes 5 ms at 50 Hz and 31.25 µs at 8 kHz. Three samples of 10 µs are 0.24 of a period at 8
    // kHz.
    let hum = source(Settings { hum_v: 0.1, ..settings.clone() }).samples_from(500, 1).unwrap();
    near(hum.sine_v()[0], 0.1, 1e-12);
    near(hum.cosine_v()[0], 0.1, 1e-12);
    let drive = source(Settings { interference_v: 0.1, ..settings }).samples_from(3, 1).unwrap();
    near(drive.sine_v()[0], 0.1 * (TAU * 0.24).sin(), 1e-12);
    near(drive.cosine_v()[0], -0.05 * (TAU * 0.24).sin(), 1e-12);
}
