//! Tests with synthetic signals that are good or have a single fault.

use std::f64::consts::TAU;

use super::*;

mod trust;

const RATE: f64 = 100_000.0;
const COUNT: usize = 40_000;

/// A synthetic capture of sine and cosine with an amplitude of 0.5 V.
struct Made {
    time: Vec<f64>,
    sine: Vec<f64>,
    cosine: Vec<f64>,
    references: Option<(Vec<f64>, Vec<f64>)>,
    periods: Option<u32>,
}

/// Returns a synthetic capture of 40 000 samples over 0.4 s, with 0.5 mV of noise. `motion` converts seconds to
/// periods, and `disturbed` changes sine and cosine.
fn made(motion: impl Fn(f64) -> f64, disturbed: impl Fn(f64, f64, (f64, f64)) -> (f64, f64)) -> Made {
    let mut random = fastrand::Rng::with_seed(3);
    // The sum of four uniformly distributed numbers has a variance of a third.
    let mut noise = || 5e-4 * 3.0_f64.sqrt() * ((0..4).map(|_| random.f64()).sum::<f64>() - 2.0);
    let mut made = Made { time: vec![], sine: vec![], cosine: vec![], references: None, periods: None };
    for at in 0..COUNT {
        let time = at as f64 / RATE;
        let angle = TAU * motion(time);
        let (sine, cosine) = disturbed(time, angle, (0.5 * angle.sin(), 0.5 * angle.cos()));
        made.time.push(time);
        made.sine.push(sine + noise());
        made.cosine.push(cosine + noise());
    }
    made
}

/// A steady motion of 1234.5 periods per second.
fn steady(time: f64) -> f64 {
    1234.5 * time
}

fn with_interference(volts_sine: f64, volts_cosine: f64, hertz: f64) -> impl Fn(f64, f64, (f64, f64)) -> (f64, f64) {
    move |time, _, (sine, cosine)| {
        let wave = (TAU * hertz * time).sin();
        (sine + volts_sine * wave, cosine + volts_cosine * wave)
    }
}

impl Made {
    fn record(&self) -> Record<'_> {
        Record {
            samples: Samples { time_s: &self.time, sine_v: &self.sine, cosine_v: &self.cosine },
            references_v: self.references.as_ref().map(|(refsin, refcos)| (refsin.as_slice(), refcos.as_slice())),
            periods: self.periods,
        }
    }

    fn diagnosed(&self) -> Diagnosis {
        let record = self.record();
        diagnose(&record, Analysis::from_samples(record.samples).as_ref(), &Limits::HIPERFACE)
    }

    /// Returns the only finding, apart from a warning about uncertain parameters.
    #[track_caller]
    fn finding_text(&self) -> DiagnosisFinding {
        let mut found = self.diagnosed().findings;
        found.retain(|finding| !matches!(finding.kind, FindingKind::Uncertain { .. }));
        assert_eq!(found.len(), 1, "{found:?}");
        found[0]
    }
}

#[track_caller]
fn near(found: f64, expected: f64, tolerance: f64) {
    assert!((found - expected).abs() <= tolerance, "{found} instead of {expected}");
}

#[test]
fn good_signal_has_no_findings() {
    let uneven = |time: f64| steady(time) + 0.3 * (TAU * 20.5 * time).sin() + 0.02 * (TAU * 300.0 * time).sin();
    let plain = |_, _, signal| signal;
    let slow = |time: f64| 3.0 * time;
    let speeding = |time: f64| 100.0 * time + 4_000.0 * time * time;
    for (label, made, spectrum) in [
        ("steady", made(steady, plain), true),
        ("backwards", made(|time| -steady(time), plain), true),
        ("an uneven motion", made(uneven, plain), true),
        ("speeding up a little", made(|time| steady(time) + 50.0 * time * time, plain), true),
        ("speeding up", made(speeding, plain), true),
        ("nearly too fast", made(|time| 24_900.0 * time, plain), true),
        ("few periods", made(slow, plain), false),
    ] {
        let told = made.diagnosed();
        assert_eq!(told.findings, [], "{label}: {told:?}");
        near(told.noise_v.unwrap(), 5e-4, 5e-5);
        assert_eq!(told.interference.is_some(), spectrum, "{label}");
    }
}

#[test]
fn amplitude_modulation_is_not_interference() {
    // 16 periods per revolution: lines 77 Hz above and below the signal.
    let wobbling = |_, angle: f64, (sine, cosine)| {
        let amplitude = 1.0 + 0.04 * (angle / 16.0).cos();
        (sine * amplitude, cosine * amplitude)
    };
    let mut capture = made(steady, wobbling);
    assert_eq!(capture.diagnosed().interference, Some(vec![]));
    capture.periods = Some(16);
    let finding = capture.finding_text();
    let FindingKind::Modulation { share } = finding.kind else { panic!("{finding:?}") };
    assert_eq!(finding.severity, Severity::Notice);
    // Averaging over a 36th of a revolution reduces the modulation by a thousandth.
    near(share, 0.04, 3e-4);
    capture.periods = Some(2_000);
    // Less than a revolution does not reveal the modulation, so the distance from the ellipse is reported.
    let finding = capture.finding_text();
    assert!(matches!(finding.kind, FindingKind::Limit(OutOfLimits::Residual(_))), "{finding:?}");
}

#[test]
fn reports_interference_frequency_and_amplitude() {
    for (volts, severity) in [(0.02, Severity::Warning), (0.002, Severity::Notice)] {
        for hertz in [8_000.0, 8_003.7, 1_300.0, 21_234.5] {
            let finding = made(steady, with_interference(volts, -0.5 * volts, hertz)).finding_text();
            let FindingKind::Interference { frequency_hz, volts: found, share, common } = finding.kind else {
                panic!("{finding:?}")
            };
            near(frequency_hz, hertz, 0.5);
            // The noise changes the amplitude of a line by 2·0.5 mV·√(1.5/80 000) = 4 µV.
            near(found, volts, 4e-5);
            near(share, volts / 0.5, 1e-4);
            assert_eq!((finding.severity, common), (severity, false));
        }
    }
}

#[test]
fn finds_interference_at_changing_speed() {
    let finding =
        made(|time| 500.0 * time + 100.0 * time * time, with_interference(0.02, 0.015, 8_000.0)).finding_text();
    let FindingKind::Interference { frequency_hz, volts, common, .. } = finding.kind else { panic!("{finding:?}") };
    near(frequency_hz, 8_000.0, 0.5);
    near(volts, 0.02, 2e-4);
    assert!(common, "in phase and of nearly the same strength");
}

#[test]
fn reports_mains_hum_with_harmonics() {
    for mains in [50.0, 60.0] {
        let hum = |time: f64, _, (sine, cosine)| {
            let wave = 0.008 * (TAU * mains * time).sin() + 0.006 * (TAU * 3.0 * mains * time + 1.0).sin();
            (sine + wave, cosine + wave)
        };
        let finding = made(steady, hum).finding_text();
        let FindingKind::Hum { mains_hz, volts, share, common } = finding.kind else { panic!("{finding:?}") };
        assert_eq!((mains_hz, common, finding.severity), (mains, true, Severity::Warning));
        near(volts, 0.01, 5e-5);
        near(share, 0.02, 1e-4);
    }
    // Ten milliseconds cannot distinguish 50 Hz from the mean level.
    let mut short = made(steady, with_interference(0.01, 0.01, 50.0));
    for column in [&mut short.time, &mut short.sine, &mut short.cosine] {
        column.truncate(1_000);
    }
    assert!(!short.diagnosed().findings.iter().any(|finding| matches!(finding.kind, FindingKind::Hum { .. })));
}

#[test]
fn separates_noise_from_spectral_lines() {
    let mut random = fastrand::Rng::with_seed(9);
    let mut capture = made(steady, with_interference(0.02, 0.0, 8_000.0));
    for value in capture.sine.iter_mut().chain(&mut capture.cosine) {
        *value += 0.01 * 3.0_f64.sqrt() * ((0..4).map(|_| random.f64()).sum::<f64>() - 2.0);
    }
    let found = capture.diagnosed().findings;
    let noise = found.iter().find_map(|finding| match finding.kind {
        FindingKind::Noise { volts, share } => Some((finding.severity, volts, share)),
        _ => None,
    });
    let (severity, volts, share) = noise.unwrap();
    assert_eq!(severity, Severity::Warning);
    near(volts, 0.01, 2e-4);
    near(share, 0.02, 4e-4);
    assert_eq!(found.len(), 3, "the distance from the ellipse has no separate sentence: {found:?}");
}

#[test]
fn finds_third_harmonic_at_any_motion() {
    let third =
        |_, angle: f64, (sine, cosine)| (sine + 0.01 * (3.0 * angle).sin(), cosine - 0.01 * (3.0 * angle).cos());
    for made in [made(steady, third), made(|time| 30.0 * time * time, third)] {
        // With few periods of an uneven motion, the ellipse absorbs a part of the disturbance, which is also reported.
        let finding = made.diagnosed().findings[0];
        let FindingKind::Harmonics { order, share } = finding.kind else { panic!("{finding:?}") };
        assert_eq!((order, finding.severity), (4, Severity::Warning));
        near(share, 0.02, 2e-4);
    }
}

#[test]
fn reports_clipping_voltage() {
    let cut = |_, _, (sine, cosine): (f64, f64)| (sine, cosine.min(0.45));
    let mut capture = made(steady, cut);
    // A converter at its limit outputs no noise.
    capture.cosine.iter_mut().for_each(|value| *value = value.min(0.45));
    let found = capture.diagnosed().findings;
    let cut_off = found.iter().find_map(|finding| match finding.kind {
        FindingKind::Clipping { channel, volts, samples } => Some((channel, volts, samples)),
        _ => None,
    });
    let (channel, volts, samples) = cut_off.unwrap();
    assert_eq!(channel, SignalChannel::Cosine);
    near(volts, 0.45, 1e-9);
    // The signal is clipped for arccos(0.9)/π of the time. Samples within 0.2 % below the limit also count.
    near(samples, 0.1436, 0.003);
}

#[test]
fn diagnoses_broken_wires() {
    let dead = |level: f64| move |_, _, (sine, _): (f64, f64)| (sine, level);
    let with = |level: f64, refcos: f64| Made {
        references: Some((vec![2.5; COUNT], vec![refcos; COUNT])),
        ..made(steady, dead(level))
    };
    let cases = [
        ("open at a terminated receiver", made(steady, dead(0.0)), StuckLevel::Together),
        ("open elsewhere", made(steady, dead(-0.8)), StuckLevel::Apart(-0.8)),
        ("COS at ground", with(-2.4, 2.5), StuckLevel::Ground(Wire::Cos)),
        ("COS at 5 V", with(2.4, 2.5), StuckLevel::Supply(Wire::Cos)),
        ("REFCOS at ground", with(2.5, 0.0), StuckLevel::Ground(Wire::Refcos)),
        ("both together", with(0.0, 2.5), StuckLevel::Together),
    ];
    for (label, made, expected) in cases {
        let found = made.diagnosed().findings;
        let FindingKind::Dead { channel, stuck } = found[0].kind else { panic!("{label}: {found:?}") };
        assert_eq!((channel, found[0].severity), (SignalChannel::Cosine, Severity::Fault));
        match (stuck, expected) {
            (StuckLevel::Apart(found), StuckLevel::Apart(expected)) => near(found, expected, 1e-4),
            _ => assert_eq!(stuck, expected, "{label}"),
        }
    }
    let half = made(steady, |_, _, (sine, cosine)| (sine / 2.0, cosine)).finding_text();
    let FindingKind::Half { channel: SignalChannel::Sine, share } = half.kind else { panic!("{half:?}") };
    near(share, 0.5, 1e-3);
    let same = made(steady, |_, _, (sine, _)| (sine, -sine)).finding_text();
    assert_eq!(same, DiagnosisFinding { severity: Severity::Fault, kind: FindingKind::Same });
    let mut still = made(steady, |_, _, _| (0.0, 0.0));
    still.sine.fill(0.3);
    still.cosine.fill(-0.1);
    assert_eq!(still.finding_text(), DiagnosisFinding { severity: Severity::Fault, kind: FindingKind::Still });
}

#[test]
fn checks_reference_levels_against_family_limits() {
    let mut capture = made(steady, |_, _, signal| signal);
    capture.references = Some((vec![2.3; COUNT], vec![3.2; COUNT]));
    let finding = capture.finding_text();
    let FindingKind::Level { wire: Wire::Refcos, volts, ok_v: (2.0, 3.0) } = finding.kind else {
        panic!("{finding:?}")
    };
    near(volts, 3.2, 1e-9);
    let record = capture.record();
    let narrow = diagnose(&record, Analysis::from_samples(record.samples).as_ref(), &Limits::TTK70);
    assert_eq!(narrow.findings.len(), 2);
}

#[test]
fn spikes_are_not_interference() {
    let mut capture = made(steady, |_, _, signal| signal);
    (0..20).for_each(|at| capture.sine[2_000 * at + 77] = 2.0);
    let finding = capture.finding_text();
    let FindingKind::Spikes { count: 20, volts } = finding.kind else { panic!("{finding:?}") };
    assert!(volts > 1.0 && finding.severity == Severity::Notice);
    // One of the spikes is in this range.
    for at in 24_000..24_300 {
        (capture.sine[at], capture.cosine[at]) = (0.0, 0.0);
    }
    let kind = FindingKind::IntermittentContact { count: 319, longest: 300 };
    assert_eq!(capture.finding_text(), DiagnosisFinding { severity: Severity::Fault, kind });
}

#[test]
fn sorts_findings_by_severity() {
    let mut capture = made(steady, |_, _, (sine, cosine)| (0.84 * sine + 0.06, 0.84 * cosine));
    capture.sine[9] = 3.0;
    let severities: Vec<Severity> = capture.diagnosed().findings.iter().map(|finding| finding.severity).collect();
    assert_eq!(severities, [Severity::Warning, Severity::Warning, Severity::Notice]);
    let record = capture.record();
    let wide = diagnose(&record, Analysis::from_samples(record.samples).as_ref(), &Limits::AFS_AFM60);
    assert_eq!(wide.findings.len(), 2, "0.84 V is good there: {wide:?}");
}

#[test]
fn comparison_reports_worse_findings() {
    let off = made(steady, |_, _, signal| signal).diagnosed();
    let hum = |hum: f64, drive: f64, amplitude: f64| {
        made(steady, move |time, _, (sine, cosine)| {
            let hum = hum * (TAU * 50.0 * time).sin();
            let drive = drive * (TAU * 8_000.0 * time).sin();
            (amplitude * sine + hum + drive, amplitude * cosine + hum)
        })
        .diagnosed()
    };
    assert_eq!(compare(&off, &off), DiagnosisChanges::default());
    assert_eq!(compare(&hum(0.01, 0.02, 1.0), &off), DiagnosisChanges::default(), "what is gone is not worse");
    let on = compare(&hum(0.004, 0.0, 1.0), &hum(0.004, 0.02, 1.0)).worse;
    let [
        DiagnosisFinding {
            severity: Severity::Warning,
            kind: FindingKind::InterferenceIncreased { frequency_hz, from_v, to_v, common: false },
        },
    ] = on.as_slice()
    else {
        panic!("{on:?}")
    };
    near(*frequency_hz, 8_000.0, 0.5);
    assert_eq!(*from_v, 0.0);
    near(*to_v, 0.02, 5e-5);
    let mut noisy = made(steady, |_, _, signal| signal);
    let mut random = fastrand::Rng::with_seed(5);
    noisy.sine.iter_mut().chain(&mut noisy.cosine).for_each(|value| *value += 0.01 * (random.f64() - 0.5));
    let rose = compare(&off, &noisy.diagnosed()).worse;
    let [DiagnosisFinding { severity: Severity::Notice, kind: FindingKind::NoiseIncreased { to_v, .. } }] =
        rose.as_slice()
    else {
        panic!("{rose:?}")
    };
    // Uniformly distributed numbers over 10 mV have a standard deviation of 10/√12 mV.
    near(*to_v, (0.01 * 0.01 / 12.0 + 5e-4 * 5e-4_f64).sqrt(), 6e-5);
}

/// Returns a capture of an ellipse with the given amplitude, offset of the sine, and phase error in radians.
fn ellipse(amplitude: f64, offset: f64, phase: f64) -> Made {
    made(steady, move |_, angle, (_, cosine)| (amplitude * 0.5 * (angle - phase).sin() + offset, amplitude * cosine))
}

#[test]
fn amplitude_within_limits_is_not_worse() {
    let at = |amplitude| ellipse(amplitude, 0.0, 0.0).diagnosed();
    for (from, to, worse) in [(1.0, 0.95, 0), (0.8, 1.0, 0), (1.0, 0.8, 1), (0.8, 0.7, 1), (0.7, 0.8, 0)] {
        let changes = compare(&at(from), &at(to));
        assert_eq!(changes.worse.len(), worse, "{from} {to}: {changes:?}");
        let [DiagnosisFinding { severity: Severity::Notice, kind: FindingKind::AmplitudeChanged { from_v, to_v } }] =
            changes.changed.as_slice()
        else {
            panic!("{changes:?}")
        };
        near(*from_v, 0.5 * from, 1e-4);
        near(*to_v, 0.5 * to, 1e-4);
    }
}

#[test]
fn any_new_finding_counts_as_worse() {
    let good = made(steady, |_, _, signal| signal);
    let mut spikes = ellipse(1.0, 0.0, 0.0);
    (0..20).for_each(|at| spikes.sine[2_000 * at + 77] = 2.0);
    let mut contact = ellipse(1.0, 0.0, 0.0);
    for at in 24_000..24_300 {
        (contact.sine[at], contact.cosine[at]) = (0.0, 0.0);
    }
    let mut levels = ellipse(1.0, 0.0, 0.0);
    levels.references = Some((vec![2.5; COUNT], vec![3.2; COUNT]));
    let third =
        |_, angle: f64, (sine, cosine)| (sine + 0.01 * (3.0 * angle).sin(), cosine - 0.01 * (3.0 * angle).cos());
    let mut cut = made(steady, |_, _, signal| signal);
    cut.cosine.iter_mut().for_each(|value| *value = value.min(0.45));
    for (label, after) in [
        ("offset", ellipse(1.0, 0.05, 0.0)),
        ("phase", ellipse(1.0, 0.0, 0.12)),
        ("gain", made(steady, |_, _, (sine, cosine)| (0.96 * sine, 1.06 * cosine))),
        ("harmonics", made(steady, third)),
        ("clipping", cut),
        ("level", levels),
        ("spikes", spikes),
        ("contact", contact),
    ] {
        let after = after.diagnosed();
        assert!(!compare(&good.diagnosed(), &after).worse.is_empty(), "{label}: {after:?}");
        let back = compare(&after, &good.diagnosed());
        assert_eq!((back.worse, back.obstacles), (vec![], vec![]), "{label}");
    }
    let more = compare(&ellipse(1.0, 0.03, 0.0).diagnosed(), &ellipse(1.0, 0.06, 0.0).diagnosed());
    let [DiagnosisFinding { kind: FindingKind::Limit(OutOfLimits::OffsetSine(share)), .. }] = more.worse.as_slice()
    else {
        panic!("{more:?}")
    };
    near(*share, 0.12, 1e-3);
}

#[test]
fn reports_missing_comparisons() {
    let good = made(steady, |_, _, signal| signal).diagnosed();
    let mut timeless = ellipse(1.0, 0.0, 0.0);
    timeless.time.clear();
    let timeless = timeless.diagnosed();
    assert_eq!(compare(&good, &timeless).obstacles, [ComparisonObstacle::NoSpectrum]);
    assert_eq!(
        compare(&timeless, &good),
        DiagnosisChanges { obstacles: vec![ComparisonObstacle::NoSpectrum], ..DiagnosisChanges::default() }
    );
    let dead = made(steady, |_, _, (sine, _)| (sine, 0.0)).diagnosed();
    let died = compare(&good, &dead);
    assert_eq!(died.obstacles, [ComparisonObstacle::NoEllipseAfter]);
    assert!(matches!(died.worse.as_slice(), [DiagnosisFinding { kind: FindingKind::Dead { .. }, .. }]), "{died:?}");
    // The offset in the first capture is unknown.
    let mended = compare(&dead, &ellipse(1.0, 0.05, 0.0).diagnosed());
    assert_eq!(
        mended,
        DiagnosisChanges { obstacles: vec![ComparisonObstacle::NoEllipseBefore], ..DiagnosisChanges::default() }
    );
}

#[test]
fn applies_new_limits_without_samples() {
    let mut capture = ellipse(0.84, 0.03, 0.0);
    capture.references = Some((vec![2.25; COUNT], vec![2.5; COUNT]));
    let record = capture.record();
    let analysis = Analysis::from_samples(record.samples);
    let by = |limits| diagnose(&record, analysis.as_ref(), limits);
    let again = by(&Limits::HIPERFACE).with_new_limits(analysis.as_ref(), Some((2.25, 2.5)), &Limits::TTK70);
    assert_eq!(again, by(&Limits::TTK70));
    assert_ne!(again, by(&Limits::HIPERFACE));
    assert_eq!(again.with_new_limits(analysis.as_ref(), Some((2.25, 2.5)), &Limits::AFS_AFM60), by(&Limits::AFS_AFM60));
}

#[test]
fn diagnoses_empty_captures() {
    for (time, values) in [(vec![], vec![]), (vec![0.0], vec![0.1]), (vec![0.0; 9], vec![f64::NAN; 9])] {
        let record = Record {
            samples: Samples { time_s: &time, sine_v: &values, cosine_v: &values },
            references_v: Some((&[], &[])),
            periods: Some(0),
        };
        let told = diagnose(&record, Analysis::from_samples(record.samples).as_ref(), &Limits::HIPERFACE);
        assert_eq!(told, Diagnosis::default());
    }
    let mut capture = made(steady, |_, _, signal| signal);
    capture.periods = Some(0);
    capture.time.fill(1.0);
    assert_eq!((capture.diagnosed().findings, capture.diagnosed().interference), (vec![], None));
}
