//! Implements the device traits of the user interface for HIPERDRIVE drives behind an adapter or a hub.

use std::convert::Infallible;

use super::{Edit, HiperdriveAction, HiperdriveDevice, format, is_editable, status_lines};
use crate::app::action::OpenedConnection;
use crate::app::live_session::LiveSession;
use crate::app::recorder::Recorder;
use crate::app::report::{SessionResult, StatusLine};
use crate::app::services::{JobState, Services};
use crate::app::session::{Phase, SessionEvents};
use crate::app::{
    ActionContext, DeviceMemory, DeviceModel, EditStep, MotionControl, Recording, StoredDriveData, Tab, Text,
};
use crate::devices::hiperdrive::jobs::{Hiperdrive, HiperdriveJob};
use crate::devices::hiperdrive::profile::{HiperdriveProfile, Item};
use crate::devices::hiperdrive::protocol::DriveNumber;
use crate::profile::Body;

impl DeviceModel for HiperdriveDevice {
    const TAB: Tab = Tab::named("Hiperdrive");
    type Action = HiperdriveAction;
    type TaskResult = Infallible;

    fn connect(&mut self, opened: OpenedConnection<Hiperdrive>, services: &mut Services) {
        SessionEvents::release_thread(self, JobState::Cancelled, services);
        self.record.begin_session(&opened.began);
        self.records.values_mut().for_each(|record| record.begin_session(&opened.began));
        self.began = Some(opened.began.clone());
        self.moves.begin_session(opened.session_handle.motion.clone());
        self.target = opened.session_handle.target.clone();
        // Values read over an earlier link are no longer valid.
        (self.watched, self.has_polled, self.is_stale) = (DriveNumber::FIRST, false, self.survey.is_some());
        let motion = opened.session_handle.motion.clone();
        self.session.attach_connection(opened, services);
        self.request_temperatures();
        if let Some(line) = self.session.live_session() {
            services.brakes.add(Box::new(motion), line.stop_handle());
        }
        // The identity is read first, and then all other values. Nothing is set, and nothing moves.
        self.submit(HiperdriveJob::Hello, services);
    }

    fn handle_action(&mut self, action: HiperdriveAction, context: &mut ActionContext<'_>) {
        HiperdriveDevice::handle_action(self, action, context.services);
    }

    fn handle_result(&mut self, done: Infallible, _services: &mut Services) {
        match done {}
    }

    fn reported_status(&self) -> Option<Vec<StatusLine>> {
        Some(self.status.as_ref()?.drives.iter().flat_map(status_lines).collect())
    }

    fn session_results(&self) -> Vec<SessionResult> {
        let check = self.check.iter().cloned().map(SessionResult::Check);
        check.chain(self.axes.values().filter_map(|axis| self.axis_result(axis))).collect()
    }

    fn position_job(&self) -> HiperdriveJob {
        HiperdriveJob::Position(self.drive())
    }

    fn recording(&self) -> &dyn Recording {
        &self.record.track
    }

    fn record_mut(&mut self) -> &mut dyn Recording {
        &mut self.record.track
    }

    fn apply_edit_step(&mut self, step: EditStep) {
        step(&mut self.staged);
        self.refusal = None;
    }

    fn accepts_item(&self, item: &str) -> bool {
        item.parse::<Item>().is_ok_and(|item| item.0.row().is_some_and(is_editable))
    }

    fn take_item(&mut self, item: &str, from: &Body) -> Result<(), Text> {
        let not_taken = || Text::new("comparison.not_taken");
        let item: Item = item.parse().map_err(|_| not_taken())?;
        let value = from.get::<HiperdriveProfile>().and_then(|profile| profile.image.get(item.0));
        let edit = Edit::Set(item.0, value.ok_or_else(not_taken)?);
        self.staged.apply_edit(&edit).map(drop).map_err(|error| format::edit_error_text(&error))
    }

    fn memory(&self) -> Option<&dyn DeviceMemory> {
        Some(self)
    }

    fn memory_mut(&mut self) -> Result<&mut dyn DeviceMemory, Text> {
        Ok(self)
    }

    fn recorders(&self) -> Vec<&Recorder> {
        std::iter::once(&self.record).chain(self.records.values()).map(|own| &own.track.recorder).collect()
    }

    fn recorders_mut(&mut self) -> Vec<&mut Recorder> {
        std::iter::once(&mut self.record).chain(self.records.values_mut()).map(|own| &mut own.track.recorder).collect()
    }

    fn is_active(&self) -> bool {
        self.session.phase == Phase::Opening || self.session.is_busy() || self.is_requested_motion_running()
    }

    fn stop(&mut self, services: &mut Services) {
        self.moves.stop();
        let pace = self.session.line.as_ref().and_then(LiveSession::polling_interval);
        self.session.stop(services);
        // STOP applies to motion and jobs. The drives remain visible.
        if let (Some(pace), Some(line)) = (pace, &mut self.session.line) {
            line.poll(Some(pace));
        }
    }

    fn motion(&self) -> Option<&dyn MotionControl> {
        Some(self)
    }

    fn motion_mut(&mut self) -> Option<&mut dyn MotionControl> {
        Some(self)
    }

    fn drive_memory(&mut self) -> Option<&mut dyn StoredDriveData> {
        Some(self)
    }
}

impl MotionControl for HiperdriveDevice {
    fn stop(&mut self) {
        self.moves.stop();
    }

    fn release_motion(&mut self) {
        self.moves.end_held_action();
    }

    fn is_moving(&self) -> bool {
        HiperdriveDevice::is_moving(self)
    }

    fn is_requested_motion_running(&self) -> bool {
        self.moves.is_moving() || self.moves.is_motion_active()
    }

    fn is_motion_active(&self) -> bool {
        self.moves.is_motion_active()
    }

    fn has_control(&self) -> bool {
        self.moves.is_open()
    }
}
