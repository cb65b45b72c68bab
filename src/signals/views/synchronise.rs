//! Absolute and analogue position brought together: typed, or as the encoder gives them.

use egui::Ui;

use crate::app::{Action, SineCosineSource, Text};
use crate::signals::state::synchronise::{Action as Page, Form, Synchronise, ToldAs};
use crate::signals::state::{Action as Signals, Signals as State, TEXTS, synchronise::Told};
use crate::signals::views::say;
use crate::ui::controls::{
    card, card_with, choice, enabled_button, entry, icon_button, labelled_entry, paragraph, problem, row, split,
    verdict_ui,
};
use crate::ui::widgets::{StepRing, series, step_ring};
use crate::ui::{Skin, controls, icons};

/// Width of an entry.
const ENTRY: f32 = 112.0;
/// Side of the ring.
const RING: f32 = 200.0;
/// Share of the left column, and the least width for two.
const COLUMNS: (f32, f32) = (0.42, 620.0);

/// Draws the page.
pub(super) fn page_ui(
    ui: &mut Ui,
    skin: &Skin,
    signals: &State,
    device: Option<&dyn SineCosineSource>,
    actions: &mut Vec<Action>,
) {
    let state = signals.synchronise();
    let mut form = state.form.clone();
    // What is drawn beside the entries is what they come to now.
    let told = form.told();
    // Two rows, so that also in one column the result stands next to what it comes from.
    split(
        ui,
        skin,
        COLUMNS,
        (&mut form, &mut *actions),
        |ui, (form, actions)| positions(ui, skin, form, state, told.as_ref().err(), device, actions),
        |ui, _| {
            if let Ok(told) = &told {
                result(ui, skin, told);
            }
        },
    );
    ui.add_space(skin.space.groups);
    split(
        ui,
        skin,
        COLUMNS,
        (&mut form, &mut *actions),
        |ui, (form, actions)| {
            measured(ui, skin, state, actions);
            ui.add_space(skin.space.groups);
            captured(ui, skin, signals, actions);
            ui.add_space(skin.space.groups);
            counter(ui, skin, form);
        },
        |ui, _| order(ui, skin),
    );
    if form != state.form {
        actions.push(ask(Page::Edit(Box::new(form))));
    }
}

fn ask(action: Page) -> Action {
    Action::tool(Signals::Synchronise(action))
}

fn typed(ui: &mut Ui, skin: &Skin, id: &'static str, text: &mut String, hint: &str) {
    labelled_entry(ui, skin, TEXTS.text(id), text, ENTRY, hint);
}

fn positions(
    ui: &mut Ui,
    skin: &Skin,
    form: &mut Form,
    state: &Synchronise,
    refused: Option<&Text>,
    device: Option<&dyn SineCosineSource>,
    actions: &mut Vec<Action>,
) {
    card(ui, skin, TEXTS.text("synchronise.positions"), |ui| {
        typed(ui, skin, "synchronise.absolute", &mut form.absolute, "0x2A5F");
        entry(ui, skin, &say(skin, "synchronise.analogue"), |ui| {
            let ways = [
                (ToldAs::Periods, "synchronise.in_periods"),
                (ToldAs::Degrees, "synchronise.in_degrees"),
                (ToldAs::Volts, "synchronise.in_volts"),
            ];
            let ways = ways.map(|(way, id)| (way, say(skin, id)));
            choice(ui, &say(skin, "synchronise.analogue"), &mut form.told_as, ways);
        });
        match form.told_as {
            ToldAs::Periods | ToldAs::Degrees => typed(ui, skin, "synchronise.phase", &mut form.phase, "0"),
            ToldAs::Volts => {
                typed(ui, skin, "synchronise.sine", &mut form.sine_v, "0");
                typed(ui, skin, "synchronise.cosine", &mut form.cosine_v, "0");
            }
        }
        typed(ui, skin, "synchronise.periods", &mut form.periods, "1024");
        typed(ui, skin, "synchronise.turns", &mut form.turns, "1");
        typed(ui, skin, "synchronise.offset", &mut form.offset, "0");
        ui.checkbox(&mut form.half_step, say(skin, "synchronise.half_step"))
            .on_hover_text(say(skin, "synchronise.half_step_hint"));
        problem(ui, skin, refused);
        let ready = device.is_some_and(SineCosineSource::is_ready);
        let read = enabled_button(ui, ready, icons::CROSSHAIR, &say(skin, "synchronise.read"));
        if read.on_disabled_hover_text(say(skin, "synchronise.read_hint")).clicked() {
            actions.extend(device.map(SineCosineSource::read_action));
        }
        problem(ui, skin, state.problem.as_ref());
    });
}

fn measured(ui: &mut Ui, skin: &Skin, state: &Synchronise, actions: &mut Vec<Action>) {
    let count = state.readings();
    let mut forget = false;
    let aside = |ui: &mut Ui| {
        forget = icon_button(ui, count > 0, icons::TRASH, &say(skin, "synchronise.forget")).clicked();
    };
    card_with(ui, skin, TEXTS.text("synchronise.measured"), aside, |ui| {
        paragraph(ui, skin.label(say(skin, "synchronise.measured_words")));
        row(ui, skin, &say(skin, "synchronise.readings"), skin.mono(count.to_string()));
        let offset = state.measured();
        let words = offset.map_or_else(|| "–".to_owned(), |offset| format!("{}/32", skin.number(offset, 2)));
        row(ui, skin, &say(skin, "synchronise.mean"), skin.mono(words));
        if enabled_button(ui, offset.is_some(), icons::CHECK, &say(skin, "synchronise.use")).clicked() {
            actions.push(ask(Page::UseOffset));
        }
    });
    if forget {
        actions.push(ask(Page::Forget));
    }
}

/// The offset over a capture with an absolute position.
fn captured(ui: &mut Ui, skin: &Skin, signals: &State, actions: &mut Vec<Action>) {
    card(ui, skin, TEXTS.text("synchronise.captured"), |ui| {
        let measurement = signals.measurement();
        let Some((own, offset)) = measurement.and_then(|own| Some((own, own.absolute_offset?))) else {
            paragraph(ui, skin.label(say(skin, "synchronise.not_captured")));
            return;
        };
        let name = TEXTS.text("synchronise.captured_from").with_text("name", own.origin.name());
        paragraph(ui, skin.label(skin.words(&name)));
        match offset {
            Ok(offset) => {
                let steps = |steps| skin.mono(format!("{}/32", skin.number(steps, 2)));
                let state = signals.synchronise();
                row(ui, skin, &say(skin, "quality.samples"), skin.mono(offset.samples.to_string()));
                row(ui, skin, &say(skin, "synchronise.mean"), steps(state.with_half_step(offset.offset_steps)));
                row(ui, skin, &say(skin, "synchronise.farthest"), steps(offset.farthest_steps));
                if enabled_button(ui, true, icons::CHECK, &say(skin, "synchronise.use_captured")).clicked() {
                    actions.push(ask(Page::UseCaptured(offset.offset_steps)));
                }
            }
            Err(why) => problem(ui, skin, Some(&why.text())),
        }
    });
}

fn result(ui: &mut Ui, skin: &Skin, told: &Told) {
    let (verdict, words) = told.words();
    let (_, colour) = controls::verdict(skin, verdict);
    card(ui, skin, TEXTS.text("synchronise.result"), |ui| {
        let fine = told.result.ok();
        let (label, value) = (say(skin, "synchronise.ring"), skin.words(&words));
        let ring = StepRing {
            step: told.step,
            phase: told.phase.periods(),
            apart: fine.map(|fine| fine.residual_periods),
            colour: colour.into(),
            label: &label,
            value: &value,
        };
        let shown = fine.map_or_else(|| "–".to_owned(), |fine| skin.number(fine.periods(), 5));
        ui.label(skin.value(shown));
        verdict_ui(ui, skin, verdict, &words);
        ui.add_space(skin.space.inside);
        split(
            ui,
            skin,
            (0.5, 2.0 * RING),
            (),
            |ui, ()| {
                ui.vertical_centered(|ui| step_ring(ui, skin, &ring, RING.min(ui.available_width())));
            },
            |ui, ()| numbers(ui, skin, told),
        );
    });
}

fn numbers(ui: &mut Ui, skin: &Skin, told: &Told) {
    let number = |value, decimals, unit: &str| skin.mono(format!("{}{unit}", skin.number(value, decimals)));
    row(ui, skin, &say(skin, "synchronise.period"), skin.mono(told.period.to_string()));
    // In the colours that they have in the ring.
    row(ui, skin, &say(skin, "synchronise.step"), skin.mono(format!("{}/32", told.step)).color(series(skin, 0)));
    row(ui, skin, &say(skin, "synchronise.phase_now"), number(told.phase.periods(), 5, "").color(series(skin, 1)));
    row(ui, skin, &say(skin, "synchronise.difference"), number(told.difference_steps, 2, "/32"));
    if let Ok(fine) = told.result {
        let correction = if fine.correction == 0 { "0".to_owned() } else { format!("{:+}", fine.correction) };
        row(ui, skin, &say(skin, "synchronise.correction"), skin.mono(correction));
        row(ui, skin, &say(skin, "synchronise.residual"), number(fine.residual_periods * 32.0, 2, "/32"));
        row(ui, skin, &say(skin, "synchronise.steps"), skin.mono(format!("{:X}h", fine.steps(16))));
    }
    if let Some(degrees) = told.degrees() {
        row(ui, skin, &say(skin, "synchronise.shaft"), number(degrees, 6, "°"));
    }
}

fn counter(ui: &mut Ui, skin: &Skin, form: &mut Form) {
    card(ui, skin, TEXTS.text("synchronise.counter"), |ui| {
        paragraph(ui, skin.label(say(skin, "synchronise.counter_words")));
        typed(ui, skin, "synchronise.quarters", &mut form.quarters, "1356");
        match form.quadrature() {
            Ok(Some(fine)) => row(ui, skin, &say(skin, "synchronise.fine"), skin.mono(skin.number(fine, 5))),
            Ok(None) => {}
            Err(why) => problem(ui, skin, Some(&why)),
        }
        ui.add_space(skin.space.inside);
        paragraph(ui, skin.label(say(skin, "synchronise.check_words")));
        typed(ui, skin, "synchronise.jitter", &mut form.jitter_ms, "1");
        match form.unlatched_rpm() {
            Ok(rpm) => {
                let words = format!("{} {}", skin.number(rpm, 1), say(skin, "input.rpm"));
                row(ui, skin, &say(skin, "synchronise.below"), skin.mono(words));
            }
            Err(why) => problem(ui, skin, Some(&why)),
        }
    });
}

fn order(ui: &mut Ui, skin: &Skin) {
    card(ui, skin, TEXTS.text("synchronise.order"), |ui| {
        for id in [
            "synchronise.order_read",
            "synchronise.order_sample",
            "synchronise.order_join",
            "synchronise.order_load",
            "synchronise.order_run",
            "synchronise.order_check",
        ] {
            paragraph(ui, skin.label(say(skin, id)));
        }
    });
}
