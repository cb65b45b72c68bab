//! The command `analyse`, which determines the quality of sine and cosine signals from a recording or an adapter.

mod args;
mod live;

use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use crate::signals::state::{DiagnosisSettings, Measurement, Origin, TEXTS, TableSource, report};

use clap::{Arg, ArgMatches, Args};
use serde_json::{Value as Json, json};

use self::args::{AnalyseArgs, ReportOptions};
use crate::analysis::capture::{Capture, Layout, TableHints};
use crate::analysis::diagnosis::{Diagnosis, Record, diagnose};
use crate::analysis::position_error::{ErrorBasis, Samples, harmonic_amplitudes};
use crate::analysis::quality::Family;
use crate::analysis::revolution::Revolution;
use crate::analysis::signal_analysis::Analysis;
use crate::app::explain;
use crate::app::report::{ReportContext, file_name};
use crate::cli::args::{CommonArgs, ReportArgs};
use crate::cli::commands::{CliCommand, arg_list, parse};
use crate::cli::output::{Lines, Output};
use crate::cli::runner::{TerminalProgressBar, to_failure};
use crate::cli::{Failure, Result, Success};
use crate::report::Report;
use crate::store::read_capture;

pub(crate) struct AnalyseCommand;

impl CliCommand for AnalyseCommand {
    fn command(&self) -> clap::Command {
        AnalyseArgs::augment_args(clap::Command::new("analyse")).about(
            "Analyse a sine/cosine signal, recorded or from an adapter: amplitude, offsets, gain, phase, position error",
        )
    }

    fn run(&self, common: &CommonArgs, output: &Output, matches: &ArgMatches) -> Result {
        let arguments: AnalyseArgs = parse(matches)?;
        match (&arguments.file, &common.link) {
            (Some(file), None) => {
                let (columns, volts_per_unit) = (arguments.columns, arguments.volts_per_unit);
                let capture = read(output, file, &TableHints { columns, volts_per_unit, ..TableHints::default() })?;
                analyse_capture(output, file, &capture, &arguments)
            }
            (None, Some(link)) => {
                let capture = live::sample(output, link, arguments.rate, arguments.seconds)?;
                analyse_capture(output, Path::new(&link.to_string()), &capture, &arguments)
            }
            _ => Err(Failure::Usage("this command needs either FILE.csv or --link with an adapter".to_owned())),
        }
    }

    fn report_options(&self) -> Vec<Arg> {
        arg_list::<ReportOptions>()
    }

    fn report(&self, output: &Output, report: &ReportArgs, context: &ReportContext<'_>) -> Option<Result<Report>> {
        is_capture(&report.subject).then(|| capture_report(output, report, context))
    }
}

/// File extensions of captures.
const CAPTURES: [&str; 4] = ["csv", "txt", "tsv", "dat"];

fn is_capture(path: &Path) -> bool {
    let extension = path.extension().and_then(|extension| extension.to_str()).unwrap_or_default();
    CAPTURES.iter().any(|own| own.eq_ignore_ascii_case(extension))
}

fn capture_report(output: &Output, arguments: &ReportArgs, context: &ReportContext<'_>) -> Result<Report> {
    let path = &arguments.subject;
    let options: ReportOptions = arguments.own.read()?;
    let capture = read(output, path, &TableHints::default())?;
    let settings = DiagnosisSettings { family: options.limits.family(), periods: options.periods };
    let origin = Origin::Table(TableSource::File(path.clone()));
    let measurement = Measurement::from_capture(origin, Arc::new(capture), settings);
    report::report(&measurement, file_name(path), arguments.asset.as_ref(), context).map_err(|why| to_failure(&why))
}

fn read(output: &Output, path: &Path, hints: &TableHints) -> std::result::Result<Capture, Failure> {
    let bar = TerminalProgressBar::default();
    let mut progress = |done, total| bar.show(done, total, &"bytes");
    // The command never cancels reading. It does not write anything, so Ctrl-C may end the whole process.
    let read = read_capture(path, hints, &AtomicBool::new(false), &mut progress);
    drop(bar);
    let (layout, capture) =
        read.map_err(|error| to_failure(&explain::signal::read_capture_error_text(path, &error)))?;
    print_remarks(output, &layout, &capture);
    Ok(capture)
}

/// Analyses samples. `path` is the file or link they come from.
fn analyse_capture(output: &Output, path: &Path, capture: &Capture, arguments: &AnalyseArgs) -> Result {
    let samples = Samples { time_s: &capture.time_s, sine_v: &capture.sine_v, cosine_v: &capture.cosine_v };
    let references_v = capture.references_v();
    let record = Record { samples, references_v, periods: arguments.periods };
    let family = arguments.limits.family();
    let analysis = Analysis::from_samples(samples);
    let diagnosis = diagnose(&record, analysis.as_ref(), &family.limits());
    let findings: Vec<String> =
        diagnosis.findings.iter().map(|finding| explain::signal::diagnosis_text(finding).terminal_text()).collect();
    let analysis = analysis.map_err(|error| {
        let why = explain::signal::analysis_error_text(path, &error).terminal_text();
        // If single wires were recorded, the findings about these wires explain more than the missing ellipse.
        let more = findings.iter().filter(|_| references_v.is_some()).take(3).cloned();
        Failure::Failed(std::iter::once(why).chain(more).collect())
    })?;
    let revolution = analyse_revolution(output, capture, &analysis, arguments.periods);
    let report = CaptureReport {
        family,
        analysis: &analysis,
        diagnosis: &diagnosis,
        findings: &findings,
        revolution,
        periods: arguments.periods,
        rows_left_out: capture.skipped_rows,
    };
    output.show(&report.json(), &report.text())?;
    Ok(Success::Completed)
}

fn print_remarks(output: &Output, layout: &Layout, capture: &Capture) {
    if let Some(clock) = layout.clock {
        let text = TEXTS.text("columns.clock").with("start", clock.start_s).with("increment", clock.increment_s);
        output.print_message(&text.terminal_text());
    }
    if capture.skipped_rows > 0 {
        output.print_message(&format!(
            "{} rows without a value (empty, NaN or overload) were left out.",
            capture.skipped_rows
        ));
    }
}

/// Calculates DNL and INL from the reference angle. If the number of periods is missing, a remark explains how to
/// specify it.
fn analyse_revolution(
    output: &Output,
    capture: &Capture,
    analysis: &Analysis,
    periods: Option<u32>,
) -> Option<Revolution> {
    let reference = capture.reference_deg.as_ref()?;
    let Some(periods) = periods else {
        output
            .print_message("The table contains the angle of a reference encoder. Add --periods N to get DNL and INL.");
        return None;
    };
    let left_out = analysis.outliers.as_ref().map_or(&[][..], |outliers| &outliers.excluded_ranges);
    let revolution =
        Revolution::from_samples(&capture.sine_v, &capture.cosine_v, reference, left_out, &analysis.ellipse, periods);
    revolution
        .inspect_err(|error| output.print_message(&explain::signal::revolution_error_text(error).terminal_text()))
        .ok()
}

struct CaptureReport<'a> {
    family: Family,
    analysis: &'a Analysis,
    diagnosis: &'a Diagnosis,
    findings: &'a [String],
    revolution: Option<Revolution>,
    periods: Option<u32>,
    rows_left_out: u64,
}

impl CaptureReport<'_> {
    fn speed_rpm(&self) -> Option<f64> {
        Some(self.analysis.frequency_hz()? * 60.0 / f64::from(self.periods?))
    }

    fn json(&self) -> Json {
        let Analysis { ellipse, coverage, error, .. } = self.analysis;
        let (least, most) = coverage.vector_v;
        let lines: Option<Vec<Json>> = self.diagnosis.interference.as_ref().map(|lines| {
            lines.iter().map(|line| json!({"frequency_hz": line.frequency_hz, "amplitude_v": line.volts})).collect()
        });
        let mut json = json!({
            "samples": self.analysis.samples,
            "rows_left_out": self.rows_left_out,
            "left_out": self.analysis.outliers.as_ref().map_or(0, |outliers| outliers.count),
            "periods": coverage.periods,
            "frequency_hz": self.analysis.frequency_hz(),
            "speed_rpm": self.speed_rpm(),
            "amplitude_v": ellipse.amplitude_v,
            "offset_sin_v": ellipse.offset_sine_v,
            "offset_cos_v": ellipse.offset_cosine_v,
            "gain_ratio": ellipse.gain_ratio,
            "phase_error_deg": ellipse.phase_error_deg(),
            "residual_rms": coverage.residual_rms,
            "octants": coverage.octants,
            "vector_min_v": least,
            "vector_max_v": most,
            "error_pp_deg_raw": error.raw_peak_to_peak_deg(),
            "error_pp_deg_corrected": error.corrected_pp_deg,
            "error_basis": basis_keyword(error.basis),
            "harmonics_deg_raw": harmonic_amplitudes(&error.raw_deg),
            "harmonics_deg_corrected": harmonic_amplitudes(&error.corrected_deg),
            "noise_rms_v": self.diagnosis.noise_v,
            "interference": lines,
            "limits": self.family.name(),
            "findings": self.findings,
        });
        if let (Some(Revolution { raw, corrected }), Some(object)) = (&self.revolution, json.as_object_mut()) {
            for (key, value) in [
                ("inl_deg", raw.integral_deg),
                ("dnl_deg", raw.differential_deg),
                ("inl_deg_corrected", corrected.integral_deg),
                ("dnl_deg_corrected", corrected.differential_deg),
                ("revolutions", raw.revolutions),
            ] {
                object.insert(key.to_owned(), json!(value));
            }
        }
        json
    }

    fn text(&self) -> String {
        let Analysis { ellipse, coverage, error, .. } = self.analysis;
        let (least, most) = coverage.vector_v;
        let share =
            |volts: f64| format!("{volts:+.4} V ({:+.1} % of the amplitude)", 100.0 * volts / ellipse.amplitude_v);
        let left_out = self.analysis.outliers.as_ref().map_or_else(String::new, |outliers| {
            format!(", {} of them left out (up to {:.3} V off the ellipse)", outliers.count, outliers.farthest_v)
        });
        let mut lines = Lines::default();
        lines
            .add_line("samples", format!("{}{left_out}", self.analysis.samples))
            .add_line("periods", format!("{:.3}, in {} of 8 octants", coverage.periods, coverage.octants));
        if let Some(frequency) = self.analysis.frequency_hz() {
            let speed = self.speed_rpm().map_or_else(String::new, |speed| format!(", {speed:.3} 1/min"));
            let mark = if self.analysis.is_angle_tracked() { "" } else { " (uncertain: too few samples per period)" };
            lines.add_line("frequency", format!("{frequency:.3} Hz{speed}{mark}"));
        }
        lines
            .add_line(
                "amplitude",
                format!("{:.4} V cosine, {:.4} V sine (peak)", ellipse.amplitude_v, ellipse.amplitude_sine_v()),
            )
            .add_line("vector", format!("{least:.4} … {most:.4} V"))
            .add_line("offset sine", share(ellipse.offset_sine_v))
            .add_line("offset cosine", share(ellipse.offset_cosine_v))
            .add_line("gain ratio", format!("{:.4} (cosine / sine)", ellipse.gain_ratio))
            .add_line("phase error", format!("{:+.3}°", ellipse.phase_error_deg()))
            .add_line("residual", format!("{:.3} % rms of the amplitude", 100.0 * coverage.residual_rms))
            .add_line("position error", format!("{:.3}° peak to peak (electrical)", error.raw_peak_to_peak_deg()))
            .add_line(
                "corrected",
                format!("{:.3}° peak to peak, {}", error.corrected_pp_deg, error_basis_text(error.basis)),
            );
        if let Some(Revolution { raw, corrected }) = &self.revolution {
            let both = |raw: f64, corrected: f64| {
                format!("±{:.1}″ as measured, ±{:.1}″ corrected (mechanical)", raw * 3_600.0, corrected * 3_600.0)
            };
            lines
                .add_line("DNL", both(raw.differential_deg, corrected.differential_deg))
                .add_line("INL", both(raw.integral_deg, corrected.integral_deg));
            if raw.revolutions < 1.0 {
                lines.add_line("", format!("over only {:.2} of a revolution", raw.revolutions));
            }
        }
        if self.findings.is_empty() {
            lines.add_line("verdict", format!("within the limits of {}", self.family.name()));
        }
        for (at, finding) in self.findings.iter().enumerate() {
            lines.add_line(if at == 0 { "verdict" } else { "" }, finding);
        }
        lines.text()
    }
}

fn basis_keyword(basis: ErrorBasis) -> &'static str {
    match basis {
        ErrorBasis::Motion { .. } => "motion",
        ErrorBasis::Ellipse => "ellipse",
    }
}

fn error_basis_text(basis: ErrorBasis) -> String {
    match basis {
        ErrorBasis::Motion { noise_deg } => format!("noise {noise_deg:.3}° rms"),
        ErrorBasis::Ellipse => "estimated from the residual: the motion is too short or not uniform".to_owned(),
    }
}
