//! The handle through which a person moves drives: what is wanted goes into a cell, of which the latest counts, and what the
//! drives say comes back. The thread of the cyclic connection reads the one and fills the other; nobody waits.

use std::collections::BTreeMap;
use std::fmt;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::Duration;

use crate::device::hiperdrive::cyclic::{CyclicLost, Drives, LinkFigures};
use crate::device::hiperdrive::dead_man::{DeadMan, Ended, Intent, Lock, Permit, Phase, Wish};
use crate::link::Clock;
use crate::protocol::hiperdrive::{Actual, DriveNumber, Setpoint};
use crate::units::Moment;

/// The motion of a session's drives. Clones share it.
#[derive(Clone)]
pub struct Motion(Arc<Shared>);

struct Shared {
    clock: Arc<dyn Clock>,
    cell: Mutex<Cell>,
}

struct Cell {
    intent: Intent,
    permits: BTreeMap<DriveNumber, Permit>,
    /// Parameters 154 and 156, as they were read with those.
    scales: BTreeMap<DriveNumber, (i64, i64)>,
    /// What rules a drive is known by nothing older than this.
    ruled: BTreeMap<DriveNumber, Moment>,
    /// Drives whose limits have to be looked at.
    unconfirmed: Vec<DriveNumber>,
    expert: bool,
    punctual: bool,
    view: View,
}

/// For so long what was read of what rules a drive counts: longer than a device may take to say all of it.
const LATELY: Duration = Duration::from_secs(4);

/// What the drives do, and how well their connection works.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct View {
    /// The cyclic connection is there.
    pub open: bool,
    /// The drives that have a place in it, as they were last; in the order of their numbers.
    pub drives: Vec<DriveView>,
    /// The connection.
    pub link: LinkFigures,
    /// The system wakes its thread before all ordinary ones.
    pub punctual: bool,
    /// Why it is not there any more, where nobody has closed it.
    pub lost: Option<CyclicLost>,
}

/// What a drive does.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DriveView {
    /// Which one.
    pub number: DriveNumber,
    /// What it said last.
    pub actual: Actual,
    /// What it was sent last.
    pub sent: Setpoint,
    /// What is done with it.
    pub phase: Phase,
    /// The act that is under way, or the last one; 0 for none.
    pub act: u64,
    /// The last act that ended, and how.
    pub ended: Option<(u64, Ended)>,
}

impl Motion {
    /// Nothing is wanted, and nothing is permitted.
    pub fn new(clock: Arc<dyn Clock>) -> Self {
        let intent = Intent::rest(DriveNumber::FIRST, 0, clock.now());
        let cell = Cell {
            intent,
            permits: BTreeMap::new(),
            scales: BTreeMap::new(),
            ruled: BTreeMap::new(),
            unconfirmed: Vec::new(),
            expert: false,
            punctual: false,
            view: View::default(),
        };
        Motion(Arc::new(Shared { clock, cell: Mutex::new(cell) }))
    }

    /// A person wants something of a drive: an act of its own, whose number comes back. It replaces the one before; what
    /// moved by that stops. It has to be kept [fresh](Self::refresh). Without a cyclic connection nothing comes of it.
    pub fn intend(&self, drive: DriveNumber, wish: Wish) -> u64 {
        let refreshed = self.0.clock.now();
        let mut cell = self.lock();
        let number = cell.intent.number + 1;
        cell.intent = Intent { drive, wish, number, refreshed };
        number
    }

    /// What was wanted last is wanted still. To be said every 100 ms while anything moves: 250 ms without it stop the drive,
    /// and what comes after them is too late, also where the connection's thread stood still as long.
    pub fn refresh(&self) {
        let now = self.0.clock.now();
        let mut cell = self.lock();
        if !cell.intent.is_stale(now) {
            cell.intent.refreshed = now;
        }
    }

    /// All drives stop.
    pub fn stop(&self) {
        let drive = self.lock().intent.drive;
        self.intend(drive, Wish::Stop);
    }

    /// The act of this number is the latest.
    pub fn is_latest(&self, number: u64) -> bool {
        self.lock().intent.number == number
    }

    /// What the drives do.
    pub fn view(&self) -> View {
        self.lock().view.clone()
    }

    /// The cyclic connection is there.
    pub fn is_open(&self) -> bool {
        self.lock().view.open
    }

    /// What a drive may do from now on: by its parameters. Limits that have to be confirmed stay so.
    pub fn permit(&self, drive: DriveNumber, permit: Permit) {
        let mut cell = self.lock();
        if permit.locks.contains(&Lock::LimitsUnconfirmed) {
            cell.unconfirm(drive);
        }
        cell.permits.insert(drive, permit);
    }

    /// The scale in which a drive has its limits (parameters 154 and 156); `None` where it was not read.
    pub fn scale(&self, drive: DriveNumber) -> Option<(i64, i64)> {
        self.lock().scales.get(&drive).copied()
    }

    /// What a drive may do from now on, and in which scale; `moved`: its limits lie elsewhere than before. All at once: nobody
    /// confirms limits between two of these.
    pub(super) fn rule(&self, drive: DriveNumber, scale: Option<(i64, i64)>, moved: bool, permit: Permit) {
        let mut cell = self.lock();
        if moved || permit.locks.contains(&Lock::LimitsUnconfirmed) {
            cell.unconfirm(drive);
        }
        match scale {
            Some(scale) => cell.scales.insert(drive, scale),
            None => cell.scales.remove(&drive),
        };
        cell.permits.insert(drive, permit);
    }

    /// What rules a drive was read within the last seconds. It is read each second while there is a cyclic connection; where
    /// it is not, somebody else may have changed it.
    pub fn is_ruled_lately(&self, drive: DriveNumber) -> bool {
        let now = self.0.clock.now();
        self.lock().ruled.get(&drive).is_some_and(|since| now.since(*since) <= LATELY)
    }

    /// Nothing that was read of what rules a drive counts any more: it is to be read before the drive moves.
    pub fn doubt_rules(&self, drive: DriveNumber) {
        self.lock().ruled.remove(&drive);
    }

    /// What rules a drive is known by nothing older than this; `None` where it is not known.
    pub(super) fn ruled(&self, drive: DriveNumber, since: Option<Moment>) {
        let mut cell = self.lock();
        match since {
            Some(since) => cell.ruled.insert(drive, since),
            None => cell.ruled.remove(&drive),
        };
    }

    /// The drive of which something was wanted last.
    pub(super) fn wanted_drive(&self) -> DriveNumber {
        self.lock().intent.drive
    }

    /// The scaling of a drive was changed, and with it where its limits lie: nothing moves until they are confirmed.
    pub fn limits_changed(&self, drive: DriveNumber) {
        self.lock().unconfirm(drive);
    }

    /// A person has looked at the limits of a drive in their own units, by the scale that was shown. Whether that counts: not
    /// where the drive has another scale by now.
    pub fn confirm_limits(&self, drive: DriveNumber, seen: (i64, i64)) -> bool {
        let mut cell = self.lock();
        let is_so = cell.scales.get(&drive).is_none_or(|scale| *scale == seen);
        if is_so {
            cell.unconfirmed.retain(|unconfirmed| *unconfirmed != drive);
        }
        is_so
    }

    /// Somebody knows what an endless run is. It may begin where limits and scaling are the factory's too.
    pub fn expert(&self, expert: bool) {
        self.lock().expert = expert;
    }

    /// What a drive may do at the moment, all things considered.
    pub fn permitted(&self, drive: DriveNumber) -> Permit {
        self.lock().permitted(drive)
    }

    /// A connection begins: no act up to the number that comes back moves anything over it.
    pub(super) fn open(&self) -> u64 {
        let now = self.0.clock.now();
        let mut cell = self.lock();
        let number = cell.intent.number + 1;
        cell.intent = Intent::rest(cell.intent.drive, number, now);
        cell.view = View { open: true, ..View::default() };
        number
    }

    /// What is wanted at this moment, for whoever makes the next packet of it.
    pub(super) fn with_wanted<T>(&self, make: impl FnOnce(&Intent, &dyn Fn(DriveNumber) -> Permit) -> T) -> T {
        let cell = self.lock();
        make(&cell.intent, &|drive| cell.permitted(drive))
    }

    /// What has become of the drives.
    pub(super) fn publish(&self, drives: &Drives) {
        let of = |man: &DeadMan| DriveView {
            number: man.drive(),
            actual: man.actual(),
            sent: man.sent(),
            phase: man.phase(),
            act: man.act(),
            ended: man.ended(),
        };
        let mut views: Vec<DriveView> = drives.men().map(of).collect();
        views.sort_by_key(|view| view.number);
        let view = View {
            open: !drives.is_ending(),
            drives: views,
            link: drives.figures().clone(),
            punctual: false,
            lost: drives.lost().cloned(),
        };
        let mut cell = self.lock();
        cell.view = View { punctual: cell.punctual, ..view };
    }

    /// Whether the system wakes the connection's thread before all ordinary ones.
    pub(super) fn set_punctual(&self, punctual: bool) {
        self.lock().punctual = punctual;
    }

    /// The connection's thread has failed, or never began.
    pub(super) fn fail(&self) {
        let mut cell = self.lock();
        (cell.view.open, cell.view.lost) = (false, Some(CyclicLost::Failed));
    }

    pub(super) fn lost(&self) -> Option<CyclicLost> {
        self.lock().view.lost.clone()
    }

    /// Whether its parameters allow an endless run, whoever asks for it.
    pub fn could_run_endlessly(&self, drive: DriveNumber) -> bool {
        self.lock().permits.get(&drive).is_some_and(|permit| permit.endless)
    }

    /// No drive was sent a word with which it moves: a stop that was asked for is on the wire.
    pub fn is_standing(&self) -> bool {
        let cell = self.lock();
        !cell.view.open || cell.view.drives.iter().all(|drive| drive.sent.control.is_standing())
    }

    fn lock(&self) -> MutexGuard<'_, Cell> {
        // Each change is whole: whoever panicked has left nothing half done.
        self.0.cell.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Cell {
    fn unconfirm(&mut self, drive: DriveNumber) {
        if !self.unconfirmed.contains(&drive) {
            self.unconfirmed.push(drive);
        }
    }

    fn permitted(&self, drive: DriveNumber) -> Permit {
        let mut permit = self.permits.get(&drive).cloned().unwrap_or_default();
        permit.locks.retain(|lock| *lock != Lock::LimitsUnconfirmed);
        if self.unconfirmed.contains(&drive) {
            permit.locks.push(Lock::LimitsUnconfirmed);
        }
        permit.endless &= self.expert;
        permit
    }
}

impl fmt::Debug for Motion {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_tuple("Motion").field(&self.view()).finish()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::device::hiperdrive::dead_man::Effort;
    use crate::link::VirtualClock;

    /// Where the window and the thread of the connection stood still together, the window may be the first to wake up.
    #[test]
    fn what_nobody_said_for_too_long_is_not_said_again() {
        let clock = Arc::new(VirtualClock::default());
        let motion = Motion::new(clock.clone());
        let is_stale = || motion.with_wanted(|intent, _| intent.is_stale(clock.now()));
        let later = |time: Duration| clock.sleep_until(clock.now() + time);
        motion.intend(DriveNumber::FIRST, Wish::Move { target: 1, effort: Effort::MOVE });
        for _ in 0..3 {
            later(Intent::FRESH);
            motion.refresh();
        }
        assert!(!is_stale(), "said in time, again and again");
        later(Intent::FRESH + Duration::from_millis(1));
        motion.refresh();
        assert!(is_stale(), "too late");
        motion.intend(DriveNumber::FIRST, Wish::Move { target: 1, effort: Effort::MOVE });
        assert!(!is_stale(), "another act");
    }
}
