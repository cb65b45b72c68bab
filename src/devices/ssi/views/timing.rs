//! The timing page: a burst to scale, the reading rate, the age of a position, and violated limits.

use egui::{RichText, Ui};

use super::form::{LayoutFormUiState, rows_ui};
use crate::app::{Action, Text};
use crate::devices::ssi::protocol::Timing;
use crate::devices::ssi::state::explain;
use crate::devices::ssi::state::timing::{BurstDiagram, frequency};
use crate::devices::ssi::state::{Encoder, TEXTS};
use crate::devices::ssi::views::translate;
use crate::devices::ssi::views::widgets::{TimingDiagram, timing_diagram};
use crate::ui::controls::{card, paragraph, row, two_columns};
use crate::ui::{Theme, icons};

pub(super) fn page_ui(
    ui: &mut Ui,
    theme: &Theme,
    encoder: &Encoder,
    view: &mut LayoutFormUiState,
    actions: &mut Vec<Action>,
) {
    let designer = &encoder.designer;
    let rows = designer.reading_form();
    let timing = designer.timing();
    card(ui, theme, TEXTS.text("ssi_timing.title"), |ui| {
        let diagram = BurstDiagram::new(designer.layout(), &designer.applicable_times(), &designer.read_conditions());
        let label = translate(theme, "ssi_timing.title");
        let model = TimingDiagram { label: &label, diagram: &diagram, frame: Some(encoder.displayed_frame().frame) };
        timing_diagram(ui, theme, &model);
    });
    theme.add_gap(ui);
    two_columns(
        ui,
        theme,
        (view, actions),
        |ui, (view, actions)| {
            card(ui, theme, TEXTS.text("ssi_timing.reading"), |ui| rows_ui(ui, theme, encoder, &rows, view, actions));
        },
        |ui, _| {
            card(ui, theme, TEXTS.text("ssi_timing.result"), |ui| {
                result_ui(ui, theme, &timing);
                if designer.family().is_none() {
                    paragraph(ui, theme.caption(translate(theme, "ssi_timing.general")));
                }
            });
        },
    );
}

fn result_ui(ui: &mut Ui, theme: &Theme, timing: &Timing) {
    let micros = |time: std::time::Duration| theme.format_number(time.as_secs_f64() * 1e6, 2);
    let hertz = |hertz: f64| theme.format_text(&frequency(hertz));
    let mut value_row = |id: &'static str, words: String| row(ui, theme, &translate(theme, id), theme.monospace(words));
    value_row("ssi_timing.period", format!("{} µs", micros(timing.period)));
    value_row("ssi_timing.burst", format!("{} µs", micros(timing.burst)));
    let rate = hertz(1.0 / timing.cycle.as_secs_f64().max(1e-9));
    value_row("ssi_timing.cycle", format!("{} µs · {rate}", micros(timing.cycle)));
    let (least, most) = timing.monoflop;
    let monoflop = if least == most { micros(most) } else { format!("{} … {}", micros(least), micros(most)) };
    value_row("ssi_timing.monoflop", format!("{monoflop} µs"));
    value_row("ssi_timing.least_pause", format!("> {} µs", micros(timing.least_pause)));
    value_row("ssi_timing.most_reads", hertz(timing.most_reads_hz));
    let age = match timing.age {
        // The position is latched at the first edge and is complete when the burst ends.
        None => format!("≥ {} µs", micros(timing.burst)),
        Some((least, most)) if least == most => format!("{} µs", micros(most)),
        Some((least, most)) => format!("{} … {} µs", micros(least), micros(most)),
    };
    value_row("ssi_timing.age", age);
    let cable = timing.cable_hz.map_or_else(|| translate(theme, "ssi_timing.cable_unknown"), |hz| hertz(hz.into()));
    value_row("ssi_timing.most_clock", cable);
    if timing.age.is_none() {
        paragraph(ui, theme.caption(translate(theme, "ssi_timing.age_unknown")));
    }
    ui.add_space(theme.space.inside);
    if timing.warnings.is_empty() {
        warning_ui(ui, theme, (icons::CHECK_CIRCLE, theme.palette.good), &TEXTS.text("ssi_timing.fits"));
    }
    for warning in &timing.warnings {
        warning_ui(ui, theme, (icons::WARNING, theme.palette.warn), &explain::timing_warning_text(warning));
    }
}

fn warning_ui(ui: &mut Ui, theme: &Theme, (icon, colour): (&str, crate::app::Rgb), words: &Text) {
    ui.horizontal_top(|ui| {
        ui.label(RichText::new(icon).color(colour));
        paragraph(ui, theme.format_text(words));
    });
}
