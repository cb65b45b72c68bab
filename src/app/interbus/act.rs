//! What the user asks of an encoder, carried out: edits at once, everything else as a job on its line or a task.

use std::path::{Path, PathBuf};

use jiff::Timestamp;

use super::action::Action;
use super::encoder::Encoder;
use super::staged::Edit;
use crate::app::action::{FileQuestion, ReadError};
use crate::app::services::Services;
use crate::app::session::{OnLine, Phase, Source, WithMemory};
use crate::app::{Severity, Text};
use crate::profile::interbus::InterbusProfile;
use crate::profile::{Body, Document};
use crate::protocol::interbus::ProgramNumber;
use crate::worker::interbus::InterbusJob;

impl Encoder {
    /// Does what is asked.
    pub(in crate::app) fn act(&mut self, action: Action, services: &mut Services) {
        match action {
            // The studio opens links, and knows other sessions.
            Action::Reconnect | Action::WriteInto(_) => {}
            Action::Stopped(stopped) => self.say_stopped(stopped),
            Action::Read => {
                if !self.session.read_file_again(services) && self.try_submit(InterbusJob::Survey, services) {
                    self.read_after = self.known_programs();
                }
            }
            Action::ReadPrograms(programs) => self.submit(InterbusJob::Programs(programs), services),
            Action::ReadOut(what) => self.submit(InterbusJob::ReadOut(what), services),
            Action::Select(mode) => self.submit(InterbusJob::Select(mode), services),
            Action::Check => self.submit(InterbusJob::Check, services),
            Action::ReadPosition => self.submit(InterbusJob::Position, services),
            Action::Poll(interval) => {
                if let Some(line) = &mut self.session.line {
                    let begins = line.polling().is_none();
                    line.poll(interval);
                    self.record.poll(interval, begins);
                }
            }
            Action::Edit(edit) => self.edit(&edit),
            Action::Undo => {
                self.staged.undo();
                self.refusal = None;
            }
            Action::Redo => {
                self.staged.redo();
                self.refusal = None;
            }
            Action::RevertAll => {
                self.staged.revert();
                self.refusal = None;
            }
            Action::Review => self.review_edits(services),
            Action::Plan(change) => self.plan(*change, services),
            Action::LeadBack => self.submit(InterbusJob::LeadBack, services),
            Action::AskTable(program) => {
                self.table_program = program;
                services.file_question = Some(FileQuestion::OpenCams { session: self.session.id });
            }
            Action::OpenTable(path) => self.open_table(path, services),
            Action::PasteTable(program, text) => self.read_table(Text::new("ib_table.pasted"), text, program),
            Action::TakeTable(take) => self.take_table(take),
            Action::AskSaveTable { decimal_comma } => {
                let suggested = self.session.suggested_file().with_extension("csv");
                services.file_question =
                    Some(FileQuestion::Cams { session: self.session.id, decimal_comma, suggested });
            }
            Action::SaveTable { path, decimal_comma } => self.save_table(path, decimal_comma, services),
            Action::SetScale(scale) => {
                self.scale = scale;
                self.read_table_anew();
            }
            Action::Turn(rpm) => {
                if let Some(motor) = &self.motor {
                    motor.set_rpm(rpm);
                }
            }
            Action::AskSave => {
                let suggested = self.session.suggested_file();
                services.file_question = Some(FileQuestion::Save { session: self.session.id, suggested });
            }
            Action::Save(path) => self.save(path, services),
            Action::Restore(path) => match self.key() {
                Some(of) => self.session.read_backup(of, path, services),
                None => self.refuse(Text::new("session.not_connected"), services),
            },
        }
    }

    pub(super) fn edit(&mut self, edit: &Edit) {
        self.refusal = match self.session.is_writing() {
            true => Some(Text::new("session.busy")),
            false => self.staged.edit(edit).err().map(|error| super::cams::words::refused(&error)),
        };
    }

    pub(super) fn refuse(&self, text: Text, services: &mut Services) {
        services.tell(Severity::Error, vec![text], Some(&self.session.name()));
    }

    /// A connected encoder is read again for it; a profile is written as it is edited.
    pub(in crate::app) fn save(&mut self, path: PathBuf, services: &mut Services) {
        match &self.session.source {
            Source::Link(_) | Source::New { .. } => {
                if self.try_submit(InterbusJob::Save { programs: true }, services) {
                    self.session.save_to = Some(path);
                }
            }
            Source::File { document, .. } => {
                let mut document = (**document).clone();
                if let Some(profile) = self.wanted_profile() {
                    document.body = Body::Interbus(Box::new(profile));
                }
                self.session.write_document(path, document, Vec::new(), services);
            }
        }
    }

    /// A profile was read for a file: with the names that its cams have here.
    pub(super) fn saved(&mut self, mut profile: InterbusProfile, services: &mut Services) {
        let programs: Vec<_> = profile.image.known().map(|(number, own)| (number, *own)).collect();
        self.staged.refresh_parameters(profile.image.parameters);
        self.staged.refresh_programs(&programs, profile.image.shift);
        let Some(path) = self.session.save_to.take() else { return };
        if let Some(wanted) = self.staged.wanted() {
            profile.names = wanted.names.clone();
        }
        let mut remarks = Vec::new();
        // The profile holds what the encoder has.
        if self.is_dirty() {
            remarks.push(Text::new("session.saved_without").with("count", self.edits()));
        }
        let now = Timestamp::now();
        let seconds = Timestamp::from_second(now.as_second()).unwrap_or(now);
        let document = Document::new(seconds.to_string(), Body::Interbus(Box::new(profile)));
        self.session.write_document(path, document, remarks, services);
    }

    /// A backup was read, or not.
    pub(in crate::app) fn take_backup(
        &mut self,
        path: &Path,
        result: Result<Box<Document>, ReadError>,
        services: &mut Services,
    ) {
        match result.and_then(|document| document.body.into_interbus().map_err(ReadError::Profile)) {
            Ok(profile) => self.plan_restore(profile, services),
            Err(error) => self.refuse(crate::app::documents::read_error(path, &error), services),
        }
    }

    /// Everything that there is to be read of a virtual encoder is read by itself; false where there is nothing more.
    pub(super) fn read_on(&mut self, services: &mut Services) -> bool {
        if !self.session.is_virtual() || self.session.phase == Phase::Offline {
            return false;
        }
        if self.survey.is_none() {
            self.try_submit(InterbusJob::Survey, services)
        } else if self.programs_read() < ProgramNumber::COUNT {
            self.try_submit(InterbusJob::Programs(ProgramNumber::all().collect()), services)
        } else {
            false
        }
    }
}
