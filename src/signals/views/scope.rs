//! The signals over time, and their spectrum.

use egui::{Ui, vec2};

use super::numbers::with_unit;
use super::{SignalsUiState, quality, source};
use crate::app::{Action, RecorderOwner, explain};
use crate::signals::state::{
    ChannelSpectrum, Measurement, Signals, Spectra, TAB, TEXTS, TimeAxisError, Unit, to_decibel_volts,
};
use crate::signals::views::translate;
use crate::ui::controls::{card, card_with_trailing, name, paragraph};
use crate::ui::widgets::{Chart, Trace, chart};
use crate::ui::{Theme, plot};

/// Minimum height of the trace in points.
const MIN_TRACE_HEIGHT: f32 = 300.0;
const SPECTRUM_HEIGHT: f32 = 200.0;

#[derive(Default)]
pub(super) struct ScopeUiState {
    plot: plot::PlotUiState,
    /// Whether the spectrum is shown in volts instead of decibels.
    volts: bool,
}

pub(super) fn page_ui(
    ui: &mut Ui,
    theme: &Theme,
    signals: &Signals,
    view: &mut SignalsUiState,
    actions: &mut Vec<Action>,
) {
    source::settings_ui(ui, theme, signals, &view.source, actions);
    trace(ui, theme, signals, &mut view.scope, actions);
    let Some(measurement) = signals.measurement() else { return };
    theme.add_gap(ui);
    spectrum_ui(ui, theme, signals, measurement, &mut view.scope);
    if measurement.analysis.is_err() {
        theme.add_gap(ui);
        quality::refusal_ui(ui, theme, measurement);
    }
}

fn trace(ui: &mut Ui, theme: &Theme, signals: &Signals, view: &mut ScopeUiState, actions: &mut Vec<Action>) {
    let scope = signals.scope();
    let height = (ui.ctx().content_rect().height() * 0.5).max(MIN_TRACE_HEIGHT);
    card(ui, theme, TEXTS.text("scope.title"), |ui| {
        ui.allocate_ui(vec2(ui.available_width(), height), |ui| {
            ui.set_max_height(height);
            let empty = translate(
                theme,
                match scope.refused {
                    Some(TimeAxisError::GoBack) => "scope.refused",
                    Some(TimeAxisError::TooFar) => "scope.too_far",
                    None => "scope.nothing",
                },
            );
            plot::plot_ui(ui, theme, &scope.recorder, RecorderOwner::Tool(TAB), &mut view.plot, &empty, actions);
        });
        if scope.recorder.counts_samples() {
            paragraph(ui, theme.caption(translate(theme, "scope.counts")));
        }
    });
}

fn spectrum_ui(ui: &mut Ui, theme: &Theme, signals: &Signals, measurement: &Measurement, view: &mut ScopeUiState) {
    let volts = view.volts;
    let mut wanted = volts;
    let aside = |ui: &mut Ui| {
        // The buttons are laid out from right to left.
        for (own, id) in [(true, "spectrum.volts"), (false, "spectrum.decibels")] {
            let word = translate(theme, id);
            let button = egui::Button::selectable(volts == own, word.as_str()).frame_when_inactive(true);
            if name(ui.add(button), true, &word).clicked() {
                wanted = own;
            }
        }
    };
    card_with_trailing(ui, theme, TEXTS.text("spectrum.title"), aside, |ui| {
        let spectra = match &measurement.spectra {
            Ok(spectra) => spectra,
            Err(error) => {
                paragraph(ui, theme.label(theme.format_text(&explain::signal::spectrum_error_text(error))));
                return;
            }
        };
        let kept = signals.comparison_result().and_then(|own| own.spectra.as_ref().ok());
        lines_ui(ui, theme, spectra, kept, volts);
        peaks_ui(ui, theme, spectra, measurement);
    });
    view.volts = wanted;
}

fn display_scale(volts: bool, peak_v: f64) -> f64 {
    if volts { peak_v } else { to_decibel_volts(peak_v) }
}

fn lines_ui(ui: &mut Ui, theme: &Theme, spectra: &Spectra, kept: Option<&Spectra>, volts: bool) {
    let trace = |id: &'static str, channel: &ChannelSpectrum, colour: usize, dashed: bool| Trace {
        name: translate(theme, id),
        points: channel.lines.iter().map(|(hertz, peak)| (hertz / 1e3, display_scale(volts, *peak))).collect(),
        colour,
        dashed,
    };
    let mut traces = Vec::new();
    if let Some(kept) = kept {
        traces.push(trace("spectrum.kept_sine", &kept.sine, 1, true));
        traces.push(trace("spectrum.kept_cosine", &kept.cosine, 6, true));
    }
    traces.push(trace("signals.cosine", &spectra.cosine, 2, false));
    traces.push(trace("signals.sine", &spectra.sine, 0, false));
    let mark = |line: &crate::analysis::spectrum::SpectralLine| {
        let words = with_unit(theme, line.frequency_hz / 1e3, 3, Unit::Kilohertz);
        (line.frequency_hz / 1e3, display_scale(volts, line.amplitude_v), words)
    };
    let marks: Vec<_> = spectra.sine.peaks.iter().take(3).map(mark).collect();
    let value: Vec<String> = marks.iter().map(|(_, _, words)| words.clone()).collect();
    let own = Chart {
        traces: &traces,
        label: &translate(theme, "spectrum.title"),
        value: &value.join("; "),
        height: SPECTRUM_HEIGHT,
        x_unit: Unit::Kilohertz.unit_symbol(),
        y_unit: if volts { Unit::Volts } else { Unit::DecibelVolts }.unit_symbol(),
        marks: &marks,
        ..Chart::default()
    };
    chart(ui, theme, &own);
    let text = TEXTS.text("spectrum.axes").with("samples", spectra.samples).with_number(
        "spacing",
        spectra.spacing_hz,
        if spectra.spacing_hz < 10.0 { 2 } else { 0 },
    );
    paragraph(ui, theme.caption(theme.format_text(&text)));
}

fn peaks_ui(ui: &mut Ui, theme: &Theme, spectra: &Spectra, measurement: &Measurement) {
    let signal_hz = measurement.analysis.as_ref().ok().and_then(|own| own.frequency_hz()).map(f64::abs);
    ui.add_space(theme.space.inside);
    ui.spacing_mut().interact_size.y = 20.0;
    egui::Grid::new("spectrum.title").spacing([theme.space.groups, theme.space.inside]).show(ui, |ui| {
        for id in ["spectrum.channel", "spectrum.frequency", "spectrum.amplitude", "spectrum.level", "spectrum.order"] {
            ui.label(theme.caption(translate(theme, id)));
        }
        ui.end_row();
        for (id, channel) in [("signals.sine", &spectra.sine), ("signals.cosine", &spectra.cosine)] {
            for peak in channel.peaks.iter().take(4) {
                ui.label(theme.label(translate(theme, id)));
                ui.label(theme.monospace(with_unit(theme, peak.frequency_hz / 1e3, 4, Unit::Kilohertz)));
                ui.label(theme.monospace(with_unit(theme, 1e3 * peak.amplitude_v, 2, Unit::Millivolts)));
                ui.label(theme.monospace(with_unit(theme, to_decibel_volts(peak.amplitude_v), 1, Unit::DecibelVolts)));
                let order = signal_hz.filter(|hertz| *hertz > 0.0).map(|hertz| peak.frequency_hz / hertz);
                ui.label(theme.monospace(order.map_or_else(|| "–".to_owned(), |order| theme.format_number(order, 2))));
                ui.end_row();
            }
        }
    });
}
