//! Executes the user's actions on a device and its drives. Edits and motion take effect immediately. All other actions
//! are jobs of the session or tasks.

use std::time::Duration;

use super::action::{HiperdriveAction, MotorCommand};
use super::staged::Edit;
use super::unit::HiperdriveDevice;
use super::{explain, format};
use crate::app::services::Services;
use crate::app::session::{HasDraft, HasMemory, HasProfile};
use crate::app::{PendingEdits, Severity, Text};
use crate::devices::hiperdrive::jobs::HiperdriveJob;
use crate::devices::hiperdrive::procedures::Temperature;
use crate::devices::hiperdrive::procedures::dead_man::{MotionRequest, SpeedTorque};
use crate::devices::hiperdrive::profile::HiperdriveProfile;
use crate::profile::Body;

/// Interval for reading a watched temperature, which changes slowly.
const WATCH_INTERVAL: Duration = Duration::from_secs(2);

impl HiperdriveDevice {
    pub(crate) fn handle_action(&mut self, action: HiperdriveAction, services: &mut Services) {
        match action {
            HiperdriveAction::ReadStatus => {
                self.submit(HiperdriveJob::Status, services);
            }
            HiperdriveAction::Check => {
                self.submit(HiperdriveJob::Check, services);
            }
            HiperdriveAction::SelectDrive(drive) => {
                if self.drives().contains(&drive) {
                    self.show_drive(drive);
                    self.update_watched(services);
                }
            }
            HiperdriveAction::Watch(what, on) => self.watch_temperature(what, on),
            HiperdriveAction::SetMeasure(measure) => self.measure = measure,
            HiperdriveAction::SetPitch(drive, pitch) => {
                match pitch.filter(|own| own.nanometres > 0) {
                    Some(pitch) => self.pitches.insert(drive, pitch),
                    None => self.pitches.remove(&drive),
                };
                let ruler = self.ruler(drive);
                if ruler.from_steps(0, self.measure).is_none() {
                    self.measure = super::PositionUnit::default();
                }
            }
            HiperdriveAction::Edit(edit) => self.apply_edit(&edit),
            HiperdriveAction::Plan(change) => self.plan(*change, services),
            HiperdriveAction::Take => self.take_control(services),
            HiperdriveAction::Give => {
                self.moves.stop();
                self.submit(HiperdriveJob::Give, services);
            }
            HiperdriveAction::Drive(motor) => self.apply_motor_action(motor, services),
            HiperdriveAction::Axis(action) => self.apply_axis_action(action, services),
            HiperdriveAction::Save(path) => self.save(path, services),
        }
    }

    fn watch_temperature(&mut self, what: Temperature, on: bool) {
        match what {
            Temperature::Device => self.watches_device = on,
            Temperature::Drive(_) => self.watches_drive = on,
        }
        self.request_temperatures();
    }

    pub fn watched_temperatures(&self) -> Vec<Temperature> {
        let device = self.watches_device.then_some(Temperature::Device);
        device.into_iter().chain(self.watches_drive.then_some(Temperature::Drive(self.drive()))).collect()
    }

    /// Starts recording and polling the watched temperatures.
    pub(super) fn request_temperatures(&mut self) {
        let wished = self.watched_temperatures();
        self.record.watch_temperatures(&wished);
        if let Some(line) = &self.session.line {
            line.watch_values(wished.into_iter().map(|what| (what, WATCH_INTERVAL)).collect());
        }
    }

    /// Executes a motion command, or notifies the user of the reason why the drive may not be moved.
    fn apply_motor_action(&mut self, motor: MotorCommand, services: &mut Services) {
        let drive = self.drive();
        let request = match motor {
            MotorCommand::JogHold => return self.moves.refresh_held_action(),
            MotorCommand::JogRelease => return self.moves.release(),
            MotorCommand::Stop => return self.moves.stop(),
            MotorCommand::JogEffort(effort) => return self.moves.set_jog_effort(drive, effort),
            MotorCommand::MoveEffort(effort) => return self.moves.set_move_effort(drive, effort),
            MotorCommand::RunEffort(effort) => return self.moves.set_run_effort(drive, effort),
            MotorCommand::Expert(expert) => return self.moves.set_endless_allowed(drive, expert),
            MotorCommand::AllowOutward(direction) => return self.enable_outward_jog(drive, direction, services),
            MotorCommand::ConfirmLimits(drive) => {
                self.confirm_limits(drive, services);
                return;
            }
            MotorCommand::JogPress { repeated: true, .. } | MotorCommand::SlowJogPress { repeated: true, .. } => return,
            MotorCommand::JogPress { direction, .. } => {
                let outward = self.moves.is_outward_jog_enabled(drive, direction);
                MotionRequest::Jog { direction, effort: self.moves.jog_speed_torque(drive), outward }
            }
            MotorCommand::SlowJogPress { direction, .. } => {
                let outward = self.moves.is_outward_jog_enabled(drive, direction);
                MotionRequest::Jog { direction, effort: SpeedTorque::DEFAULT_JOG, outward }
            }
            MotorCommand::Lead(goal) => MotionRequest::Lead(goal),
            MotorCommand::Acknowledge => MotionRequest::Acknowledge,
            MotorCommand::Step { by } => MotionRequest::Step { by, effort: self.moves.move_speed_torque(drive) },
            MotorCommand::Move { target } => {
                MotionRequest::Move { target, effort: self.moves.move_speed_torque(drive) }
            }
            MotorCommand::Run { direction, end } => {
                MotionRequest::Run { direction, end, effort: self.moves.run_speed_torque(drive) }
            }
            MotorCommand::Pause => MotionRequest::Pause,
            MotorCommand::Resume => MotionRequest::Resume,
        };
        if let Err(why) = self.check_motion_allowed(drive, request) {
            // The current motion continues, because no other motion has started.
            return self.report_drive_message(drive, Severity::Warning, vec![why], services);
        }
        for ended in explain::MOTION_ENDS {
            services.log.remove_from_window(ended, Some(&self.session.name()));
        }
        match request {
            MotionRequest::Jog { .. } => self.moves.press_jog(drive, request),
            _ => {
                self.moves.request_motion(drive, request);
            }
        }
    }

    /// Opens the cyclic connection, over which the selected drive is then read continuously.
    fn take_control(&mut self, services: &mut Services) {
        if let Err(why) = self.check_can_take_control() {
            services.notify(Severity::Warning, vec![why], Some(&self.session.name()));
            return;
        }
        self.submit(HiperdriveJob::Take, services);
    }

    pub(super) fn apply_edit(&mut self, edit: &Edit) {
        self.refusal = match self.session.is_writing() {
            true => Some(Text::new("session.busy")),
            false => self.staged.apply_edit(edit).err().map(|error| format::edit_error_text(&error)),
        };
    }

    /// Starts a job. Returns `false` if it cannot be started; the user is then told why.
    pub(super) fn submit(&mut self, job: HiperdriveJob, services: &mut Services) -> bool {
        self.session.submit(job, services)
    }

    /// Saves a profile that was read for this purpose.
    pub(super) fn save_profile(&mut self, profile: HiperdriveProfile, services: &mut Services) {
        self.handle_scale_change(&profile.image);
        self.staged.refresh_partially(&profile.image);
        let edits = self.is_dirty().then(|| self.staged.count());
        let device = self.device_key();
        self.session.save_read_values(device, Body::new(profile), edits, Vec::new(), services);
    }
}
