//! Draws form rows with a number, a choice, a switch or a name. The state module defines their meaning.

use std::collections::BTreeMap;

use crate::devices::ssi::views::translate;

use egui::{Key, Ui};

use crate::app::{Action, Text};
use crate::devices::ssi::state::timing::{frequency, read_frequency};
use crate::devices::ssi::state::{Encoder, Entry, Field, FieldInput, Row, SsiAction as Ssi, parse_whole};
use crate::ui::Theme;
use crate::ui::controls::{committed_entry, dropdown, entry, label_width, show_error_beside};

#[derive(Default)]
pub(super) struct LayoutFormUiState {
    drafts: BTreeMap<Field, Option<(String, Option<Text>)>>,
}

const NUMBER_WIDTH: f32 = 104.0;
const NAME_WIDTH: f32 = 160.0;

pub(super) fn rows_ui(
    ui: &mut Ui,
    theme: &Theme,
    encoder: &Encoder,
    rows: &[Row],
    view: &mut LayoutFormUiState,
    actions: &mut Vec<Action>,
) {
    for row in rows {
        let word = theme.format_text(&row.name);
        let mut put = |input| actions.push(Action::device(encoder.session.id, Ssi::Enter(row.field, input)));
        let response = match &row.entry {
            Entry::Switch(is_on) => {
                let mut is_on = *is_on;
                ui.horizontal(|ui| {
                    ui.add_space(label_width(ui) + ui.spacing().item_spacing.x);
                    let response = ui.checkbox(&mut is_on, &word);
                    if response.changed() {
                        put(FieldInput::Switch(is_on));
                    }
                    response
                })
                .inner
            }
            Entry::Choice { options, chosen } => {
                let mut own = *chosen;
                let all = options.iter().enumerate().map(|(at, text)| (at, theme.format_text(text)));
                let inner = ui.scope(|ui| {
                    entry(ui, theme, &word, |ui| {
                        if dropdown(ui, &word, &mut own, all) {
                            put(FieldInput::Choice(own));
                        }
                    });
                });
                inner.response
            }
            Entry::Number { value, unit } => {
                let draft = view.drafts.entry(row.field).or_default();
                entry(ui, theme, &word, |ui| {
                    let response = committed_entry(ui, draft, &value.to_string(), NUMBER_WIDTH, &word, |text| {
                        put(FieldInput::Number(parse_whole(text)?));
                        Ok(())
                    });
                    // The arrow keys increase and decrease the number.
                    if response.has_focus() {
                        let (up, down) =
                            ui.input(|input| (input.key_pressed(Key::ArrowUp), input.key_pressed(Key::ArrowDown)));
                        if up || down {
                            *draft = None;
                            put(FieldInput::Number(if up { value.saturating_add(1) } else { value.saturating_sub(1) }));
                        }
                    }
                    if let Some(unit) = unit {
                        ui.label(theme.label(theme.format_text(unit)));
                    }
                    show_error_beside(ui, theme, rejection(draft));
                    response
                })
            }
            Entry::Frequency(hertz) => {
                let draft = view.drafts.entry(row.field).or_default();
                let shown = theme.format_text(&frequency((*hertz).into()));
                entry(ui, theme, &word, |ui| {
                    let response = committed_entry(ui, draft, &shown, NUMBER_WIDTH, &word, |text| {
                        put(FieldInput::Number(read_frequency(text)?.into()));
                        Ok(())
                    });
                    show_error_beside(ui, theme, rejection(draft));
                    response
                })
            }
            Entry::Words(words) => {
                let draft = view.drafts.entry(row.field).or_default();
                entry(ui, theme, &word, |ui| {
                    let response = committed_entry(ui, draft, words, NAME_WIDTH, &word, |text| {
                        put(FieldInput::Words(text.to_owned()));
                        Ok(())
                    });
                    show_error_beside(ui, theme, rejection(draft));
                    response
                })
            }
        };
        if let Some(hint) = row.hint {
            response.on_hover_text(translate(theme, hint));
        }
    }
}

fn rejection(draft: &Option<(String, Option<Text>)>) -> Option<&Text> {
    draft.as_ref()?.1.as_ref()
}
