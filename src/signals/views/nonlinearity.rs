//! DNL and INL over a revolution, relative to a reference encoder, as curves and ± values.

use egui::Ui;

use super::numbers;
use crate::app::explain;
use crate::signals::state::{MeasurementResult, Nonlinearities, TEXTS, nonlinearity_quantities};
use crate::signals::views::translate;
use crate::ui::Theme;
use crate::ui::controls::{card, paragraph, problem_ui};
use crate::ui::widgets::{Chart, Trace, chart};

pub(super) fn card_ui(
    ui: &mut Ui,
    theme: &Theme,
    measurement: &MeasurementResult,
    compared: Option<&MeasurementResult>,
) {
    card(ui, theme, TEXTS.text("nonlinearity.title"), |ui| match &measurement.nonlinearities {
        Some(Ok(nonlinearities)) => {
            curve_ui(ui, theme, nonlinearities);
            ui.add_space(theme.space.inside);
            let other = compared.and_then(|own| own.nonlinearities.as_ref()?.as_ref().ok());
            let other = other.map(nonlinearity_quantities);
            numbers::rows_ui(
                ui,
                theme,
                "nonlinearity.title",
                &nonlinearity_quantities(nonlinearities),
                other.as_deref(),
            );
            if nonlinearities.revolutions < 1.0 {
                let text = TEXTS.text("nonlinearity.part").with_number("revolutions", nonlinearities.revolutions, 2);
                paragraph(ui, theme.caption(theme.format_text(&text)));
            }
        }
        Some(Err(error)) => problem_ui(ui, theme, Some(&explain::signal::revolution_error_text(error))),
        None => paragraph(ui, theme.label(translate(theme, "nonlinearity.no_reference"))),
    });
}

fn curve_ui(ui: &mut Ui, theme: &Theme, nonlinearities: &Nonlinearities) {
    let trace = |id: &'static str, points: &[(f64, f64)], colour: usize, dashed: bool| Trace {
        name: translate(theme, id),
        points: points.to_vec(),
        colour,
        dashed,
    };
    let traces = [
        trace("quality.raw", &nonlinearities.raw.deviation, 0, false),
        trace("quality.corrected", &nonlinearities.corrected.deviation, 2, false),
        trace("nonlinearity.mean", &nonlinearities.corrected.mean, 1, true),
    ];
    let value = TEXTS
        .text("nonlinearity.curve_value")
        .with_number("dnl", nonlinearities.raw.differential_deg, 5)
        .with_number("inl", nonlinearities.raw.integral_deg, 5);
    let own = Chart {
        traces: &traces,
        label: &translate(theme, "nonlinearity.title"),
        value: &theme.format_text(&value),
        height: 180.0,
        x_unit: "°",
        y_unit: "°",
        x_step: (nonlinearities.revolutions <= 2.0).then_some(90.0),
        ..Chart::default()
    };
    chart(ui, theme, &own);
    paragraph(ui, theme.caption(translate(theme, "nonlinearity.axes")));
}
