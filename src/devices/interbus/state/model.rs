//! Implements the common device traits for INTERBUS encoders.

use super::cams::labels::edit_error_text;
use super::trace::FrameDecoder;
use super::{Edit, Encoder, InterbusAction, TEXTS, TaskResult, status_lines};
use crate::app::action::OpenedConnection;
use crate::app::report::{SessionResult, StatusLine};
use crate::app::services::{JobState, Services};
use crate::app::session::{HasProfile, SessionEvents};
use crate::app::{ActionContext, DeviceMemory, DeviceModel, EditStep, Recording, Severity, Tab, Text, explain};
use crate::devices::interbus::jobs::{Interbus, InterbusJob};
use crate::devices::interbus::profile::{InterbusProfile, Item};
use crate::devices::interbus::protocol::Reply;
use crate::profile::Body;

impl DeviceModel for Encoder {
    const TAB: Tab = Tab::named("Interbus");
    type Action = InterbusAction;
    type TaskResult = TaskResult;

    fn connect(&mut self, opened: OpenedConnection<Interbus>, services: &mut Services) {
        self.release_thread(JobState::Cancelled, services);
        self.record.begin_session(&opened.began);
        self.motor = opened.session_handle.clone();
        self.trace = FrameDecoder::new(self.word_order());
        self.session.attach_connection(opened, services);
        self.submit(InterbusJob::Hello, services);
    }

    fn handle_action(&mut self, action: InterbusAction, context: &mut ActionContext<'_>) {
        Encoder::handle_action(self, action, context.services);
    }

    fn handle_result(&mut self, done: TaskResult, services: &mut Services) {
        match done {
            TaskResult::Read(path, Ok(text)) => {
                let name = path.file_name().map_or_else(String::new, |name| name.to_string_lossy().into_owned());
                self.read_table(explain::literal_text(name), text, self.table_program);
            }
            TaskResult::Written(path, Ok(())) => {
                services.log.remove_file_notices(&path);
                let text = Text::new("session.saved").with("path", path.display());
                services.notify(Severity::Good, vec![text], Some(&self.session.name()));
            }
            TaskResult::Read(_, Err(error)) | TaskResult::Written(_, Err(error)) => {
                self.session.report_rejection(explain::file_error_text(&error), services)
            }
        }
    }

    fn reported_status(&self) -> Option<Vec<StatusLine>> {
        match self.record.last()?.reply() {
            Reply::Run { .. } => Some(status_lines(None)),
            Reply::Error(error) => Some(status_lines(Some(error))),
            // While values are transferred, the word says nothing about errors.
            _ => None,
        }
    }

    fn session_results(&self) -> Vec<SessionResult> {
        self.check.iter().cloned().map(SessionResult::Check).collect()
    }

    fn position_job(&self) -> InterbusJob {
        InterbusJob::Position
    }

    fn recording(&self) -> &dyn Recording {
        &self.record.track
    }

    fn record_mut(&mut self) -> &mut dyn Recording {
        &mut self.record.track
    }

    fn read_device(&mut self, services: &mut Services) {
        if self.try_submit(InterbusJob::Survey, services) {
            // Reading a program of a real encoder may use a write cycle, so the cams page reads programs only on
            // request.
            self.read_after = if self.session.is_virtual() { self.known_programs() } else { Vec::new() };
        }
    }

    fn apply_edit_step(&mut self, step: EditStep) {
        step(&mut self.staged);
        self.refusal = None;
    }

    fn ask_where_to_save(&mut self, services: &mut Services) {
        // This is checked before the user enters a file name, because saving selects cam programs. Known values are not
        // read again.
        if self.needs_standstill_confirmation() && !self.is_stopped() && !self.saves_last_reading() {
            services.notify(Severity::Warning, vec![TEXTS.text("ib_stop.first")], Some(&self.session.name()));
        } else {
            self.session.ask_where_to_save(services);
        }
    }

    fn accepts_item(&self, item: &str) -> bool {
        item.parse::<Item>().is_ok_and(Item::is_writable)
    }

    fn take_item(&mut self, item: &str, from: &Body) -> Result<(), Text> {
        let not_taken = || Text::new("comparison.not_taken");
        let item: Item = item.parse().map_err(|_| not_taken())?;
        let value = from.get::<InterbusProfile>().and_then(|profile| profile.image.get_value(item));
        let edit = Edit::of_item(item, value.ok_or_else(not_taken)?).ok_or_else(not_taken)?;
        self.staged.apply_edit(&edit).map(drop).map_err(|error| edit_error_text(&error))
    }

    fn memory(&self) -> Option<&dyn DeviceMemory> {
        Some(self)
    }

    fn memory_mut(&mut self) -> Result<&mut dyn DeviceMemory, Text> {
        Ok(self)
    }
}
