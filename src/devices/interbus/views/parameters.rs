//! The parameters page: parameters and their edits, preset, EEPROM wear, and the words of the handshake.

use std::collections::BTreeMap;

use crate::devices::interbus::state::TEXTS;
use crate::devices::interbus::views::translate;

use egui::{Align, Layout, RichText, Ui, vec2};

use crate::app::explain::cycle_count_text;
use crate::app::{Action, Text};
use crate::devices::interbus::jobs::{
    Change, WEAR_CONFIRMATION, WEAR_GUARANTEE, WEAR_LIMIT, WEAR_WARNING, WearAfterPlan,
};
use crate::devices::interbus::profile::Direction;
use crate::devices::interbus::protocol::Parameter;
use crate::devices::interbus::state::staged::Edit;
use crate::devices::interbus::state::{
    Encoder, InterbusAction as Interbus, cams, explain, format, forms, word_meaning,
};
use crate::ui::controls::{
    card, committed_entry, dropdown, empty_placeholder, enabled_button, entry, paragraph, problem_ui, row,
    show_error_below, show_error_beside, two_columns,
};
use crate::ui::{Theme, icons};

/// Typed text that has not been applied yet.
#[derive(Default)]
pub(super) struct EncoderParametersUiState {
    drafts: BTreeMap<&'static str, Option<(String, Option<Text>)>>,
    preset: String,
    preset_problem: Option<Text>,
}

const ENTRY_WIDTH: f32 = 96.0;
const TEXT_WIDTH: f32 = 240.0;
/// Width of a process data word shown as hexadecimal digits.
const WORD: f32 = 80.0;

pub(super) fn page_ui(
    ui: &mut Ui,
    theme: &Theme,
    encoder: &Encoder,
    view: &mut EncoderParametersUiState,
    actions: &mut Vec<Action>,
) {
    let is_profile = encoder.profile().is_some();
    two_columns(
        ui,
        theme,
        (actions, view),
        |ui, (actions, view)| {
            table_ui(ui, theme, encoder, view, actions);
        },
        |ui, (actions, view)| {
            if is_profile {
                return;
            }
            preset_ui(ui, theme, encoder, view, actions);
            theme.add_gap(ui);
            eeprom_wear_ui(ui, theme, encoder);
        },
    );
    if !is_profile {
        theme.add_gap(ui);
        handshake_ui(ui, theme, encoder);
    }
}

fn table_ui(
    ui: &mut Ui,
    theme: &Theme,
    encoder: &Encoder,
    view: &mut EncoderParametersUiState,
    actions: &mut Vec<Action>,
) {
    card(ui, theme, TEXTS.text("ib_set.title"), |ui| {
        let (Some(device), Some(wanted)) = (encoder.staged.device(), encoder.staged.edited_values()) else {
            empty_placeholder(ui, theme, &translate(theme, "ib_set.nothing"), None);
            return;
        };
        let id = encoder.session.id;
        let (old, new) = (&device.parameters, &wanted.image.parameters);
        for parameter in
            [Parameter::Turns, Parameter::Steps, Parameter::Direction, Parameter::Preset, Parameter::ZeroShift]
        {
            let word = theme.format_text(&format::parameter(parameter));
            let (Some(before), Some(now)) = (old.value(parameter), new.value(parameter)) else { continue };
            entry(ui, theme, &word, |ui| {
                if parameter == Parameter::Direction {
                    let mut direction = new.direction;
                    let both = [Direction::Clockwise, Direction::Counterclockwise];
                    let both = both.map(|own| (own, theme.format_text(&explain::direction_text(own))));
                    if dropdown(ui, &word, &mut direction, both) {
                        actions.push(Action::device(id, Interbus::Edit(Box::new(Edit::Direction(direction)))));
                    }
                } else {
                    let draft = view.drafts.entry(parameter.name()).or_default();
                    committed_entry(ui, draft, &now.to_string(), ENTRY_WIDTH, &word, |text| {
                        let edit = forms::parse_parameter_edit(parameter, text, new)?;
                        actions.push(Action::device(id, Interbus::Edit(Box::new(edit))));
                        Ok(())
                    });
                }
                let refused = view.drafts.get(parameter.name()).and_then(|draft| draft.as_ref()?.1.as_ref());
                if refused.is_some() {
                    show_error_beside(ui, theme, refused);
                } else if before != now {
                    let was = TEXTS.text("ib_set.was").with_text("value", format::setting(parameter, before));
                    ui.add(
                        egui::Label::new(RichText::new(theme.format_text(&was)).color(theme.palette.staged)).truncate(),
                    );
                } else if let Ok(gear) = new.gear()
                    && parameter != Parameter::Direction
                {
                    let range = parameter.valid_range(gear);
                    let range = theme.caption(format!("{} … {}", range.start(), range.end()));
                    ui.add(egui::Label::new(range).truncate());
                }
            });
        }
        ui.add_space(theme.space.inside);
        match new.gear() {
            Ok(gear) => {
                let per_turn = f64::from(gear.total_steps()) / f64::from(gear.turns());
                let text = TEXTS
                    .text("ib_set.gear")
                    .with_number("steps", per_turn, if gear.total_steps() % gear.turns() == 0 { 0 } else { 4 })
                    .with_number("degrees", 360.0 / per_turn, 5);
                paragraph(ui, theme.label(theme.format_text(&text)));
                if gear.total_steps() % gear.turns() != 0 {
                    paragraph(ui, theme.caption(translate(theme, "ib_set.uneven")));
                }
            }
            Err(error) => {
                problem_ui(ui, theme, Some(&cams::labels::gear(&error)));
            }
        }
        if encoder.identity().is_some_and(|own| own.flags.steps_minus_one()) {
            paragraph(ui, theme.caption(translate(theme, "ib_set.steps_minus_one")));
        }
        paragraph(ui, theme.caption(translate(theme, "ib_set.mounting")));
    });
}

fn preset_ui(
    ui: &mut Ui,
    theme: &Theme,
    encoder: &Encoder,
    view: &mut EncoderParametersUiState,
    actions: &mut Vec<Action>,
) {
    card(ui, theme, TEXTS.text("ib_preset.title"), |ui| {
        paragraph(ui, theme.label(translate(theme, "ib_preset.words")));
        let id = encoder.session.id;
        let Some(parameters) = encoder.staged.device().map(|image| image.parameters) else { return };
        let ready = encoder.session.is_ready() && encoder.is_stopped();
        let word = translate(theme, "ib_preset.value");
        entry(ui, theme, &word, |ui| {
            let hint = parameters.preset.to_string();
            crate::ui::controls::text_entry(ui, &mut view.preset, ENTRY_WIDTH, &word, &hint);
            if enabled_button(ui, ready, icons::TARGET, &translate(theme, "ib_preset.set")).clicked() {
                match forms::parse_preset(&view.preset, &parameters) {
                    Ok(value) => {
                        view.preset_problem = None;
                        actions.push(Action::device(id, Interbus::Plan(Box::new(Change::Preset { value }))));
                    }
                    Err(why) => view.preset_problem = Some(why),
                }
            }
        });
        show_error_below(ui, theme, view.preset_problem.as_ref());
        if let Some(position) = encoder.position() {
            row(ui, theme, &translate(theme, "ib_preset.now"), theme.monospace(position.to_string()));
        }
        ui.add_space(theme.space.inside);
        if enabled_button(ui, ready, icons::ARROW_COUNTER_CLOCKWISE, &translate(theme, "ib_preset.default")).clicked() {
            actions.push(Action::device(id, Interbus::Plan(Box::new(Change::Default))));
        }
        paragraph(ui, theme.caption(translate(theme, "ib_preset.default_words")));
    });
}

fn eeprom_wear_ui(ui: &mut Ui, theme: &Theme, encoder: &Encoder) {
    card(ui, theme, TEXTS.text("ib_wear.title"), |ui| {
        let Some(stores) = encoder.store_count() else {
            paragraph(ui, theme.label(translate(theme, "ib_wear.unknown")));
            return;
        };
        let palette = theme.palette;
        let ink = match WearAfterPlan::from_stores(stores.seen) {
            Some(WearAfterPlan::Worn(_) | WearAfterPlan::Unknown) => palette.bad,
            Some(WearAfterPlan::Known(_) | WearAfterPlan::Ask(_)) => palette.warn,
            None => palette.accent,
        };
        let text = TEXTS
            .text("ib_wear.seen")
            .with_text("stores", cycle_count_text(stores))
            .with("nominal", WEAR_CONFIRMATION)
            .with("last", WEAR_GUARANTEE);
        paragraph(ui, theme.format_text(&text));
        let share = (stores.seen as f32 / WEAR_GUARANTEE as f32).min(1.0);
        ui.add(egui::ProgressBar::new(share).desired_height(6.0).fill(ink.into()));
        let text = TEXTS
            .text("ib_wear.words")
            .with("warning", WEAR_WARNING)
            .with("ask", WEAR_CONFIRMATION)
            .with("limit", WEAR_LIMIT);
        paragraph(ui, theme.caption(theme.format_text(&text)));
    });
}

fn handshake_ui(ui: &mut Ui, theme: &Theme, encoder: &Encoder) {
    card(ui, theme, TEXTS.text("ib_handshake.title"), |ui| {
        if encoder.handshake.is_empty() {
            paragraph(ui, theme.label(translate(theme, "ib_handshake.nothing")));
            return;
        }
        let list = egui::ScrollArea::vertical().id_salt("handshake").max_height(TEXT_WIDTH).stick_to_bottom(true);
        list.auto_shrink([false, true]).show(ui, |ui| {
            ui.spacing_mut().item_spacing = vec2(theme.space.groups, theme.space.inside);
            // The meanings take up the width that the words leave free.
            let room = ui.available_width() - ui.spacing().scroll.allocated_width() - 3.0 * theme.space.groups;
            let meaning = (room / 2.0 - WORD).max(WORD / 2.0);
            let cell = |ui: &mut Ui, width: f32, words: RichText| {
                let size = vec2(width, ui.spacing().interact_size.y);
                ui.allocate_ui_with_layout(size, Layout::left_to_right(Align::Center), |ui| {
                    ui.set_min_width(width);
                    ui.add(egui::Label::new(words).truncate());
                });
            };
            for step in &encoder.handshake {
                let known = word_meaning::WordContext::for_command(step.command, encoder.shift());
                ui.horizontal(|ui| {
                    cell(ui, WORD, theme.monospace(format!("0x{:08X}", step.out)));
                    cell(ui, meaning, theme.label(theme.format_text(&word_meaning::command_text(step.command))));
                    cell(ui, WORD, theme.monospace(format!("0x{:08X}", step.input)));
                    cell(ui, meaning, theme.label(theme.format_text(&word_meaning::word_text(step.input, &known))));
                });
            }
        });
    });
}
