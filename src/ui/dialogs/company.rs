//! The form for the company name and logo that appear in reports.

use egui::{RichText, Ui};

use crate::app::{Action, CompanyAction, CompanyForm, Studio};
use crate::ui::controls::{entry, labelled_button, modal, paragraph, primary_button, right_aligned};
use crate::ui::entries::text_entry;
use crate::ui::{Theme, icons};

const WIDTH: f32 = 480.0;
/// Height in points reserved for an error message about the logo.
const PROBLEM_HEIGHT: f32 = 44.0;

/// Text typed into the form. It is discarded when the form is closed.
#[derive(Default)]
pub(in crate::ui) struct CompanyView {
    typed: Option<Typed>,
}

struct Typed {
    name: String,
    logo: String,
    /// Path of the logo last chosen in the file dialog.
    taken: Option<String>,
}

pub(in crate::ui) fn company_ui(
    ctx: &egui::Context,
    theme: &Theme,
    studio: &Studio,
    view: &mut CompanyView,
    actions: &mut Vec<Action>,
) {
    let Some(form) = studio.company_form() else {
        view.typed = None;
        return;
    };
    let known = |text: &Option<String>| text.clone().unwrap_or_default();
    let settings = &studio.settings;
    let begin = || Typed { name: known(&settings.company), logo: known(&settings.company_logo), taken: None };
    let typed = view.typed.get_or_insert_with(begin);
    let chosen = form.chosen_logo().map(|path| path.display().to_string());
    if chosen != typed.taken {
        typed.logo = chosen.clone().unwrap_or_default();
        typed.taken = chosen;
    }
    modal(ctx, theme, "company", WIDTH, |ui| {
        ui.label(theme.heading(theme.translate("company_form.title")));
        ui.add_space(theme.space.between);
        let word = theme.translate("company_form.name");
        entry(ui, theme, &word, |ui| text_entry(ui, &mut typed.name, ui.available_width(), &word, ""));
        ui.add_space(theme.space.inside);
        let word = theme.translate("company_form.logo");
        let hint = theme.translate("company_form.logo_hint");
        entry(ui, theme, &word, |ui| text_entry(ui, &mut typed.logo, ui.available_width(), &word, &hint));
        if labelled_button(ui, icons::FOLDER_OPEN, &theme.translate("company_form.choose")).clicked() {
            actions.push(Action::Company(CompanyAction::AskLogo));
        }
        ui.add_space(theme.space.inside);
        problem_ui(ui, theme, form);
        buttons_ui(ui, theme, form, typed, actions);
    });
}

fn problem_ui(ui: &mut Ui, theme: &Theme, form: &CompanyForm) {
    let top = ui.cursor().top();
    match form.problem() {
        Some(text) => paragraph(ui, RichText::new(theme.format_text(text)).color(theme.palette.bad)),
        None => ui.skip_ahead_auto_ids(1),
    }
    // Keep the buttons in place, so that they do not move under the pointer.
    ui.add_space((top + PROBLEM_HEIGHT - ui.cursor().top()).max(0.0));
}

fn buttons_ui(ui: &mut Ui, theme: &Theme, form: &CompanyForm, typed: &Typed, actions: &mut Vec<Action>) {
    right_aligned(ui, |ui| {
        let can_save = !form.is_checking();
        if primary_button(ui, theme, can_save, icons::FLOPPY_DISK, &theme.translate("server_form.save")).clicked() {
            let (name, logo) = (typed.name.clone(), typed.logo.clone());
            actions.push(Action::Company(CompanyAction::Save { name, logo }));
        }
        if labelled_button(ui, "", &theme.translate("server_form.cancel")).clicked() {
            actions.push(Action::Company(CompanyAction::Close));
        }
    });
}
