//! What a drive can be requested to do now, why other requests are rejected, and the state of the last request.

use super::action::MotorCommand;
use super::ruler::PositionUnit;
use super::unit::HiperdriveDevice;
use crate::app::number::required_decimals;
use crate::app::services::Services;
use crate::app::session::Phase;
use crate::app::{Severity, Text};
use crate::devices::hiperdrive::procedures::DriveLimits;
use crate::devices::hiperdrive::procedures::dead_man::{MotionLock, MotionRequest, Phase as Doing, TargetState};
use crate::devices::hiperdrive::protocol::drive_parameter::MAXIMUM_SPEED;
use crate::devices::hiperdrive::protocol::{DriveNumber, Percent, RunEnd, State, effective_torque};
use crate::devices::hiperdrive::state::TEXTS;
use crate::devices::hiperdrive::state::explain;

#[derive(Clone, Debug, PartialEq, Eq)]
pub struct RequestState {
    pub words: Text,
    /// Whether nothing needs to be done.
    pub is_well: bool,
}

impl HiperdriveDevice {
    /// Checks whether the cyclic connection can be opened now.
    ///
    /// # Errors
    /// Returns an error with the reason if the connection cannot be opened.
    pub fn check_can_take_control(&self) -> Result<(), Text> {
        match self.session.plan_obstacle() {
            _ if self.session.phase == Phase::Offline => Err(Text::new("session.not_connected")),
            Some(why) => Err(why),
            None if self.moves.is_open() => Err(TEXTS.text("hd_said.in_control")),
            None if self.survey.is_none() => Err(explain::lock_text(MotionLock::Unread)),
            None => Ok(()),
        }
    }

    /// Checks whether the cyclic connection can be closed now.
    ///
    /// # Errors
    /// Returns an error with the reason if the connection cannot be closed.
    pub fn check_can_release_control(&self) -> Result<(), Text> {
        // Control can be released even if the device does not reply.
        match self.session.live_session() {
            _ if !self.moves.is_open() => Err(TEXTS.text("hd_refused.not_taken")),
            None => Err(Text::new("session.not_connected")),
            Some(_) if self.session.is_busy() => Err(Text::new("session.busy")),
            Some(_) => Ok(()),
        }
    }

    /// Checks whether a drive may be moved now.
    ///
    /// # Errors
    /// Returns an error with the reason if the drive may not be moved.
    pub fn may_move(&self, drive: DriveNumber) -> Result<(), Text> {
        self.check_controllable()?;
        if let Phase::Silent(why) = &self.session.phase {
            return Err(why.clone());
        }
        if let Some(why) = self.missing_parameters_reason(drive) {
            return Err(why);
        }
        if let Some(lock) = self.moves.motion_locks(drive).first() {
            return Err(explain::lock_text(*lock));
        }
        match self.state(drive) {
            Some(State::Fault) => Err(TEXTS.text("hd_refused.fault")),
            Some(State::Locked) => Err(TEXTS.text("hd_refused.lock")),
            _ => Ok(()),
        }
    }

    /// Sets whether the window is operated over a remote desktop. If so, ends a jog or a run.
    pub(super) fn set_remote(&mut self, is_remote: bool) {
        self.is_remote = is_remote;
        if is_remote {
            self.moves.end_held_action();
        }
    }

    /// Checks whether a drive may start a jog or a run, which lasts until the user stops it.
    ///
    /// # Errors
    /// Returns an error with the reason if the drive may not be moved in this way.
    pub fn check_can_move_until_stopped(&self, drive: DriveNumber) -> Result<(), Text> {
        self.may_move(drive)?;
        if self.is_remote { Err(TEXTS.text("hd_refused.remote")) } else { Ok(()) }
    }

    /// Checks whether a drive may run past its limits now.
    ///
    /// # Errors
    /// Returns an error with the reason if the drive may not do so.
    pub fn check_can_run_endlessly(&self, drive: DriveNumber) -> Result<(), Text> {
        self.check_can_move_until_stopped(drive)?;
        let permitted = self.moves.motion_permit(drive).is_some_and(|permit| permit.endless);
        if permitted { Ok(()) } else { Err(TEXTS.text("hd_refused.endless")) }
    }

    /// Checks whether an endless run can be allowed, which requires factory limits and scaling.
    ///
    /// # Errors
    /// Returns an error with the reason if an endless run cannot be allowed.
    pub fn check_can_allow_endless_run(&self, drive: DriveNumber) -> Result<(), Text> {
        let could = self.moves.limits(drive).is_some_and(DriveLimits::is_endless_run_allowed);
        if could { Ok(()) } else { Err(TEXTS.text("hd_refused.endless")) }
    }

    fn check_controllable(&self) -> Result<(), Text> {
        if !self.moves.is_open() {
            return Err(TEXTS.text("hd_refused.not_taken"));
        }
        if self.session.is_writing() || self.session.review.is_some() {
            return Err(TEXTS.text("hd_refused.busy"));
        }
        Ok(())
    }

    pub(super) fn check_motion_allowed(&self, drive: DriveNumber, request: MotionRequest) -> Result<(), Text> {
        let asks_target = match request {
            MotionRequest::Move { target, .. } => Some(target),
            _ => None,
        };
        self.check_may_end_motion(drive, request)?;
        match request {
            MotionRequest::Run { end: RunEnd::Endless, .. } => self.check_can_run_endlessly(drive)?,
            MotionRequest::Run { .. } | MotionRequest::Jog { .. } => self.check_can_move_until_stopped(drive)?,
            _ if request.needs_motion() => self.may_move(drive)?,
            _ => self.check_controllable()?,
        }
        let Some(permit) = self.moves.motion_permit(drive) else { return Err(TEXTS.text("hd_refused.not_taken")) };
        if request == MotionRequest::Resume && permit.doubted {
            // The dead-man would end the paused job.
            return Err(explain::lock_text(MotionLock::Outdated));
        }
        let place = |steps| self.position_text(drive, steps);
        let here =
            self.moves.actual_values(drive).map_or(Ok(()), |actual| permit.check_position_limits(request, actual));
        permit.check_request(request, asks_target).and(here).map_err(|refusal| explain::refusal_text(refusal, place))
    }

    /// Checks whether a request may end the current motion. A stop or a jog of the same drive may. Any other request
    /// must not end the motion of another drive, nor a step or a move that is still in progress.
    fn check_may_end_motion(&self, drive: DriveNumber, request: MotionRequest) -> Result<(), Text> {
        match self.moves.moving_drive() {
            Some(mover) if mover != drive && request != MotionRequest::Stop => {
                Err(TEXTS.text("hd_refused.other_moves").with("drive", mover.get()))
            }
            Some(_)
                if matches!(
                    request,
                    MotionRequest::Step { .. } | MotionRequest::Move { .. } | MotionRequest::Run { .. }
                ) =>
            {
                Err(TEXTS.text("hd_refused.still_moves"))
            }
            _ => Ok(()),
        }
    }

    /// Notifies the user about a drive. The message includes the name of the drive if there are several.
    pub(super) fn report_drive_message(
        &self,
        drive: DriveNumber,
        severity: Severity,
        texts: Vec<Text>,
        services: &mut Services,
    ) {
        services.notify_device_part(severity, texts, (Some(&self.session.name()), self.drive_name(drive)));
    }

    /// Returns the name of a drive, or `None` if there is only one drive.
    pub fn drive_name(&self, drive: DriveNumber) -> Option<Text> {
        (self.drives().len() > 1).then(|| TEXTS.text("hd_bar.named").with("drive", drive.get()))
    }

    pub fn moving_drives(&self) -> Vec<DriveNumber> {
        let moves = |drive: &DriveNumber| {
            self.moves.is_drive_moving(*drive) || self.polled_state(*drive) == Some(State::Moving)
        };
        self.drives().into_iter().filter(moves).collect()
    }

    pub fn position_text(&self, drive: DriveNumber, steps: i32) -> Text {
        let (value, decimals, unit) = self.convert_to_user_unit(drive, steps);
        TEXTS.text("hd_entry.place").with_number("value", value, decimals).with_text("unit", unit)
    }

    /// Formats a position in all units, since the number of steps alone depends on the scale. Degrees are included only
    /// if selected.
    pub fn position_texts(&self, drive: DriveNumber, steps: i32) -> Vec<Text> {
        let ruler = self.ruler(drive);
        let wanted = |own: &PositionUnit| *own != PositionUnit::Degrees || *own == self.measure;
        let place = |own: PositionUnit| {
            let value = ruler.from_steps(i64::from(steps), own)?;
            let decimals = required_decimals(value, ruler.decimal_places(own).min(4));
            let text = TEXTS.text("hd_entry.place").with_number("value", value, decimals);
            Some(text.with_text("unit", TEXTS.text(own.unit())))
        };
        ruler.available_units().filter(wanted).filter_map(place).collect()
    }

    /// Formats a range of positions, with the unit.
    pub fn range_text(&self, drive: DriveNumber, (low, high): (i32, i32)) -> Text {
        let ((low, ..), (high, decimals, unit)) =
            (self.convert_to_user_unit(drive, low), self.convert_to_user_unit(drive, high));
        let text = TEXTS.text("hd_entry.range").with_number("low", low, decimals);
        text.with_number("high", high, decimals).with_text("unit", unit)
    }

    /// Converts a position to the user's unit. Returns the value, its number of decimals, and the unit.
    fn convert_to_user_unit(&self, drive: DriveNumber, steps: i32) -> (f64, usize, Text) {
        let ruler = self.ruler(drive);
        let value = ruler.from_steps(i64::from(steps), self.measure);
        let (value, measure) = value.map_or((f64::from(steps), PositionUnit::Steps), |value| (value, self.measure));
        (value, ruler.decimal_places(measure), TEXTS.text(measure.unit()))
    }

    /// Returns the states that the drive can reach from its current state with one control word. The list is empty if
    /// this program does not control the drive.
    pub fn reachable_states(&self, drive: DriveNumber) -> Vec<State> {
        let Some(state) = self.state(drive).filter(|_| self.check_controllable().is_ok()) else { return Vec::new() };
        let mut reachable = Vec::new();
        for row in state.transitions().filter(|row| row.word.is_some()) {
            if !reachable.contains(&row.to) {
                reachable.push(row.to);
            }
        }
        reachable
    }

    /// Describes the control word that leads to a state, and whether the manual documents it.
    pub fn transition_hint(&self, drive: DriveNumber, to: State) -> Option<Text> {
        let row = self.state(drive)?.transitions().find(|row| row.to == to && row.word.is_some())?;
        let id = if row.assumed { "hd_hint.assumed" } else { "hd_hint.word" };
        Some(TEXTS.text(id).with("word", format!("0x{:04X}", row.word?.to_u16())))
    }

    /// Returns the command that leads to one of the [`reachable_states`](Self::reachable_states), or `None` if no
    /// command does. An acknowledgement leads from a fault to the switch-on lock.
    pub const fn command_for_state(to: State) -> Option<MotorCommand> {
        match to {
            State::NotReady => Some(MotorCommand::Lead(TargetState::Off)),
            State::Ready => Some(MotorCommand::Lead(TargetState::Ready)),
            State::Operational => Some(MotorCommand::Lead(TargetState::Operational)),
            State::Enabled => Some(MotorCommand::Lead(TargetState::Enabled)),
            State::Locked => Some(MotorCommand::Acknowledge),
            State::Moving | State::Fault => None,
        }
    }

    /// Describes the running action of the drive, or how its last action ended. Returns `None` without a cyclic
    /// connection, and before the first action.
    pub fn current_or_last_request(&self, drive: DriveNumber) -> Option<RequestState> {
        let view = self.moves.drive(drive)?;
        if view.phase != Doing::Idle {
            return Some(RequestState { words: explain::phase_text(view.phase), is_well: true });
        }
        let (_, ended) = view.ended?;
        let words = explain::end_text(ended, |steps| self.position_text(drive, steps));
        Some(RequestState { words, is_well: explain::end_severity(ended) == Severity::Note })
    }

    /// Explains why control was lost. Returns `None` if this program has control, has released it or never had it.
    pub fn loss_reason(&self) -> Option<Text> {
        let view = self.moves.snapshot();
        view.lost.as_ref().filter(|_| !view.open).map(|lost| explain::cyclic_loss_text(Some(lost)))
    }

    /// Formats the speed that corresponds to a percentage, based on parameter 166.
    pub fn speed_text(&self, percent: Percent) -> Option<Text> {
        Some(TEXTS.text("hd_entry.rpm").with_number("rpm", self.speed_rpm(percent)?, 1))
    }

    /// Returns the speed in rpm that corresponds to a percentage, based on parameter 166.
    fn speed_rpm(&self, percent: Percent) -> Option<f64> {
        let most = self.parameter_value(self.drive(), MAXIMUM_SPEED)?;
        // The maximum speed is in tenths of rpm, and the setting is in percent.
        Some(most as f64 * f64::from(percent.get()) / 1000.0)
    }

    /// Describes the distance to `target`, and the time that a move takes at the set speed, not counting acceleration.
    /// Returns `None` during a motion, or if the position or the speed is unknown.
    pub fn move_estimate(&self, target: i32) -> Option<Text> {
        let drive = self.drive();
        let distance = target.saturating_sub(self.actual_values(drive)?.position);
        let rpm = self.speed_rpm(self.moves.move_speed_torque(drive).speed).filter(|rpm| *rpm > 0.0)?;
        let turns = self.ruler(drive).from_steps(i64::from(distance).abs(), PositionUnit::Turns)?;
        if self.moves.phase(drive).is_some_and(|phase| phase != Doing::Idle) {
            return None;
        }
        let (seconds, distance) = (turns / rpm * 60.0, self.position_text(drive, distance));
        let text = |id| TEXTS.text(id).with_text("distance", distance);
        Some(match seconds.round() {
            whole @ 60.0.. => {
                let text = text("hd_move.estimate_minutes").with_number("minutes", (whole / 60.0).floor(), 0);
                text.with_number("seconds", whole % 60.0, 0)
            }
            whole @ 10.0.. => text("hd_move.estimate").with_number("seconds", whole, 0),
            _ => text("hd_move.estimate").with_number("seconds", seconds, 1),
        })
    }

    /// Formats the torque that the drive actually applies: the percentage rounded up to a multiple of 25 %. Returns
    /// `None` if it equals the percentage.
    pub fn torque_text(&self, percent: Percent) -> Option<Text> {
        let effective = effective_torque(percent.get());
        (effective != percent.get()).then(|| TEXTS.text("hd_entry.torque").with("percent", effective))
    }
}
