//! The layout for other programs: as text to be read, copied and saved.

use egui::{ScrollArea, Ui};

use crate::app::{Action, DeviceCommand};
use crate::devices::ssi::state::{Action as Ssi, Encoder, Format, TEXTS};
use crate::devices::ssi::views::say;
use crate::ui::controls::{button, card, card_with, enabled_button, name, paragraph, problem};
use crate::ui::{Skin, icons};

/// Which one is looked at.
#[derive(Default)]
pub(super) struct View {
    format: Option<Format>,
}

pub(super) fn page_ui(ui: &mut Ui, skin: &Skin, encoder: &Encoder, view: &mut View, actions: &mut Vec<Action>) {
    let id = encoder.session.id;
    let own = view.format.unwrap_or(Format::Sheet);
    ui.horizontal_wrapped(|ui| {
        for format in Format::ALL {
            let word = say(skin, format.word());
            let response = ui.add(egui::Button::selectable(own == format, &word));
            if name(response, true, &word).on_hover_text(say(skin, format.hint())).clicked() {
                view.format = Some(format);
            }
        }
    });
    ui.add_space(skin.space.between);
    paragraph(ui, skin.label(say(skin, own.hint())));
    ui.add_space(skin.space.between);
    let text = encoder.designer.export(own);
    let aside = |ui: &mut Ui| {
        let is_there = text.is_ok();
        if enabled_button(ui, is_there, icons::FLOPPY_DISK, &say(skin, "ssi_export.save")).clicked() {
            actions.push(Action::device(id, Ssi::AskExport(own)));
        }
        if enabled_button(ui, is_there, icons::COPY, &say(skin, "ssi_export.copy")).clicked()
            && let Ok(text) = &text
        {
            ui.copy_text(text.clone());
        }
    };
    card_with(ui, skin, TEXTS.text(own.word()), aside, |ui| match &text {
        Ok(text) => {
            let height = (ui.ctx().content_rect().height() - 330.0).max(160.0);
            ScrollArea::both().id_salt(own.word()).max_height(height).auto_shrink([false, true]).show(ui, |ui| {
                ui.add(egui::Label::new(skin.mono(text)).selectable(true).extend());
            });
        }
        Err(why) => problem(ui, skin, Some(why)),
    });
    ui.add_space(skin.space.groups);
    card(ui, skin, TEXTS.text("ssi_export.profile"), |ui| {
        paragraph(ui, skin.label(say(skin, "ssi_export.profile_words")));
        ui.horizontal(|ui| {
            if button(ui, icons::FLOPPY_DISK, &skin.say("profile_card.save")).clicked() {
                actions.push(Action::Save(id));
            }
            if button(ui, "", &skin.say("profile_card.save_as")).clicked() {
                actions.push(Action::Command(id, DeviceCommand::AskSave));
            }
        });
    });
}
