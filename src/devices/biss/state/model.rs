//! The BiSS encoder as a device of the studio.

use std::convert::Infallible;

use super::explain::outcome_texts;
use super::{BissAction, Encoder, ProcedureEnd, format, status_lines};
use crate::app::action::OpenedConnection;
use crate::app::report::{SessionResult, StatusLine};
use crate::app::services::{JobState, Services};
use crate::app::session::SessionEvents;
use crate::app::{ActionContext, DeviceMemory, DeviceModel, Recording, Tab, Text};
use crate::devices::biss::jobs::{Biss, BissJob};
use crate::devices::biss::profile::{BissProfile, RegisterRange};
use crate::devices::biss::protocol::RegisterAddress;
use crate::profile::Body;

impl DeviceModel for Encoder {
    const TAB: Tab = Tab::named("Biss");
    type Action = BissAction;
    type TaskResult = Infallible;

    fn connect(&mut self, opened: OpenedConnection<Biss>, services: &mut Services) {
        self.release_thread(JobState::Cancelled, services);
        self.record.begin_session(&opened.began);
        self.motor = opened.session_handle.clone();
        self.session.attach_connection(opened, services);
        self.update_watches();
        self.submit(BissJob::Survey, services);
    }

    fn handle_action(&mut self, action: BissAction, context: &mut ActionContext<'_>) {
        Encoder::handle_action(self, action, context);
    }

    fn handle_result(&mut self, done: Infallible, _services: &mut Services) {
        match done {}
    }

    fn reported_status(&self) -> Option<Vec<StatusLine>> {
        self.status.as_ref().map(status_lines)
    }

    fn session_results(&self) -> Vec<SessionResult> {
        let outcomes = match self.guide.as_ref().and_then(|guide| guide.end.as_ref()) {
            Some(ProcedureEnd::Done(outcomes) | ProcedureEnd::Failed { before: outcomes, .. }) => outcomes.as_slice(),
            None => &[],
        };
        let lines: Vec<Text> = outcomes.iter().flat_map(outcome_texts).collect();
        let procedure = SessionResult::Procedure { title: Text::new("logbook.kind_procedure"), lines };
        let has_ended = !outcomes.is_empty();
        let check = self.check.iter().cloned().map(SessionResult::Check);
        check.chain(has_ended.then_some(procedure)).collect()
    }

    fn position_job(&self) -> BissJob {
        BissJob::Position
    }

    fn recording(&self) -> &dyn Recording {
        &self.record
    }

    fn record_mut(&mut self) -> &mut dyn Recording {
        &mut self.record
    }

    fn accepts_item(&self, item: &str) -> bool {
        let start = item.parse::<RegisterRange>().map(RegisterRange::start);
        let area = |start| self.description.as_ref()?.area_at(start);
        start.is_ok_and(|start| area(start).is_some_and(|area| area.access.is_writable()))
    }

    fn take_item(&mut self, item: &str, from: &Body) -> Result<(), Text> {
        let not_taken = || Text::new("comparison.not_taken");
        let range: RegisterRange = item.parse().map_err(|_| not_taken())?;
        let profile = from.get::<BissProfile>().ok_or_else(not_taken)?;
        let byte = |at: RegisterAddress| profile.register(at);
        let bytes = range.addresses().map(byte).collect::<Option<Vec<u8>>>().ok_or_else(not_taken)?;
        let description = self.description.clone().ok_or_else(not_taken)?;
        self.memory.edit_bytes(&description, range.start(), &bytes).map_err(format::edit_error_text)
    }

    fn memory(&self) -> Option<&dyn DeviceMemory> {
        Some(self)
    }

    fn memory_mut(&mut self) -> Result<&mut dyn DeviceMemory, Text> {
        Ok(self)
    }

    fn can_stream(&self) -> bool {
        self.identity().is_some_and(|own| own.adapter.is_some())
    }
}
