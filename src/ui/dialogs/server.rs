//! The form for the logbook server.

use egui::{RichText, Ui};

use crate::app::{Action, ServerAction, ServerForm, Studio};
use crate::store::Password;
use crate::ui::controls::{enabled_button, entry, labelled_button, modal, paragraph, primary_button, right_aligned};
use crate::ui::entries::{mono_entry, secret_entry};
use crate::ui::{Theme, icons};

const WIDTH: f32 = 560.0;
/// Height in points reserved for the result of a connection test.
const OUTCOME_HEIGHT: f32 = 60.0;

/// Text typed into the form. It is discarded when the form is closed.
#[derive(Default)]
pub(in crate::ui) struct ServerView {
    typed: Option<Typed>,
}

struct Typed {
    address: String,
    password: String,
    /// Id of the password entry, whose state could still contain the password after the form is closed.
    entry: Option<egui::Id>,
}

pub(in crate::ui) fn server_ui(
    ctx: &egui::Context,
    theme: &Theme,
    studio: &Studio,
    view: &mut ServerView,
    actions: &mut Vec<Action>,
) {
    let Some(form) = studio.server_form() else {
        if let Some(entry) = view.typed.take().and_then(|typed| typed.entry) {
            egui::TextEdit::store_state(ctx, entry, egui::text_edit::TextEditState::default());
        }
        return;
    };
    let begin = || Typed {
        address: form.address().to_owned(),
        password: form.password().map(|password| password.reveal().to_owned()).unwrap_or_default(),
        entry: None,
    };
    let typed = view.typed.get_or_insert_with(begin);
    modal(ctx, theme, "server", WIDTH, |ui| {
        ui.label(theme.heading(theme.translate("server_form.title")));
        ui.add_space(theme.space.inside);
        paragraph(ui, theme.translate("server_form.words"));
        ui.add_space(theme.space.between);
        let word = theme.translate("server_form.address");
        let example = theme.translate("server_form.example");
        entry(ui, theme, &word, |ui| mono_entry(ui, theme, &mut typed.address, ui.available_width(), &word, &example));
        ui.add_space(theme.space.inside);
        let word = theme.translate("server_form.password");
        let secret = entry(ui, theme, &word, |ui| secret_entry(ui, &mut typed.password, ui.available_width(), &word));
        typed.entry = Some(secret.id);
        ui.add_space(theme.space.inside);
        paragraph(ui, theme.caption(theme.translate("server_form.password_words")));
        if form.is_server_given() {
            paragraph(ui, theme.caption(theme.translate("server_form.given")));
        }
        ui.add_space(theme.space.inside);
        outcome_ui(ui, theme, form);
        buttons_ui(ui, theme, form, typed, actions);
    });
}

fn outcome_ui(ui: &mut Ui, theme: &Theme, form: &ServerForm) {
    let top = ui.cursor().top();
    let palette = theme.palette;
    match form.outcome() {
        _ if form.is_testing() => paragraph(ui, theme.label(theme.translate("server_form.testing"))),
        Some(Ok(text)) => paragraph(ui, RichText::new(theme.format_text(text)).color(palette.good)),
        Some(Err(text)) => paragraph(ui, RichText::new(theme.format_text(text)).color(palette.bad)),
        None => ui.skip_ahead_auto_ids(1),
    }
    // This keeps the buttons from moving under the pointer.
    ui.add_space((top + OUTCOME_HEIGHT - ui.cursor().top()).max(0.0));
}

fn buttons_ui(ui: &mut Ui, theme: &Theme, form: &ServerForm, typed: &Typed, actions: &mut Vec<Action>) {
    let values = || (typed.address.clone(), Password::new(typed.password.clone()));
    right_aligned(ui, |ui| {
        if primary_button(ui, theme, true, icons::FLOPPY_DISK, &theme.translate("server_form.save")).clicked() {
            let (address, password) = values();
            actions.push(Action::Server(ServerAction::Save { address, password }));
        }
        let can_test = !form.is_testing() && !typed.address.trim().is_empty();
        let word = theme.translate("server_form.test");
        if enabled_button(ui, can_test, icons::PLUGS_CONNECTED, &word).clicked() {
            let (address, password) = values();
            actions.push(Action::Server(ServerAction::Test { address, password }));
        }
        if labelled_button(ui, "", &theme.translate("server_form.cancel")).clicked() {
            actions.push(Action::Server(ServerAction::Close));
        }
    });
}
