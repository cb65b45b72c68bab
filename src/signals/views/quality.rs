//! Signal quality: the Lissajous figure, the findings, and all values with their limits.

use std::sync::Arc;

use crate::signals::state::TEXTS;
use crate::signals::views::translate;

use egui::{Color32, RichText, TextureHandle, TextureId, Ui};

use super::{SignalsUiState, numbers, source};
use crate::analysis::diagnosis::{DiagnosisChanges, DiagnosisFinding, Severity};
use crate::analysis::lissajous::PlotSquare;
use crate::analysis::quality::Family;
use crate::analysis::signal_analysis::Analysis;
use crate::app::{Action, Text, explain};
use crate::signals::state::{
    Measurement, MeasurementResult, Signals, SignalsAction as Signals_, forms, signal_quantities,
};
use crate::ui::controls::{
    card, card_with_trailing, committed_entry, dropdown, entry, name, paragraph, problem_ui, split,
};
use crate::ui::widgets::{Lissajous, LissajousFigure, density_image, lissajous, series_colour};
use crate::ui::{Theme, icons};

/// Common numbers of periods per revolution.
const COMMON_PERIODS: [u32; 11] = [16, 32, 64, 128, 256, 512, 1024, 2048, 4096, 8192, 65_536];
const CURVE: usize = 180;

pub(super) fn page_ui(
    ui: &mut Ui,
    theme: &Theme,
    signals: &Signals,
    view: &mut SignalsUiState,
    actions: &mut Vec<Action>,
) {
    let Some(measurement) = signals.measurement() else { return };
    split(
        ui,
        theme,
        (0.42, 520.0),
        (view, actions),
        |ui, (view, _)| {
            figure_ui(ui, theme, signals, measurement, view);
            theme.add_gap(ui);
            verdict_ui(ui, theme, signals, measurement);
        },
        |ui, (view, actions)| {
            source::settings_ui(ui, theme, signals, &view.source, actions);
            values_ui(ui, theme, signals, measurement, view, actions);
        },
    );
}

fn figure_ui(ui: &mut Ui, theme: &Theme, signals: &Signals, measurement: &Arc<Measurement>, view: &mut SignalsUiState) {
    let analysed = measurement.analysis.as_ref().ok();
    let corrected = view.corrected && analysed.is_some();
    let aside = |ui: &mut Ui| {
        // The buttons are laid out from right to left.
        for (own, id) in [(true, "quality.corrected"), (false, "quality.raw")] {
            let word = translate(theme, id);
            let button = egui::Button::selectable(corrected == own, word.as_str()).frame_when_inactive(true);
            if name(ui.add_enabled(analysed.is_some(), button), analysed.is_some(), &word).clicked() {
                view.corrected = own;
            }
        }
    };
    card_with_trailing(ui, theme, TEXTS.text("quality.lissajous"), aside, |ui| {
        let limits = signals.family().limits();
        let (least, most) = limits.ok_v;
        let value = match analysed {
            Some(analysis) => TEXTS
                .text("quality.lissajous_value")
                .with_number("shortest", analysis.coverage.vector_v.0, 3)
                .with_number("longest", analysis.coverage.vector_v.1, 3)
                .with_number("least", least, 2)
                .with_number("most", most, 2),
            None => TEXTS.text("quality.lissajous_bare").with("samples", measurement.capture.sine_v.len()),
        };
        let [own, other] = &mut view.pictures;
        if signals.comparison_result().is_none() {
            *other = LissajousTexture::default();
        }
        let compared = signals.comparison_result().map(|kept| {
            let picture = other.density_texture(ui, theme, kept, corrected, 1);
            quality_figure(kept, corrected, picture, (1, true))
        });
        let picture = own.density_texture(ui, theme, measurement.results(), corrected, 0);
        let shown = quality_figure(measurement, corrected, picture, (0, false));
        let figures: Vec<LissajousFigure> = compared.into_iter().chain([shown]).collect();
        let side = ui.available_width().min(440.0);
        let lissajous_ = Lissajous {
            figures: &figures,
            ok_v: limits.ok_v,
            fault_v: limits.fault_v,
            label: &translate(theme, "quality.lissajous"),
            value: &theme.format_text(&value),
        };
        lissajous(ui, theme, &lissajous_, side);
        paragraph(ui, theme.caption(translate(theme, "quality.rings")));
    });
}

/// Cached texture of a Lissajous figure. It is replaced when the samples or the colour change.
#[derive(Default)]
pub(super) struct LissajousTexture(Option<(Arc<MeasurementResult>, bool, Color32, TextureHandle)>);

impl LissajousTexture {
    fn density_texture(
        &mut self,
        ui: &Ui,
        theme: &Theme,
        measurement: &Arc<MeasurementResult>,
        corrected: bool,
        colour: usize,
    ) -> Option<(TextureId, PlotSquare)> {
        let colour = series_colour(theme, colour);
        let density = if corrected { &measurement.corrected } else { &measurement.raw };
        let density = density.as_ref()?;
        let same = |(own, own_corrected, own_colour, _): &(Arc<MeasurementResult>, bool, Color32, TextureHandle)| {
            Arc::ptr_eq(own, measurement) && *own_corrected == corrected && *own_colour == colour
        };
        if !self.0.as_ref().is_some_and(same) {
            let image = density_image(density, colour);
            let texture = ui.ctx().load_texture("", image, egui::TextureOptions::LINEAR);
            self.0 = Some((measurement.clone(), corrected, colour, texture));
        }
        let (.., texture) = self.0.as_ref()?;
        Some((texture.id(), density.plot_square()))
    }
}

fn quality_figure(
    measurement: &MeasurementResult,
    corrected: bool,
    picture: Option<(TextureId, PlotSquare)>,
    (colour, dashed): (usize, bool),
) -> LissajousFigure {
    let curve = |analysis: &Analysis| {
        let ellipse = if corrected { analysis.ellipse.corrected_ellipse() } else { analysis.ellipse };
        ellipse.outline_points(CURVE)
    };
    LissajousFigure { picture, curve: measurement.analysis.as_ref().map(curve).unwrap_or_default(), colour, dashed }
}

/// Draws the reason why a capture could not be analysed, with its findings.
pub(super) fn refusal_ui(ui: &mut Ui, theme: &Theme, measurement: &MeasurementResult) {
    let Some(why) = measurement.failure_text(theme.language) else { return };
    card(ui, theme, TEXTS.text("quality.findings"), |ui| {
        line_ui(ui, icons::X_CIRCLE, theme.palette.bad, theme.format_text(&why));
        for finding in &measurement.diagnosis.findings {
            finding_ui(ui, theme, finding);
        }
    });
}

fn line_ui(ui: &mut Ui, icon: &str, colour: crate::app::Rgb, words: String) {
    ui.horizontal_top(|ui| {
        ui.label(RichText::new(icon).color(colour));
        paragraph(ui, words);
    });
}

fn finding_ui(ui: &mut Ui, theme: &Theme, finding: &DiagnosisFinding) {
    let palette = theme.palette;
    let (icon, colour) = match finding.severity {
        Severity::Notice => (icons::INFO, palette.accent),
        Severity::Warning => (icons::WARNING, palette.warn),
        Severity::Fault => (icons::X_CIRCLE, palette.bad),
    };
    line_ui(ui, icon, colour, theme.format_text(&explain::signal::diagnosis_text(finding)));
}

fn verdict_ui(ui: &mut Ui, theme: &Theme, signals: &Signals, measurement: &Measurement) {
    card(ui, theme, TEXTS.text("quality.findings"), |ui| {
        let findings = signals.findings();
        match measurement.failure_text(theme.language) {
            Some(why) => line_ui(ui, icons::X_CIRCLE, theme.palette.bad, theme.format_text(&why)),
            None if findings.is_empty() => {
                line_ui(ui, icons::CHECK_CIRCLE, theme.palette.good, translate(theme, "quality.good"));
            }
            None => {}
        }
        for finding in findings {
            finding_ui(ui, theme, finding);
        }
        if let Some((kept, changes)) = signals.comparison_result().zip(signals.changes()) {
            changes_ui(ui, theme, &kept.origin.name(), &changes);
        }
    });
}

/// Draws the changes since the compared capture. “Nothing is worse” appears only if everything could be compared.
fn changes_ui(ui: &mut Ui, theme: &Theme, name: &Text, changes: &DiagnosisChanges) {
    let under = |ui: &mut Ui, id| {
        ui.add_space(theme.space.inside);
        ui.label(theme.caption(theme.format_text(&TEXTS.text(id).with_text("name", name.clone()))));
    };
    under(ui, "compare.worse");
    if changes.worse.is_empty() && changes.obstacles.is_empty() {
        line_ui(ui, icons::CHECK_CIRCLE, theme.palette.good, translate(theme, "compare.nothing"));
    }
    for finding in &changes.worse {
        finding_ui(ui, theme, finding);
    }
    for obstacle in &changes.obstacles {
        line_ui(
            ui,
            icons::QUESTION,
            theme.palette.muted,
            theme.format_text(&explain::signal::comparison_obstacle(*obstacle)),
        );
    }
    if !changes.changed.is_empty() {
        under(ui, "compare.changed");
    }
    for finding in &changes.changed {
        finding_ui(ui, theme, finding);
    }
}

fn values_ui(
    ui: &mut Ui,
    theme: &Theme,
    signals: &Signals,
    measurement: &Measurement,
    view: &mut SignalsUiState,
    actions: &mut Vec<Action>,
) {
    card(ui, theme, TEXTS.text("quality.numbers"), |ui| {
        let word = translate(theme, "quality.family");
        let mut family = signals.family();
        entry(ui, theme, &word, |ui| {
            let families = Family::ALL.map(|own| (own, own.name().to_owned()));
            if dropdown(ui, &word, &mut family, families) {
                actions.push(Action::tool(Signals_::SetFamily(family)));
            }
        });
        periods_ui(ui, theme, signals, &mut view.periods, actions);
        ui.add_space(theme.space.inside);
        let of = |own: &MeasurementResult| signal_quantities(own, signals.family(), signals.signal_periods());
        let others = signals.comparison_result().map(|own| of(own));
        numbers::rows_ui(ui, theme, "quality.numbers", &of(measurement), others.as_deref());
    });
}

/// Draws the entry for the number of signal periods per revolution.
pub(super) fn periods_ui(
    ui: &mut Ui,
    theme: &Theme,
    signals: &Signals,
    draft: &mut super::Draft,
    actions: &mut Vec<Action>,
) {
    let word = translate(theme, "quality.periods_per_turn");
    entry(ui, theme, &word, |ui| {
        let shown = signals.signal_periods().map(|periods| periods.to_string()).unwrap_or_default();
        committed_entry(ui, draft, &shown, 72.0, &word, |text| {
            actions.push(Action::tool(Signals_::SetPeriods(forms::parse_periods(text)?)));
            Ok(())
        });
        let usual = translate(theme, "quality.periods_usual");
        let menu = ui.menu_button(icons::CARET_DOWN, |ui| {
            for periods in COMMON_PERIODS {
                if ui.selectable_label(signals.signal_periods() == Some(periods), periods.to_string()).clicked() {
                    *draft = None;
                    actions.push(Action::tool(Signals_::SetPeriods(periods)));
                    ui.close();
                }
            }
        });
        name(menu.response, true, &usual).on_hover_text(usual);
    });
    if let Some((_, Some(why))) = draft {
        problem_ui(ui, theme, Some(why));
    }
    if signals.signal_periods().is_none() {
        line_ui(ui, icons::QUESTION, theme.palette.warn, translate(theme, "quality.periods_open"));
    }
}
