//! Detection of unreliable results: gaps in the times, a reversal, few samples per period, disturbed samples, and
//! columns recorded against ground.

use super::{DiagnosisFinding, FindingKind, OutOfLimits, Severity, WARNING_SHARE};
use crate::analysis::ellipse::Ellipse;
use crate::analysis::position_error::ErrorBasis;
use crate::analysis::signal_analysis::Analysis;

/// Range of the mean level, in volts, that identifies a single wire. The manual states 2.0 V to 3.0 V and 0.5 Vpp, and
/// the range adds a margin for signals outside their limits. See section 1 of the project's sine/cosine reference.
const WIRE_LEVEL_V: (f64, f64) = (1.5, 3.5);
const WIRE_AMPLITUDE_V: (f64, f64) = (0.1, 0.6);
/// Factor by which a correction must increase the error to be harmful. The increase must also exceed
/// `HARMFUL_EXCESS_DEG`.
const HARMFUL_FACTOR: f64 = 1.1;
const HARMFUL_EXCESS_DEG: f64 = 0.2;

pub(super) fn check_times(analysis: &Analysis, say: &mut dyn FnMut(Severity, FindingKind)) {
    if let Some(sample) = analysis.continuity.first_backward_sample {
        say(Severity::Warning, FindingKind::TimeGoesBack { sample });
    }
    if let Some(missing) = analysis.continuity.missing {
        say(Severity::Warning, FindingKind::Missing { gaps: missing.gaps, longest_s: missing.longest_s });
    }
    if !analysis.is_angle_tracked() {
        // An apparent reversal may add half a period to the true angle.
        say(Severity::Warning, FindingKind::Coarse { step_deg: analysis.step_deg });
    } else if analysis.coverage.reversals > 0 {
        say(Severity::Notice, FindingKind::Reversed { times: analysis.coverage.reversals });
    }
}

/// Checks whether the fit has mistaken harmonics for gain or phase errors, in which case the correction doubles the
/// harmonics. Only an error measured from the motion reveals this, because the distance from the ellipse contains
/// noise.
pub(super) fn check_correction(analysis: &Analysis, say: &mut dyn FnMut(Severity, FindingKind)) {
    let ErrorBasis::Motion { noise_deg } = analysis.error.basis else { return };
    let (raw_deg, corrected_deg) = (analysis.error.raw_peak_to_peak_deg(), analysis.error.corrected_pp_deg);
    if corrected_deg > HARMFUL_FACTOR * raw_deg && corrected_deg - raw_deg > HARMFUL_EXCESS_DEG.max(noise_deg) {
        say(Severity::Warning, FindingKind::HarmfulCorrection { raw_deg, corrected_deg });
    }
}

/// Returns the uncertainty of the ellipse, which is approximately the combined magnitude of all disturbances as a
/// fraction of the amplitude.
pub(super) fn uncertainty_finding(findings: &[DiagnosisFinding]) -> Option<FindingKind> {
    let share = |finding: &DiagnosisFinding| match finding.kind {
        FindingKind::Hum { share, .. }
        | FindingKind::Interference { share, .. }
        | FindingKind::Harmonics { share, .. } => Some(share),
        _ => None,
    };
    let squares = findings.iter().filter_map(share).filter(|share| *share >= WARNING_SHARE).map(|share| share * share);
    let share = squares.sum::<f64>().sqrt();
    (share > 0.0).then_some(FindingKind::Uncertain { share })
}

/// Reports whether SIN and COS were recorded against ground instead of against their references.
pub(super) fn detect_single_ended(ellipse: &Ellipse) -> Option<FindingKind> {
    let within = |value: f64, (least, most): (f64, f64)| (least..=most).contains(&value);
    let (sine_v, cosine_v) = (ellipse.offset_sine_v, ellipse.offset_cosine_v);
    let levels = [sine_v, cosine_v].iter().all(|level| within(*level, WIRE_LEVEL_V));
    let amplitudes = [ellipse.amplitude_v, ellipse.amplitude_sine_v()];
    let amplitudes = amplitudes.iter().all(|amplitude| within(*amplitude, WIRE_AMPLITUDE_V));
    (levels && amplitudes).then_some(FindingKind::SingleEnded { sine_v, cosine_v })
}

/// Returns whether a finding is explained by single-ended columns, which have half the amplitude and the wire's level
/// as their offset.
pub(super) fn is_caused_by_single_ended(found: &OutOfLimits) -> bool {
    matches!(found, OutOfLimits::Amplitude { .. } | OutOfLimits::OffsetSine(_) | OutOfLimits::OffsetCosine(_))
}
