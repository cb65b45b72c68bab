//! Motion requests to a drive, the permit to move it, and the outcome of an action.

use std::time::Duration;

use crate::devices::hiperdrive::protocol::{Direction, DriveNumber, Percent, RunEnd, State};
use crate::units::Moment;

/// A motion request to a drive with the time of its last refresh.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct MotionIntent {
    pub drive: DriveNumber,
    pub request: MotionRequest,
    /// Number of the user's action. It is higher than all previous numbers.
    pub number: u64,
    /// Time of the last refresh. No motion continues after [`MotionIntent::REFRESH_VALIDITY`].
    pub refreshed: Moment,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MotionRequest {
    /// No request. The drive is stopped if it moves, and otherwise stays in its state.
    Rest,
    Lead(TargetState),
    Acknowledge,
    /// Moves to a position in scaled steps.
    Move {
        target: i32,
        effort: SpeedTorque,
    },
    /// Moves by a number of scaled steps from the current position. A stop ends this motion, which is a positioning
    /// job.
    Step {
        /// Signed number of steps.
        by: i32,
        effort: SpeedTorque,
    },
    Pause,
    Resume,
    /// Turns while the button is held, but not past the end of the range.
    Jog {
        direction: Direction,
        /// Speed and torque. If `outward` is set, they are limited to [`SpeedTorque::DEFAULT_JOG`].
        effort: SpeedTorque,
        /// Whether a drive outside its limits may move further outward. If the reference is wrong, this may be the only
        /// way back.
        outward: bool,
    },
    Run {
        direction: Direction,
        end: RunEnd,
        effort: SpeedTorque,
    },
    Stop,
}

/// A target state of a drive.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum TargetState {
    /// Not ready, 0000h.
    Off,
    /// Ready, 0400h.
    Ready,
    /// Operational, 0401h.
    Operational,
    /// Enabled and at rest, 0409h.
    Enabled,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SpeedTorque {
    pub speed: Percent,
    pub torque: Percent,
}

/// Permission for a drive to move: limits, locks and exceptions.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Permit {
    /// Lower and upper limit (parameters 158 and 160), or `None` if they have not been read.
    pub limits: Option<(i32, i32)>,
    pub locks: Vec<MotionLock>,
    /// Whether the drive may run past its limits.
    pub endless: bool,
    /// Whether the parameters must be read again before the next motion starts. A running motion continues.
    pub doubted: bool,
    /// Scaled steps per degree, at least 1. The repeatability of a drive is one degree (manual, technical data).
    pub degree: u32,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum MotionLock {
    Unread,
    /// Parameter 186 is 255 or not a time, so the drive could continue to move after a loss of communication.
    NoTimeout,
    /// The scale has changed, so the limits are at other positions, and the user has not confirmed them yet.
    LimitsUnconfirmed,
    /// Parameter 152 (Requested) of the drive is not 1.
    NotRequested,
    /// The parameters were read too long ago, and another master may have changed them since.
    Outdated,
    /// The device no longer answers explicit messages.
    NoAnswer,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Phase {
    Idle,
    Leading(TargetState),
    Starting(MotionKind),
    Moving(MotionKind),
    Paused { target: i32 },
    Stopping(StopLevel),
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MotionKind {
    Job {
        /// Target position in scaled steps.
        target: i32,
    },
    Run {
        direction: Direction,
        end: RunEnd,
    },
}

/// A level of the stop sequence (reference, section 3, *STOP ladder*).
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum StopLevel {
    Mode,
    /// Disables operation by sending 0401h.
    Operational,
    /// Switches the drive off by sending 0000h.
    Off,
    /// Closes the cyclic connection, so that the drives are stopped by their watchdogs.
    Close,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ActionEnd {
    Done,
    Arrived,
    RangeEnd,
    Stopped,
    Replaced,
    /// The request was not refreshed in time.
    Stale,
    Deaf,
    Lost,
    /// The drive has a fault and cannot move until the fault is acknowledged.
    Fault,
    /// The drive is no longer permitted to move.
    Locked(MotionLock),
    /// The request was rejected, and nothing was sent.
    Refused(MotionRejection),
    /// The drive did not obey a control word and stayed in this state.
    NoAnswer(State),
    NotStarted,
    /// The drive has left the state that is required for motion and is now in this one.
    Left(State),
    /// The drive is at rest but has not reached its target.
    Short,
    Beyond {
        /// Position in scaled steps.
        position: i32,
    },
    /// The drive is moving away from its target, or against the direction of its run.
    WrongWay {
        /// Position in scaled steps.
        position: i32,
    },
}

impl ActionEnd {
    /// Returns whether an action that had begun failed, rather than being completed, stopped or replaced.
    pub(super) const fn is_failure(self) -> bool {
        !matches!(
            self,
            ActionEnd::Done
                | ActionEnd::Arrived
                | ActionEnd::Stopped
                | ActionEnd::Replaced
                | ActionEnd::Refused(MotionRejection::NothingToPause | MotionRejection::NothingToResume)
        )
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MotionRejection {
    Locked(MotionLock),
    /// The requested speed or torque is 0 %.
    NoEffort,
    Outside {
        /// Target position in scaled steps.
        target: i32,
        /// Lower limit in scaled steps, parameter 158.
        low: i32,
        /// Upper limit in scaled steps, parameter 160.
        high: i32,
    },
    /// The drive is outside its limits, and the motion would take it further outside.
    Outward {
        /// Position in scaled steps.
        position: i32,
        /// Lower limit in scaled steps, parameter 158.
        low: i32,
        /// Upper limit in scaled steps, parameter 160.
        high: i32,
    },
    /// Status bit 15 reports the drive outside its limits, although its position is inside. It is unclear which
    /// direction leads back inside.
    Unclear {
        /// Position in scaled steps.
        position: i32,
        /// Lower limit in scaled steps, parameter 158.
        low: i32,
        /// Upper limit in scaled steps, parameter 160.
        high: i32,
    },
    Endless,
    /// The drive has a fault, which must be acknowledged first.
    Fault,
    /// The drive is in the switch-on lock, which it must leave first.
    SwitchOnLock,
    /// No job is running.
    NothingToPause,
    /// No job is paused.
    NothingToResume,
    Absent,
}

impl MotionIntent {
    /// Time for which a refresh is valid. A refresh is due every 100 ms.
    pub const REFRESH_VALIDITY: Duration = Duration::from_millis(250);

    /// Creates an intent that requests nothing.
    pub const fn idle(drive: DriveNumber, number: u64, now: Moment) -> Self {
        MotionIntent { drive, request: MotionRequest::Rest, number, refreshed: now }
    }

    /// Returns whether the request has not been refreshed in time.
    pub fn is_stale(&self, now: Moment) -> bool {
        now.duration_since(self.refreshed) > MotionIntent::REFRESH_VALIDITY
    }
}

impl MotionRequest {
    /// Returns whether the request makes the drive move. A pause does not.
    pub const fn needs_motion(self) -> bool {
        matches!(
            self,
            MotionRequest::Move { .. }
                | MotionRequest::Step { .. }
                | MotionRequest::Resume
                | MotionRequest::Jog { .. }
                | MotionRequest::Run { .. }
        )
    }

    /// Returns speed and torque, or `None` for requests without them, such as a stop.
    pub fn speed_torque(self) -> Option<SpeedTorque> {
        match self {
            MotionRequest::Jog { effort, outward: true, .. } => Some(effort.at_most(SpeedTorque::DEFAULT_JOG)),
            MotionRequest::Move { effort, .. }
            | MotionRequest::Step { effort, .. }
            | MotionRequest::Jog { effort, .. }
            | MotionRequest::Run { effort, .. } => Some(effort),
            MotionRequest::Rest
            | MotionRequest::Lead(_)
            | MotionRequest::Acknowledge
            | MotionRequest::Pause
            | MotionRequest::Resume
            | MotionRequest::Stop => None,
        }
    }
}

impl TargetState {
    pub const ALL: [TargetState; 4] =
        [TargetState::Off, TargetState::Ready, TargetState::Operational, TargetState::Enabled];

    pub(super) const fn next_level(self) -> TargetState {
        match self {
            TargetState::Off => TargetState::Ready,
            TargetState::Ready => TargetState::Operational,
            TargetState::Operational | TargetState::Enabled => TargetState::Enabled,
        }
    }

    /// Returns the target state for a drive state. For a fault and the switch-on lock, this is the lowest one.
    pub(super) const fn from_state(state: State) -> TargetState {
        match state {
            State::NotReady | State::Fault | State::Locked => TargetState::Off,
            State::Ready => TargetState::Ready,
            State::Operational => TargetState::Operational,
            State::Enabled | State::Moving => TargetState::Enabled,
        }
    }
}

impl SpeedTorque {
    /// Zero speed and torque, which start no motion.
    pub const NONE: SpeedTorque = SpeedTorque { speed: Percent::NONE, torque: Percent::NONE };
    /// Default speed (10 %) and torque (25 %) of a jog.
    pub const DEFAULT_JOG: SpeedTorque = SpeedTorque { speed: percent(10), torque: percent(25) };
    /// Default speed (25 %) and torque (100 %) of a move. The low speed leaves time to stop after a mistyped target,
    /// whereas an axis may need the full torque.
    pub const DEFAULT_MOVE: SpeedTorque = SpeedTorque { speed: percent(25), torque: Percent::FULL };

    pub fn at_most(self, other: SpeedTorque) -> Self {
        SpeedTorque { speed: self.speed.min(other.speed), torque: self.torque.min(other.torque) }
    }

    /// Returns whether speed or torque is 0 %, so that no motion would start.
    pub const fn is_none(self) -> bool {
        self.speed.get() == 0 || self.torque.get() == 0
    }
}

const fn percent(percent: u8) -> Percent {
    match Percent::new(percent) {
        Some(percent) => percent,
        None => Percent::FULL,
    }
}

impl Default for Permit {
    /// Creates the permit that applies before the parameters of a drive have been read. It does not allow any motion.
    fn default() -> Self {
        Permit { limits: None, locks: vec![MotionLock::Unread], endless: false, doubted: false, degree: 1 }
    }
}

impl Permit {
    /// Creates a permit for positions within the given limits, with no locks and the factory scale of 65536 steps per
    /// turn.
    pub const fn for_range(low: i32, high: i32) -> Self {
        Permit { limits: Some((low, high)), locks: Vec::new(), endless: false, doubted: false, degree: 183 }
    }

    /// Checks whether a motion may begin or continue. `target` is the final position, if the motion has one.
    ///
    /// # Errors
    /// Returns the [`MotionRejection`] if the motion is not permitted.
    pub fn check_request(&self, request: MotionRequest, target: Option<i32>) -> Result<(), MotionRejection> {
        if !request.needs_motion() {
            return Ok(());
        }
        if let Some(lock) = self.locks.first() {
            return Err(MotionRejection::Locked(*lock));
        }
        if request.speed_torque().is_some_and(SpeedTorque::is_none) {
            return Err(MotionRejection::NoEffort);
        }
        if matches!(request, MotionRequest::Run { end: RunEnd::Endless, .. }) && !self.endless {
            return Err(MotionRejection::Endless);
        }
        match (target, self.limits) {
            (_, None) => Err(MotionRejection::Locked(MotionLock::Unread)),
            (Some(target), Some((low, high))) if !(low..=high).contains(&target) => {
                Err(MotionRejection::Outside { target, low, high })
            }
            _ => Ok(()),
        }
    }
}
