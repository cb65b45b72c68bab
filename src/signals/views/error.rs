//! Position error within a period, both raw and corrected, and its harmonics.

use egui::Ui;

use super::{SignalsUiState, nonlinearity, numbers, octant, quality, source};
use crate::analysis::position_error::{ErrorBasis, PositionError, harmonic_amplitudes};
use crate::app::{Action, Text};
use crate::signals::state::{MeasurementResult, Signals, TEXTS, error_quantities};
use crate::signals::views::translate;
use crate::ui::Theme;
use crate::ui::controls::{card, paragraph, split};
use crate::ui::widgets::{Chart, Trace, chart};

pub(super) fn page_ui(
    ui: &mut Ui,
    theme: &Theme,
    signals: &Signals,
    view: &mut SignalsUiState,
    actions: &mut Vec<Action>,
) {
    let Some(measurement) = signals.measurement() else { return };
    source::settings_ui(ui, theme, signals, &view.source, actions);
    let Ok(analysis) = &measurement.analysis else {
        quality::refusal_ui(ui, theme, measurement);
        theme.add_gap(ui);
        octant::card_ui(ui, theme, &mut view.octant);
        return;
    };
    let compared = signals.comparison_result();
    curves_ui(ui, theme, &analysis.error, compared.map(AsRef::as_ref));
    theme.add_gap(ui);
    split(
        ui,
        theme,
        (0.5, 560.0),
        (&mut view.periods, actions),
        |ui, (periods, actions)| {
            card(ui, theme, TEXTS.text("error.numbers"), |ui| {
                quality::periods_ui(ui, theme, signals, periods, actions);
                ui.add_space(theme.space.inside);
                let of = |own: &MeasurementResult| {
                    own.analysis.as_ref().ok().map(|own| error_quantities(own, signals.signal_periods()))
                };
                let others = compared.and_then(|own| of(own));
                let own = error_quantities(analysis, signals.signal_periods());
                numbers::rows_ui(ui, theme, "error.numbers", &own, others.as_deref());
                ui.add_space(theme.space.inside);
                paragraph(ui, theme.caption(theme.format_text(&basis_text(analysis.error.basis))));
            });
        },
        |ui, _| harmonics_ui(ui, theme, &analysis.error, compared.map(AsRef::as_ref)),
    );
    theme.add_gap(ui);
    nonlinearity::card_ui(ui, theme, measurement, compared.map(AsRef::as_ref));
    theme.add_gap(ui);
    octant::card_ui(ui, theme, &mut view.octant);
}

fn basis_text(basis: ErrorBasis) -> Text {
    match basis {
        ErrorBasis::Motion { noise_deg } => TEXTS.text("error.basis_motion").with_number("noise", noise_deg, 3),
        ErrorBasis::Ellipse => TEXTS.text("error.basis_ellipse"),
    }
}

fn compared_error(compared: Option<&MeasurementResult>) -> Option<&PositionError> {
    compared.and_then(|own| own.analysis.as_ref().ok()).map(|own| &own.error)
}

fn curves_ui(ui: &mut Ui, theme: &Theme, error: &PositionError, compared: Option<&MeasurementResult>) {
    let trace = |id: &'static str, curve: &[f64], colour: usize, dashed: bool| {
        let step = 360.0 / curve.len().max(1) as f64;
        let points = curve.iter().enumerate().map(|(at, error)| (at as f64 * step, *error)).collect();
        Trace { name: translate(theme, id), points, colour, dashed }
    };
    let traces = error_series(error, compared_error(compared), trace);
    card(ui, theme, TEXTS.text("error.curve"), |ui| {
        let value = TEXTS.text("error.curve_value").with_number("raw", error.raw_peak_to_peak_deg(), 3).with_number(
            "corrected",
            error.corrected_pp_deg,
            3,
        );
        let own = Chart {
            traces: &traces,
            label: &translate(theme, "error.curve"),
            value: &theme.format_text(&value),
            height: 180.0,
            x_unit: "°",
            y_unit: "°",
            x_range: Some((0.0, 360.0)),
            x_step: Some(45.0),
            ..Chart::default()
        };
        chart(ui, theme, &own);
        paragraph(ui, theme.caption(translate(theme, "error.axes")));
    });
}

fn harmonics_ui(ui: &mut Ui, theme: &Theme, error: &PositionError, compared: Option<&MeasurementResult>) {
    let trace = |id: &'static str, curve: &[f64], colour: usize, dashed: bool| {
        let points = (1_u32..).zip(harmonic_amplitudes(curve)).map(|(order, peak)| (f64::from(order), peak)).collect();
        Trace { name: translate(theme, id), points, colour, dashed }
    };
    let traces = error_series(error, compared_error(compared), trace);
    card(ui, theme, TEXTS.text("error.harmonics"), |ui| {
        let peaks: Vec<String> =
            harmonic_amplitudes(&error.raw_deg).iter().map(|peak| theme.format_number(*peak, 3)).collect();
        let own = Chart {
            traces: &traces,
            label: &translate(theme, "error.harmonics"),
            value: &peaks.join("; "),
            height: 150.0,
            y_unit: "°",
            x_step: Some(1.0),
            y_floor: Some(0.0),
            bars: true,
            ..Chart::default()
        };
        chart(ui, theme, &own);
        paragraph(ui, theme.caption(translate(theme, "error.harmonics_axes")));
    });
}

/// Returns the raw and corrected traces of the capture, and of the compared capture if given.
fn error_series(
    error: &PositionError,
    compared: Option<&PositionError>,
    trace: impl Fn(&'static str, &[f64], usize, bool) -> Trace,
) -> Vec<Trace> {
    let mut traces = Vec::new();
    if let Some(other) = compared {
        traces.push(trace("error.kept_raw", &other.raw_deg, 1, true));
        traces.push(trace("error.kept_corrected", &other.corrected_deg, 6, true));
    }
    traces.push(trace("quality.raw", &error.raw_deg, 0, false));
    traces.push(trace("quality.corrected", &error.corrected_deg, 2, false));
    traces
}
