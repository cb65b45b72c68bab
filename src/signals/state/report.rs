//! Report on a sine/cosine capture: measured values with their limits, the findings, and plots of the signals over
//! time, the Lissajous figure, the spectrum and the position error within a period.

use super::{Measurement, Quantity, Spectra, TEXTS, Unit, error_quantities, signal_quantities};
use crate::analysis::quality::{Family, Verdict};
use crate::analysis::signal_analysis::Analysis;
use crate::app::Text;
use crate::app::explain::signal::diagnosis_text;
use crate::app::report::{ReportContent, ReportContext, data_report};
use crate::drawing::plot::{Curve, Plot};
use crate::report::{Block, CellStyle, Fact, Mark, Report, Section, Table};
use crate::store::AssetName;

const SINE: &str = "#1a6fa3";
const COSINE: &str = "#b34d00";
const CORRECTED: &str = "#00775a";
const LIMIT: &str = "#c62828";
/// Size of a plot across the full width of a page. `SQUARE` is the size of a square plot.
const WIDE: (u32, u32) = (700, 210);
const SQUARE: (u32, u32) = (400, 370);
/// Maximum number of points in a curve. On paper, more could not be distinguished.
const POINTS: usize = 2000;
/// Number of signal periods in the plot over time.
const PERIODS: f64 = 4.0;
/// Highest frequency in the spectrum, as a multiple of the signal frequency.
const ORDERS: f64 = 12.0;

/// Creates the report on a capture with the given name.
///
/// # Errors
/// Returns the reason why the capture cannot be analysed.
pub(crate) fn report(
    measurement: &Measurement,
    name: String,
    asset: Option<&AssetName>,
    context: &ReportContext<'_>,
) -> Result<Report, Text> {
    let labels = (TEXTS.text("report.sig_subject"), TEXTS.text("report.sig_capture"));
    Ok(data_report(context, labels, name, asset, content(measurement, context)?))
}

fn content(measurement: &Measurement, context: &ReportContext<'_>) -> Result<ReportContent, Text> {
    let settings = measurement.diagnosis_settings;
    let analysis = match (&measurement.analysis, measurement.failure_text(context.language)) {
        (Ok(analysis), _) => analysis,
        (Err(_), Some(why)) => return Err(why),
        (Err(error), None) => return Err(crate::app::explain::literal_text(error)),
    };
    let signal = signal_quantities(measurement, settings.family, settings.periods);
    let mut sections = vec![quality_section(context, &signal, settings.family), findings_section(context, measurement)];
    sections.extend(time_section(context, measurement, analysis));
    sections.push(lissajous_section(context, measurement, analysis, settings.family));
    if let Ok(spectra) = &measurement.spectra {
        sections.push(spectrum_section(context, spectra, analysis));
    }
    sections.push(error_section(context, analysis, settings.periods));
    Ok(ReportContent { title: context.localize(measurement.origin.name()), key: None, sections })
}

fn quality_section(context: &ReportContext<'_>, quantities: &[Quantity], family: Family) -> Section {
    let mut table = context.table([
        (Text::new("report.name"), CellStyle::Text),
        (Text::new("report.value"), CellStyle::Number),
        (Text::new("report.unit"), CellStyle::Short),
        (TEXTS.text("report.sig_limit"), CellStyle::Number),
        (TEXTS.text("report.sig_verdict"), CellStyle::Text),
    ]);
    for quantity in quantities {
        let (mark, verdict) = match quantity.verdict {
            None => (Mark::None, None),
            Some(Verdict::Ok) => (Mark::Good, Some("quality.inside")),
            Some(Verdict::Warn) => (Mark::Warning, Some("quality.outside")),
            Some(Verdict::Fault) => (Mark::Bad, Some("quality.fault")),
        };
        let plain = |value: f64| context.format_shortest_number((value * 1e6).round() / 1e6);
        table.add_marked_row(
            mark,
            [
                context.localize(TEXTS.text(quantity.word)),
                context.number(quantity.value, quantity.decimals),
                quantity.unit.unit_symbol().to_owned(),
                quantity.bound.map(|bound| bound.format(plain)).unwrap_or_default(),
                verdict.map(|id| context.localize(TEXTS.text(id))).unwrap_or_default(),
            ],
        );
    }
    let limits = Fact::new(context.localize(TEXTS.text("quality.family")), family.name());
    Section::new(context.localize(TEXTS.text("report.sig_quality")))
        .with(Block::Facts(vec![limits]))
        .with(Block::Table(table))
}

/// Formats a quantity with its unit, followed by its value in a second unit, if any.
fn quantity_fact(context: &ReportContext<'_>, quantity: &Quantity) -> Fact {
    let shown = |value, decimals, unit: Unit| format!("{} {}", context.number(value, decimals), unit.unit_symbol());
    let also = quantity.also.map(|(value, decimals, unit)| format!(" ({})", shown(value, decimals, unit)));
    let value = shown(quantity.value, quantity.decimals, quantity.unit) + &also.unwrap_or_default();
    Fact { style: CellStyle::Code, ..Fact::new(context.localize(TEXTS.text(quantity.word)), value) }
}

fn findings_section(context: &ReportContext<'_>, measurement: &Measurement) -> Section {
    let section = Section::new(context.localize(TEXTS.text("quality.findings")));
    let findings = &measurement.diagnosis.findings;
    if findings.is_empty() {
        return section.with(Block::Paragraph(context.localize(TEXTS.text("quality.good"))));
    }
    let texts = findings.iter().map(|finding| Block::Paragraph(context.localize(diagnosis_text(finding))));
    texts.fold(section, Section::with)
}

fn time_section(context: &ReportContext<'_>, measurement: &Measurement, analysis: &Analysis) -> Option<Section> {
    let capture = &measurement.capture;
    let first = *capture.time_s.first()?;
    let duration = analysis.duration_s?;
    let span = analysis.frequency_hz().map_or(duration, |hz| (PERIODS / hz.abs().max(1e-9)).min(duration));
    let count = capture.time_s.iter().take_while(|time| **time - first <= span).count();
    let curve = |values: &[f64], colour, id| {
        let points = capture.time_s.iter().zip(values).take(count);
        let points = points.map(|(time, volts)| (1e3 * (time - first), *volts)).collect();
        Curve { points: thinned(points), colour, name: Some(context.localize(TEXTS.text(id))) }
    };
    let curves = vec![curve(&capture.sine_v, SINE, "scope.sine"), curve(&capture.cosine_v, COSINE, "scope.cosine")];
    let title = context.localize(TEXTS.text("scope.title"));
    let y = symmetric_range(&curves);
    let plot = plot(context, title.clone(), WIDE, (0.0, 1e3 * span), y, ("ms", "V"), curves);
    Some(Section::new(title).with(Block::Drawing(plot)))
}

/// Plots the samples as a Lissajous figure, with the limits for the vector length.
fn lissajous_section(
    context: &ReportContext<'_>,
    measurement: &Measurement,
    analysis: &Analysis,
    family: Family,
) -> Section {
    let capture = &measurement.capture;
    let samples = capture.cosine_v.iter().zip(&capture.sine_v).map(|(cosine, sine)| (*cosine, *sine)).collect();
    let ring = |volts: f64, colour, name| Curve {
        points: circle(|angle| (volts * angle.cos(), volts * angle.sin())),
        colour,
        name,
    };
    let (least, most) = family.limits().ok_v;
    let name = |id| Some(context.localize(TEXTS.text(id)));
    let ellipse = circle(|angle| {
        let (sine, cosine) = analysis.ellipse.point_at(angle);
        (cosine, sine)
    });
    let curves = vec![
        ring(least, LIMIT, name("report.sig_limit")),
        ring(most, LIMIT, None),
        Curve { points: thinned(samples), colour: SINE, name: name("quality.raw") },
        Curve { points: ellipse, colour: CORRECTED, name: name("report.sig_ellipse") },
    ];
    let range = symmetric_range(&curves);
    let title = context.localize(TEXTS.text("quality.lissajous"));
    let plot = plot(context, title.clone(), SQUARE, range, range, ("cos (V)", "sin (V)"), curves);
    Section::new(title).with(Block::Drawing(plot))
}

fn spectrum_section(context: &ReportContext<'_>, spectra: &Spectra, analysis: &Analysis) -> Section {
    let most = spectra.sine.lines.last().map_or(1.0, |(hz, _)| *hz);
    let range = analysis
        .frequency_hz()
        .map_or(most, |hz| (ORDERS * hz.abs()).clamp(spectra.spacing_hz, most.max(spectra.spacing_hz)));
    let curve = |lines: &[(f64, f64)], colour, id| {
        let points = lines.iter().filter(|(hz, _)| *hz <= range).map(|(hz, volts)| (hz / 1e3, *volts)).collect();
        Curve { points, colour, name: Some(context.localize(TEXTS.text(id))) }
    };
    let curves =
        vec![curve(&spectra.sine.lines, SINE, "scope.sine"), curve(&spectra.cosine.lines, COSINE, "scope.cosine")];
    let highest = curves.iter().flat_map(|curve| &curve.points).map(|(_, volts)| *volts).fold(0.0, f64::max);
    let title = context.localize(TEXTS.text("spectrum.title"));
    let unit = context.localize(TEXTS.text("spectrum.volts"));
    let x = (0.0, range / 1e3);
    let plot = plot(context, title.clone(), WIDE, x, (0.0, 1.1 * highest.max(1e-6)), ("kHz", &unit), curves);
    let mut table: Table = context.table([
        (TEXTS.text("spectrum.channel"), CellStyle::Text),
        (TEXTS.text("report.sig_kilohertz"), CellStyle::Number),
        (TEXTS.text("report.sig_millivolts"), CellStyle::Number),
        (TEXTS.text("spectrum.order"), CellStyle::Number),
    ]);
    for (id, channel) in [("scope.sine", &spectra.sine), ("scope.cosine", &spectra.cosine)] {
        for peak in &channel.peaks {
            let order = analysis.frequency_hz().map(|hz| peak.frequency_hz / hz.abs().max(1e-9));
            table.add_row([
                context.localize(TEXTS.text(id)),
                context.number(peak.frequency_hz / 1e3, 4),
                context.number(1e3 * peak.amplitude_v, 2),
                order.map(|order| context.number(order, 2)).unwrap_or_default(),
            ]);
        }
    }
    Section::new(title).with(Block::Drawing(plot)).with(Block::Table(table))
}

fn error_section(context: &ReportContext<'_>, analysis: &Analysis, periods: Option<u32>) -> Section {
    let curve = |values: &[f64], colour, id| {
        let step = 360.0 / values.len().max(1) as f64;
        let points = values.iter().zip(0_u32..).map(|(error, at)| (f64::from(at) * step, *error)).collect();
        Curve { points, colour, name: Some(context.localize(TEXTS.text(id))) }
    };
    let curves = vec![
        curve(&analysis.error.raw_deg, SINE, "error.raw_pp"),
        curve(&analysis.error.corrected_deg, CORRECTED, "error.corrected_pp"),
    ];
    let title = context.localize(TEXTS.text("report.sig_error"));
    let y = symmetric_range(&curves);
    let plot = plot(context, title.clone(), WIDE, (0.0, 360.0), y, ("°", "°"), curves);
    let facts = error_quantities(analysis, periods).iter().map(|quantity| quantity_fact(context, quantity)).collect();
    Section::new(title).with(Block::Drawing(plot)).with(Block::Facts(facts))
}

fn plot(
    context: &ReportContext<'_>,
    title: String,
    size: (u32, u32),
    x: (f64, f64),
    y: (f64, f64),
    labels: (&str, &str),
    curves: Vec<Curve>,
) -> crate::drawing::Drawing {
    let format = |value: f64, decimals: usize| context.number(value, decimals);
    Plot { title, size, x, y, labels: (labels.0.to_owned(), labels.1.to_owned()), curves, format: &format }.to_drawing()
}

/// Returns a range around zero that contains all curves.
fn symmetric_range(curves: &[Curve]) -> (f64, f64) {
    let all = curves.iter().flat_map(|curve| &curve.points);
    let most = all.map(|(_, y)| y.abs()).filter(|value| value.is_finite()).fold(1e-6, f64::max);
    (-1.1 * most, 1.1 * most)
}

fn circle(point: impl Fn(f64) -> (f64, f64)) -> Vec<(f64, f64)> {
    (0..=120).map(|at| point(f64::from(at) / 120.0 * std::f64::consts::TAU)).collect()
}

/// Reduces a long curve to at most `POINTS` points.
fn thinned(points: Vec<(f64, f64)>) -> Vec<(f64, f64)> {
    let step = points.len().div_ceil(POINTS).max(1);
    points.into_iter().step_by(step).collect()
}
