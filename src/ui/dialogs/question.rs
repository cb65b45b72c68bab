//! A question before something is lost.

use egui::RichText;

use crate::app::{Action, Studio};
use crate::ui::controls::{at_the_right, button, modal, name, paragraph};
use crate::ui::{Skin, icons};

/// Draws the open question.
pub(in crate::ui) fn question_ui(ctx: &egui::Context, skin: &Skin, studio: &Studio, actions: &mut Vec<Action>) {
    let Some(question) = &studio.question else { return };
    modal(ctx, skin, "question", 420.0, |ui| {
        ui.horizontal_top(|ui| {
            ui.label(RichText::new(icons::WARNING).size(skin.sizes.value).color(skin.palette.warn));
            paragraph(ui, skin.words(&question.text));
        });
        ui.add_space(skin.space.groups);
        at_the_right(ui, |ui| {
            let word = skin.words(&question.confirm);
            let response = ui.button(RichText::new(&word).color(skin.palette.bad));
            if name(response, true, &word).clicked() {
                actions.push(Action::Confirm);
            }
            if button(ui, "", &skin.words(&question.decline)).clicked() {
                actions.push(Action::Escape);
            }
        });
    });
}
