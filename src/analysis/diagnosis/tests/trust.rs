//! Tests of captures with unreliable results.

use super::*;

fn found(made: &Made) -> Vec<FindingKind> {
    made.diagnosed().findings.iter().map(|finding| finding.kind).collect()
}

fn plain(_: f64, _: f64, signal: (f64, f64)) -> (f64, f64) {
    signal
}

fn analysed(made: &Made) -> Analysis {
    Analysis::from_samples(made.record().samples).unwrap()
}

#[test]
fn missing_samples_do_not_change_frequency() {
    let mut capture = made(|time| 2_000.0 * time, plain);
    for column in [&mut capture.time, &mut capture.sine, &mut capture.cosine] {
        // 2.12 ms are removed, which is not a whole number of periods.
        column.drain(10_000..10_212);
    }
    let finding = capture.finding_text();
    let FindingKind::Missing { gaps: 1, longest_s } = finding.kind else { panic!("{finding:?}") };
    near(longest_s, 213e-5, 1e-9);
    assert_eq!(finding.severity, Severity::Warning);
    near(analysed(&capture).frequency_hz().unwrap(), 2_000.0, 0.01);
}

#[test]
fn reports_backward_time_step() {
    let mut capture = made(|time| 2_000.0 * time, plain);
    let shift = capture.time[20_000];
    capture.time.iter_mut().skip(20_000).for_each(|time| *time -= shift);
    assert_eq!(found(&capture), [FindingKind::TimeGoesBack { sample: 20_000 }]);
    near(analysed(&capture).frequency_hz().unwrap(), 2_000.0, 0.01);
}

#[test]
fn reversing_shaft_has_mean_speed() {
    // The angle swings by 12 periods to both sides, eight times per second: 3.2 swings in 0.4 s.
    let capture = made(|time| 12.0 * (TAU * 8.0 * time).sin(), plain);
    assert_eq!(found(&capture), [FindingKind::Reversed { times: 6 }]);
    // There are 6 turning points. The path is 12 + 5·24 periods to the last one at −12, and then 23.413 back to
    // 12·sin(6.4π) = 11.413.
    near(analysed(&capture).frequency_hz().unwrap(), (12.0 + 5.0 * 24.0 + 23.413) / 0.399_99, 0.05);
}

#[test]
fn reports_too_few_samples_per_period() {
    for (hertz, followed) in [(20_000.0, true), (24_000.0, true), (26_000.0, false), (49_000.0, false)] {
        let capture = made(|time| hertz * time, plain);
        let found = found(&capture);
        assert_eq!(analysed(&capture).is_angle_tracked(), followed, "{hertz}");
        match found.as_slice() {
            [] => assert!(followed, "{hertz}"),
            [FindingKind::Coarse { step_deg }] => near(*step_deg, hertz / RATE * 360.0, 0.1),
            _ => panic!("{hertz}: {found:?}"),
        }
    }
}

#[test]
fn disturbance_makes_parameters_uncertain() {
    let uncertain = |what: &FindingKind| match what {
        FindingKind::Uncertain { share } => Some(*share),
        _ => None,
    };
    let hum = found(&made(steady, with_interference(0.05, 0.05, 50.0)));
    near(hum.iter().find_map(uncertain).unwrap(), 0.1, 2e-3);
    let two = found(&made(steady, with_interference(0.03, 0.0, 8_000.0)));
    near(two.iter().find_map(uncertain).unwrap(), 0.06, 1e-3);
    let little = found(&made(steady, with_interference(0.004, 0.0, 8_000.0)));
    assert!(!little.is_empty() && little.iter().find_map(uncertain).is_none(), "{little:?}");
}

#[test]
fn reports_harmful_correction() {
    // Harmonics in opposite phase: the deviation from the ellipse repeats twice per period, which looks like a gain
    // ratio of 1.04.
    let third =
        |_, angle: f64, (sine, cosine)| (sine - 0.01 * (3.0 * angle).sin(), cosine - 0.01 * (3.0 * angle).cos());
    let other =
        |_, angle: f64, (sine, cosine)| (sine + 0.01 * (3.0 * angle).sin(), cosine + 0.01 * (3.0 * angle).cos());
    for capture in [made(steady, third), made(steady, other)] {
        let found = found(&capture);
        let [FindingKind::HarmfulCorrection { raw_deg, corrected_deg }] = found.as_slice() else { panic!("{found:?}") };
        // The error is 0.02·sin 2θ, and the correction of the gain adds the same amount. Python yields 2.29° and 4.59°.
        near(*raw_deg, 2.29, 0.02);
        near(*corrected_deg, 4.59, 0.1);
    }
    let helps = made(steady, |_, _, (sine, cosine)| (sine + 0.02, cosine));
    assert!(!found(&helps).iter().any(|what| matches!(what, FindingKind::HarmfulCorrection { .. })));
}

#[test]
fn distinguishes_single_ended_columns_from_offset() {
    for amplitude in [0.5, 1.0] {
        let capture = made(steady, |_, _, (sine, cosine)| (2.5 + amplitude * sine, 2.6 + amplitude * cosine));
        let finding = capture.finding_text();
        let FindingKind::SingleEnded { sine_v, cosine_v } = finding.kind else { panic!("{finding:?}") };
        near(sine_v, 2.5, 1e-3);
        near(cosine_v, 2.6, 1e-3);
        let analysis = analysed(&capture);
        let again = capture.diagnosed().with_new_limits(Ok(&analysis), None, &Limits::TTK70);
        assert_eq!(again.findings.len(), 1, "{again:?}");
    }
    let offset = made(steady, |_, _, (sine, cosine)| (sine + 0.3, cosine));
    assert!(matches!(offset.finding_text().kind, FindingKind::Limit(OutOfLimits::OffsetSine(_))));
}

#[test]
fn reports_shaft_at_rest() {
    for periods in [0.0, 0.13, 0.5, 0.88] {
        let capture = made(|_| periods, plain);
        assert_eq!(Analysis::from_samples(capture.record().samples).unwrap_err(), AnalysisError::AtRest, "{periods}");
        assert_eq!(found(&capture), [FindingKind::AtRest]);
    }
    // Noise around zero may be an open cable.
    let capture = made(|_| 0.0, |_, _, _| (0.0, 0.0));
    assert_ne!(Analysis::from_samples(capture.record().samples).unwrap_err(), AnalysisError::AtRest);
}
