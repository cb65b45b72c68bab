//! The page that combines the absolute and the analogue position, either typed or read from an encoder.

use egui::Ui;

use crate::app::{Action, SineCosineSource, Text};
use crate::signals::state::synchronise::{Form, PhaseInput, SynchroniseAction as Page, SynchroniseState};
use crate::signals::state::{Signals as State, SignalsAction as Signals, TEXTS, synchronise::SynchronisationResult};
use crate::signals::views::translate;
use crate::ui::controls::{
    card, card_with_trailing, dropdown, enabled_button, entry, icon_button, labelled_number_entry, paragraph,
    problem_ui, row, show_error_below, split, verdict_ui,
};
use crate::ui::widgets::{StepRing, series_colour, step_ring};
use crate::ui::{Theme, controls, icons};

const ENTRY_WIDTH: f32 = 112.0;
const RING_SIDE: f32 = 200.0;
/// Fraction of the width for the left column, and minimum width in points for two columns.
const COLUMNS: (f32, f32) = (0.42, 620.0);

pub(super) fn page_ui(
    ui: &mut Ui,
    theme: &Theme,
    signals: &State,
    device: Option<&dyn SineCosineSource>,
    actions: &mut Vec<Action>,
) {
    let state = signals.synchronise();
    let mut form = state.form.clone();
    // The result is drawn beside the entries, and so it is calculated first.
    let synchronisation = form.compute_result();
    // The page has two rows. In a single column, each result then follows its inputs.
    split(
        ui,
        theme,
        COLUMNS,
        (&mut form, &mut *actions),
        |ui, (form, actions)| positions_ui(ui, theme, form, state, synchronisation.as_ref().err(), device, actions),
        |ui, _| {
            if let Ok(synchronisation) = &synchronisation {
                result_ui(ui, theme, synchronisation);
            }
        },
    );
    theme.add_gap(ui);
    split(
        ui,
        theme,
        COLUMNS,
        (&mut form, &mut *actions),
        |ui, (form, actions)| {
            measured_offset_ui(ui, theme, state, actions);
            theme.add_gap(ui);
            captured_offset_ui(ui, theme, signals, actions);
            theme.add_gap(ui);
            counter_ui(ui, theme, form);
        },
        |ui, _| order_ui(ui, theme),
    );
    if form != state.form {
        actions.push(to_action(Page::Edit(Box::new(form))));
    }
}

fn to_action(action: Page) -> Action {
    Action::tool(Signals::Synchronise(action))
}

fn typed_entry_ui(ui: &mut Ui, theme: &Theme, id: &'static str, text: &mut String, hint: &str) {
    labelled_number_entry(ui, theme, TEXTS.text(id), text, ENTRY_WIDTH, hint);
}

fn positions_ui(
    ui: &mut Ui,
    theme: &Theme,
    form: &mut Form,
    state: &SynchroniseState,
    refused: Option<&Text>,
    device: Option<&dyn SineCosineSource>,
    actions: &mut Vec<Action>,
) {
    card(ui, theme, TEXTS.text("synchronise.positions"), |ui| {
        typed_entry_ui(ui, theme, "synchronise.absolute", &mut form.absolute, "0x2A5F");
        entry(ui, theme, &translate(theme, "synchronise.analogue"), |ui| {
            let ways = [
                (PhaseInput::Periods, "synchronise.in_periods"),
                (PhaseInput::Degrees, "synchronise.in_degrees"),
                (PhaseInput::Volts, "synchronise.in_volts"),
            ];
            let ways = ways.map(|(way, id)| (way, translate(theme, id)));
            dropdown(ui, &translate(theme, "synchronise.analogue"), &mut form.phase_input, ways);
        });
        match form.phase_input {
            PhaseInput::Periods | PhaseInput::Degrees => {
                typed_entry_ui(ui, theme, "synchronise.phase", &mut form.phase, "0")
            }
            PhaseInput::Volts => {
                typed_entry_ui(ui, theme, "synchronise.sine", &mut form.sine_v, "0");
                typed_entry_ui(ui, theme, "synchronise.cosine", &mut form.cosine_v, "0");
            }
        }
        typed_entry_ui(ui, theme, "synchronise.periods", &mut form.periods, "1024");
        typed_entry_ui(ui, theme, "synchronise.turns", &mut form.turns, "1");
        typed_entry_ui(ui, theme, "synchronise.offset", &mut form.offset, "0");
        ui.checkbox(&mut form.half_step, translate(theme, "synchronise.half_step"))
            .on_hover_text(translate(theme, "synchronise.half_step_hint"));
        show_error_below(ui, theme, refused.or(state.problem.as_ref()));
        let ready = device.is_some_and(SineCosineSource::is_ready);
        let read = enabled_button(ui, ready, icons::CROSSHAIR, &translate(theme, "synchronise.read"));
        if read.on_disabled_hover_text(translate(theme, "synchronise.read_hint")).clicked() {
            actions.extend(device.map(SineCosineSource::read_action));
        }
    });
}

fn measured_offset_ui(ui: &mut Ui, theme: &Theme, state: &SynchroniseState, actions: &mut Vec<Action>) {
    let count = state.reading_count();
    let mut forget = false;
    let aside = |ui: &mut Ui| {
        forget = icon_button(ui, count > 0, icons::TRASH, &translate(theme, "synchronise.forget")).clicked();
    };
    card_with_trailing(ui, theme, TEXTS.text("synchronise.measured"), aside, |ui| {
        paragraph(ui, theme.label(translate(theme, "synchronise.measured_words")));
        row(ui, theme, &translate(theme, "synchronise.readings"), theme.monospace(count.to_string()));
        let offset = state.measured_offset();
        let words = offset.map_or_else(|| "–".to_owned(), |offset| format!("{}/32", theme.format_number(offset, 2)));
        row(ui, theme, &translate(theme, "synchronise.mean"), theme.monospace(words));
        if enabled_button(ui, offset.is_some(), icons::CHECK, &translate(theme, "synchronise.use")).clicked() {
            actions.push(to_action(Page::UseOffset));
        }
    });
    if forget {
        actions.push(to_action(Page::Forget));
    }
}

fn captured_offset_ui(ui: &mut Ui, theme: &Theme, signals: &State, actions: &mut Vec<Action>) {
    card(ui, theme, TEXTS.text("synchronise.captured"), |ui| {
        let measurement = signals.measurement();
        let Some((own, offset)) = measurement.and_then(|own| Some((own, own.absolute_offset?))) else {
            paragraph(ui, theme.label(translate(theme, "synchronise.not_captured")));
            return;
        };
        let name = TEXTS.text("synchronise.captured_from").with_text("name", own.origin.name());
        paragraph(ui, theme.label(theme.format_text(&name)));
        match offset {
            Ok(offset) => {
                let steps = |steps| theme.monospace(format!("{}/32", theme.format_number(steps, 2)));
                let state = signals.synchronise();
                row(ui, theme, &translate(theme, "quality.samples"), theme.monospace(offset.samples.to_string()));
                row(ui, theme, &translate(theme, "synchronise.mean"), steps(state.add_half_step(offset.offset_steps)));
                row(ui, theme, &translate(theme, "synchronise.farthest"), steps(offset.farthest_steps));
                if enabled_button(ui, true, icons::CHECK, &translate(theme, "synchronise.use_captured")).clicked() {
                    actions.push(to_action(Page::UseCaptured(offset.offset_steps)));
                }
            }
            Err(why) => problem_ui(ui, theme, Some(&why.text())),
        }
    });
}

fn result_ui(ui: &mut Ui, theme: &Theme, synchronisation: &SynchronisationResult) {
    let (verdict, words) = synchronisation.to_text();
    let (_, colour) = controls::verdict_badge(theme, verdict);
    card(ui, theme, TEXTS.text("synchronise.result"), |ui| {
        let fine = synchronisation.result.ok();
        let (label, value) = (translate(theme, "synchronise.ring"), theme.format_text(&words));
        let ring = StepRing {
            step: synchronisation.step,
            phase: synchronisation.phase.to_periods(),
            apart: fine.map(|fine| fine.residual_periods),
            colour: colour.into(),
            label: &label,
            value: &value,
        };
        let shown = fine.map_or_else(|| "–".to_owned(), |fine| theme.format_number(fine.periods(), 5));
        ui.label(theme.value(shown));
        verdict_ui(ui, theme, verdict, &words);
        ui.add_space(theme.space.inside);
        split(
            ui,
            theme,
            (0.5, 2.0 * RING_SIDE),
            (),
            |ui, ()| {
                ui.vertical_centered(|ui| step_ring(ui, theme, &ring, RING_SIDE.min(ui.available_width())));
            },
            |ui, ()| numbers_ui(ui, theme, synchronisation),
        );
    });
}

fn numbers_ui(ui: &mut Ui, theme: &Theme, synchronisation: &SynchronisationResult) {
    let number =
        |value, decimals, unit: &str| theme.monospace(format!("{}{unit}", theme.format_number(value, decimals)));
    row(ui, theme, &translate(theme, "synchronise.period"), theme.monospace(synchronisation.period.to_string()));
    // The numbers have the colours of the ring.
    row(
        ui,
        theme,
        &translate(theme, "synchronise.step"),
        theme.monospace(format!("{}/32", synchronisation.step)).color(series_colour(theme, 0)),
    );
    row(
        ui,
        theme,
        &translate(theme, "synchronise.phase_now"),
        number(synchronisation.phase.to_periods(), 5, "").color(series_colour(theme, 1)),
    );
    row(ui, theme, &translate(theme, "synchronise.difference"), number(synchronisation.difference_steps, 2, "/32"));
    if let Ok(fine) = synchronisation.result {
        let correction = if fine.correction == 0 { "0".to_owned() } else { format!("{:+}", fine.correction) };
        row(ui, theme, &translate(theme, "synchronise.correction"), theme.monospace(correction));
        row(ui, theme, &translate(theme, "synchronise.residual"), number(fine.residual_periods * 32.0, 2, "/32"));
        row(
            ui,
            theme,
            &translate(theme, "synchronise.steps"),
            theme.monospace(format!("{:X}h", fine.steps_per_period(16))),
        );
    }
    if let Some(degrees) = synchronisation.to_degrees() {
        row(ui, theme, &translate(theme, "synchronise.shaft"), number(degrees, 6, "°"));
    }
}

fn counter_ui(ui: &mut Ui, theme: &Theme, form: &mut Form) {
    card(ui, theme, TEXTS.text("synchronise.counter"), |ui| {
        paragraph(ui, theme.label(translate(theme, "synchronise.counter_words")));
        typed_entry_ui(ui, theme, "synchronise.quarters", &mut form.quarters, "1356");
        match form.quadrature_position() {
            Ok(Some(fine)) => {
                row(ui, theme, &translate(theme, "synchronise.fine"), theme.monospace(theme.format_number(fine, 5)))
            }
            Ok(None) => {}
            Err(why) => problem_ui(ui, theme, Some(&why)),
        }
        ui.add_space(theme.space.inside);
        paragraph(ui, theme.label(translate(theme, "synchronise.check_words")));
        typed_entry_ui(ui, theme, "synchronise.jitter", &mut form.jitter_ms, "1");
        match form.max_unlatched_rpm() {
            Ok(rpm) => {
                let words = format!("{} {}", theme.format_number(rpm, 1), translate(theme, "input.rpm"));
                row(ui, theme, &translate(theme, "synchronise.below"), theme.monospace(words));
            }
            Err(why) => problem_ui(ui, theme, Some(&why)),
        }
    });
}

fn order_ui(ui: &mut Ui, theme: &Theme) {
    card(ui, theme, TEXTS.text("synchronise.order"), |ui| {
        for id in [
            "synchronise.order_read",
            "synchronise.order_sample",
            "synchronise.order_join",
            "synchronise.order_load",
            "synchronise.order_run",
            "synchronise.order_check",
        ] {
            paragraph(ui, theme.label(translate(theme, id)));
        }
    });
}
