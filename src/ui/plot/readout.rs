//! The numbers below the chart: for each line, the raw sample under the pointer or the newest sample, and the cursor
//! readings.

use egui::{RichText, Sense, Ui, vec2};

use super::{Context, axes, chart};
use crate::analysis::SampleTime;
use crate::analysis::history::{Flags, Sample};
use crate::app::recorder::{CursorReadings, Series, UNTIMED_SAMPLE_INTERVAL_NS};
use crate::ui::Theme;

pub(super) fn readout_ui(ui: &mut Ui, context: &Context<'_>, hovered: Option<SampleTime>) {
    let (theme, recorder) = (context.theme, context.recorder);
    if recorder.is_empty() {
        return;
    }
    ui.spacing_mut().item_spacing = vec2(theme.space.between, 2.0);
    ui.spacing_mut().interact_size.y = 16.0;
    if let Some(between) = recorder.cursor_distance() {
        ui.horizontal_wrapped(|ui| {
            if recorder.counts_samples() {
                figure_ui(ui, theme, "Δn", &(between / UNTIMED_SAMPLE_INTERVAL_NS).to_string());
                return;
            }
            figure_ui(ui, theme, "Δt", &axes::duration(between, theme.language));
            if between != 0 {
                let hertz = 1e9 / between.abs() as f64;
                figure_ui(
                    ui,
                    theme,
                    "1/Δt",
                    &format!("{} Hz", theme.format_number(hertz, if hertz < 100.0 { 3 } else { 1 })),
                );
            }
        });
    }
    let measured = recorder.visible_series().any(|line| recorder.readings_at_cursors(line).is_some());
    if measured {
        if ui.available_width() > STACKED_WIDTH {
            table_ui(ui, context, hovered)
        } else {
            columns_ui(ui, context, hovered)
        }
        return;
    }
    for line in recorder.visible_series() {
        ui.horizontal_wrapped(|ui| {
            name_ui(ui, theme, line);
            ui.label(small_text(theme, current_value(context, line, hovered)));
            ui.label(theme.caption(line.scale().map(|scale| theme.format_text(&scale.unit)).unwrap_or_default()));
            remarks_ui(ui, theme, line, None);
        });
    }
}

/// Minimum width in points at which each line has its own row of numbers.
const STACKED_WIDTH: f32 = 640.0;

fn table_ui(ui: &mut Ui, context: &Context<'_>, hovered: Option<SampleTime>) {
    let (theme, recorder) = (context.theme, context.recorder);
    let right = |ui: &mut Ui, words: RichText| {
        ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| ui.label(words));
    };
    egui::Grid::new("measured").num_columns(11).spacing(vec2(theme.space.groups, 2.0)).show(ui, |ui| {
        let rows: Vec<(&Series, CursorReadings)> = recorder
            .visible_series()
            .filter_map(|line| recorder.readings_at_cursors(line).map(|own| (line, own)))
            .collect();
        let longest =
            rows.iter().map(|(line, own)| cursor_figures(theme, line, own)).max_by_key(Vec::len).unwrap_or_default();
        (0..3).for_each(|_| {
            ui.label("");
        });
        let row = |ui: &mut Ui, cells: Vec<RichText>| {
            let last = cells.len().saturating_sub(1);
            for (at, words) in cells.into_iter().enumerate() {
                // The last column needs no padding on the right.
                if at == last {
                    ui.label(words);
                } else {
                    right(ui, words);
                }
            }
        };
        row(ui, longest.into_iter().map(|(label, _)| theme.caption(label)).collect());
        ui.end_row();
        for (line, measured) in rows {
            ui.horizontal(|ui| name_ui(ui, theme, line));
            right(ui, small_text(theme, current_value(context, line, hovered)));
            ui.label(theme.caption(line.scale().map(|scale| theme.format_text(&scale.unit)).unwrap_or_default()));
            row(
                ui,
                cursor_figures(theme, line, &measured).into_iter().map(|(_, value)| small_text(theme, value)).collect(),
            );
            remarks_ui(ui, theme, line, Some(&measured));
            ui.end_row();
        }
    });
}

/// Draws a table with one column per line and one row per number, for narrow panels.
fn columns_ui(ui: &mut Ui, context: &Context<'_>, hovered: Option<SampleTime>) {
    let (theme, recorder) = (context.theme, context.recorder);
    let lines: Vec<(&Series, Option<CursorReadings>)> =
        recorder.visible_series().map(|line| (line, recorder.readings_at_cursors(line))).collect();
    let numbers: Vec<Vec<(String, String)>> = lines
        .iter()
        .map(|(line, measured)| measured.as_ref().map(|own| cursor_figures(theme, line, own)).unwrap_or_default())
        .collect();
    let labels: Vec<&String> =
        numbers.iter().max_by_key(|own| own.len()).into_iter().flatten().map(|(label, _)| label).collect();
    egui::Grid::new("measured").num_columns(lines.len() + 1).spacing(vec2(theme.space.between, 2.0)).show(ui, |ui| {
        ui.label("");
        for (line, _) in &lines {
            let unit = line.scale().map(|scale| theme.format_text(&scale.unit)).unwrap_or_default();
            ui.horizontal(|ui| {
                swatch_ui(ui, theme, line);
                ui.label(theme.caption(unit)).on_hover_text(theme.format_text(&line.name));
            });
        }
        ui.end_row();
        ui.label("");
        for (line, _) in &lines {
            ui.label(small_text(theme, current_value(context, line, hovered)));
        }
        ui.end_row();
        for (at, label) in labels.into_iter().enumerate() {
            ui.label(theme.caption(label));
            for own in &numbers {
                ui.label(small_text(theme, own.get(at).map_or("", |(_, value)| value.as_str())));
            }
            ui.end_row();
        }
    });
    for (line, measured) in &lines {
        ui.horizontal_wrapped(|ui| remarks_ui(ui, theme, line, measured.as_ref()));
    }
}

fn name_ui(ui: &mut Ui, theme: &Theme, line: &Series) {
    swatch_ui(ui, theme, line);
    ui.label(theme.caption(theme.format_text(&line.name)));
}

fn swatch_ui(ui: &mut Ui, theme: &Theme, line: &Series) {
    let (rect, _) = ui.allocate_exact_size(vec2(10.0, 10.0), Sense::hover());
    ui.painter().rect_filled(rect.shrink(1.0), 2.0, chart::series_colour(theme, line));
}

/// Formats the raw sample under the pointer, or the newest sample if the pointer is not on the chart.
fn current_value(context: &Context<'_>, line: &Series, hovered: Option<SampleTime>) -> String {
    let sample = hovered.map_or_else(|| latest_sample(context, line), |time| context.recorder.sample_at(line, time));
    sample.map_or_else(|| "–".to_owned(), |sample| value(context.theme, line, &sample))
}

/// Returns the names and values of a line's cursor readings.
fn cursor_figures(theme: &Theme, line: &Series, measured: &CursorReadings) -> Vec<(String, String)> {
    let decimals = line.decimal_places();
    let number =
        |value: Option<f64>| value.map_or_else(|| "–".to_owned(), |value| theme.format_number(value, decimals));
    let mut figures = vec![
        ("A".to_owned(), number(measured.a)),
        ("B".to_owned(), number(measured.b)),
        ("Δ".to_owned(), number(measured.difference)),
    ];
    if let Some(between) = &measured.between {
        figures.extend([
            (theme.translate("recorder.mean"), number(Some(between.mean))),
            (theme.translate("recorder.min"), number(Some(between.min))),
            (theme.translate("recorder.max"), number(Some(between.max))),
            // Use one more decimal, because noise is smaller than the values.
            ("σ".to_owned(), theme.format_number(between.deviation, decimals + 1)),
            ("n".to_owned(), between.count.to_string()),
        ]);
    }
    figures
}

/// Draws the reason why there are no samples, and the number of invalid samples.
fn remarks_ui(ui: &mut Ui, theme: &Theme, line: &Series, measured: Option<&CursorReadings>) {
    let caption = |words: String, colour: crate::app::Rgb| RichText::new(words).size(theme.sizes.caption).color(colour);
    if let Some(remark) = &line.remark {
        ui.label(caption(theme.format_text(remark), theme.palette.warn));
    }
    if let Some(between) = measured.and_then(|measured| measured.between.as_ref())
        && between.bad > 0
        && !line.derived
    {
        ui.label(caption(format!("{} {}", between.bad, theme.translate("recorder.bad")), theme.palette.bad));
    }
}

fn latest_sample(context: &Context<'_>, line: &Series) -> Option<Sample> {
    let history = context.recorder.history(line)?;
    history.sample(line.column(), history.indices().end.checked_sub(1)?)
}

fn value(theme: &Theme, line: &Series, sample: &Sample) -> String {
    let value = line.value(sample);
    if sample.flags.contains(Flags::BAD) || !value.is_finite() {
        return "–".to_owned();
    }
    theme.format_number(value, line.decimal_places())
}

fn small_text(theme: &Theme, words: impl Into<String>) -> RichText {
    RichText::new(words).font(egui::FontId::monospace(theme.sizes.caption + 1.0))
}

fn figure_ui(ui: &mut Ui, theme: &Theme, label: &str, value: &str) {
    // The sign and the number must not be separated by a line break.
    let mut job = egui::text::LayoutJob::default();
    let format = |size, colour: crate::app::Rgb| egui::TextFormat {
        font_id: egui::FontId::monospace(size),
        color: colour.into(),
        ..egui::TextFormat::default()
    };
    job.append(label, 0.0, format(theme.sizes.caption, theme.palette.muted));
    job.append(value, 4.0, format(theme.sizes.caption + 1.0, theme.palette.text));
    ui.add(egui::Label::new(job).extend());
}
