//! Comparison of two captures of the same signal, for example with the drive off and on. The result lists what has
//! become worse, what has merely changed, and what cannot be compared. Both captures must be diagnosed with the same
//! limits.

use std::mem::discriminant;

use super::lines::Interference;
use super::{Diagnosis, DiagnosisFinding, FindingKind, MIN_INTERFERENCE_FRACTION, OutOfLimits, Severity, severity};

#[derive(Clone, Debug, Default, PartialEq)]
pub struct DiagnosisChanges {
    /// Findings that are new or became worse, the most severe first.
    pub worse: Vec<DiagnosisFinding>,
    /// Findings that changed without becoming worse.
    pub changed: Vec<DiagnosisFinding>,
    /// Properties that cannot be compared.
    pub obstacles: Vec<ComparisonObstacle>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ComparisonObstacle {
    NoEllipseBefore,
    NoEllipseAfter,
    /// One of the captures has no spectrum, so hum, interference and noise cannot be compared.
    NoSpectrum,
}

/// Factor by which a disturbance must grow to be reported as an increase.
const DISTURBANCE_INCREASE: f64 = 1.5;
/// Factor by which the deviation of an ellipse parameter must grow to be reported as worse.
const LIMIT_EXCESS_INCREASE: f64 = 1.1;
/// Minimum noise increase that is reported, as a fraction of the amplitude.
const MIN_NOISE: f64 = 0.001;
/// Minimum relative change of an amplitude that is reported.
const AMPLITUDE: f64 = 0.02;

pub fn compare(before: &Diagnosis, after: &Diagnosis) -> DiagnosisChanges {
    let mut changes = DiagnosisChanges::default();
    let is_worse = |finding: &&DiagnosisFinding| is_worse(finding, before, after);
    changes.worse.extend(after.findings.iter().filter(is_worse));
    match (before.amplitude_v, after.amplitude_v) {
        (Some(from_v), Some(to_v)) => {
            if (to_v / from_v - 1.0).abs() >= AMPLITUDE {
                // An amplitude that left its limits is also listed among the worse findings.
                let what = FindingKind::AmplitudeChanged { from_v, to_v };
                changes.changed.push(DiagnosisFinding { severity: Severity::Notice, kind: what });
            }
            compare_disturbances(before, after, to_v, &mut changes);
        }
        (None, _) => changes.obstacles.push(ComparisonObstacle::NoEllipseBefore),
        (Some(_), None) => changes.obstacles.push(ComparisonObstacle::NoEllipseAfter),
    }
    changes.worse.sort_by_key(|finding| std::cmp::Reverse(finding.severity));
    changes
}

/// Compares noise and spectral lines by magnitude.
fn compare_disturbances(before: &Diagnosis, after: &Diagnosis, amplitude: f64, changes: &mut DiagnosisChanges) {
    let (Some(earlier), Some(later)) = (&before.interference, &after.interference) else {
        changes.obstacles.push(ComparisonObstacle::NoSpectrum);
        return;
    };
    if let (Some(from_v), Some(to_v)) = (before.noise_v, after.noise_v)
        && to_v >= DISTURBANCE_INCREASE * from_v
        && to_v - from_v >= MIN_NOISE * amplitude
    {
        let what = FindingKind::NoiseIncreased { from_v, to_v };
        changes.worse.push(DiagnosisFinding { severity: severity(to_v / amplitude), kind: what });
    }
    let spacing = before.spacing_hz.unwrap_or(0.0).max(after.spacing_hz.unwrap_or(0.0));
    changes.worse.extend(later.iter().filter_map(|line| increase_finding(line, earlier, spacing, amplitude)));
}

/// Returns whether a finding of the second capture is new, or greater than in the first capture.
fn is_worse(finding: &DiagnosisFinding, before: &Diagnosis, after: &Diagnosis) -> bool {
    match finding.kind {
        // Without an ellipse for comparison, only these kinds can be reported.
        FindingKind::Still
        | FindingKind::AtRest
        | FindingKind::Same
        | FindingKind::Dead { .. }
        | FindingKind::Level { .. } => {}
        _ if before.amplitude_v.is_none() => return false,
        // These findings are compared by magnitude.
        FindingKind::Hum { .. } | FindingKind::Interference { .. } | FindingKind::Noise { .. } => return false,
        // Consequences of other findings, and properties of the motion.
        FindingKind::Uncertain { .. } | FindingKind::Reversed { .. } => return false,
        // In the first capture, another finding may have explained the residual.
        FindingKind::Limit(OutOfLimits::Residual(_)) => {
            return match (before.residual, after.residual) {
                (Some(before), Some(after)) => after >= LIMIT_EXCESS_INCREASE * before,
                _ => false,
            };
        }
        _ => {}
    }
    let same = |other: &&DiagnosisFinding| is_same_or_worse(&other.kind, &finding.kind);
    let Some(earlier) = before.findings.iter().find(same) else { return true };
    let factor = if matches!(finding.kind, FindingKind::Limit(_) | FindingKind::Level { .. }) {
        LIMIT_EXCESS_INCREASE
    } else {
        DISTURBANCE_INCREASE
    };
    let comparable = discriminant(&earlier.kind) == discriminant(&finding.kind);
    finding.severity > earlier.severity
        || comparable && finding_magnitude(&finding.kind) >= factor * finding_magnitude(&earlier.kind)
}

/// Returns whether the earlier finding is of the same kind as the later one, or of a worse kind.
fn is_same_or_worse(earlier: &FindingKind, later: &FindingKind) -> bool {
    match (earlier, later) {
        (FindingKind::Limit(earlier), FindingKind::Limit(later)) => discriminant(earlier) == discriminant(later),
        (FindingKind::Half { .. }, FindingKind::Limit(OutOfLimits::Amplitude { .. } | OutOfLimits::GainRatio(_)))
        | (FindingKind::IntermittentContact { .. }, FindingKind::Spikes { .. }) => true,
        (
            FindingKind::Dead { channel: earlier, .. } | FindingKind::Half { channel: earlier, .. },
            FindingKind::Half { channel: later, .. },
        )
        | (FindingKind::Dead { channel: earlier, .. }, FindingKind::Dead { channel: later, .. })
        | (FindingKind::Clipping { channel: earlier, .. }, FindingKind::Clipping { channel: later, .. }) => {
            earlier == later
        }
        (FindingKind::Level { wire: earlier, .. }, FindingKind::Level { wire: later, .. }) => earlier == later,
        (earlier, later) => discriminant(earlier) == discriminant(later),
    }
}

fn finding_magnitude(what: &FindingKind) -> f64 {
    let beyond = |value: f64, (least, most): (f64, f64)| (least - value).max(value - most).max(0.0);
    match *what {
        FindingKind::Limit(OutOfLimits::Amplitude { volts, ok_v, .. }) => beyond(volts, ok_v),
        FindingKind::Limit(
            OutOfLimits::OffsetSine(value)
            | OutOfLimits::OffsetCosine(value)
            | OutOfLimits::PhaseError(value)
            | OutOfLimits::Residual(value),
        ) => value.abs(),
        FindingKind::Limit(OutOfLimits::GainRatio(ratio)) => ratio.ln().abs(),
        FindingKind::Level { volts, ok_v, .. } => beyond(volts, ok_v),
        FindingKind::Harmonics { share, .. } | FindingKind::Modulation { share } => share,
        FindingKind::Clipping { samples, .. } => samples,
        FindingKind::Spikes { count, .. } | FindingKind::IntermittentContact { count, .. } => count as f64,
        FindingKind::Missing { gaps, .. } => gaps as f64,
        FindingKind::Half { share, .. } => 1.0 / share,
        // Such a finding has no magnitude: only its presence counts.
        _ => f64::NAN,
    }
}

fn increase_finding(
    line: &Interference,
    earlier: &[Interference],
    spacing_hz: f64,
    amplitude: f64,
) -> Option<DiagnosisFinding> {
    let same = earlier.iter().filter(|other| (other.frequency_hz - line.frequency_hz).abs() <= 2.0 * spacing_hz);
    let from_v = same.map(|other| other.volts).fold(0.0, f64::max);
    let to_v = line.volts;
    if to_v < DISTURBANCE_INCREASE * from_v || to_v - from_v < MIN_INTERFERENCE_FRACTION * amplitude {
        return None;
    }
    let (frequency_hz, common) = (line.frequency_hz, line.common);
    let what = FindingKind::InterferenceIncreased { frequency_hz, from_v, to_v, common };
    Some(DiagnosisFinding { severity: severity(to_v / amplitude), kind: what })
}
