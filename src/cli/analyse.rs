//! `analyse`: the quality of a recorded sine/cosine signal, offline.

use std::sync::atomic::AtomicBool;

use serde_json::{Value as Json, json};

use super::args::Analyse;
use super::output::{Lines, Output};
use super::runner::{Bar, failed};
use super::{Done, Result};
use crate::app::explain;
use crate::signal::analysis::Analysis;
use crate::signal::capture::Wishes;
use crate::signal::diagnosis::{Record, diagnose};
use crate::signal::position_error::{Basis, Samples, harmonics};
use crate::signal::quality::Family;
use crate::store::read_capture;

pub(super) fn analyse(output: &Output, arguments: &Analyse) -> Result {
    let path = &arguments.file;
    let wishes = Wishes { columns: arguments.columns, volts_per_unit: arguments.volts_per_unit, ..Wishes::default() };
    let bar = Bar::default();
    let mut progress = |done, total| bar.show(done, total, &"bytes");
    // Ctrl-C ends a command that only reads.
    let read = read_capture(path, &wishes, &AtomicBool::new(false), &mut progress);
    drop(bar);
    let (_, capture) = read.map_err(|error| failed(&explain::signal::read(path, &error)))?;
    let samples = Samples { time_s: &capture.time_s, sine_v: &capture.sine_v, cosine_v: &capture.cosine_v };
    let analysis = Analysis::of(samples).map_err(|error| failed(&explain::signal::analysis(path, &error)))?;
    let references_v = capture.references_v.as_ref().map(|(refsin, refcos)| (refsin.as_slice(), refcos.as_slice()));
    let record = Record { samples, references_v, periods: None };
    let diagnosis = diagnose(&record, Ok(&analysis), &Family::Hiperface.limits());
    let findings: Vec<String> =
        diagnosis.findings.iter().map(|finding| explain::signal::diagnosis(finding).terminal()).collect();
    output.show(&json(&analysis, &findings), &text(&analysis, &findings))?;
    Ok(Done::Well)
}

fn json(analysis: &Analysis, findings: &[String]) -> Json {
    let Analysis { ellipse, coverage, error, .. } = analysis;
    let (least, most) = coverage.vector_v;
    json!({
        "samples": analysis.samples,
        "left_out": analysis.outliers.as_ref().map_or(0, |outliers| outliers.count),
        "periods": coverage.periods,
        "frequency_hz": analysis.frequency_hz(),
        "amplitude_v": ellipse.amplitude_v,
        "offset_sin_v": ellipse.offset_sine_v,
        "offset_cos_v": ellipse.offset_cosine_v,
        "gain_ratio": ellipse.gain_ratio,
        "phase_error_deg": ellipse.phase_error_deg(),
        "residual_rms": coverage.residual_rms,
        "octants": coverage.octants,
        "vector_min_v": least,
        "vector_max_v": most,
        "error_pp_deg_raw": error.raw_pp_deg(),
        "error_pp_deg_corrected": error.corrected_pp_deg,
        "error_basis": basis(error.basis),
        "harmonics_deg_raw": harmonics(&error.raw_deg),
        "harmonics_deg_corrected": harmonics(&error.corrected_deg),
        "findings": findings,
    })
}

fn basis(basis: Basis) -> &'static str {
    match basis {
        Basis::Motion { .. } => "motion",
        Basis::Ellipse => "ellipse",
    }
}

fn text(analysis: &Analysis, findings: &[String]) -> String {
    let Analysis { ellipse, coverage, error, .. } = analysis;
    let (least, most) = coverage.vector_v;
    let share = |volts: f64| format!("{volts:+.4} V ({:+.1} % of the amplitude)", 100.0 * volts / ellipse.amplitude_v);
    let mut lines = Lines::default();
    let left_out = analysis.outliers.as_ref().map_or_else(String::new, |outliers| {
        format!(", {} of them left out: up to {:.3} V off the ellipse", outliers.count, outliers.farthest_v)
    });
    lines
        .add("samples", format!("{}{left_out}", analysis.samples))
        .add("periods", format!("{:.3}, in {} of 8 octants", coverage.periods, coverage.octants));
    if let Some(frequency) = analysis.frequency_hz() {
        lines.add("frequency", format!("{frequency:.3} Hz"));
    }
    lines
        .add(
            "amplitude",
            format!("{:.4} V cosine, {:.4} V sine (peak)", ellipse.amplitude_v, ellipse.amplitude_sine_v()),
        )
        .add("vector", format!("{least:.4} … {most:.4} V"))
        .add("offset sine", share(ellipse.offset_sine_v))
        .add("offset cosine", share(ellipse.offset_cosine_v))
        .add("gain ratio", format!("{:.4} (cosine over sine)", ellipse.gain_ratio))
        .add("phase error", format!("{:+.3}°", ellipse.phase_error_deg()))
        .add("residual", format!("{:.3} % rms of the amplitude", 100.0 * coverage.residual_rms))
        .add("position error", format!("{:.3}° peak to peak (electrical)", error.raw_pp_deg()))
        .add("corrected", format!("{:.3}° peak to peak, {}", error.corrected_pp_deg, basis_words(error.basis)));
    if findings.is_empty() {
        lines.add("verdict", "within the limits of HIPERFACE");
    }
    for (at, finding) in findings.iter().enumerate() {
        lines.add(if at == 0 { "verdict" } else { "" }, finding);
    }
    lines.text()
}

fn basis_words(basis: Basis) -> String {
    match basis {
        Basis::Motion { noise_deg } => format!("noise {noise_deg:.3}° rms"),
        Basis::Ellipse => "from the residual: the motion is too short or not steady".to_owned(),
    }
}
