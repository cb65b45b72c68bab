//! Motion of the drives as requested in the window: the held button, the running action, and the outcome of the
//! previous action. What is sent to a drive is decided only by the dead-man control behind [`Motion`]. This module
//! refreshes its requests, and ends them immediately when required.
//!
//! A jog is refreshed in every frame in which its button is held. A move, a step or a run is refreshed in every frame.
//! If the window hangs, nothing is refreshed, and the drives stop 250 ms later.

mod effort;

use std::collections::{BTreeMap, BTreeSet};

use crate::devices::hiperdrive::jobs::{DriveSnapshot, DrivesSnapshot, Motion, MotionSnapshot};
use crate::devices::hiperdrive::procedures::dead_man::{
    ActionEnd, MotionKind, MotionLock, MotionRequest, POSITION_SETTLING_TIME, Permit, Phase, SpeedTorque,
};
use crate::devices::hiperdrive::procedures::{DisplayedLimits, DriveLimits};
use crate::devices::hiperdrive::protocol::{ActualValues, Direction, DriveNumber, RunEnd, Setpoint, State};
use crate::units::Moment;

/// Motion of the drives in a session, as requested by the user.
pub struct DriveMotion {
    /// Motion handle, present while the session is open.
    motion: Option<Motion>,
    view: MotionSnapshot,
    act: Option<ActiveAction>,
    /// Speed and torque of jogs, for each drive where they differ from the default.
    jogs: BTreeMap<DriveNumber, SpeedTorque>,
    jobs: BTreeMap<DriveNumber, SpeedTorque>,
    /// Speed and torque of runs, for each drive where they differ from the default.
    runs: BTreeMap<DriveNumber, SpeedTorque>,
    /// Drives for which the user has allowed an endless run.
    experts: BTreeSet<DriveNumber>,
    /// Drive and number of the latest endless run. When it ends or is replaced, the next one must be allowed again.
    endless_run: Option<(DriveNumber, u64)>,
    /// Direction in which the user has allowed the next jog to move the drive further outside its limits.
    freed: Option<(DriveNumber, Direction)>,
    used: Option<(DriveNumber, Direction)>,
    /// Limits of the drives at the last update. The need to confirm them outlasts a session.
    limits: BTreeMap<DriveNumber, DriveLimits>,
    looked: Moment,
    /// Drives whose limits have changed since the last call of [`take_changed_limits`](Self::take_changed_limits).
    limits_changed: BTreeSet<DriveNumber>,
    /// Whether the cyclic connection has been opened since the last call of
    /// [`take_control_opened`](Self::take_control_opened).
    taken: bool,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct ActiveAction {
    drive: DriveNumber,
    number: u64,
    kind: Kind,
    /// Whether the action moves the drive or has paused its job.
    moves: bool,
    is_reported: bool,
}

/// Kind of action, which determines how it is refreshed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Kind {
    Held,
    /// A run, which is refreshed in every frame and lasts until it is stopped.
    Run,
    Other,
}

impl Default for DriveMotion {
    fn default() -> Self {
        DriveMotion {
            motion: None,
            view: MotionSnapshot::default(),
            act: None,
            jogs: BTreeMap::new(),
            jobs: BTreeMap::new(),
            runs: BTreeMap::new(),
            experts: BTreeSet::new(),
            endless_run: None,
            freed: None,
            used: None,
            limits: BTreeMap::new(),
            looked: Moment::START,
            limits_changed: BTreeSet::new(),
            taken: false,
        }
    }
}

impl DriveMotion {
    /// Begins a session. Limits still to be confirmed remain so, and endless runs must be allowed again. Jogs and runs
    /// last until they are stopped, so they start at the low speed of [`SpeedTorque::DEFAULT_JOG`].
    pub(super) fn begin_session(&mut self, motion: Motion) {
        for drive in self.unconfirmed_drives() {
            motion.revoke_limits_confirmation(drive);
        }
        (self.experts, self.endless_run, self.act) = (BTreeSet::new(), None, None);
        // Every session begins slowly, regardless of the speed in the previous one.
        self.jogs.clear();
        self.runs.clear();
        self.limits_changed.clear();
        self.taken = false;
        let DrivesSnapshot { at, view, limits } = motion.take_snapshot();
        (self.looked, self.view, self.limits) = (at, view, limits);
        self.motion = Some(motion);
    }

    pub(super) fn end_session(&mut self) {
        self.stop();
        self.update();
        self.motion = None;
        (self.view, self.act) = (MotionSnapshot::default(), None);
    }

    pub(super) fn clear(&mut self) {
        self.stop();
        self.limits.clear();
        self.limits_changed.clear();
        (self.jogs, self.jobs, self.runs) = (BTreeMap::new(), BTreeMap::new(), BTreeMap::new());
        for drive in std::mem::take(&mut self.experts) {
            self.set_endless_allowed(drive, false);
        }
    }

    /// Fetches the state of the drives, and refreshes moves, steps and runs. It must be called in every frame.
    pub(super) fn send_heartbeat(&mut self) {
        if let (Some(motion), Some(act)) = (&self.motion, &self.act)
            && act.kind != Kind::Held
            && motion.is_latest_action(act.number)
            && !self.has_ended(act.number, act.drive)
        {
            motion.refresh();
        }
        self.update();
    }

    pub(super) fn update(&mut self) {
        let Some(motion) = &self.motion else { return };
        let DrivesSnapshot { at, view, limits } = motion.take_snapshot();
        self.taken |= view.open && !self.view.open;
        for (drive, own) in &limits {
            let before = self.limits.get(drive).map(|before| (before.rules(), before.motion_locks()));
            if before.is_some_and(|before| before != (own.rules(), own.motion_locks())) {
                self.limits_changed.insert(*drive);
            }
        }
        let replaced = self.endless_run.is_some_and(|(_, number)| !motion.is_latest_action(number));
        (self.looked, self.view, self.limits) = (at, view, limits);
        if let Some((drive, number)) = self.endless_run
            && (replaced || self.has_ended(number, drive))
        {
            self.endless_run = None;
            self.set_endless_allowed(drive, false);
        }
    }

    /// Returns the drives whose limits have changed since the last call, whether through this program or another
    /// master.
    pub(super) fn take_changed_limits(&mut self) -> BTreeSet<DriveNumber> {
        std::mem::take(&mut self.limits_changed)
    }

    /// Returns whether the cyclic connection has been opened since the last call.
    pub(super) fn take_control_opened(&mut self) -> bool {
        std::mem::take(&mut self.taken)
    }

    pub(super) fn take_motion_end(&mut self) -> Option<(DriveNumber, ActionEnd)> {
        let act = self.act.filter(|act| !act.is_reported)?;
        let (number, ended) = self.drive(act.drive)?.ended?;
        if number < act.number {
            return None;
        }
        self.act = Some(ActiveAction { is_reported: true, ..act });
        Some((act.drive, ended))
    }

    fn has_ended(&self, number: u64, drive: DriveNumber) -> bool {
        self.drive(drive).and_then(|own| own.ended).is_some_and(|(own, _)| own >= number)
    }

    fn submit_request(&mut self, drive: DriveNumber, request: MotionRequest, kind: Kind) -> Option<u64> {
        // The permission is valid for one press. The next request needs another permission.
        self.freed = None;
        let number = self.motion.as_ref()?.request_motion(drive, request);
        let moves = request.needs_motion() || request == MotionRequest::Pause;
        self.act = Some(ActiveAction { drive, number, kind, moves, is_reported: false });
        Some(number)
    }

    /// Starts a jog, unless the button of another jog is held.
    pub(super) fn press_jog(&mut self, drive: DriveNumber, jog: MotionRequest) {
        if !self.is_held() {
            self.submit_request(drive, jog, Kind::Held);
            self.used = match jog {
                MotionRequest::Jog { direction, outward: true, .. } => Some((drive, direction)),
                _ => None,
            };
        }
    }

    /// Returns whether the jog has ended although its button is still held. The button has no effect until it has been
    /// released.
    pub fn has_held_jog_ended(&self) -> bool {
        self.act.is_some_and(|act| act.kind == Kind::Held && self.has_ended(act.number, act.drive))
    }

    pub(super) fn refresh_held_action(&self) {
        if let (Some(motion), Some(act)) = (&self.motion, self.act)
            && act.kind == Kind::Held
            && motion.is_latest_action(act.number)
        {
            motion.refresh();
        }
    }

    /// Ends the jog when its button is released or disappears. The drive stops immediately, not only at the next
    /// update.
    pub(crate) fn release(&mut self) {
        self.stop_motion_of_kind(|kind| kind == Kind::Held);
    }

    /// Ends an action that would last until stopped, that is, a jog or a run.
    pub(crate) fn end_held_action(&mut self) {
        self.freed = None;
        self.stop_motion_of_kind(|kind| matches!(kind, Kind::Held | Kind::Run));
    }

    fn stop_motion_of_kind(&mut self, which: impl FnOnce(Kind) -> bool) {
        let Some(act) = self.act.filter(|act| which(act.kind)) else { return };
        if let Some(motion) = self.motion.as_ref().filter(|motion| motion.is_latest_action(act.number)) {
            motion.request_motion(act.drive, MotionRequest::Stop);
        }
        // The end of the action has yet to be reported, but the action is no longer refreshed.
        self.act = Some(ActiveAction { kind: Kind::Other, ..act });
    }

    pub(super) fn start_endless_run(&mut self, drive: DriveNumber, direction: Direction) {
        self.freed = Some((drive, direction));
    }

    /// Returns whether the current or next jog in this direction may move the drive further outside its limits.
    pub fn is_outward_jog_enabled(&self, drive: DriveNumber, direction: Direction) -> bool {
        let way = Some((drive, direction));
        self.freed == way || self.used == way && self.is_held()
    }

    /// Starts a move, a step, a run or a change of state. Returns the number of the action, or `None` if no session is
    /// open.
    pub(super) fn request_motion(&mut self, drive: DriveNumber, request: MotionRequest) -> Option<u64> {
        let kind = if matches!(request, MotionRequest::Run { .. }) { Kind::Run } else { Kind::Other };
        let number = self.submit_request(drive, request, kind)?;
        if matches!(request, MotionRequest::Run { end: RunEnd::Endless, .. }) {
            self.endless_run = Some((drive, number));
        }
        Some(number)
    }

    pub(crate) fn stop(&mut self) {
        self.freed = None;
        if let Some(motion) = &self.motion {
            motion.stop();
        }
        if let Some(act) = &mut self.act {
            act.kind = Kind::Other;
        }
    }

    pub(super) fn require_confirmation(&mut self, drive: DriveNumber) {
        self.limits.entry(drive).or_default().require_confirmation();
        if let Some(motion) = &self.motion {
            motion.revoke_limits_confirmation(drive);
        }
    }

    /// Confirms the limits as shown to the user. Returns whether the confirmation is valid.
    pub(super) fn confirm_limits(&mut self, drive: DriveNumber, seen: DisplayedLimits) -> bool {
        let counts = self.motion.as_ref().is_some_and(|motion| motion.confirm_limits(drive, seen));
        self.update();
        counts
    }

    pub fn unconfirmed_drives(&self) -> BTreeSet<DriveNumber> {
        self.limits.iter().filter(|(_, own)| own.is_unconfirmed()).map(|(drive, _)| *drive).collect()
    }

    pub(super) fn set_endless_allowed(&mut self, drive: DriveNumber, expert: bool) {
        if expert {
            self.experts.insert(drive);
        } else {
            self.experts.remove(&drive);
        }
        if let Some(motion) = &self.motion {
            motion.allow_endless_run(drive, expert);
        }
    }

    pub fn motion(&self) -> Option<&Motion> {
        self.motion.as_ref()
    }

    pub fn is_open(&self) -> bool {
        self.view.open
    }

    pub fn snapshot(&self) -> &MotionSnapshot {
        &self.view
    }

    /// Returns a drive as of the last update, or `None` without a cyclic connection.
    pub fn drive(&self, drive: DriveNumber) -> Option<&DriveSnapshot> {
        self.view.drives.iter().find(|own| own.number == drive).filter(|_| self.view.open)
    }

    pub fn actual_values(&self, drive: DriveNumber) -> Option<ActualValues> {
        self.drive(drive).map(|own| own.actual)
    }

    pub fn last_setpoint(&self, drive: DriveNumber) -> Option<Setpoint> {
        self.drive(drive).map(|own| own.sent)
    }

    /// Returns the target of the drive's current job, if any.
    pub fn target(&self, drive: DriveNumber) -> Option<i32> {
        match self.phase(drive)? {
            Phase::Starting(MotionKind::Job { target }) | Phase::Moving(MotionKind::Job { target }) => Some(target),
            Phase::Paused { target } => Some(target),
            _ => None,
        }
    }

    pub fn phase(&self, drive: DriveNumber) -> Option<Phase> {
        self.drive(drive).map(|own| own.phase)
    }

    /// Returns the motion permit of a drive, or `None` if no session is open.
    pub fn motion_permit(&self, drive: DriveNumber) -> Option<Permit> {
        self.motion.as_ref().map(|motion| motion.motion_permit(drive))
    }

    /// Returns the limits of a drive at the last update, if known.
    pub fn limits(&self, drive: DriveNumber) -> Option<&DriveLimits> {
        self.limits.get(&drive)
    }

    /// Returns whether a drive may start moving with its limits as of the last update.
    pub(super) fn are_limits_valid(&self, drive: DriveNumber) -> bool {
        self.limits(drive).is_some_and(|limits| limits.is_valid(self.looked))
    }

    /// Requires that the limits of a drive are read before it moves.
    pub(super) fn invalidate_limits(&mut self, drive: DriveNumber) {
        self.limits.entry(drive).or_default().invalidate(self.looked);
        if let Some(motion) = &self.motion {
            motion.invalidate_limits(drive);
        }
    }

    pub fn motion_locks(&self, drive: DriveNumber) -> Vec<MotionLock> {
        let mut locks = self.motion_permit(drive).map(|permit| permit.locks).unwrap_or_default();
        // Without control, nothing moves. The limits are read when control is taken, so a slow reply ends no motion.
        locks.retain(|lock| !matches!(lock, MotionLock::Outdated | MotionLock::NoAnswer) || self.view.open);
        locks
    }

    pub fn is_held(&self) -> bool {
        let held = self.act.filter(|act| act.kind == Kind::Held && !self.has_ended(act.number, act.drive));
        held.is_some_and(|act| self.motion.as_ref().is_some_and(|motion| motion.is_latest_action(act.number)))
    }

    /// Returns the action number and direction of a jog, if its button is held and the drive is moving.
    pub fn held_jog(&self, drive: DriveNumber) -> Option<(u64, Direction)> {
        let act = self.act.filter(|act| act.drive == drive && self.is_held())?;
        match self.phase(drive)? {
            Phase::Moving(MotionKind::Run { direction, .. }) => Some((act.number, direction)),
            _ => None,
        }
    }

    /// Returns whether data have been arriving for long enough to be valid. The first packets of a connection contain
    /// no valid positions.
    pub fn is_data_valid(&self) -> bool {
        let link = &self.view.link;
        let packets = u32::try_from(link.received).unwrap_or(u32::MAX);
        self.view.open && link.interval.saturating_mul(packets) >= POSITION_SETTLING_TIME
    }

    pub fn is_moving(&self) -> bool {
        self.view.open && self.view.drives.iter().any(is_moving) || self.is_held() || self.is_motion_active()
    }

    /// Returns whether an action is running that must be refreshed.
    pub fn is_motion_active(&self) -> bool {
        let own = |act: &ActiveAction| {
            let is_latest = self.motion.as_ref().is_some_and(|motion| motion.is_latest_action(act.number));
            self.view.open && is_latest && !self.has_ended(act.number, act.drive)
        };
        self.act.as_ref().is_some_and(own)
    }

    /// Returns whether a drive is moving or changing to another state.
    pub fn is_drive_moving(&self, drive: DriveNumber) -> bool {
        self.drive(drive).is_some_and(is_moving) || self.moving_drive() == Some(drive)
    }

    /// Returns the drive that is moving or whose job is paused. A new request ends this motion or job.
    pub fn moving_drive(&self) -> Option<DriveNumber> {
        let asked = self.act.filter(|act| act.moves && self.is_motion_active()).map(|act| act.drive);
        let has_job =
            |own: &&DriveSnapshot| matches!(own.phase, Phase::Starting(_) | Phase::Moving(_) | Phase::Paused { .. });
        let busy = self.view.drives.iter().find(has_job).filter(|_| self.view.open);
        asked.or_else(|| busy.map(|own| own.number))
    }

    pub fn allows_endless_run(&self, drive: DriveNumber) -> bool {
        self.experts.contains(&drive)
    }
}

fn is_moving(own: &DriveSnapshot) -> bool {
    own.actual.status.state() == State::Moving
        || matches!(own.phase, Phase::Starting(_) | Phase::Moving(_) | Phase::Stopping(_))
}
