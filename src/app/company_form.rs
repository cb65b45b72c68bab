//! The form for the company name and logo shown in reports.

use std::path::{Path, PathBuf};

use super::action::{Action, TaskResult};
use super::file_question::FileQuestion;
use super::report::check_company;
use super::studio::Studio;
use super::{Settings, Text};

/// State of the open form.
#[derive(Debug, Default)]
pub struct CompanyForm {
    /// Path of a logo chosen in the file dialog, until the form has displayed it.
    chosen: Option<PathBuf>,
    /// Number of the running check. Results of other checks are ignored.
    check: Option<u32>,
    problem: Option<Text>,
}

/// An action of the form.
#[derive(Debug)]
pub enum CompanyAction {
    Open,
    Close,
    /// Ask the user to choose a logo file.
    AskLogo,
    /// Use the name and the logo in reports. An empty string omits the item from reports.
    Save {
        name: String,
        logo: String,
    },
}

impl CompanyForm {
    /// Returns the path of the logo that was chosen in the file dialog, if any.
    pub fn chosen_logo(&self) -> Option<&Path> {
        self.chosen.as_deref()
    }

    pub fn is_checking(&self) -> bool {
        self.check.is_some()
    }

    /// Returns the reason why the logo cannot be used, if any.
    pub fn problem(&self) -> Option<&Text> {
        self.problem.as_ref()
    }
}

impl Studio {
    /// Returns the form, or `None` if it is closed.
    pub fn company_form(&self) -> Option<&CompanyForm> {
        self.company_form.as_ref()
    }

    /// Returns whether a settings form is open.
    pub fn has_form(&self) -> bool {
        self.server_form.is_some() || self.company_form.is_some()
    }

    pub(super) fn apply_company_action(&mut self, action: CompanyAction) {
        match action {
            CompanyAction::Open => self.company_form = Some(CompanyForm::default()),
            CompanyAction::Close => self.company_form = None,
            CompanyAction::AskLogo => self.services.file_question = Some(FileQuestion::Logo),
            CompanyAction::Save { name, logo } => self.check_company(&name, &logo),
        }
    }

    pub(super) fn choose_logo(&mut self, path: PathBuf) {
        if let Some(form) = &mut self.company_form {
            (form.chosen, form.problem) = (Some(path), None);
        }
    }

    /// Starts a task that checks the logo. If the logo can be used, the form is saved.
    fn check_company(&mut self, name: &str, logo: &str) {
        let number = self.next_number();
        let Some(form) = &mut self.company_form else { return };
        form.check = Some(number);
        let text = |text: &str| Some(text.trim().to_owned()).filter(|text| !text.is_empty());
        let mut wanted = Settings::default();
        (wanted.company, wanted.company_logo) = (text(name), text(logo));
        self.services.tasks.run("company", move || {
            let result = check_company(&wanted);
            Action::Done(TaskResult::CompanyChecked(number, Box::new(wanted), result))
        });
    }

    pub(super) fn save_company(&mut self, number: u32, wanted: Settings, checked: Result<(), Text>) {
        let Some(form) = self.company_form.as_mut().filter(|form| form.check == Some(number)) else { return };
        match checked {
            Ok(()) => {
                let Settings { company, company_logo, .. } = wanted;
                (self.settings.company, self.settings.company_logo) = (company, company_logo);
                self.company_form = None;
            }
            Err(why) => (form.check, form.problem) = (None, Some(why)),
        }
    }
}
