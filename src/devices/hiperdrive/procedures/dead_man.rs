//! The dead-man: it alone makes the control word of a drive, interval by interval, from what the drive says, what a person
//! wants and what the drive may do (reference 3). Pure: time is handed in, nothing is waited for.
//!
//! What holds whatever is handed in:
//! - a word that could begin a motion is sent only while a fresh act of a person asks for that motion. All others stand
//!   ([`ControlWord::is_standing`]): nothing begins with them whatever the drive says, also where it says it late;
//! - with the call that learns of a reason to stop, the word is one that stands;
//! - an act that has ended never begins again, nor does one that was not refreshed until it could begin;
//! - a motion that leads beyond the limits, or away from its target, is stopped with the report that shows it (`watch`);
//! - a drive that has run in speed mode is led through 0400 before anything else, which makes it forget the job that
//!   clearing bit 12 would be; the target is where it stands whenever no job is under way.
//!
//! A motion leads up to *enabled* by itself, but never out of a fault or the lock.

mod act;
mod cause;
mod lead;
mod stage;
#[cfg(test)]
mod table;
#[cfg(test)]
mod tests;
mod watch;

use std::time::Duration;

pub use act::{Effort, Ended, Goal, Intent, Lock, MotionRequest, Motive, Permit, Phase, Refusal, Rung};
pub use watch::{Outside, Side};

use lead::Lead;
use stage::{Mark, Stage};
use watch::Watch;

use crate::devices::hiperdrive::protocol::{Actual, ControlWord, DriveNumber, Percent, RunEnd, Setpoint, StatusBit};
use crate::units::Moment;

/// A drive's dead-man, from the opening of a cyclic connection to its end.
#[derive(Clone, Debug)]
pub struct DeadMan {
    drive: DriveNumber,
    heard: Option<(Moment, Actual)>,
    /// When it was heard first.
    first: Option<Moment>,
    /// Number of reports received.
    reports: u64,
    sent: Setpoint,
    stage: Stage,
    /// The goal at rest.
    level: Goal,
    act: Option<Act>,
    /// No act up to this one begins any more.
    spent: u64,
    /// Of the last motion.
    effort: Effort,
    /// Speed mode was entered, and the drive may remember it: it has to go below operational.
    after_run: bool,
    /// It is not heard at the moment: nothing that moves begins.
    deaf: bool,
    ended: Option<(u64, Ended)>,
}

/// The act that is under way.
#[derive(Clone, Copy, Debug)]
struct Act {
    number: u64,
    /// As it was said last: a pause of a job is an act too.
    said: MotionRequest,
    /// The motion, if any.
    motion: Option<Motion>,
    /// Supervision of a motion that has begun.
    watch: Option<Watch>,
}

#[derive(Clone, Copy, Debug)]
struct Motion {
    /// As it was asked for.
    wish: MotionRequest,
    motive: Motive,
}

/// A rung of the stop ladder.
pub const RUNG: Duration = Duration::from_millis(200);
/// Time for a drive to obey a word on the way to another state.
const STEP: Duration = Duration::from_secs(2);
/// Time for a drive to begin a motion.
const START: Duration = Duration::from_secs(1);
/// Without a word from the drive for so long, nothing moves: beyond three of the longest intervals.
const DEAF: Duration = Duration::from_millis(350);
/// How late a report may be behind what it reports, between a hub and its drives (`U`).
pub const SETTLE: Duration = Duration::from_millis(100);
/// How long positions have to arrive before they count as the drive's (`U`: a hub first queries all its drives).
pub const HEARD: Duration = Duration::from_millis(250);
/// It stands without having arrived.
const SHORT: Duration = Duration::from_millis(500);

impl DeadMan {
    /// Creates the state at the opening of a connection. No act up to `spent` begins.
    pub const fn new(drive: DriveNumber, spent: u64) -> Self {
        DeadMan {
            drive,
            heard: None,
            first: None,
            reports: 0,
            sent: NONE,
            stage: Stage::Rest { moves: None },
            level: Goal::Off,
            act: None,
            spent,
            effort: Effort::NONE,
            after_run: false,
            deaf: false,
            ended: None,
        }
    }

    /// Returns the setpoint to send now. `heard` is the data received since the last call; `None` if nothing arrived.
    pub fn next(&mut self, now: Moment, heard: Option<Actual>, intent: &Intent, permit: &Permit) -> Setpoint {
        if let Some(actual) = heard {
            self.hear(now, actual);
        }
        self.sent = match self.heard {
            Some((_, actual)) => {
                self.look_for_an_end(now, actual, intent, permit);
                self.advance(now, actual);
                self.take(now, actual, intent, permit);
                self.guarded(self.setpoint(actual), actual)
            }
            None => {
                self.forget_what_is_void(now, intent);
                NONE
            }
        };
        self.sent
    }

    pub const fn drive(&self) -> DriveNumber {
        self.drive
    }

    /// Returns the data received last; zero before the first.
    pub fn actual(&self) -> Actual {
        self.heard.map(|(_, actual)| actual).unwrap_or_default()
    }

    /// Returns the time of the drive's last status; `None` before the first.
    pub fn heard_at(&self) -> Option<Moment> {
        self.heard.map(|(at, _)| at)
    }

    /// Returns the setpoint sent last.
    pub const fn sent(&self) -> Setpoint {
        self.sent
    }

    /// The act that is under way, or else the last one that is over; 0 for none.
    pub fn act(&self) -> u64 {
        self.act.map_or(self.ended.map_or(0, |(number, _)| number), |act| act.number)
    }

    /// The last act that ended, and how.
    pub const fn ended(&self) -> Option<(u64, Ended)> {
        self.ended
    }

    /// Returns the phase of the motion.
    pub fn phase(&self) -> Phase {
        let motive = self.act.and_then(|act| act.motion).map(|motion| motion.motive);
        match (&self.stage, motive) {
            (Stage::Stop { rung, .. }, _) => Phase::Stopping(*rung),
            (Stage::Lead(lead), _) => Phase::Leading(lead.goal()),
            (Stage::Arm { .. } | Stage::Start { .. }, Some(motive)) => Phase::Starting(motive),
            (Stage::Go { .. }, Some(motive)) => Phase::Moving(motive),
            (Stage::Paused { .. }, Some(Motive::Job { target })) => Phase::Paused { target },
            _ => Phase::Idle,
        }
    }

    /// Returns whether nothing helped: the connection is to be closed, so that the drives' watchdog stops them.
    pub const fn gives_up(&self) -> bool {
        matches!(self.stage, Stage::Stop { rung: Rung::Close, .. })
    }

    /// Returns whether nothing is under way and the drive need not be stopped.
    pub const fn is_idle(&self) -> bool {
        matches!(self.stage, Stage::Rest { moves: None })
    }

    /// The connection ends, or is gone: what was under way has ended so, and the drive is to stand.
    pub fn lose(&mut self, now: Moment) {
        if self.stage.has_motion() {
            self.stop(now, Ended::Lost);
        } else if matches!(self.stage, Stage::Lead(_)) {
            self.end(Ended::Lost);
            self.hold_what_is(self.actual().status.state());
        }
    }

    /// Handles lost positions, for whatever reason: motion is stopped, and none begins.
    pub fn fall_deaf(&mut self, now: Moment) {
        self.deaf = true;
        if self.stage.has_motion() {
            self.stop(now, Ended::Deaf);
        }
    }

    fn hear(&mut self, now: Moment, actual: Actual) {
        self.reports += 1;
        self.deaf = false;
        self.heard = Some((now, actual));
        self.first = self.first.or(Some(now));
        let below = Goal::of_word(self.sent.control) < Goal::Operational;
        let forgotten = |bit| !actual.status.has(bit);
        if below && forgotten(StatusBit::Operational) && forgotten(StatusBit::SetpointAcknowledged) {
            self.after_run = false;
        }
    }

    /// Forgets requests that could not begin while they were fresh, and those before a stop or an act for another
    /// drive.
    fn forget_what_is_void(&mut self, now: Moment, intent: &Intent) {
        let rests = matches!(intent.wish, MotionRequest::Rest | MotionRequest::Stop);
        let stale = intent.is_stale(now);
        if intent.number <= self.spent || !(intent.drive != self.drive || rests || stale) {
            return;
        }
        self.spent = intent.number;
        if intent.drive == self.drive && !rests && self.act.is_none_or(|act| act.number < intent.number) {
            self.ended = Some((intent.number, Ended::Stale));
        }
    }

    /// Ends an act. The caller stops its motion.
    fn end(&mut self, how: Ended) {
        if let Some(act) = self.act.take() {
            self.spent = self.spent.max(act.number);
            self.ended = Some((act.number, how));
        }
    }

    /// A new act is taken where there is one, and where the last one has come to its end.
    fn take(&mut self, now: Moment, actual: Actual, intent: &Intent, permit: &Permit) {
        self.forget_what_is_void(now, intent);
        // A step counts from where the drive is.
        let is_heard = self.first.is_some_and(|first| now.since(first) >= HEARD);
        let has_place = is_heard || !matches!(intent.wish, MotionRequest::Step { .. });
        let waits = self.act.is_some() || !has_place || !matches!(self.stage, Stage::Rest { .. } | Stage::Lead(_));
        if intent.drive != self.drive || intent.number <= self.spent || waits {
            return;
        }
        self.act = Some(Act { number: intent.number, said: intent.wish, motion: None, watch: None });
        if self.deaf && intent.wish.moves() {
            self.end(Ended::Deaf);
        } else if let Err(refusal) = self.begin(now, actual, intent.wish, permit) {
            self.end(Ended::Refused(refusal));
        }
    }

    fn begin(&mut self, now: Moment, actual: Actual, wish: MotionRequest, permit: &Permit) -> Result<(), Refusal> {
        let status = actual.status;
        if !status.is_present() {
            return Err(Refusal::Absent);
        }
        let motive = match wish {
            MotionRequest::Rest | MotionRequest::Stop => return Ok(()),
            MotionRequest::Lead(goal) => return self.lead(now, actual, goal),
            MotionRequest::Acknowledge => return self.acknowledge(now, actual),
            MotionRequest::Pause => return Err(Refusal::NothingToPause),
            MotionRequest::Resume => return Err(Refusal::NothingToResume),
            MotionRequest::Move { target, .. } => Motive::Job { target },
            MotionRequest::Step { by, .. } => Motive::Job { target: actual.position.saturating_add(by) },
            MotionRequest::Jog { direction, .. } => Motive::Run { direction, end: RunEnd::RangeEnd },
            MotionRequest::Run { direction, end, .. } => Motive::Run { direction, end },
        };
        permit.check(wish, motive.target())?;
        if permit.doubted {
            return Err(Refusal::Locked(Lock::Outdated));
        }
        permit.check_place(wish, actual)?;
        if status.has(StatusBit::Fault) {
            return Err(Refusal::Fault);
        }
        if status.has(StatusBit::SwitchOnLock) {
            return Err(Refusal::SwitchOnLock);
        }
        if let Some(act) = &mut self.act {
            act.motion = Some(Motion { wish, motive });
        }
        self.effort = wish.effort().unwrap_or(self.effort);
        self.stage = Stage::Lead(Lead::to(Goal::Enabled));
        self.advance(now, actual);
        Ok(())
    }

    /// The last line of defence: no word that could begin a motion leaves without an act that moves.
    fn guarded(&self, setpoint: Setpoint, actual: Actual) -> Setpoint {
        let meant = self.act.is_some_and(|act| act.motion.is_some()) && self.stage.moves();
        if meant || setpoint.control.is_standing() { setpoint } else { Setpoint::standing(actual) }
    }

    const fn mark(&self, now: Moment) -> Mark {
        Mark { at: now, report: self.reports }
    }
}

impl Motive {
    pub const fn target(self) -> Option<i32> {
        match self {
            Motive::Job { target } => Some(target),
            Motive::Run { .. } => None,
        }
    }
}

/// Before a drive was heard: it is left alone.
const NONE: Setpoint = Setpoint { control: ControlWord::OFF, speed: Percent::NONE, torque: Percent::NONE, target: 0 };
