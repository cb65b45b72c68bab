//! The confirmation dialog before an action that would cause data loss.

use egui::RichText;

use crate::app::{Action, Studio};
use crate::ui::controls::{labelled_button, modal, name, paragraph, right_aligned};
use crate::ui::{Theme, icons};

pub(in crate::ui) fn question_ui(ctx: &egui::Context, theme: &Theme, studio: &Studio, actions: &mut Vec<Action>) {
    let Some(question) = &studio.question else { return };
    modal(ctx, theme, "question", 420.0, |ui| {
        ui.horizontal_top(|ui| {
            ui.label(RichText::new(icons::WARNING).size(theme.sizes.value).color(theme.palette.warn));
            paragraph(ui, theme.format_text(&question.text));
        });
        theme.add_gap(ui);
        right_aligned(ui, |ui| {
            let word = theme.format_text(&question.confirm);
            let response = ui.button(RichText::new(&word).color(theme.palette.bad));
            if name(response, true, &word).clicked() {
                actions.push(Action::Confirm);
            }
            if labelled_button(ui, "", &theme.format_text(&question.decline)).clicked() {
                actions.push(Action::Escape);
            }
        });
    });
}
