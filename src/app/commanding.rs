//! Dispatch of commands that every device supports, and of actions specific to one kind of device.

use std::time::Duration;

use super::action::{ReadError, RecorderOwner};
use super::devices::{ActionContext, DeviceCommand};
use super::documents::read_error;
use super::file_question::FileQuestion;
use super::payload::{Payload, PayloadKindError};
use super::studio::{SessionId, Studio};
use super::{AnyDevice, Severity, Text};

/// Polling interval of live values that start automatically.
const LIVE_INTERVAL: Duration = Duration::from_millis(50);

impl Studio {
    /// Executes a command that every device supports, even one that opens a link or involves two sessions.
    pub(super) fn command(&mut self, id: SessionId, command: DeviceCommand) {
        match command {
            DeviceCommand::Reconnect => self.reconnect(id),
            DeviceCommand::WriteInto(target) => self.write_profile_to_device(id, target),
            DeviceCommand::AskRestore => self.services.file_question = Some(FileQuestion::Restore(id)),
            DeviceCommand::AskCompare => self.compare_session(id, None),
            DeviceCommand::AskReport => self.ask_report_path(RecorderOwner::Device(id)),
            DeviceCommand::Compare(source) => self.compare_session(id, Some(*source)),
            DeviceCommand::Poll(interval) => {
                self.settings.live_stopped = interval.is_none();
                self.poll_device(id, interval);
            }
            command => self.with_device(id, |device, services| device.apply_command(command, services)),
        }
    }

    fn poll_device(&mut self, id: SessionId, interval: Option<Duration>) {
        self.with_device(id, |device, services| {
            device.state_mut().live_due = false;
            device.apply_command(DeviceCommand::Poll(interval), services);
        });
    }

    /// Starts live values automatically once the device has been read and its line is idle.
    pub(super) fn start_due_live_values(&mut self) {
        let is_due = |device: &AnyDevice| {
            let state = device.state();
            state.live_due && !state.just_connected && device.is_ready()
        };
        let due: Vec<SessionId> =
            self.devices.iter().filter(|own| is_due(own.as_ref())).map(|device| device.id()).collect();
        for id in due {
            if self.settings.live_stopped {
                self.with_device(id, |device, _| device.state_mut().live_due = false);
            } else {
                self.poll_device(id, Some(LIVE_INTERVAL));
            }
        }
    }

    fn write_profile_to_device(&mut self, id: SessionId, target: SessionId) {
        // A device without a memory is never written to, so it can adopt a read-only profile.
        let is_written = self.device(id).is_some_and(|device| device.memory().is_some());
        if is_written && self.reject_if_read_only(id) {
            return;
        }
        let Some(body) = self.device(id).and_then(AnyDevice::edited_body) else { return };
        let Some(tab) = self.device(target).map(AnyDevice::tab) else { return };
        self.show(tab, target);
        let Some(at) = self.devices.iter().position(|device| device.id() == target) else { return };
        let taken = self.devices.get_mut(at).map(|device| device.apply_profile(body, &mut self.services));
        if let Some(Err(error)) = taken {
            let place = self.device(id).map(AnyDevice::data_source).unwrap_or_default();
            let text = read_error(place.as_ref(), &ReadError::Profile(error), self.services.world.kinds);
            self.services.notify(Severity::Error, vec![text], None);
        }
    }

    pub(super) fn apply_device_action(&mut self, id: SessionId, action: Payload) {
        let Some(at) = self.devices.iter().position(|device| device.id() == id) else { return };
        let mut device = self.devices.remove(at);
        let mut context = ActionContext::new(&mut self.services, &self.devices);
        let done = device.handle_action(action, &mut context);
        let next = context.into_requests();
        self.devices.insert(at, device);
        self.report_wrong_kind(done, id);
        for command in next {
            self.command(id, command);
        }
    }

    pub(super) fn finish_device_action(&mut self, id: SessionId, done: Payload) {
        let mut taken = Ok(());
        self.with_device(id, |device, services| taken = device.handle_result(done, services));
        self.report_wrong_kind(taken, id);
    }

    /// Stops all motion if an action has reached the wrong kind of device, because the intended device does not exist.
    pub(super) fn report_wrong_kind(&mut self, done: Result<(), PayloadKindError>, id: SessionId) {
        if done.is_err() {
            let name = self.device(id).map(AnyDevice::name);
            self.notify_wrong_kind(name.as_deref());
        }
    }

    /// Reports that an action has reached the wrong kind of device, and stops all motion.
    pub(super) fn notify_wrong_kind(&mut self, about: Option<&str>) {
        self.stop_motion();
        self.services.notify(Severity::Error, vec![Text::new("session.wrong_kind")], about);
    }
}
