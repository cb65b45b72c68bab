//! The export page: the layout in formats of other programs, to copy or save. Pictures are shown as pictures.

use egui::{ScrollArea, Ui};

use super::picture::picture_ui;
use crate::app::{Action, DeviceCommand};
use crate::devices::ssi::state::{Encoder, ExportFormat, SsiAction as Ssi, TEXTS};
use crate::devices::ssi::views::translate;
use crate::ui::controls::{card, card_with_trailing, enabled_button, labelled_button, name, paragraph, problem_ui};
use crate::ui::{Theme, icons};

#[derive(Default)]
pub(super) struct ExportUiState {
    format: Option<ExportFormat>,
}

pub(super) fn page_ui(
    ui: &mut Ui,
    theme: &Theme,
    encoder: &Encoder,
    view: &mut ExportUiState,
    actions: &mut Vec<Action>,
) {
    let id = encoder.session.id;
    let own = view.format.unwrap_or(ExportFormat::Sheet);
    ui.horizontal_wrapped(|ui| {
        for format in ExportFormat::ALL {
            let word = translate(theme, format.keyword());
            let response = ui.add(egui::Button::selectable(own == format, &word));
            if name(response, true, &word).on_hover_text(translate(theme, format.hint_id())).clicked() {
                view.format = Some(format);
            }
        }
    });
    ui.add_space(theme.space.between);
    paragraph(ui, theme.label(translate(theme, own.hint_id())));
    ui.add_space(theme.space.between);
    let picture = encoder.designer.layout_picture(own, theme.language);
    let text = encoder.designer.export(own, theme.language);
    let copy = if picture.is_some() { "ssi_export.copy_svg" } else { "ssi_export.copy" };
    let aside = |ui: &mut Ui| {
        let is_there = text.is_ok();
        if enabled_button(ui, is_there, icons::FLOPPY_DISK, &translate(theme, "ssi_export.save")).clicked() {
            actions.push(Action::device(id, Ssi::AskExport(own, theme.language)));
        }
        if enabled_button(ui, is_there, icons::COPY, &translate(theme, copy)).clicked()
            && let Ok(text) = &text
        {
            ui.copy_text(text.clone());
        }
    };
    card_with_trailing(ui, theme, TEXTS.text(own.keyword()), aside, |ui| match (&picture, &text) {
        (Some(picture), _) => picture_ui(ui, theme, picture),
        (None, Ok(text)) => {
            let height = (ui.ctx().content_rect().height() - 330.0).max(160.0);
            ScrollArea::both().id_salt(own.keyword()).max_height(height).auto_shrink([false, true]).show(ui, |ui| {
                ui.add(egui::Label::new(theme.monospace(text)).selectable(true).extend());
            });
        }
        (None, Err(why)) => problem_ui(ui, theme, Some(why)),
    });
    theme.add_gap(ui);
    card(ui, theme, TEXTS.text("ssi_export.profile"), |ui| {
        paragraph(ui, theme.label(translate(theme, "ssi_export.profile_words")));
        ui.horizontal(|ui| {
            if labelled_button(ui, icons::FLOPPY_DISK, &theme.translate("profile_card.save")).clicked() {
                actions.push(Action::Save(id));
            }
            if labelled_button(ui, "", &theme.translate("profile_card.save_as")).clicked() {
                actions.push(Action::Command(id, DeviceCommand::AskSave));
            }
        });
    });
}
