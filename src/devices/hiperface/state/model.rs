//! Implements the application's device traits for HIPERFACE encoders.

use std::convert::Infallible;

use super::explain::check_lines;
use super::{Encoder, HiperfaceAction, explain, status_lines};
use crate::app::action::OpenedConnection;
use crate::app::report::{SessionResult, StatusLine};
use crate::app::services::{JobState, Services, StudioEnvironment};
use crate::app::session::SessionEvents;
use crate::app::{ActionContext, DeviceMemory, DeviceModel, PrepareFn, Recording, SineCosineSource, Tab, Text};
use crate::devices::hiperface::jobs::{Hiperface, HiperfaceJob};
use crate::devices::hiperface::procedures::InitialAccessCodes;
use crate::devices::hiperface::profile::{FieldRange, HiperfaceProfile, Item};
use crate::profile::Body;

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
        self.pending_codes.clear();
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

    fn accepts_item(&self, item: &str) -> bool {
        matches!(item.parse(), Ok(Item::Field(FieldRange { count: Some(_), .. })))
    }

    fn take_item(&mut self, item: &str, from: &Body) -> Result<(), Text> {
        let not_taken = || Text::new("comparison.not_taken");
        let Ok(Item::Field(range)) = item.parse() else { return Err(not_taken()) };
        let fields = from.get::<HiperfaceProfile>().map(|profile| profile.fields.as_slice()).unwrap_or_default();
        let field = fields.iter().find(|own| own.number == range.field);
        let bytes = field.and_then(|own| own.bytes.as_ref()).and_then(|bytes| {
            let end = range.count.map_or(bytes.len(), |count| range.start.saturating_add(count));
            bytes.get(range.start..end)
        });
        let bytes = bytes.ok_or_else(not_taken)?;
        let edited = self.staged.edit_bytes(range.field, range.start, bytes);
        edited.map_err(|error| explain::edit_error_text(&error, bytes.len(), range.start))
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
