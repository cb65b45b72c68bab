//! The export page, on which the layout can be copied or saved in the formats of other programs. Pictures are shown as
//! drawings.

use egui::{FontId, Ui};

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
    let picture = encoder.designer.layout_drawing(own, theme.language);
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
            let glyph = ui.fonts_mut(|fonts| fonts.glyph_width(&FontId::monospace(theme.sizes.body), '0'));
            let columns = (ui.available_width() / glyph) as usize;
            // Copied code must not contain the line breaks of the window.
            let text = if own == ExportFormat::Sheet { wrap_sheet(text, columns) } else { text.clone() };
            ui.add(egui::Label::new(theme.monospace(text)).selectable(true).wrap());
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

/// Wraps long lines of a settings sheet at spaces. Continuation lines are aligned with the value, which follows two
/// spaces.
fn wrap_sheet(text: &str, columns: usize) -> String {
    text.lines().map(|line| wrap_line(line, columns)).collect::<Vec<_>>().join("\n")
}

fn wrap_line(line: &str, columns: usize) -> String {
    if line.chars().count() <= columns {
        return line.to_owned();
    }
    let indent = line.len() - line.trim_start().len();
    let start = line.trim_start().rfind("  ").map_or(indent, |at| indent + at + 2);
    let (label, value) = line.split_at(start);
    let start = label.chars().count();
    let (mut wrapped, mut at) = (label.to_owned(), start);
    for (number, word) in value.split(' ').enumerate() {
        let length = word.chars().count();
        if number > 0 && at + 1 + length > columns {
            wrapped.push('\n');
            wrapped.extend(std::iter::repeat_n(' ', start));
            at = start;
        } else if number > 0 {
            wrapped.push(' ');
            at += 1;
        }
        wrapped.push_str(word);
        at += length;
    }
    wrapped
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn wraps_long_sheet_lines() {
        let sheet = "Monoflopzeit   15 bis 25 µs (die Pause muss länger sein)\n\n  Code  Dual\nDer Geber wird nicht programmiert.";
        let expected = "Monoflopzeit   15 bis 25 µs (die\n               Pause muss länger\n               sein)\n\n  Code  Dual\nDer Geber wird nicht\nprogrammiert.";
        assert_eq!(wrap_sheet(sheet, 32), expected);
        assert_eq!(wrap_sheet(sheet, 80), sheet);
        assert_eq!(wrap_sheet("  one_long_word", 5), "  one_long_word", "a word is not broken");
    }
}
