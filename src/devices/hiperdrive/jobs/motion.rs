//! The motion handle. A shared cell holds the latest request and the latest state of the drives. The thread of the
//! cyclic connection reads the request and writes the state. Neither side waits for the other.

use std::collections::{BTreeMap, BTreeSet};
use std::fmt;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::Duration;

use super::session_watch::ReplyMonitor;
use crate::devices::hiperdrive::procedures::cyclic::{
    ConnectionLoss, Drives, LinkStatistics, ParameterReading, ParameterReadings,
};
use crate::devices::hiperdrive::procedures::dead_man::{
    ActionEnd, DeadMan, MotionIntent, MotionLock, MotionRequest, Permit, Phase,
};
use crate::devices::hiperdrive::procedures::{DisplayedLimits, DriveLimits};
use crate::devices::hiperdrive::protocol::{ActualValues, DriveNumber, ParameterNumber, Setpoint};
use crate::link::Clock;
use crate::units::Moment;

/// Handle that moves the drives of a session. All clones share the same state.
#[derive(Clone)]
pub struct Motion(Arc<Shared>);

struct Shared {
    clock: Arc<dyn Clock>,
    cell: Mutex<Cell>,
}

struct Cell {
    intent: MotionIntent,
    /// Limits of each drive. This is the only copy of them.
    limits: BTreeMap<DriveNumber, DriveLimits>,
    /// Drives for which the user has allowed an endless run.
    experts: BTreeSet<DriveNumber>,
    /// Parameters to read through the parameter words, each with the time of the latest request.
    watched: BTreeMap<ParameterNumber, Moment>,
    session: ReplyMonitor,
    punctual: bool,
    view: MotionSnapshot,
    /// Whether the program is shutting down. Motion is forbidden while this is set.
    is_shutting_down: bool,
    /// Whether the target holds a cyclic connection opened by this session.
    connected: bool,
}

#[derive(Clone, Debug)]
pub struct DrivesSnapshot {
    pub at: Moment,
    pub view: MotionSnapshot,
    pub limits: BTreeMap<DriveNumber, DriveLimits>,
}

#[derive(Clone, Debug, Default, PartialEq)]
pub struct MotionSnapshot {
    pub open: bool,
    /// Latest state of each drive of the connection, ordered by number.
    pub drives: Vec<DriveSnapshot>,
    pub link: LinkStatistics,
    /// Parameters read through the parameter words, or `None` if the connection has none.
    pub parameters: Option<ParameterReadings>,
    /// Whether the connection thread has a higher priority than ordinary threads.
    pub punctual: bool,
    /// Reason for the loss if the connection was lost.
    pub lost: Option<ConnectionLoss>,
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DriveSnapshot {
    pub number: DriveNumber,
    pub actual: ActualValues,
    /// Time at which the data in `actual` was received, or `None` before the first reception.
    pub received_at: Option<Moment>,
    pub sent: Setpoint,
    pub phase: Phase,
    /// Number of the running action, or of the last one if none is running. It is 0 before the first action.
    pub act: u64,
    /// Number of the last action that ended, and how it ended.
    pub ended: Option<(u64, ActionEnd)>,
}

/// Time for which a parameter is read after it was last requested. A reading is considered recent for equally long.
const WATCH_DURATION: Duration = Duration::from_secs(5);

impl Motion {
    pub fn new(clock: Arc<dyn Clock>) -> Self {
        let intent = MotionIntent::idle(DriveNumber::FIRST, 0, clock.now());
        let cell = Cell {
            intent,
            limits: BTreeMap::new(),
            experts: BTreeSet::new(),
            watched: BTreeMap::new(),
            session: ReplyMonitor::default(),
            punctual: false,
            view: MotionSnapshot::default(),
            is_shutting_down: false,
            connected: false,
        };
        Motion(Arc::new(Shared { clock, cell: Mutex::new(cell) }))
    }

    /// Requests a motion of a drive and returns the number of this action. The action replaces the previous one, whose
    /// motion is stopped, and must be [refreshed](Self::refresh). Without a cyclic connection it has no effect.
    pub fn request_motion(&self, drive: DriveNumber, request: MotionRequest) -> u64 {
        let refreshed = self.0.clock.now();
        let mut cell = self.lock();
        let number = cell.intent.number + 1;
        cell.intent = MotionIntent { drive, request, number, refreshed };
        number
    }

    /// Refreshes the last request. This is required every 100 ms while a drive moves. After 250 ms without a refresh
    /// the drive stops, and a later refresh has no effect, even if the connection thread was suspended in the meantime.
    pub fn refresh(&self) {
        let now = self.0.clock.now();
        let mut cell = self.lock();
        if !cell.intent.is_stale(now) {
            cell.intent.refreshed = now;
        }
    }

    pub fn stop(&self) {
        let drive = self.lock().intent.drive;
        self.request_motion(drive, MotionRequest::Stop);
    }

    pub fn is_latest_action(&self, number: u64) -> bool {
        self.lock().intent.number == number
    }

    pub fn snapshot(&self) -> MotionSnapshot {
        self.lock().view.clone()
    }

    pub fn is_open(&self) -> bool {
        self.lock().view.open
    }

    pub fn take_snapshot(&self) -> DrivesSnapshot {
        let at = self.0.clock.now();
        let cell = self.lock();
        DrivesSnapshot { at, view: cell.view.clone(), limits: cell.limits.clone() }
    }

    /// Returns the limits of a drive with the time at which they were read, or the default for an unknown drive.
    pub fn limits(&self, drive: DriveNumber) -> DriveLimits {
        self.lock().limits.get(&drive).cloned().unwrap_or_default()
    }

    /// Publishes the limits of a drive. A session does this automatically.
    pub fn publish_limits(&self, drive: DriveNumber, limits: DriveLimits) {
        self.with_limits(drive, |own| *own = limits);
    }

    /// Changes the limits of a drive atomically, so that a partial change can be neither read nor confirmed.
    pub(super) fn with_limits<T>(&self, drive: DriveNumber, change: impl FnOnce(&mut DriveLimits) -> T) -> T {
        change(self.lock().limits.entry(drive).or_default())
    }

    /// Requires that the limits of a drive are read before its next motion, because another master may have changed
    /// them.
    pub fn invalidate_limits(&self, drive: DriveNumber) {
        let now = self.0.clock.now();
        self.with_limits(drive, |limits| limits.invalidate(now));
    }

    pub(super) fn requested_drive(&self) -> DriveNumber {
        self.lock().intent.drive
    }

    /// Requires that the user confirms the limits of a drive before it moves.
    pub fn revoke_limits_confirmation(&self, drive: DriveNumber) {
        self.with_limits(drive, DriveLimits::require_confirmation);
    }

    /// Confirms the limits of a drive as shown to the user. Returns `false` without any effect if the limits have
    /// changed since then.
    pub fn confirm_limits(&self, drive: DriveNumber, seen: DisplayedLimits) -> bool {
        self.with_limits(drive, |limits| limits.confirm_displayed(seen))
    }

    /// Allows or forbids an endless run of a drive, which requires factory limits and scaling.
    pub fn allow_endless_run(&self, drive: DriveNumber, allowed: bool) {
        let mut cell = self.lock();
        if allowed {
            cell.experts.insert(drive);
        } else {
            cell.experts.remove(&drive);
        }
    }

    /// Requests that a parameter is read through the parameter words of the cyclic connection for the next few seconds.
    /// Returns the latest reading, or `None` if the reading is outdated or the connection has no parameter words.
    pub fn watch_parameter(&self, number: ParameterNumber) -> Option<ParameterReading> {
        let now = self.0.clock.now();
        let mut cell = self.lock();
        cell.watched.insert(number, now);
        let readings = cell.view.parameters.as_ref().filter(|_| cell.view.open)?;
        readings.get(&number).filter(|reading| now.duration_since(reading.at) < WATCH_DURATION).copied()
    }

    pub(super) fn watched_parameters(&self) -> Vec<ParameterNumber> {
        let now = self.0.clock.now();
        let mut cell = self.lock();
        cell.watched.retain(|_, requested| now.duration_since(*requested) < WATCH_DURATION);
        cell.watched.keys().copied().collect()
    }

    pub fn motion_permit(&self, drive: DriveNumber) -> Permit {
        let now = self.0.clock.now();
        self.lock().motion_permit(drive, now)
    }

    /// Marks the start of a connection and returns the number of the latest action. Actions numbered up to this one
    /// cannot move a drive over the new connection.
    pub(super) fn open(&self) -> u64 {
        let now = self.0.clock.now();
        let mut cell = self.lock();
        let number = cell.intent.number + 1;
        cell.intent = MotionIntent::idle(cell.intent.drive, number, now);
        cell.view = MotionSnapshot { open: true, ..MotionSnapshot::default() };
        number
    }

    /// Calls `make`, which builds the next packet, with the current request and the motion permits.
    pub(super) fn with_motion_intent<T>(
        &self,
        make: impl FnOnce(&MotionIntent, &dyn Fn(DriveNumber) -> Permit) -> T,
    ) -> T {
        let now = self.0.clock.now();
        let cell = self.lock();
        make(&cell.intent, &|drive| cell.motion_permit(drive, now))
    }

    /// Records that an explicit message was requested or answered.
    pub(super) fn update_session_watch(&self, note: impl FnOnce(&mut ReplyMonitor)) {
        note(&mut self.lock().session);
    }

    /// Returns whether a drive is moving or changing to another state.
    pub(super) fn is_motion_active(&self) -> bool {
        let cell = self.lock();
        cell.view.open && cell.view.drives.iter().any(|drive| drive.phase != Phase::Idle)
    }

    pub(super) fn publish_drive_states(&self, drives: &Drives) {
        let of = |man: &DeadMan| DriveSnapshot {
            number: man.drive(),
            actual: man.actual_values(),
            received_at: man.received_at(),
            sent: man.last_setpoint(),
            phase: man.phase(),
            act: man.action_number(),
            ended: man.last_end(),
        };
        let mut views: Vec<DriveSnapshot> = drives.dead_man_switches().map(of).collect();
        views.sort_by_key(|view| view.number);
        let view = MotionSnapshot {
            open: !drives.is_ending(),
            drives: views,
            link: drives.statistics().clone(),
            parameters: drives.parameters().cloned(),
            punctual: false,
            lost: drives.connection_loss().cloned(),
        };
        let mut cell = self.lock();
        cell.view = MotionSnapshot { punctual: cell.punctual, ..view };
    }

    pub(super) fn set_realtime_priority(&self, punctual: bool) {
        self.lock().punctual = punctual;
    }

    /// Records that the connection thread has failed or could not start.
    pub(super) fn mark_failed(&self) {
        let mut cell = self.lock();
        (cell.view.open, cell.view.lost) = (false, Some(ConnectionLoss::Failed));
    }

    pub(super) fn connection_loss(&self) -> Option<ConnectionLoss> {
        self.lock().view.lost.clone()
    }

    /// Ends motion when the program exits: stops and switches off all drives and closes their connection. Nothing moves
    /// afterwards.
    pub fn release_drives(&self) {
        self.lock().is_shutting_down = true;
    }

    pub(super) fn is_shutting_down(&self) -> bool {
        self.lock().is_shutting_down
    }

    /// Returns whether the target holds a cyclic connection opened by this session and not yet closed.
    pub fn is_connected(&self) -> bool {
        self.lock().connected
    }

    /// Records that the cyclic connection was opened or that both ends have closed it.
    pub(super) fn set_connected(&self, connected: bool) {
        self.lock().connected = connected;
    }

    pub fn is_orphaned(&self) -> bool {
        Arc::strong_count(&self.0) == 1
    }

    /// Returns whether every drive was last sent a stop. Without a connection, returns `true`.
    pub fn is_at_rest(&self) -> bool {
        let cell = self.lock();
        !cell.view.open || cell.view.drives.iter().all(|drive| drive.sent.control.is_at_rest())
    }

    fn lock(&self) -> MutexGuard<'_, Cell> {
        // Every change to the cell is complete, so a panic leaves it consistent.
        self.0.cell.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Cell {
    fn motion_permit(&self, drive: DriveNumber, now: Moment) -> Permit {
        let limits = self.limits.get(&drive);
        let permit = limits.map(|limits| limits.motion_permit(now, self.experts.contains(&drive)));
        let mut permit = permit.unwrap_or_default();
        permit.locks.extend(self.session.is_silent(now).then_some(MotionLock::NoAnswer));
        permit
    }
}

impl fmt::Debug for Motion {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_tuple("Motion").field(&self.snapshot()).finish()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::devices::hiperdrive::procedures::dead_man::SpeedTorque;
    use crate::link::VirtualClock;

    /// If the window and the connection thread were both suspended, and the window resumes first, it does not revive a
    /// stale request.
    #[test]
    fn does_not_repeat_stale_intents() {
        let clock = Arc::new(VirtualClock::default());
        let motion = Motion::new(clock.clone());
        let is_stale = || motion.with_motion_intent(|intent, _| intent.is_stale(clock.now()));
        let later = |time: Duration| clock.sleep_until(clock.now() + time);
        motion.request_motion(DriveNumber::FIRST, MotionRequest::Move { target: 1, effort: SpeedTorque::DEFAULT_MOVE });
        for _ in 0..3 {
            later(MotionIntent::REFRESH_VALIDITY);
            motion.refresh();
        }
        assert!(!is_stale(), "said in time, again and again");
        later(MotionIntent::REFRESH_VALIDITY + Duration::from_millis(1));
        motion.refresh();
        assert!(is_stale(), "too late");
        motion.request_motion(DriveNumber::FIRST, MotionRequest::Move { target: 1, effort: SpeedTorque::DEFAULT_MOVE });
        assert!(!is_stale(), "another act");
    }
}
