//! Data and requests that connect the axis set-up and the network settings with a device.

use core::net::Ipv4Addr;
use std::path::PathBuf;

use super::axis::{Axis, AxisAction, AxisButton, AxisReport, AxisStep, Device, DriveFacts, DriveRequest};
use super::review::ReviewState;
use super::unit::HiperdriveDevice;
use crate::app::action::{Action as StudioAction, TaskResult};
use crate::app::report::SessionResult;
use crate::app::services::Services;
use crate::app::session::{HasMemory, Phase, Source};
use crate::app::{DeviceFile, FileQuestion, Language, Severity, Text};
use crate::devices::hiperdrive::jobs::{Change, HiperdriveJob};
use crate::devices::hiperdrive::procedures::dead_man::{MotionRequest, SpeedTorque};
use crate::devices::hiperdrive::profile::{Image, NetworkSettings, Service};
use crate::devices::hiperdrive::protocol::drive_parameter::{DRIVE_REQUESTED, NUMERATOR, REFERENCE};
use crate::devices::hiperdrive::protocol::{AddressSwitch, DriveNumber, ParameterNumber};
use crate::devices::hiperdrive::state::TEXTS;
use crate::devices::hiperdrive::state::explain;
use crate::store::write_atomically;

/// Parameters used by the set-up, by their numbers for drive 1.
const AXIS: std::ops::RangeInclusive<u16> = 152..=REFERENCE;

impl HiperdriveDevice {
    pub fn axis(&self) -> Option<&Axis> {
        self.axes.get(&self.drive())
    }

    /// Checks whether the selected drive can be set up.
    ///
    /// # Errors
    /// Returns an error with the reason if the drive cannot be set up.
    pub fn check_can_set_up(&self) -> Result<(), Text> {
        match self.session.plan_obstacle() {
            _ if self.session.phase == Phase::Offline => Err(Text::new("session.not_connected")),
            Some(why) => Err(why),
            None if self.survey.is_none() || self.parameter_value(self.drive(), NUMERATOR).is_none() => {
                Err(TEXTS.text("hd_axis.unread"))
            }
            None if self.is_moving() => Err(TEXTS.text("hd_axis.moving")),
            None => Ok(()),
        }
    }

    /// Checks whether a change can be planned now.
    ///
    /// # Errors
    /// Returns an error with the reason if no change can be planned.
    pub fn check_can_plan(&self) -> Result<(), Text> {
        self.session.plan_obstacle().map_or(Ok(()), Err)
    }

    pub fn drive_facts(&self, drive: DriveNumber) -> DriveFacts {
        let view = self.moves.drive(drive);
        let actual = self.actual_values(drive);
        let is_heard = !self.moves.is_open() || self.moves.is_data_valid();
        let position = actual.filter(|own| own.status.is_present() && is_heard).map(|own| own.position);
        let errors = self.drive_status(drive).filter(|own| own.faults > 0);
        let family = self.drive_identity(drive).and_then(|own| own.variant.row()).map(|row| row.family);
        DriveFacts {
            connected: self.session.phase == Phase::Connected && self.session.live_session().is_some(),
            busy: self.session.is_busy() || self.session.review.is_some(),
            stale: self.is_stale,
            is_virtual: self.target.is_some(),
            controlled: self.moves.is_open(),
            moves: self.is_moving() || self.moves.is_motion_active(),
            held: self.moves.held_jog(drive),
            actual,
            actual_at: self.last_report_time(drive),
            position,
            values: AXIS.filter_map(|number| Some((number, self.parameter_value(drive, number)?))).collect(),
            unsaved: self.unsaved_values(drive),
            times_set: self.position_set_count(drive),
            requested: self.parameter_value(drive, DRIVE_REQUESTED).map(|value| value == 1),
            scale: self.scale(drive),
            pitch: self.spindle_pitch(drive),
            limits: self.limits(drive),
            family,
            locks: self.moves.motion_locks(drive),
            ended: view.and_then(|own| own.ended),
            error: errors.and_then(|own| own.buffer.first().copied()),
        }
    }

    /// Returns the network settings, or `None` if they have not been read or the device does not provide them.
    pub fn network_settings(&self) -> Option<NetworkSettings> {
        let own = self.network()?;
        Some(NetworkSettings { source: own.control?.source(), interface: own.interface.clone()? })
    }

    /// Returns the setting of the address switches as read at power-up.
    pub fn address_switch(&self) -> Option<AddressSwitch> {
        self.network()?.address_switch()
    }

    /// Returns the IP address of the device, if the link contains a numeric address.
    pub fn host_address(&self) -> Option<Ipv4Addr> {
        let Source::Link(url) = &self.session.source else { return None };
        let host = url.target.rsplit_once(':').map_or(url.target.as_str(), |(host, _)| host);
        host.parse().ok()
    }

    pub(super) fn apply_axis_action(&mut self, action: AxisAction, services: &mut Services) {
        let drive = self.drive();
        let seen = self.drive_facts(drive);
        if action == AxisAction::Begin {
            return self.begin_axis_setup(drive, services);
        }
        let when = services.current_time().strftime("%Y-%m-%d %H:%M").to_string();
        let Some(axis) = self.axes.get_mut(&drive) else { return };
        match action {
            AxisAction::Begin => {}
            AxisAction::Edit(entries) => axis.set_entries(*entries),
            AxisAction::Press(button) => match axis.request(button, &seen) {
                Ok(ask) => self.execute_request(drive, button, ask, &seen, services),
                Err(why) => self.report_drive_message(drive, Severity::Warning, vec![why], services),
            },
            AxisAction::TakePlace => axis.adopt_limit(&seen),
            AxisAction::Next => {
                // Before this step, the entered spindle data is only used for a preview. After this step, it applies to
                // all displayed positions.
                let confirms = axis.step() == AxisStep::Scale
                    && axis.setup_end().is_none()
                    && axis.check_can_continue(&seen).is_ok();
                let pitch = axis.entries().parse_pitch().ok().filter(|_| confirms);
                axis.next_step(&DriveFacts { pitch: pitch.or(seen.pitch), ..seen }, &when);
                if let Some(pitch) = pitch {
                    self.pitches.insert(drive, pitch);
                }
            }
            AxisAction::Skip => axis.skip_step(&seen, &when),
            AxisAction::Back => axis.go_back(&seen),
            AxisAction::Cancel => {
                axis.cancel(&seen, &when);
                self.moves.stop();
            }
            AxisAction::AskReport => {
                let file = self.session.suggested_file();
                let stem = file.file_stem().map_or_else(String::new, |own| own.to_string_lossy().into_owned());
                let suggested = PathBuf::from(format!("{stem}-axis-{}.txt", drive.get()));
                let words = (TEXTS.text("file.report_title"), TEXTS.text("file.reports"));
                let save = |path, language| super::HiperdriveAction::Axis(AxisAction::SaveReport(path, language));
                let file = DeviceFile::write_question(self.session.id, words, &["txt"], suggested, save);
                services.file_question = Some(FileQuestion::OfDevice(file));
            }
            AxisAction::SaveReport(path, language) => {
                let Some(text) = self.axis_report(language) else { return };
                services.tasks.run("report", move || {
                    let result = write_atomically(&path, text.as_bytes());
                    StudioAction::Done(TaskResult::FileSaved { message: Text::new("report.saved"), path, result })
                });
            }
        }
    }

    fn begin_axis_setup(&mut self, drive: DriveNumber, services: &mut Services) {
        if let Err(why) = self.check_can_set_up() {
            return self.report_drive_message(drive, Severity::Warning, vec![why], services);
        }
        self.axes.insert(drive, Axis::new(drive, Some(self.ruler(drive))));
    }

    pub fn axis_report(&self, language: Language) -> Option<String> {
        self.create_axis_report(self.axis()?).map(|report| report.page(language))
    }

    /// Returns the result of a completed axis set-up for a device report.
    pub(super) fn axis_result(&self, axis: &Axis) -> Option<SessionResult> {
        self.create_axis_report(axis).map(AxisReport::into_session_result)
    }

    fn create_axis_report(&self, axis: &Axis) -> Option<AxisReport> {
        let own = self.drive_identity(axis.drive());
        let device = Device {
            name: self.session.name(),
            variant: own.map(|own| explain::variant_text(own.variant)),
            serial_number: own.map_or_else(String::new, |own| own.serial_number.clone()),
        };
        AxisReport::new(axis, &self.drive_facts(axis.drive()), &device)
    }

    /// Executes the request that a button triggers. A change that is saved is planned first, and reviewed by the user.
    fn execute_request(
        &mut self,
        drive: DriveNumber,
        button: AxisButton,
        ask: DriveRequest,
        seen: &DriveFacts,
        services: &mut Services,
    ) {
        match &ask {
            DriveRequest::Try(values) | DriveRequest::Restore(values) => {
                let numbered =
                    |(number, value): &(u16, i64)| Some((ParameterNumber::for_drive(*number, drive)?, *value));
                let image = Image { values: values.iter().filter_map(numbered).collect() };
                self.plan(Change::Try(Box::new(image)), services);
            }
            DriveRequest::SetPosition(position) => {
                self.plan(Change::SetPosition { drive, position: *position, save: false }, services);
            }
            DriveRequest::Save => self.plan(Change::Do(Service::Save), services),
            DriveRequest::BelieveRestart => {}
            DriveRequest::Acknowledge => {
                if let Err(why) = self.check_motion_allowed(drive, MotionRequest::Acknowledge) {
                    return self.report_drive_message(drive, Severity::Warning, vec![why], services);
                }
                self.moves.request_motion(drive, MotionRequest::Acknowledge);
            }
            DriveRequest::ConfirmLimits => {
                if !self.confirm_limits(drive, services) {
                    return;
                }
            }
            DriveRequest::Take => self.handle_action(super::HiperdriveAction::Take, services),
            DriveRequest::Give => self.handle_action(super::HiperdriveAction::Give, services),
            DriveRequest::Move(target) => {
                let request = MotionRequest::Move { target: *target, effort: SpeedTorque::DEFAULT_JOG };
                if let Err(why) = self.check_motion_allowed(drive, request) {
                    return self.report_drive_message(drive, Severity::Warning, vec![why], services);
                }
                let act = self.moves.request_motion(drive, request);
                if let (Some(act), AxisButton::Go(place), Some(axis)) = (act, button, self.axes.get_mut(&drive)) {
                    axis.record_test_move_start(place, *target, act);
                }
                return;
            }
            DriveRequest::PowerCycle => {
                if let Some(target) = &self.target {
                    target.power_cycle();
                    self.switched = true;
                }
                self.axes.values_mut().for_each(Axis::handle_connection_loss);
                self.submit(HiperdriveJob::Survey, services);
                return;
            }
        }
        let begins = match ask {
            DriveRequest::Try(_) | DriveRequest::Restore(_) | DriveRequest::SetPosition(_) | DriveRequest::Save => {
                self.session.review.is_some()
            }
            _ => true,
        };
        if let Some(axis) = self.axes.get_mut(&drive).filter(|_| begins) {
            axis.begin_request(ask, seen);
        }
    }

    /// Updates all axis set-ups. Must be called after each update of the drives.
    pub(super) fn update_axes(&mut self) {
        if self.axes.is_empty() {
            return;
        }
        // `None` means that the review is closed. After the review has ended, the value specifies whether the plan was
        // executed.
        let write = self.open_review().map(|review| match &review.state {
            ReviewState::Done(..) => Some(Ok(())),
            ReviewState::Failed { begun, .. } => Some(Err(*begun)),
            _ => None,
        });
        let seen: Vec<(DriveNumber, DriveFacts)> =
            self.axes.keys().map(|drive| (*drive, self.drive_facts(*drive))).collect();
        for (drive, seen) in seen {
            let Some(axis) = self.axes.get_mut(&drive) else { continue };
            if !seen.connected {
                axis.handle_connection_loss();
            }
            if axis.is_writing() {
                match write {
                    Some(Some(Ok(()))) => axis.mark_written(),
                    Some(Some(Err(begun))) => axis.handle_write_failure(begun),
                    Some(None) => {}
                    None => axis.handle_write_failure(false),
                }
            }
            axis.update(&seen);
        }
    }

    /// Informs all axis set-ups that the parameters were read. This may show that the saved values have survived a
    /// power cycle.
    pub(super) fn handle_axes_survey(&mut self) {
        let switched = std::mem::take(&mut self.switched);
        let seen: Vec<(DriveNumber, DriveFacts)> =
            self.axes.keys().map(|drive| (*drive, self.drive_facts(*drive))).collect();
        for (drive, seen) in seen {
            if let Some(axis) = self.axes.get_mut(&drive) {
                axis.on_survey(&seen, switched);
            }
        }
    }
}
