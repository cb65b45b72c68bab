//! Diagnosis of a recorded signal: its faults and their likely causes, such as a broken wire, the cable screen, a drive
//! or the encoder's scale. The parameter limits are those of the encoder family (`quality`). Wiring faults are
//! recognised by the distribution of the samples, by spectral lines, and by effects that repeat with the period or the
//! revolution. See sections 1 and 2 of the project's sine/cosine reference.
//!
//! Thresholds without a source are assumptions (U) and are collected below.

mod compare;
mod finding;
mod lines;
mod shape;
mod trust;

pub use compare::{ComparisonObstacle, DiagnosisChanges, compare};
pub use finding::{DiagnosisFinding, FindingKind, Severity, StuckLevel};
pub use lines::Interference;

use super::ellipse::{FitError, SignalChannel};
use super::position_error::Samples;
use super::quality::{Limits, QualityFinding as OutOfLimits, Verdict, is_within};
use super::signal_analysis::{Analysis, AnalysisError};
use super::wiring::Wire;

/// Hum and interference below this fraction of the amplitude are not reported.
pub const MIN_INTERFERENCE_FRACTION: f64 = 0.002;
/// A disturbance of at least this fraction of the amplitude is a warning instead of a notice. It corresponds to an
/// error of 0.6 electrical degrees.
pub const WARNING_SHARE: f64 = 0.01;
/// Range of the amplitude ratio for which the weaker channel has probably lost one of its two wires.
const HALF_AMPLITUDE_RATIO: (f64, f64) = (0.4, 0.6);
/// Maximum voltage difference between two wires at the same level.
const SAME_LEVEL_TOLERANCE_V: f64 = 0.1;
/// Levels in volts: a wire below the first is shorted to ground, and a wire above the second to a supply.
const RAILS_V: (f64, f64) = (0.5, 4.5);
/// Fraction of samples excluded from the fit above which spikes are reported as a warning.
const SPIKE_WARNING_FRACTION: f64 = 1e-3;
/// Minimum number of consecutive outliers that indicate an intermittent contact. Fewer outliers count as a spike.
const INTERMITTENT_SAMPLES: usize = 16;
/// Thresholds of the amplitude modulation over a revolution, for a notice and for a warning.
const MODULATION: (f64, f64) = (0.03, 0.1);

/// Fraction of the residual's mean square that other findings must account for.
const EXPLAINED_FRACTION: f64 = 0.7;

#[derive(Clone, Copy, Debug)]
pub struct Record<'a> {
    pub samples: Samples<'a>,
    /// REFSIN and REFCOS in volts, if recorded.
    pub references_v: Option<(&'a [f64], &'a [f64])>,
    /// Signal periods per revolution, if known.
    pub periods: Option<u32>,
}

#[derive(Clone, Debug, Default, PartialEq)]
pub struct Diagnosis {
    /// Findings, most severe first.
    pub findings: Vec<DiagnosisFinding>,
    /// Peak amplitude of the cosine channel in volts, or `None` if no ellipse was fitted.
    pub amplitude_v: Option<f64>,
    /// RMS white noise of one channel in volts, if known.
    pub noise_v: Option<f64>,
    /// Spectral lines that are not harmonics of the signal, strongest first, including mains hum. The value is `None`
    /// if the samples are not evenly spaced or the capture is too short for a spectrum.
    pub interference: Option<Vec<Interference>>,
    /// Line spacing of the interference spectrum in hertz, if available.
    pub spacing_hz: Option<f64>,
    /// RMS distance of the samples from the ellipse as a fraction of the amplitude, if known.
    pub residual: Option<f64>,
    explained: bool,
}

/// Diagnoses a capture from its samples and the result of its analysis.
pub fn diagnose(record: &Record<'_>, analysis: Result<&Analysis, &AnalysisError>, limits: &Limits) -> Diagnosis {
    let mut diagnosis = Diagnosis::default();
    let mut say = |severity, what| diagnosis.findings.push(DiagnosisFinding { severity, kind: what });
    check_mean_levels(record.references_v.map(|(refsin, refcos)| (mean(refsin), mean(refcos))), limits, &mut say);
    match analysis {
        Err(error) => diagnose_without_ellipse(record, error, &mut say),
        Ok(analysis) => {
            let amplitude = analysis.ellipse.amplitude_v;
            check_ellipse_limits(analysis, limits, &mut say);
            let seen = lines::find_interference(&record.samples, analysis);
            let noise_v = seen.as_ref().map_or(analysis.coverage.residual_rms * amplitude, |seen| seen.noise_v);
            report_disturbances(amplitude, noise_v, seen.as_ref(), &mut say);
            let harmonics = shape::strongest_harmonic(&record.samples, analysis);
            let modulation =
                record.periods.and_then(|periods| shape::amplitude_modulation(&record.samples, analysis, periods));
            report_shape(record, analysis, harmonics, modulation, &mut say);
            trust::check_times(analysis, &mut say);
            trust::check_correction(analysis, &mut say);
            if let Some(what) = trust::uncertainty_finding(&diagnosis.findings) {
                diagnosis.findings.push(DiagnosisFinding { severity: Severity::Warning, kind: what });
            }
            let by_lines =
                seen.as_ref().map_or(0.0, |seen| (seen.radial_v2 + noise_v * noise_v) / (amplitude * amplitude));
            let by_shape = [harmonics.map(|(_, share)| share), modulation].into_iter().flatten();
            let explained = by_lines + by_shape.map(|share| share * share / 2.0).sum::<f64>();
            diagnosis.explained = explained >= EXPLAINED_FRACTION * analysis.coverage.residual_rms.powi(2);
            diagnosis.remove_explained_findings();
            diagnosis.residual = Some(analysis.coverage.residual_rms);
            diagnosis.amplitude_v = Some(amplitude);
            diagnosis.noise_v = Some(noise_v);
            diagnosis.spacing_hz = seen.as_ref().map(|seen| seen.spacing_hz);
            diagnosis.interference = seen.map(|seen| seen.lines);
        }
    }
    // The sort is stable: findings of equal severity keep their order.
    diagnosis.findings.sort_by_key(|finding| std::cmp::Reverse(finding.severity));
    diagnosis
}

impl Diagnosis {
    /// Returns the diagnosis with different limits. The samples are not needed: the findings that depend on limits are
    /// derived from the analysis and from the mean levels of REFSIN and REFCOS in volts.
    #[must_use]
    pub fn with_new_limits(
        &self,
        analysis: Result<&Analysis, &AnalysisError>,
        levels_v: Option<(f64, f64)>,
        limits: &Limits,
    ) -> Self {
        let mut diagnosis = self.clone();
        let depends = |what: &FindingKind| {
            matches!(
                what,
                FindingKind::Limit(_)
                    | FindingKind::Level { .. }
                    | FindingKind::Half { .. }
                    | FindingKind::SingleEnded { .. }
            )
        };
        diagnosis.findings.retain(|finding| !depends(&finding.kind));
        let mut say = |severity, what| diagnosis.findings.push(DiagnosisFinding { severity, kind: what });
        check_mean_levels(levels_v.map(|(sine, cosine)| (Some(sine), Some(cosine))), limits, &mut say);
        if let Ok(analysis) = analysis {
            check_ellipse_limits(analysis, limits, &mut say);
        }
        diagnosis.remove_explained_findings();
        diagnosis.findings.sort_by_key(|finding| std::cmp::Reverse(finding.severity));
        diagnosis
    }

    fn remove_explained_findings(&mut self) {
        if self.explained {
            self.findings.retain(|finding| !matches!(finding.kind, FindingKind::Limit(OutOfLimits::Residual(_))));
        }
    }
}

fn severity(share: f64) -> Severity {
    if share >= WARNING_SHARE { Severity::Warning } else { Severity::Notice }
}

/// Reports REFSIN and REFCOS if their mean levels, in volts, are outside their limits.
fn check_mean_levels(
    levels_v: Option<(Option<f64>, Option<f64>)>,
    limits: &Limits,
    say: &mut dyn FnMut(Severity, FindingKind),
) {
    let Some((refsin, refcos)) = levels_v else { return };
    let ok_v = limits.level_v;
    for (wire, level) in [(Wire::Refsin, refsin), (Wire::Refcos, refcos)] {
        if let Some(volts) = level
            && !is_within(volts, ok_v)
        {
            say(Severity::Warning, FindingKind::Level { wire, volts, ok_v });
        }
    }
}

/// Diagnoses samples to which no ellipse could be fitted. Their distribution still reveals the cause.
fn diagnose_without_ellipse(record: &Record<'_>, error: &AnalysisError, say: &mut dyn FnMut(Severity, FindingKind)) {
    match error {
        AnalysisError::AtRest => say(Severity::Warning, FindingKind::AtRest),
        AnalysisError::Fit(FitError::Constant) => say(Severity::Fault, FindingKind::Still),
        AnalysisError::Fit(FitError::Line) => say(Severity::Fault, FindingKind::Same),
        AnalysisError::Fit(FitError::Dead(channel)) => {
            say(Severity::Fault, FindingKind::Dead { channel: *channel, stuck: stuck_level(record, *channel) });
        }
        _ => {}
    }
}

fn stuck_level(record: &Record<'_>, channel: SignalChannel) -> StuckLevel {
    let references = record.references_v.unwrap_or_default();
    let (values, reference, wires) = match channel {
        SignalChannel::Sine => (record.samples.sine_v, references.0, (Wire::Sin, Wire::Refsin)),
        SignalChannel::Cosine => (record.samples.cosine_v, references.1, (Wire::Cos, Wire::Refcos)),
    };
    let difference = mean(values).unwrap_or(0.0);
    let level = mean(reference);
    // Both wires may be at ground if the pair is open at the encoder and the receiver has no bias.
    let wires = level.map(|level| [(wires.0, level + difference), (wires.1, level)]);
    let at = |is: fn(f64) -> bool| wires.and_then(|wires| wires.into_iter().find(|(_, level)| is(*level)));
    match (at(|level| level < RAILS_V.0), at(|level| level > RAILS_V.1)) {
        _ if difference.abs() <= SAME_LEVEL_TOLERANCE_V => StuckLevel::Together,
        (Some((wire, _)), _) => StuckLevel::Ground(wire),
        (None, Some((wire, _))) => StuckLevel::Supply(wire),
        (None, None) => StuckLevel::Apart(difference),
    }
}

/// Checks the ellipse against its limits. If a channel has lost a wire, deviations in amplitude and gain are attributed
/// to that.
fn check_ellipse_limits(analysis: &Analysis, limits: &Limits, say: &mut dyn FnMut(Severity, FindingKind)) {
    let ratio = analysis.ellipse.gain_ratio;
    let half = if is_within(1.0 / ratio, HALF_AMPLITUDE_RATIO) {
        Some((SignalChannel::Sine, 1.0 / ratio))
    } else if is_within(ratio, HALF_AMPLITUDE_RATIO) {
        Some((SignalChannel::Cosine, ratio))
    } else {
        None
    };
    if let Some((channel, share)) = half {
        say(Severity::Fault, FindingKind::Half { channel, share });
    }
    let single = trust::detect_single_ended(&analysis.ellipse);
    if let Some(what) = single {
        say(Severity::Fault, what);
    }
    for found in limits.check_ellipse(&analysis.ellipse, analysis.coverage.residual_rms) {
        if single.is_some() && trust::is_caused_by_single_ended(&found) {
            continue;
        }
        let explained = matches!(found, OutOfLimits::Amplitude { .. } | OutOfLimits::GainRatio(_));
        let severity = match found {
            OutOfLimits::Amplitude { verdict: Verdict::Fault, .. } => Severity::Fault,
            _ => Severity::Warning,
        };
        if half.is_none() || !explained {
            say(severity, FindingKind::Limit(found));
        }
    }
}

fn report_disturbances(
    amplitude: f64,
    noise_v: f64,
    seen: Option<&lines::SpectrumContent>,
    say: &mut dyn FnMut(Severity, FindingKind),
) {
    let lines = seen.map_or(&[][..], |seen| &seen.lines);
    for mains_hz in lines::MAINS_HZ {
        let of_it = || lines.iter().filter(|line| line.mains_hz == Some(mains_hz));
        if let Some(strongest) = of_it().next() {
            let volts = of_it().map(|line| line.volts * line.volts).sum::<f64>().sqrt();
            let share = volts / amplitude;
            say(severity(share), FindingKind::Hum { mains_hz, volts, share, common: strongest.common });
        }
    }
    for line in lines.iter().filter(|line| line.mains_hz.is_none()) {
        let Interference { frequency_hz, volts, common, .. } = *line;
        let share = volts / amplitude;
        say(severity(share), FindingKind::Interference { frequency_hz, volts, share, common });
    }
    let share = noise_v / amplitude;
    if share >= WARNING_SHARE && seen.is_some() {
        say(Severity::Warning, FindingKind::Noise { volts: noise_v, share });
    }
}

fn report_shape(
    record: &Record<'_>,
    analysis: &Analysis,
    harmonics: Option<(usize, f64)>,
    modulation: Option<f64>,
    say: &mut dyn FnMut(Severity, FindingKind),
) {
    if let Some((order, share)) = harmonics
        && share >= WARNING_SHARE
    {
        say(Severity::Warning, FindingKind::Harmonics { order, share });
    }
    for (channel, volts, samples) in shape::find_clipping(&record.samples, analysis) {
        say(Severity::Warning, FindingKind::Clipping { channel, volts, samples });
    }
    if let Some(share) = modulation
        && share >= MODULATION.0
    {
        let severity = if share >= MODULATION.1 { Severity::Warning } else { Severity::Notice };
        say(severity, FindingKind::Modulation { share });
    }
    if let Some(outliers) = &analysis.outliers {
        let many = outliers.count as f64 > SPIKE_WARNING_FRACTION * analysis.samples as f64;
        let severity = if many { Severity::Warning } else { Severity::Notice };
        if outliers.longest >= INTERMITTENT_SAMPLES {
            let (count, longest) = (outliers.count, outliers.longest);
            say(Severity::Fault, FindingKind::IntermittentContact { count, longest });
        } else {
            say(severity, FindingKind::Spikes { count: outliers.count, volts: outliers.farthest_v });
        }
    }
}

fn mean(values: &[f64]) -> Option<f64> {
    (!values.is_empty()).then(|| values.iter().sum::<f64>() / values.len() as f64)
}

#[cfg(test)]
mod tests;
