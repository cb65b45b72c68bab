//! Two captures of one signal, as with the drive off and on: what became worse.

use super::lines::Interference;
use super::{Diagnosis, Finding, LEAST_LINE, Severity, What, severity};

/// Noise or a line is more when it is more by this factor.
const MORE: f64 = 1.5;
/// And by this share of the amplitude, for noise.
const LEAST_NOISE: f64 = 0.001;
/// An amplitude is another when it differs by this share; from the second on it is a warning.
const AMPLITUDE: (f64, f64) = (0.02, 0.1);

/// What is worse in `after` than in `before`; nothing where that cannot be told.
pub fn compare(before: &Diagnosis, after: &Diagnosis) -> Vec<Finding> {
    let mut findings = Vec::new();
    let (Some(from_v), Some(to_v)) = (before.amplitude_v, after.amplitude_v) else { return findings };
    let changed = (to_v / from_v - 1.0).abs();
    if changed >= AMPLITUDE.0 {
        let severity = if changed >= AMPLITUDE.1 { Severity::Warning } else { Severity::Notice };
        findings.push(Finding { severity, what: What::AmplitudeChanged { from_v, to_v } });
    }
    let amplitude = to_v;
    if let (Some(from_v), Some(to_v)) = (before.noise_v, after.noise_v)
        && to_v >= MORE * from_v
        && to_v - from_v >= LEAST_NOISE * amplitude
    {
        findings.push(Finding { severity: severity(to_v / amplitude), what: What::NoiseRose { from_v, to_v } });
    }
    if let (Some(earlier), Some(later)) = (&before.interference, &after.interference) {
        let spacing = before.spacing_hz.unwrap_or(0.0).max(after.spacing_hz.unwrap_or(0.0));
        let found = later.iter().filter_map(|line| rose(line, earlier, spacing, amplitude));
        findings.extend(found);
    }
    findings.sort_by_key(|finding| std::cmp::Reverse(finding.severity));
    findings
}

fn rose(line: &Interference, earlier: &[Interference], spacing_hz: f64, amplitude: f64) -> Option<Finding> {
    let same = earlier.iter().filter(|other| (other.frequency_hz - line.frequency_hz).abs() <= 2.0 * spacing_hz);
    let from_v = same.map(|other| other.volts).fold(0.0, f64::max);
    let to_v = line.volts;
    if to_v < MORE * from_v || to_v - from_v < LEAST_LINE * amplitude {
        return None;
    }
    let (frequency_hz, common) = (line.frequency_hz, line.common);
    let what = What::InterferenceRose { frequency_hz, from_v, to_v, common };
    Some(Finding { severity: severity(to_v / amplitude), what })
}
