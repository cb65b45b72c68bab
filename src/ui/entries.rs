//! One-line text entries: plain, monospace, secret, labelled, and one whose text takes effect when it loses focus.

use egui::{Response, Ui, WidgetInfo};

use super::Theme;
use super::controls::entry;
use crate::app::Text;

/// Inner margin of a text entry. It makes the entry as high as a button.
const FIELD: egui::Margin = egui::Margin::symmetric(8, 6);
pub fn text_entry(ui: &mut Ui, text: &mut String, width: f32, label: &str, hint: &str) -> Response {
    sized_entry(ui, text, width, label, hint, egui::TextStyle::Body.into())
}

pub(crate) fn mono_entry(
    ui: &mut Ui,
    theme: &Theme,
    text: &mut String,
    width: f32,
    label: &str,
    hint: &str,
) -> Response {
    sized_entry(ui, text, width, label, hint, egui::FontId::monospace(theme.sizes.body).into())
}

fn sized_entry(
    ui: &mut Ui,
    text: &mut String,
    width: f32,
    label: &str,
    hint: &str,
    font: egui::FontSelection,
) -> Response {
    let edit = egui::TextEdit::singleline(text).desired_width(width).hint_text(hint).margin(FIELD).font(font);
    let response = ui.add(edit);
    let value = text.clone();
    response.widget_info(|| {
        let mut info = WidgetInfo::text_edit(true, &value, &value, hint);
        info.label = Some(label.to_owned());
        info
    });
    response
}

/// Draws a one-line entry for a secret. The secret is hidden on screen, from screen readers and from the undo history.
pub(crate) fn secret_entry(ui: &mut Ui, text: &mut String, width: f32, label: &str) -> Response {
    let edit = egui::TextEdit::singleline(text).password(true).desired_width(width).margin(FIELD);
    let response = ui.add(edit);
    response.widget_info(|| WidgetInfo::labeled(egui::Role::PasswordInput, true, label));
    response
}

/// Clears a secret entry and any state from which the secret could be recovered.
pub(crate) fn clear_secret(ui: &Ui, response: &Response, text: &mut String) {
    text.clear();
    egui::TextEdit::store_state(ui.ctx(), response.id, egui::text_edit::TextEditState::default());
}

/// Draws a one-line number entry to the right of its label, with the decimal separator of the current language. Screen
/// readers find the entry by the label.
pub(crate) fn labelled_number_entry(
    ui: &mut Ui,
    theme: &Theme,
    what: impl Into<Text>,
    text: &mut String,
    width: f32,
    hint: &str,
) -> Response {
    let word = theme.format_text(&what.into());
    // Parsing accepts both decimal separators.
    let mut shown = theme.digits(text);
    let response = entry(ui, theme, &word, |ui| text_entry(ui, &mut shown, width, &word, hint));
    if response.changed() {
        *text = shown;
    }
    response
}

/// Draws a one-line entry whose text takes effect when it loses focus or Enter is pressed. Until then, `draft` holds
/// the text. If `take` rejects the text, it stays in the entry, and the reason is drawn below.
pub fn committed_entry(
    ui: &mut Ui,
    draft: &mut Option<(String, Option<crate::app::Text>)>,
    shown: &str,
    width: f32,
    label: &str,
    take: impl FnOnce(&str) -> Result<(), crate::app::Text>,
) -> Response {
    let (mut text, problem) = draft.take().unwrap_or_else(|| (shown.to_owned(), None));
    let response = text_entry(ui, &mut text, width, label, "");
    if response.has_focus() {
        *draft = Some((text, problem));
    } else if response.lost_focus() {
        // The earlier text is valid, whatever has been typed since.
        if text != shown
            && let Err(why) = take(&text)
        {
            *draft = Some((text, Some(why)));
        }
    } else if problem.is_some() {
        *draft = Some((text, problem));
    }
    response
}
