//! The trial frame. The user can enter a position to see its bits, or bits to see their position. The last word read
//! can be used as well.

use egui::{RichText, Ui};

use crate::app::{Action, Text};
use crate::devices::ssi::protocol::{BitMeaning, Location, frame_bits};
use crate::devices::ssi::state::explain;
use crate::devices::ssi::state::{Decoded, Encoder, SsiAction as Ssi, TEXTS, TrialInput, parse_whole};
use crate::devices::ssi::views::translate;
use crate::ui::controls::{
    card_with_trailing, committed_entry, entry, icon_button, mono_entry, name, paragraph, row, show_error_below,
    show_error_beside,
};
use crate::ui::{Theme, icons};

#[derive(Default)]
pub(super) struct TrialUiState {
    position: Option<(String, Option<Text>)>,
    turns: Option<(String, Option<Text>)>,
    steps: Option<(String, Option<Text>)>,
    bits: Option<String>,
    /// Frame that was displayed when the user began to type. Words received in the meantime do not replace it.
    held: Option<Decoded>,
}

impl TrialUiState {
    /// Returns whether the user is typing. A rejected entry that is still shown does not count.
    fn is_typing(&self) -> bool {
        let numbers = [&self.position, &self.turns, &self.steps];
        self.bits.is_some() || numbers.into_iter().flatten().any(|(_, problem)| problem.is_none())
    }
}

const ENTRY_WIDTH: f32 = 128.0;

pub(super) fn card_ui(
    ui: &mut Ui,
    theme: &Theme,
    encoder: &Encoder,
    view: &mut TrialUiState,
    actions: &mut Vec<Action>,
) {
    let shown = view.held.take().filter(|_| view.is_typing()).unwrap_or_else(|| encoder.displayed_frame());
    let is_live = encoder.is_showing_live_frame();
    let id = encoder.session.id;
    let mut action = None;
    let live = |ui: &mut Ui| {
        if encoder.last().is_some_and(|seen| seen.decoded.is_some()) {
            let word = translate(theme, "ssi_trial.live");
            let response =
                ui.add(egui::Button::selectable(is_live, &word)).on_hover_text(translate(theme, "ssi_trial.live_hint"));
            if name(response, true, &word).clicked() && !is_live {
                action = Some(TrialInput::Live);
            }
        }
    };
    card_with_trailing(ui, theme, TEXTS.text("ssi_trial.title"), live, |ui| {
        numbers_ui(ui, theme, encoder, &shown, view, &mut |with| actions.push(Action::device(id, Ssi::Try(with))));
        bits_ui(ui, theme, encoder, &shown, view, actions);
        show_error_below(ui, theme, encoder.trial.problem());
        findings_ui(ui, theme, &shown);
    });
    actions.extend(action.map(|with| Action::device(id, Ssi::Try(with))));
    view.held = view.is_typing().then_some(shown);
}

fn numbers_ui(
    ui: &mut Ui,
    theme: &Theme,
    encoder: &Encoder,
    shown: &Decoded,
    view: &mut TrialUiState,
    put: &mut dyn FnMut(TrialInput),
) {
    let position = shown.place.map_or_else(|| "–".to_owned(), |(position, _)| position.to_string());
    let most = TEXTS.text("ssi_trial.most").with("most", encoder.designer.layout().position_code().last_position());
    paragraph(ui, theme.caption(theme.format_text(&most)));
    let word = translate(theme, "ssi_trial.position");
    entry(ui, theme, &word, |ui| {
        committed_entry(ui, &mut view.position, &position, ENTRY_WIDTH, &word, |text| {
            put(TrialInput::Position(parse_whole(text)?));
            Ok(())
        });
        refusal_ui(ui, theme, view.position.as_ref());
    });
    match shown.place {
        Some((_, Location::Shaft { turns, steps, degrees })) => {
            let (own_turns, own_steps) = (theme.translate("live.turns"), theme.translate("live.step"));
            entry(ui, theme, &own_turns, |ui| {
                committed_entry(ui, &mut view.turns, &turns.to_string(), ENTRY_WIDTH, &own_turns, |text| {
                    put(TrialInput::Place(parse_whole(text)?, steps));
                    Ok(())
                });
                refusal_ui(ui, theme, view.turns.as_ref());
            });
            entry(ui, theme, &own_steps, |ui| {
                committed_entry(ui, &mut view.steps, &steps.to_string(), ENTRY_WIDTH, &own_steps, |text| {
                    put(TrialInput::Place(turns, parse_whole(text)?));
                    Ok(())
                });
                refusal_ui(ui, theme, view.steps.as_ref());
            });
            row(
                ui,
                theme,
                &translate(theme, "ssi_trial.angle"),
                theme.monospace(format!("{} °", theme.format_number(degrees, 4))),
            );
        }
        Some((_, Location::Length { millimetres })) => {
            row(
                ui,
                theme,
                &translate(theme, "ssi_trial.length"),
                theme.monospace(format!("{} mm", theme.format_number(millimetres, 4))),
            );
        }
        None => {}
    }
}

fn refusal_ui(ui: &mut Ui, theme: &Theme, draft: Option<&(String, Option<Text>)>) {
    show_error_beside(ui, theme, draft.and_then(|(_, problem)| problem.as_ref()));
}

fn bits_ui(
    ui: &mut Ui,
    theme: &Theme,
    encoder: &Encoder,
    shown: &Decoded,
    view: &mut TrialUiState,
    actions: &mut Vec<Action>,
) {
    let clocks = encoder.designer.layout().clock_count();
    let own = frame_bits(shown.frame, clocks);
    let word = translate(theme, "ssi_trial.bits_label");
    ui.horizontal(|ui| {
        ui.label(theme.label(&word));
        ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
            if icon_button(ui, true, icons::COPY, &translate(theme, "ssi_trial.copy")).clicked() {
                ui.copy_text(own.clone());
            }
            let hex = format!("0x{:0width$X}", shown.frame, width = usize::from(clocks).div_ceil(4));
            ui.add(egui::Label::new(theme.monospace(hex)).selectable(true));
        });
    });
    let mut text = view.bits.take().unwrap_or_else(|| own.clone());
    // The frame around the entry adds its own width to the width of the text.
    let width = (ui.available_width() - 18.0).max(0.0);
    let response = mono_entry(ui, theme, &mut text, width, &word, "");
    if response.has_focus() {
        view.bits = Some(text);
    } else if response.lost_focus() && text.trim() != own {
        actions.push(Action::device(encoder.session.id, Ssi::Try(TrialInput::Bits(text))));
    }
}

fn findings_ui(ui: &mut Ui, theme: &Theme, shown: &Decoded) {
    if shown.findings.is_empty() {
        return;
    }
    ui.add_space(theme.space.inside);
    for finding in &shown.findings {
        let (icon, colour) = match finding.meaning() {
            BitMeaning::Invalid => (icons::X_CIRCLE, theme.palette.bad),
            BitMeaning::Warning => (icons::WARNING, theme.palette.warn),
        };
        ui.horizontal_top(|ui| {
            ui.label(RichText::new(icon).color(colour));
            paragraph(ui, theme.format_text(&explain::finding_text(finding)));
        });
    }
}
