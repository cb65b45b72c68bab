//! A capture with all that is computed from it once, on a task: the analysis, the diagnosis, the spectra and the points of
//! its Lissajous figure.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use super::{Example, Spectra};
use crate::app::{Language, Text, explain};
use crate::signal::analysis::{Analysis, AnalysisError};
use crate::signal::capture::Capture;
use crate::signal::diagnosis::{Diagnosis, Record, diagnose};
use crate::signal::position_error::Samples;
use crate::signal::quality::Family;
use crate::signal::spectrum::SpectrumError;

/// Where a capture comes from.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Origin {
    /// A table.
    Table(Place),
    /// The virtual encoder.
    Virtual,
}

/// Where a table lies.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Place {
    /// A file.
    File(PathBuf),
    /// One that ships with the program.
    Example(Example),
}

impl Origin {
    /// Its name, short: without folders.
    pub fn name(&self) -> Text {
        match self {
            Origin::Virtual => Text::new("signals.virtual"),
            Origin::Table(place) => place.name(),
        }
    }
}

impl Place {
    /// The name of the file, without folders.
    pub fn name(&self) -> Text {
        let path = self.path();
        let name = path.file_name().unwrap_or(path.as_os_str());
        explain::plain(name.to_string_lossy())
    }

    pub(super) fn path(&self) -> PathBuf {
        match self {
            Place::File(path) => path.clone(),
            Place::Example(example) => example.file_name().into(),
        }
    }
}

/// A capture and what is known about it.
#[derive(Clone, Debug)]
pub struct Measurement {
    /// Where it comes from.
    pub origin: Origin,
    /// The samples.
    pub capture: Arc<Capture>,
    /// The analysis, or why there is none.
    pub analysis: Result<Analysis, AnalysisError>,
    /// What there is to look at.
    pub diagnosis: Diagnosis,
    /// By what the diagnosis was made.
    pub judge: Judge,
    /// Mean level of REFSIN and of REFCOS in volts, where they were recorded.
    pub levels_v: Option<(f64, f64)>,
    /// Amplitudes over frequency, or why there are none.
    pub spectra: Result<Spectra, SpectrumError>,
    /// Samples as (cosine, sine) in volts, of many as many as a picture can show.
    pub points: Vec<(f64, f64)>,
}

/// By what a signal is judged.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Judge {
    /// Whose limits.
    pub family: Family,
    /// Signal periods in a revolution; `None` where nobody knows.
    pub periods: Option<u32>,
}

/// Points of a Lissajous figure that tell more than fewer do.
const POINTS: usize = 4_000;

impl Measurement {
    /// Measures a capture; takes about 100 ms for a million samples.
    pub fn of(origin: Origin, capture: Arc<Capture>, judge: Judge) -> Self {
        let samples = samples(&capture);
        let analysis = Analysis::of(samples);
        let mean = |column: &[f64]| column.iter().sum::<f64>() / column.len().max(1) as f64;
        Measurement {
            diagnosis: diagnosis(&capture, &analysis, judge),
            judge,
            levels_v: capture.references_v.as_ref().map(|(sine, cosine)| (mean(sine), mean(cosine))),
            spectra: Spectra::of(samples),
            points: spread(samples.cosine_v, samples.sine_v),
            analysis,
            origin,
            capture,
        }
    }

    /// The same, judged by something else.
    #[must_use]
    pub fn judged(&self, judge: Judge) -> Self {
        Measurement { diagnosis: diagnosis(&self.capture, &self.analysis, judge), judge, ..self.clone() }
    }

    /// Why there is no analysis, in words.
    pub fn refusal(&self, language: Language) -> Option<Text> {
        let error = self.analysis.as_ref().err()?;
        Some(explain::signal::analysis(Path::new(&self.origin.name().words(language)), error))
    }

    /// What they are after the correction of the ellipse; nothing without one.
    pub fn corrected_points(&self) -> Vec<(f64, f64)> {
        let Ok(analysis) = &self.analysis else { return Vec::new() };
        let correction = analysis.ellipse.correction();
        let corrected = |(cosine, sine): &(f64, f64)| {
            let (sine, cosine) = correction.apply(*sine, *cosine);
            (cosine, sine)
        };
        self.points.iter().map(corrected).collect()
    }
}

fn samples(capture: &Capture) -> Samples<'_> {
    Samples { time_s: &capture.time_s, sine_v: &capture.sine_v, cosine_v: &capture.cosine_v }
}

fn diagnosis(capture: &Capture, analysis: &Result<Analysis, AnalysisError>, judge: Judge) -> Diagnosis {
    let references_v = capture.references_v.as_ref().map(|(sine, cosine)| (sine.as_slice(), cosine.as_slice()));
    let record = Record { samples: samples(capture), references_v, periods: judge.periods };
    diagnose(&record, analysis.as_ref(), &judge.family.limits())
}

/// Samples spread over all of them. Not every so many, which could always hit the same place of the period.
fn spread(x: &[f64], y: &[f64]) -> Vec<(f64, f64)> {
    /// The golden section: its multiples fill the unit interval evenly.
    const GOLDEN: f64 = 0.618_033_988_749_895;
    let count = x.len().min(y.len());
    let pair = |at: usize| x.get(at).copied().zip(y.get(at).copied());
    if count <= POINTS {
        return (0..count).filter_map(pair).collect();
    }
    let place = |at: usize| ((at as f64 + (at as f64 * GOLDEN).fract()) * count as f64 / POINTS as f64) as usize;
    (0..POINTS).filter_map(|at| pair(place(at))).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn many_samples_are_spread_and_few_are_all_there() {
        let few: Vec<f64> = (0..10).map(f64::from).collect();
        assert_eq!(spread(&few, &few).len(), 10);
        // A period of 250 samples, of which every 250th would be one point.
        let angle = |at: i32| f64::from(at) / 250.0 * std::f64::consts::TAU;
        let x: Vec<f64> = (0..1_000_000).map(|at| angle(at).cos()).collect();
        let y: Vec<f64> = (0..1_000_000).map(|at| angle(at).sin()).collect();
        let points = spread(&x, &y);
        let mut sectors = [0; 16];
        for (x, y) in &points {
            sectors[((y.atan2(*x) / std::f64::consts::TAU).rem_euclid(1.0) * 16.0) as usize % 16] += 1;
        }
        assert_eq!(points.len(), 4000);
        assert!(sectors.iter().all(|count| (150..=350).contains(count)), "{sectors:?}");
    }
}
