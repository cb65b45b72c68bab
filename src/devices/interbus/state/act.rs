//! Carries out the user's actions on an encoder. Edits take effect immediately, and all other actions start jobs or
//! tasks.

use super::action::InterbusAction;
use super::encoder::Encoder;
use super::staged::Edit;
use crate::app::services::Services;
use crate::app::session::{HasDraft, HasMemory, HasProfile, Phase, SessionEvents};
use crate::app::{DeviceFile, FileQuestion, Text};
use crate::devices::interbus::jobs::InterbusJob;
use crate::devices::interbus::profile::InterbusProfile;
use crate::devices::interbus::protocol::ProgramNumber;
use crate::devices::interbus::state::TEXTS;
use crate::profile::Body;

impl Encoder {
    pub(crate) fn handle_action(&mut self, action: InterbusAction, services: &mut Services) {
        match action {
            InterbusAction::ConfirmStandstill(stopped) => self.set_stopped(stopped),
            InterbusAction::ReadPrograms(programs) => self.submit(InterbusJob::Programs(programs), services),
            InterbusAction::ReadOut(what) => self.submit(InterbusJob::ReadOut(what), services),
            InterbusAction::Select(mode) => self.submit(InterbusJob::Select(mode), services),
            InterbusAction::Check => self.submit(InterbusJob::Check, services),
            InterbusAction::Edit(edit) => self.apply_edit(&edit),
            InterbusAction::Plan(change) => self.plan(*change, services),
            InterbusAction::RestoreMode => self.submit(InterbusJob::RestoreMode, services),
            InterbusAction::AskTable(program) => {
                self.table_program = program;
                let words = (TEXTS.text("file.open_cams_title"), TEXTS.text("file.tables"));
                let file =
                    DeviceFile::to_read(self.session.id, words, &["csv", "txt", "tsv"], InterbusAction::OpenTable);
                services.file_question = Some(FileQuestion::OfDevice(file));
            }
            InterbusAction::OpenTable(path) => self.open_table(path, services),
            InterbusAction::PasteTable(program, text) => self.read_table(TEXTS.text("ib_table.pasted"), text, program),
            InterbusAction::TakeTable(take) => self.finish_import(take),
            InterbusAction::AskSaveTable { decimal_comma } => {
                let suggested = self.session.suggested_file().with_extension("csv");
                let words = (TEXTS.text("file.cams_title"), TEXTS.text("file.tables"));
                let save = move |path, _| InterbusAction::SaveTable { path, decimal_comma };
                let file = DeviceFile::write_question(self.session.id, words, &["csv"], suggested, save);
                services.file_question = Some(FileQuestion::OfDevice(file));
            }
            InterbusAction::SaveTable { path, decimal_comma } => self.save_table(path, decimal_comma, services),
            InterbusAction::SetScale(scale) => {
                self.scale = scale;
                self.reparse_import();
            }
            InterbusAction::Turn(rpm) => {
                if let Some(motor) = &self.motor {
                    motor.set_rpm(rpm);
                }
            }
            InterbusAction::Save(path) => self.save(path, services),
        }
    }

    pub(super) fn apply_edit(&mut self, edit: &Edit) {
        self.refusal = match self.session.is_writing() {
            true => Some(Text::new("session.busy")),
            false => self.staged.apply_edit(edit).err().map(|error| super::cams::labels::edit_error_text(&error)),
        };
    }

    /// Adds the cam names to a profile that was read from the encoder, and saves it.
    pub(super) fn save_profile(&mut self, mut profile: InterbusProfile, services: &mut Services) {
        let programs: Vec<_> = profile.image.known_programs().map(|(number, own)| (number, *own)).collect();
        self.staged.refresh_parameters(profile.image.parameters);
        self.staged.refresh_programs(&programs, profile.image.shift);
        if let Some(wanted) = self.staged.edited_values() {
            profile.names = wanted.names.clone();
        }
        let edits = self.is_dirty().then(|| self.staged.count());
        let device = self.device_key();
        self.session.save_read_values(device, Body::new(profile), edits, Vec::new(), services);
    }

    /// Reads the next part of a virtual encoder that has not been read yet. Returns `false` if everything has been
    /// read.
    pub(super) fn read_next_unread_part(&mut self, services: &mut Services) -> bool {
        if !self.session.is_virtual() || self.session.phase == Phase::Offline {
            return false;
        }
        if self.survey.is_none() {
            self.try_submit(InterbusJob::Survey, services)
        } else if self.known_program_count() < ProgramNumber::COUNT {
            self.try_submit(InterbusJob::Programs(ProgramNumber::all().collect()), services)
        } else {
            false
        }
    }
}
