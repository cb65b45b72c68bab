//! The values page: analogue channels and the counter.

use egui::{RichText, Ui};

use crate::app::{Action, Text};
use crate::devices::hiperface::jobs::Change;
use crate::devices::hiperface::state::{Encoder, HiperfaceAction as Hiperface, TEXTS, forms};
use crate::devices::hiperface::views::translate;
use crate::ui::controls::{card, card_with_trailing, enabled_button, entry, paragraph, text_entry, two_columns};
use crate::ui::{Theme, icons};

pub(super) struct ValuesUiState {
    channel: String,
    problem: Option<Text>,
}

impl Default for ValuesUiState {
    fn default() -> Self {
        ValuesUiState { channel: "48".to_owned(), problem: None }
    }
}

pub(super) fn page_ui(
    ui: &mut Ui,
    theme: &Theme,
    encoder: &Encoder,
    view: &mut ValuesUiState,
    actions: &mut Vec<Action>,
) {
    two_columns(
        ui,
        theme,
        (actions, view),
        |ui, (actions, view)| analogue_ui(ui, theme, encoder, view, actions),
        |ui, (actions, _)| counter_ui(ui, theme, encoder, actions),
    );
}

fn analogue_ui(ui: &mut Ui, theme: &Theme, encoder: &Encoder, view: &mut ValuesUiState, actions: &mut Vec<Action>) {
    let palette = theme.palette;
    card(ui, theme, TEXTS.text("analogue_card.title"), |ui| {
        paragraph(ui, theme.label(translate(theme, "analogue_card.words")));
        for (channel, value) in &encoder.analogue {
            entry(ui, theme, &format!("{channel:02X}h"), |ui| match value {
                Ok((value, limit)) => {
                    let over = limit.is_some_and(|limit| *value > limit);
                    ui.label(theme.value(value.to_string()).color(if over { palette.bad } else { palette.text }));
                    if let Some(limit) = limit {
                        let text = TEXTS.text("analogue_card.limit").with("limit", limit);
                        ui.label(theme.label(theme.format_text(&text)));
                    }
                    if over {
                        ui.label(RichText::new(icons::WARNING).color(palette.bad));
                        ui.label(RichText::new(translate(theme, "analogue_card.over")).color(palette.bad));
                    }
                }
                Err(why) => {
                    paragraph(ui, theme.label(theme.format_text(why)));
                }
            });
        }
        ui.add_space(theme.space.inside);
        entry(ui, theme, &translate(theme, "analogue_card.channel"), |ui| {
            let label = translate(theme, "analogue_card.channel");
            let response = text_entry(ui, &mut view.channel, 48.0, &label, "48");
            let enter = response.lost_focus() && ui.input(|input| input.key_pressed(egui::Key::Enter));
            let read =
                enabled_button(ui, encoder.session.is_ready(), icons::EYE, &translate(theme, "analogue_card.read"));
            if read.clicked() || (enter && encoder.session.is_ready()) {
                match forms::parse_channel(&view.channel) {
                    Ok(channel) => {
                        view.problem = None;
                        actions.push(Action::device(encoder.session.id, Hiperface::ReadAnalogue(channel)));
                    }
                    Err(problem) => view.problem = Some(problem),
                }
            }
        });
        if let Some(problem) = &view.problem {
            ui.label(RichText::new(theme.format_text(problem)).color(palette.bad));
        }
    });
}

fn counter_ui(ui: &mut Ui, theme: &Theme, encoder: &Encoder, actions: &mut Vec<Action>) {
    let ready = encoder.session.is_ready();
    let read = |ui: &mut Ui| {
        if enabled_button(ui, ready, icons::ARROW_CLOCKWISE, &translate(theme, "counter_card.read")).clicked() {
            actions.push(Action::device(encoder.session.id, Hiperface::ReadCounter));
        }
    };
    let mut change = None;
    card_with_trailing(ui, theme, TEXTS.text("counter_card.title"), read, |ui| {
        ui.label(theme.value(encoder.counter.map_or_else(|| "–".to_owned(), |counter| counter.to_string())));
        paragraph(ui, theme.label(translate(theme, "counter_card.words")));
        ui.horizontal(|ui| {
            if enabled_button(ui, ready, icons::PLUS, &translate(theme, "counter_card.increment")).clicked() {
                change = Some(Change::IncrementCounter);
            }
            if enabled_button(ui, ready, icons::ARROW_COUNTER_CLOCKWISE, &translate(theme, "counter_card.clear"))
                .clicked()
            {
                change = Some(Change::ClearCounter);
            }
        });
    });
    actions.extend(change.map(|change| Action::device(encoder.session.id, Hiperface::Plan(change))));
}
