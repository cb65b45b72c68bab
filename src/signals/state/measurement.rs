//! A capture with all its results: analysis, diagnosis, spectra and Lissajous figures. A task computes them once.

use std::ops::Deref;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use super::{AbsoluteOffset, ExampleCapture, Nonlinearities, OffsetError, Spectra, reference_comparison};
use crate::analysis::capture::Capture;
use crate::analysis::diagnosis::{Diagnosis, Record, diagnose};
use crate::analysis::ellipse::EllipseCorrection;
use crate::analysis::lissajous::{PlotSquare, SampleDensity};
use crate::analysis::position_error::Samples;
use crate::analysis::quality::Family;
use crate::analysis::revolution::RevolutionError;
use crate::analysis::signal_analysis::{Analysis, AnalysisError};
use crate::analysis::spectrum::SpectrumError;
use crate::app::{Language, Text, explain};
use crate::signals::state::TEXTS;

#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Origin {
    Table(TableSource),
    Virtual,
    Adapter { name: String, is_virtual: bool },
}

#[derive(Clone, Debug, PartialEq, Eq)]
pub enum TableSource {
    File(PathBuf),
    Example(ExampleCapture),
}

impl Origin {
    /// Returns the name for display. Only the file name of a path is shown.
    pub fn name(&self) -> Text {
        match self {
            Origin::Virtual => TEXTS.text("signals.virtual"),
            Origin::Adapter { is_virtual: true, .. } => TEXTS.text("signals.virtual_adapter"),
            Origin::Adapter { name, .. } => TEXTS.text("signals.adapter").with("name", name),
            Origin::Table(place) => place.name(),
        }
    }
}

impl TableSource {
    /// Returns the file name without its folders.
    pub fn name(&self) -> Text {
        let path = self.path();
        let name = path.file_name().unwrap_or(path.as_os_str());
        explain::literal_text(name.to_string_lossy())
    }

    pub(super) fn path(&self) -> PathBuf {
        match self {
            TableSource::File(path) => path.clone(),
            TableSource::Example(example) => example.file_name().into(),
        }
    }
}

#[derive(Clone, Debug)]
pub struct Measurement {
    pub capture: Arc<Capture>,
    results: Arc<MeasurementResult>,
}

#[derive(Clone, Debug)]
pub struct MeasurementResult {
    pub origin: Origin,
    /// Number of table rows skipped because they contain no value.
    pub rows_left_out: u64,
    pub analysis: Result<Analysis, AnalysisError>,
    pub diagnosis: Diagnosis,
    pub diagnosis_settings: DiagnosisSettings,
    /// Mean voltages of REFSIN and REFCOS, if recorded.
    pub levels_v: Option<(f64, f64)>,
    /// Spectra of both channels, or the reason why they cannot be determined.
    pub spectra: Result<Spectra, SpectrumError>,
    /// DNL and INL, or the reason why they cannot be determined. `None` without a reference angle, a fitted ellipse or
    /// the number of periods.
    pub nonlinearities: Option<Result<Nonlinearities, RevolutionError>>,
    /// How far the absolute position is ahead of the analogue position, or the reason why this cannot be determined.
    /// `None` without an absolute position.
    pub absolute_offset: Option<Result<AbsoluteOffset, OffsetError>>,
    /// Lissajous figure of all samples, or `None` if the values are too large.
    pub raw: Option<SampleDensity>,
    /// Lissajous figure of all samples after the ellipse correction, or `None` without a fitted ellipse.
    pub corrected: Option<SampleDensity>,
}

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct DiagnosisSettings {
    pub family: Family,
    /// Signal periods per revolution, if known.
    pub periods: Option<u32>,
}

/// Cells along each side of a Lissajous figure with many samples.
const CELLS: usize = 240;
const FEW_SAMPLES_CELLS: usize = 120;
/// Maximum number of samples for which a Lissajous figure has larger cells. Single samples would be invisible in small
/// cells.
const FEW_SAMPLES: usize = 2_000;
/// Minimum voltage from the centre of a Lissajous figure to its edge. All limit circles fit into this range.
const MIN_HALF_V: f64 = 0.75;

impl Measurement {
    /// Analyses a capture. This takes about 100 ms for a million samples.
    pub fn from_capture(origin: Origin, capture: Arc<Capture>, diagnosis_settings: DiagnosisSettings) -> Self {
        let samples = capture_samples(&capture);
        let analysis = Analysis::from_samples(samples);
        let mean = |column: &[f64]| column.iter().sum::<f64>() / column.len().max(1) as f64;
        let results = MeasurementResult {
            diagnosis: diagnose_capture(&capture, &analysis, diagnosis_settings),
            diagnosis_settings,
            rows_left_out: capture.skipped_rows,
            levels_v: capture.references_v().map(|(sine, cosine)| (mean(sine), mean(cosine))),
            spectra: Spectra::from_samples(samples),
            nonlinearities: compare_with_reference(&capture, &analysis, diagnosis_settings),
            absolute_offset: reference_comparison::absolute_offset(&capture, analysis.as_ref().ok()),
            raw: sample_density(samples, None),
            corrected: analysis.as_ref().ok().and_then(|own| sample_density(samples, Some(own.ellipse.correction()))),
            analysis,
            origin,
        };
        Measurement { capture, results: Arc::new(results) }
    }

    pub fn results(&self) -> &Arc<MeasurementResult> {
        &self.results
    }

    #[must_use]
    pub fn with_settings(&self, diagnosis_settings: DiagnosisSettings) -> Self {
        let results = MeasurementResult {
            diagnosis: diagnose_capture(&self.capture, &self.analysis, diagnosis_settings),
            nonlinearities: compare_with_reference(&self.capture, &self.analysis, diagnosis_settings),
            diagnosis_settings,
            ..(*self.results).clone()
        };
        Measurement { capture: self.capture.clone(), results: Arc::new(results) }
    }
}

impl Deref for Measurement {
    type Target = MeasurementResult;

    fn deref(&self) -> &MeasurementResult {
        &self.results
    }
}

impl MeasurementResult {
    /// Returns the reason why the capture could not be analysed, if any.
    pub fn failure_text(&self, language: Language) -> Option<Text> {
        let error = self.analysis.as_ref().err()?;
        Some(explain::signal::analysis_error_text(Path::new(&self.origin.name().to_string_in(language)), error))
    }
}

fn capture_samples(capture: &Capture) -> Samples<'_> {
    Samples { time_s: &capture.time_s, sine_v: &capture.sine_v, cosine_v: &capture.cosine_v }
}

fn diagnose_capture(
    capture: &Capture,
    analysis: &Result<Analysis, AnalysisError>,
    diagnosis_settings: DiagnosisSettings,
) -> Diagnosis {
    let references_v = capture.references_v();
    let record = Record { samples: capture_samples(capture), references_v, periods: diagnosis_settings.periods };
    diagnose(&record, analysis.as_ref(), &diagnosis_settings.family.limits())
}

fn compare_with_reference(
    capture: &Capture,
    analysis: &Result<Analysis, AnalysisError>,
    diagnosis_settings: DiagnosisSettings,
) -> Option<Result<Nonlinearities, RevolutionError>> {
    reference_comparison::compute_nonlinearities(capture, analysis.as_ref().ok()?, diagnosis_settings.periods?)
}

/// Returns the Lissajous figure centred on zero, after the correction if one is given.
fn sample_density(samples: Samples<'_>, correction: Option<EllipseCorrection>) -> Option<SampleDensity> {
    /// Number of samples corrected at a time.
    const CHUNK_SAMPLES: usize = 1 << 14;
    let Samples { sine_v, cosine_v, .. } = samples;
    let most = sine_v.iter().chain(cosine_v).fold(0.0, |most: f64, volts| most.max(volts.abs()));
    // The scale changes in steps. A live image would otherwise change its size continuously.
    let half_v = ((most * 1.05 * 20.0).ceil() / 20.0).max(MIN_HALF_V);
    let side = if sine_v.len() > FEW_SAMPLES { CELLS } else { FEW_SAMPLES_CELLS };
    let mut density = SampleDensity::new(PlotSquare::centred_on_zero(half_v), side)?;
    let Some(correction) = correction else {
        density.add_samples(sine_v, cosine_v);
        return Some(density);
    };
    for (sine, cosine) in sine_v.chunks(CHUNK_SAMPLES).zip(cosine_v.chunks(CHUNK_SAMPLES)) {
        let pairs = sine.iter().zip(cosine).map(|(sine, cosine)| correction.apply(*sine, *cosine));
        let (sine, cosine): (Vec<f64>, Vec<f64>) = pairs.unzip();
        density.add_samples(&sine, &cosine);
    }
    Some(density)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn corrected_samples_form_circle() {
        let angle = |at: i32| f64::from(at) / 10_000.0 * std::f64::consts::TAU;
        let capture = Capture {
            sine_v: (0..10_000).map(|at| 0.3 * angle(at).sin() + 0.1).collect(),
            cosine_v: (0..10_000).map(|at| 0.5 * angle(at).cos() - 0.05).collect(),
            ..Capture::default()
        };
        let measurement = Measurement::from_capture(Origin::Virtual, Arc::new(capture), DiagnosisSettings::default());
        for density in [&measurement.raw, &measurement.corrected] {
            let density = density.as_ref().unwrap();
            assert_eq!(density.cell_counts().iter().sum::<u32>(), 10_000);
            assert_eq!((density.cells_per_side(), density.plot_square().half_v), (240, 0.75));
        }
        for lengths in measurement.corrected.as_ref().unwrap().vector_lengths() {
            assert!((lengths.least_v - 0.5).abs() < 1e-6 && (lengths.most_v - 0.5).abs() < 1e-6, "{lengths:?}");
        }
    }
}
