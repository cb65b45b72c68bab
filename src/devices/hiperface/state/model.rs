//! Implementation of the studio's device traits for HIPERFACE encoders.

use std::convert::Infallible;

use super::explain::check_lines;
use super::{Encoder, HiperfaceAction, status_lines};
use crate::app::action::OpenedConnection;
use crate::app::report::{SessionResult, StatusLine};
use crate::app::services::{JobState, Services, StudioEnvironment};
use crate::app::session::SessionEvents;
use crate::app::{ActionContext, DeviceMemory, DeviceModel, PrepareFn, Recording, SineCosineSource, Tab, Text};
use crate::devices::hiperface::jobs::{Hiperface, HiperfaceJob};
use crate::devices::hiperface::procedures::InitialAccessCodes;

impl DeviceModel for Encoder {
    const TAB: Tab = Tab::named("Hiperface");
    type Action = HiperfaceAction;
    type TaskResult = Infallible;

    fn prepare_session(&self, world: &StudioEnvironment) -> PrepareFn<Hiperface> {
        let codes = world.given.get::<InitialAccessCodes>().cloned().unwrap_or_default();
        Box::new(move |session| codes.apply_codes(session.access_codes_mut()))
    }

    fn connect(&mut self, opened: OpenedConnection<Hiperface>, services: &mut Services) {
        self.release_thread(JobState::Cancelled, services);
        self.record.begin_session(&opened.began);
        self.session.attach_connection(opened, services);
        self.update_watches();
        self.codes_due.clear();
        self.tried_code = None;
        self.read_encoder(services);
    }

    fn handle_action(&mut self, action: HiperfaceAction, context: &mut ActionContext<'_>) {
        Encoder::handle_action(self, action, context.services);
    }

    fn handle_result(&mut self, done: Infallible, _services: &mut Services) {
        match done {}
    }

    fn reported_status(&self) -> Option<Vec<StatusLine>> {
        self.codes.as_deref().map(status_lines)
    }

    fn session_results(&self) -> Vec<SessionResult> {
        let check = self.check.as_deref().map(|lines| SessionResult::Check(check_lines(lines)));
        let commutation = self.commutation.session_result(&self.session.name(), self.geometry());
        check.into_iter().chain(commutation).collect()
    }

    fn position_job(&self) -> HiperfaceJob {
        let geometry = self.identity.as_ref().and_then(|identity| identity.geometry);
        HiperfaceJob::Position(geometry)
    }

    fn recording(&self) -> &dyn Recording {
        &self.record.track
    }

    fn record_mut(&mut self) -> &mut dyn Recording {
        &mut self.record.track
    }

    fn read_device(&mut self, services: &mut Services) {
        self.read_encoder(services);
    }

    fn memory(&self) -> Option<&dyn DeviceMemory> {
        Some(self)
    }

    fn memory_mut(&mut self) -> Result<&mut dyn DeviceMemory, Text> {
        Ok(self)
    }

    fn sine_cosine(&self) -> Option<&dyn SineCosineSource> {
        Some(self)
    }

    fn sine_cosine_mut(&mut self) -> Option<&mut dyn SineCosineSource> {
        Some(self)
    }
}
