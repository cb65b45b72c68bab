//! The dead-man control, which is the only source of a drive's control word. In every interval, it derives the word
//! from the drive's report, the user's request and the drive's permit (reference, section 3). The caller passes in the
//! time, and no call blocks.
//!
//! Invariants for any input:
//! - A word that could start a motion is sent only while a fresh action of the user requests that motion. All other
//!   words are standing words ([`ControlWord::is_at_rest`]). They start nothing for any report of the drive, even a
//!   late one.
//! - The call that receives a reason to stop returns a standing word.
//! - An action that has ended never starts again. Neither does one that was not refreshed until it could start.
//! - A motion beyond the limits, or away from its target, is stopped with the report that shows it (`watch`).
//! - A drive that has run in speed mode receives 0400h before anything else. This discards the job that clearing bit 12
//!   would start. While no job is running, the target is the present position.
//!
//! A motion brings the drive up to *enabled* without further requests, but never out of a fault or the switch-on lock.

mod act;
mod cause;
mod stage;
mod state_sequence;
#[cfg(test)]
mod table;
#[cfg(test)]
mod tests;
mod watch;

use std::time::Duration;

pub use act::{
    ActionEnd, MotionIntent, MotionKind, MotionLock, MotionRejection, MotionRequest, Permit, Phase, SpeedTorque,
    StopLevel, TargetState,
};
pub use watch::{LimitSide, LimitViolation};

use stage::{ReportTimestamp, Stage};
use state_sequence::StateSequencer;
use watch::ActionMonitor;

use crate::devices::hiperdrive::protocol::{
    ActualValues, ControlWord, DriveNumber, Percent, RunEnd, Setpoint, StatusBit,
};
use crate::units::Moment;

#[derive(Clone, Debug)]
pub struct DeadMan {
    drive: DriveNumber,
    received: Option<(Moment, ActualValues)>,
    /// Time at which the first report from the drive arrived.
    first: Option<Moment>,
    reports: u64,
    sent: Setpoint,
    stage: Stage,
    level: TargetState,
    act: Option<UserAction>,
    /// Highest action number that can no longer start a motion.
    spent: u64,
    /// Speed and torque of the last motion.
    effort: SpeedTorque,
    /// Whether a run was started in speed mode. The drive may still remember the run and must first leave the
    /// operational state.
    after_run: bool,
    /// Whether the drive's reports are missing. No motion may start in this state.
    is_out_of_contact: bool,
    ended: Option<(u64, ActionEnd)>,
}

#[derive(Clone, Copy, Debug)]
struct UserAction {
    number: u64,
    /// Latest request within the action, which can be a pause of its job.
    request: MotionRequest,
    motion: Option<Motion>,
    watch: Option<ActionMonitor>,
}

#[derive(Clone, Copy, Debug)]
struct Motion {
    request: MotionRequest,
    kind: MotionKind,
}

/// Time allowed for a drive to stop before the next level of the stop sequence begins.
pub const STOP_LEVEL_TIMEOUT: Duration = Duration::from_millis(200);
/// Time allowed for a drive to obey a control word during a change of state.
const STEP: Duration = Duration::from_secs(2);
/// Time allowed for a drive to start moving.
const START: Duration = Duration::from_secs(1);
/// Time without a report after which no drive may move. It exceeds three of the longest intervals.
const CONTACT_TIMEOUT: Duration = Duration::from_millis(350);
/// Maximum delay of a report on its way from a drive through a hub (`U`: not documented).
pub const MAX_REPORT_DELAY: Duration = Duration::from_millis(100);
/// Time after the first report from which positions are considered valid. A hub first queries all its drives (`U`: not
/// documented).
pub const POSITION_SETTLING_TIME: Duration = Duration::from_millis(250);
/// Time after which a drive at standstill is considered to have missed its target.
const MISSED_TARGET_TIME: Duration = Duration::from_millis(500);

impl DeadMan {
    /// Creates the dead-man control for a newly opened connection. Actions numbered up to `spent` cannot start a
    /// motion.
    pub const fn new(drive: DriveNumber, spent: u64) -> Self {
        DeadMan {
            drive,
            received: None,
            first: None,
            reports: 0,
            sent: NONE,
            stage: Stage::Rest { moves: None },
            level: TargetState::Off,
            act: None,
            spent,
            effort: SpeedTorque::NONE,
            after_run: false,
            is_out_of_contact: false,
            ended: None,
        }
    }

    /// Returns the setpoint to send now. `received` is the data received since the last call, or `None` if nothing
    /// arrived.
    pub fn next(
        &mut self,
        now: Moment,
        received: Option<ActualValues>,
        intent: &MotionIntent,
        permit: &Permit,
    ) -> Setpoint {
        if let Some(actual) = received {
            self.receive(now, actual);
        }
        self.sent = match self.received {
            Some((_, actual)) => {
                self.check_end_conditions(now, actual, intent, permit);
                self.advance_stage(now, actual);
                self.accept_intent(now, actual, intent, permit);
                self.run_guarded(self.next_setpoint(actual), actual)
            }
            None => {
                self.discard_void_request(now, intent);
                NONE
            }
        };
        self.sent
    }

    pub const fn drive(&self) -> DriveNumber {
        self.drive
    }

    /// Returns the data received last, or zeros before the first reception.
    pub fn actual_values(&self) -> ActualValues {
        self.received.map(|(_, actual)| actual).unwrap_or_default()
    }

    /// Returns the time at which data were last received, or `None` before the first reception.
    pub fn received_at(&self) -> Option<Moment> {
        self.received.map(|(at, _)| at)
    }

    pub const fn last_setpoint(&self) -> Setpoint {
        self.sent
    }

    /// Returns the number of the running action, or of the last one that ended. Returns 0 before the first action.
    pub fn action_number(&self) -> u64 {
        self.act.map_or(self.ended.map_or(0, |(number, _)| number), |act| act.number)
    }

    /// Returns the number of the last action that ended, and how it ended.
    pub const fn last_end(&self) -> Option<(u64, ActionEnd)> {
        self.ended
    }

    pub fn phase(&self) -> Phase {
        let kind = self.act.and_then(|act| act.motion).map(|motion| motion.kind);
        match (&self.stage, kind) {
            (Stage::Stop { level, .. }, _) => Phase::Stopping(*level),
            (Stage::Lead(lead), _) => Phase::Leading(lead.goal()),
            (Stage::Arm { .. } | Stage::Start { .. }, Some(kind)) => Phase::Starting(kind),
            (Stage::Go { .. }, Some(kind)) => Phase::Moving(kind),
            (Stage::Paused { .. }, Some(MotionKind::Job { target })) => Phase::Paused { target },
            _ => Phase::Idle,
        }
    }

    /// Returns whether every level of the stop sequence has failed. The connection must then be closed, so that the
    /// drives are stopped by their watchdogs.
    pub const fn has_exhausted_stop_levels(&self) -> bool {
        matches!(self.stage, Stage::Stop { level: StopLevel::Close, .. })
    }

    /// Returns whether no action is running and no drive motion has to be stopped.
    pub const fn is_idle(&self) -> bool {
        matches!(self.stage, Stage::Rest { moves: None })
    }

    /// Ends the running action and stops the motion when the connection has ended or was lost.
    pub fn connection_lost(&mut self, now: Moment) {
        if self.stage.has_motion() {
            self.stop(now, ActionEnd::Lost);
        } else if matches!(self.stage, Stage::Lead(_)) {
            self.end_action(ActionEnd::Lost);
            self.hold_state(self.actual_values().status.state());
        }
    }

    /// Stops the motion when position reports are missing. No motion may start in this state.
    pub fn handle_contact_loss(&mut self, now: Moment) {
        self.is_out_of_contact = true;
        if self.stage.has_motion() {
            self.stop(now, ActionEnd::Deaf);
        }
    }

    fn receive(&mut self, now: Moment, actual: ActualValues) {
        self.reports += 1;
        self.is_out_of_contact = false;
        self.received = Some((now, actual));
        self.first = self.first.or(Some(now));
        let below = TargetState::from_word(self.sent.control) < TargetState::Operational;
        let forgotten = |bit| !actual.status.is_set(bit);
        if below && forgotten(StatusBit::Operational) && forgotten(StatusBit::SetpointAcknowledged) {
            self.after_run = false;
        }
    }

    /// Discards a request that must not start a motion, together with all earlier ones. Such requests are to rest or to
    /// stop, are meant for another drive, or were not refreshed in time.
    fn discard_void_request(&mut self, now: Moment, intent: &MotionIntent) {
        let rests = matches!(intent.request, MotionRequest::Rest | MotionRequest::Stop);
        let stale = intent.is_stale(now);
        if intent.number <= self.spent || !(intent.drive != self.drive || rests || stale) {
            return;
        }
        self.spent = intent.number;
        if intent.drive == self.drive && !rests && self.act.is_none_or(|act| act.number < intent.number) {
            self.ended = Some((intent.number, ActionEnd::Stale));
        }
    }

    fn end_action(&mut self, how: ActionEnd) {
        if let Some(act) = self.act.take() {
            self.spent = self.spent.max(act.number);
            self.ended = Some((act.number, how));
        }
    }

    /// Starts a newly requested action if the last action has ended.
    fn accept_intent(&mut self, now: Moment, actual: ActualValues, intent: &MotionIntent, permit: &Permit) {
        self.discard_void_request(now, intent);
        // A relative step starts from the present position.
        let has_arrived = self.first.is_some_and(|first| now.duration_since(first) >= POSITION_SETTLING_TIME);
        let has_place = has_arrived || !matches!(intent.request, MotionRequest::Step { .. });
        let waits = self.act.is_some() || !has_place || !matches!(self.stage, Stage::Rest { .. } | Stage::Lead(_));
        if intent.drive != self.drive || intent.number <= self.spent || waits {
            return;
        }
        if let Some(how) = self.failure_before_request(intent) {
            self.spent = intent.number;
            self.ended = Some((intent.number, how));
            return;
        }
        self.act = Some(UserAction { number: intent.number, request: intent.request, motion: None, watch: None });
        if self.is_out_of_contact && intent.request.needs_motion() {
            self.end_action(ActionEnd::Deaf);
        } else if let Err(refusal) = self.begin_action(now, actual, intent.request, permit) {
            self.end_action(ActionEnd::Refused(refusal));
        }
    }

    /// Returns how the last action failed if the new request is to pause or resume it. The user, who did not know of
    /// the failure yet, then gets its reason instead of being told that there is no job.
    fn failure_before_request(&self, intent: &MotionIntent) -> Option<ActionEnd> {
        let concerns_last_action = matches!(intent.request, MotionRequest::Pause | MotionRequest::Resume);
        let (number, how) = self.ended.filter(|_| concerns_last_action)?;
        (intent.number == number + 1 && how.is_failure()).then_some(how)
    }

    fn begin_action(
        &mut self,
        now: Moment,
        actual: ActualValues,
        request: MotionRequest,
        permit: &Permit,
    ) -> Result<(), MotionRejection> {
        let status = actual.status;
        if !status.is_present() {
            return Err(MotionRejection::Absent);
        }
        let kind = match request {
            MotionRequest::Rest | MotionRequest::Stop => return Ok(()),
            MotionRequest::Lead(goal) => return self.begin_transition(now, actual, goal),
            MotionRequest::Acknowledge => return self.acknowledge(now, actual),
            MotionRequest::Pause => return Err(MotionRejection::NothingToPause),
            MotionRequest::Resume => return Err(MotionRejection::NothingToResume),
            MotionRequest::Move { target, .. } => MotionKind::Job { target },
            MotionRequest::Step { by, .. } => MotionKind::Job { target: actual.position.saturating_add(by) },
            MotionRequest::Jog { direction, .. } => MotionKind::Run { direction, end: RunEnd::RangeEnd },
            MotionRequest::Run { direction, end, .. } => MotionKind::Run { direction, end },
        };
        permit.check_request(request, kind.target())?;
        if permit.doubted {
            return Err(MotionRejection::Locked(MotionLock::Outdated));
        }
        permit.check_position_limits(request, actual)?;
        if status.is_set(StatusBit::Fault) {
            return Err(MotionRejection::Fault);
        }
        if status.is_set(StatusBit::SwitchOnLock) {
            return Err(MotionRejection::SwitchOnLock);
        }
        if let Some(act) = &mut self.act {
            act.motion = Some(Motion { request, kind });
        }
        self.effort = request.speed_torque().unwrap_or(self.effort);
        self.stage = Stage::Lead(StateSequencer::new(TargetState::Enabled));
        self.advance_stage(now, actual);
        Ok(())
    }

    /// Replaces a control word that could start a motion while none is requested. This is the last safeguard.
    fn run_guarded(&self, setpoint: Setpoint, actual: ActualValues) -> Setpoint {
        let is_commanded = self.act.is_some_and(|act| act.motion.is_some()) && self.stage.is_moving();
        if is_commanded || setpoint.control.is_at_rest() { setpoint } else { Setpoint::holding(actual) }
    }

    const fn current_mark(&self, now: Moment) -> ReportTimestamp {
        ReportTimestamp { at: now, report: self.reports }
    }
}

impl MotionKind {
    pub const fn target(self) -> Option<i32> {
        match self {
            MotionKind::Job { target } => Some(target),
            MotionKind::Run { .. } => None,
        }
    }
}

/// Setpoint sent before the drive has sent its first report. It does not request control.
const NONE: Setpoint = Setpoint { control: ControlWord::OFF, speed: Percent::NONE, torque: Percent::NONE, target: 0 };
