//! Motion requests to a drive, its permit, and how an act ended.

use std::time::Duration;

use crate::devices::hiperdrive::protocol::{Direction, DriveNumber, Percent, RunEnd, State};
use crate::units::Moment;

/// A motion request to a drive, and when it was last refreshed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Intent {
    /// Of which drive. The others rest.
    pub drive: DriveNumber,
    pub request: MotionRequest,
    /// The act of a person that it came with: each has a number of its own, higher than those before.
    pub number: u64,
    /// When it was last said. After [`Intent::FRESH`] nothing that moves goes on.
    pub refreshed: Moment,
}

/// A motion request of the user.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MotionRequest {
    /// Nothing: what moves stops, and the drive's state is held.
    Rest,
    /// Another state.
    Lead(Goal),
    /// A fault is acknowledged; the drive is ready then.
    Acknowledge,
    /// To a place, in steps as scaled.
    Move {
        /// Target position.
        target: i32,
        /// Speed and torque.
        effort: Effort,
    },
    /// A number of scaled steps from the present position: a positioning job, which a stop ends.
    Step {
        /// Signed number of steps.
        by: i32,
        /// Speed and torque.
        effort: Effort,
    },
    /// The job that runs waits.
    Pause,
    /// The job that waits goes on.
    Resume,
    /// Turning for as long as it is held, to the end of the range at most.
    Jog {
        direction: Direction,
        /// Speed and torque; slow ([`Effort::JOG`]) if it leads further out.
        effort: Effort,
        /// From outside the limits it may lead further out: a wrong reference can make that the only way back.
        outward: bool,
    },
    /// Turning in speed mode.
    Run {
        direction: Direction,
        end: RunEnd,
        /// Speed and torque.
        effort: Effort,
    },
    /// Stops the motion.
    Stop,
}

/// A state that a drive can be led to.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Goal {
    /// Not ready: 0000h.
    Off,
    /// Ready: 0400h.
    Ready,
    /// Operational: 0401h.
    Operational,
    /// Enabled, standing: 0409h.
    Enabled,
}

/// Speed and torque of a motion.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Effort {
    /// Of the greatest speed (parameter 166).
    pub speed: Percent,
    /// Of the nominal torque.
    pub torque: Percent,
}

/// The permit of a drive.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Permit {
    /// Parameters 158 and 160; `None` where they were not read.
    pub limits: Option<(i32, i32)>,
    /// The locks that prevent motion.
    pub locks: Vec<Lock>,
    /// It may run past its limits.
    pub endless: bool,
    /// The parameters are to be read again before a motion begins; what is under way goes on.
    pub doubted: bool,
    /// Steps of one degree as scaled, at least 1: how exactly a drive repeats a position (manual, technical data).
    pub degree: u32,
}

/// A reason why a drive may not move.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Lock {
    /// Its parameters were not read.
    Unread,
    /// Parameter 186 is 255, or no time: a drive that hears nothing any more could go on.
    NoTimeout,
    /// The scaling has changed, and the limits with it; the user has not confirmed them yet.
    LimitsUnconfirmed,
    /// Parameter 152 is not 1.
    NotRequested,
    /// Its parameters were read too long ago: another master may have changed them since.
    Outdated,
    /// The device does not answer explicit messages any more.
    NoAnswer,
}

/// The phase of a drive's motion.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Phase {
    /// Nothing: its state is held.
    Idle,
    /// It is led to this state.
    Leading(Goal),
    /// A motion is about to begin.
    Starting(MotionKind),
    Moving(MotionKind),
    /// Its job waits.
    Paused {
        target: i32,
    },
    /// It is to stand.
    Stopping(StopLevel),
}

/// A motion.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MotionKind {
    /// To a place.
    Job {
        /// In steps as scaled.
        target: i32,
    },
    /// In speed mode.
    Run { direction: Direction, end: RunEnd },
}

/// A level of the ladder with which a drive is stopped (reference 3, *STOP ladder*).
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum StopLevel {
    /// The stop of its mode. Torque stays on.
    Mode,
    /// 0401h: operation is taken away.
    Operational,
    /// 0000h.
    Off,
    /// The cyclic connection is to be closed: the drives' own watchdog ends everything.
    Close,
}

/// How an act ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Ended {
    /// The drive was led to where it should be.
    Done,
    /// It is at its target.
    Arrived,
    /// It stands at the end of the range.
    RangeEnd,
    /// Released or stopped by the user.
    Stopped,
    /// Another act came.
    Replaced,
    /// Not refreshed in time.
    Stale,
    /// The drive has said nothing for too long.
    Deaf,
    /// The cyclic connection was lost or closed.
    Lost,
    /// The drive has failed. Nothing moves until that is acknowledged.
    Fault,
    /// It may not move any more.
    Locked(Lock),
    /// It was refused and nothing has been sent for it.
    Refused(Refusal),
    /// The drive is in this state and did not follow a word of its way to where it should be.
    NoAnswer(State),
    /// The drive did not begin the motion.
    NotStarted,
    /// The drive has left what it has to be in for a motion.
    Left(State),
    /// The drive stands, but has not reached its target.
    Short,
    /// The drive is beyond its limits.
    Beyond {
        /// In steps as scaled.
        position: i32,
    },
    /// The drive moves away from its target, or against the direction of its run.
    WrongWay {
        /// In steps as scaled.
        position: i32,
    },
}

/// Why an act was refused.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Refusal {
    /// It may not move.
    Locked(Lock),
    /// 0 % of speed or torque.
    NoEffort,
    /// The target is beyond the limits.
    Outside {
        /// In steps as scaled.
        target: i32,
        /// Parameter 158.
        low: i32,
        /// Parameter 160.
        high: i32,
    },
    /// It is outside its limits, and this would lead further out.
    Outward {
        /// In steps as scaled.
        position: i32,
        /// Parameter 158.
        low: i32,
        /// Parameter 160.
        high: i32,
    },
    /// By status bit 15 it is outside its limits, though its position is inside: which way leads in is not known.
    Unclear {
        /// In steps as scaled.
        position: i32,
        /// Parameter 158.
        low: i32,
        /// Parameter 160.
        high: i32,
    },
    /// Past the limits it may not run.
    Endless,
    /// It has failed: that is to be acknowledged first.
    Fault,
    /// It is in the switch-on lock: it is to be led out of it first.
    SwitchOnLock,
    /// No job runs.
    NothingToPause,
    /// No job waits.
    NothingToResume,
    /// There is no drive in this place.
    Absent,
}

impl Intent {
    /// How long a refresh stays valid. It has to be repeated every 100 ms.
    pub const FRESH: Duration = Duration::from_millis(250);

    /// Creates an act that requests nothing.
    pub const fn rest(drive: DriveNumber, number: u64, now: Moment) -> Self {
        Intent { drive, request: MotionRequest::Rest, number, refreshed: now }
    }

    /// Returns whether it was not refreshed in time.
    pub fn is_stale(&self, now: Moment) -> bool {
        now.since(self.refreshed) > Intent::FRESH
    }
}

impl MotionRequest {
    /// Returns whether the act makes the drive move. A pause does not.
    pub const fn moves(self) -> bool {
        matches!(
            self,
            MotionRequest::Move { .. }
                | MotionRequest::Step { .. }
                | MotionRequest::Resume
                | MotionRequest::Jog { .. }
                | MotionRequest::Run { .. }
        )
    }

    /// Returns speed and torque, if it has any.
    pub fn effort(self) -> Option<Effort> {
        match self {
            MotionRequest::Jog { effort, outward: true, .. } => Some(effort.at_most(Effort::JOG)),
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

impl Goal {
    /// All of them, the lowest first.
    pub const ALL: [Goal; 4] = [Goal::Off, Goal::Ready, Goal::Operational, Goal::Enabled];

    pub(super) const fn above(self) -> Goal {
        match self {
            Goal::Off => Goal::Ready,
            Goal::Ready => Goal::Operational,
            Goal::Operational | Goal::Enabled => Goal::Enabled,
        }
    }

    /// Returns how far up a state is. A fault and the lock are the lowest.
    pub(super) const fn of(state: State) -> Goal {
        match state {
            State::NotReady | State::Fault | State::Locked => Goal::Off,
            State::Ready => Goal::Ready,
            State::Operational => Goal::Operational,
            State::Enabled | State::Moving => Goal::Enabled,
        }
    }
}

impl Effort {
    /// Nothing would begin.
    pub const NONE: Effort = Effort { speed: Percent::NONE, torque: Percent::NONE };
    /// Speed and torque of a new jog: 10 % and 25 %.
    pub const JOG: Effort = Effort { speed: percent(10), torque: percent(25) };
    /// Speed and torque of a new move: a quarter of the speed, which leaves time for STOP after a mistyped target, and
    /// the torque that an axis may need.
    pub const MOVE: Effort = Effort { speed: percent(25), torque: Percent::FULL };

    /// Limits the effort to another one.
    pub fn at_most(self, other: Effort) -> Self {
        Effort { speed: self.speed.min(other.speed), torque: self.torque.min(other.torque) }
    }

    /// 0 % of one of them: nothing would begin.
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
    /// Returns the permit for nothing, as long as a drive's parameters were not read.
    fn default() -> Self {
        Permit { limits: None, locks: vec![Lock::Unread], endless: false, doubted: false, degree: 1 }
    }
}

impl Permit {
    /// Motion within these limits, with nothing against it, under the factory's scale of 65536 steps a turn.
    pub const fn within(low: i32, high: i32) -> Self {
        Permit { limits: Some((low, high)), locks: Vec::new(), endless: false, doubted: false, degree: 183 }
    }

    /// Checks whether a motion may begin, or continue. `target` is its end, if it has one.
    ///
    /// # Errors
    /// [`Refusal`].
    pub fn check(&self, request: MotionRequest, target: Option<i32>) -> Result<(), Refusal> {
        if !request.moves() {
            return Ok(());
        }
        if let Some(lock) = self.locks.first() {
            return Err(Refusal::Locked(*lock));
        }
        if request.effort().is_some_and(Effort::is_none) {
            return Err(Refusal::NoEffort);
        }
        if matches!(request, MotionRequest::Run { end: RunEnd::Endless, .. }) && !self.endless {
            return Err(Refusal::Endless);
        }
        match (target, self.limits) {
            (_, None) => Err(Refusal::Locked(Lock::Unread)),
            (Some(target), Some((low, high))) if !(low..=high).contains(&target) => {
                Err(Refusal::Outside { target, low, high })
            }
            _ => Ok(()),
        }
    }
}
