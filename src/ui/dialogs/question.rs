//! The question before an action by which something would be lost.

use egui::RichText;

use crate::app::{Action, Studio};
use crate::ui::controls::{button, modal, name, paragraph, right_aligned};
use crate::ui::{Theme, icons};

pub(in crate::ui) fn question_ui(ctx: &egui::Context, theme: &Theme, studio: &Studio, actions: &mut Vec<Action>) {
    let Some(question) = &studio.question else { return };
    modal(ctx, theme, "question", 420.0, |ui| {
        ui.horizontal_top(|ui| {
            ui.label(RichText::new(icons::WARNING).size(theme.sizes.value).color(theme.palette.warn));
            paragraph(ui, theme.words(&question.text));
        });
        theme.gap(ui);
        right_aligned(ui, |ui| {
            let word = theme.words(&question.confirm);
            let response = ui.button(RichText::new(&word).color(theme.palette.bad));
            if name(response, true, &word).clicked() {
                actions.push(Action::Confirm);
            }
            if button(ui, "", &theme.words(&question.decline)).clicked() {
                actions.push(Action::Escape);
            }
        });
    });
}
