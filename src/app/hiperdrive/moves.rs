//! The drives as a person moves them from the window: what is held, what is under way, how the last act ended. What a drive
//! is sent the dead-man behind [`Motion`] alone decides; here is its heartbeat, and what ends it at once.
//!
//! A jog is kept alive by what holds it, which says so with every picture; a move, a step and a run by the pictures
//! themselves. A window that stands still says nothing, and 250 ms later everything stands.

use std::collections::{BTreeMap, BTreeSet};

use crate::device::hiperdrive::dead_man::{Effort, Ended, Lock, Permit, Phase, Wish};
use crate::protocol::hiperdrive::{Actual, Direction, DriveNumber, Setpoint, State};
use crate::worker::hiperdrive::{DriveView, Motion, View};

/// The drives of a session as a person moves them.
pub struct Moves {
    /// While the session is open.
    motion: Option<Motion>,
    /// What the drives said at the last look.
    view: View,
    act: Option<Act>,
    jog: Effort,
    job: Effort,
    expert: bool,
    /// Drives whose scaling was changed since somebody looked at their limits. They outlive a session.
    unconfirmed: BTreeSet<DriveNumber>,
    /// What drives might do at the last look, and in which scale.
    rules: BTreeMap<DriveNumber, (Permit, Option<(i64, i64)>)>,
    /// Drives for which that has become another since somebody asked.
    ruled_anew: BTreeSet<DriveNumber>,
    /// Drives for which that had been read just before the last look.
    ruled_lately: BTreeSet<DriveNumber>,
    /// The cyclic connection was opened since somebody asked.
    taken: bool,
}

/// What was asked for last.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Act {
    drive: DriveNumber,
    number: u64,
    kind: Kind,
    /// How it ended was told.
    told: bool,
}

/// What keeps an act alive.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Kind {
    /// A button or a key that is held.
    Held,
    /// Every picture; it has no end of its own.
    Run,
    /// Every picture.
    Other,
}

impl Default for Moves {
    fn default() -> Self {
        Moves {
            motion: None,
            view: View::default(),
            act: None,
            jog: Effort::JOG,
            job: Effort::MOVE,
            expert: false,
            unconfirmed: BTreeSet::new(),
            rules: BTreeMap::new(),
            ruled_anew: BTreeSet::new(),
            ruled_lately: BTreeSet::new(),
            taken: false,
        }
    }
}

impl Moves {
    /// A session is open. Limits that nobody has looked at stay so, and nobody is an expert yet.
    pub(super) fn begin(&mut self, motion: Motion) {
        for drive in &self.unconfirmed {
            motion.limits_changed(*drive);
        }
        (self.expert, self.act) = (false, None);
        self.rules.clear();
        self.ruled_anew.clear();
        self.taken = false;
        self.view = motion.view();
        self.motion = Some(motion);
    }

    /// The session is gone, and every motion with it.
    pub(super) fn end(&mut self) {
        self.stop();
        self.look();
        self.motion = None;
        (self.view, self.act) = (View::default(), None);
    }

    /// Another device: its limits are others.
    pub(super) fn forget(&mut self) {
        self.stop();
        self.unconfirmed.clear();
        self.ruled_anew.clear();
    }

    /// Looks at what the drives say, and keeps alive what pictures keep alive. Called for every picture.
    pub(super) fn beat(&mut self) {
        if let (Some(motion), Some(act)) = (&self.motion, &self.act)
            && act.kind != Kind::Held
            && motion.is_latest(act.number)
            && !self.has_ended(act.number, act.drive)
        {
            motion.refresh();
        }
        self.look();
    }

    /// Looks at what the drives say, and at what they may do.
    pub(super) fn look(&mut self) {
        let Some(motion) = &self.motion else { return };
        let view = motion.view();
        self.taken |= view.open && !self.view.open;
        self.view = view;
        self.ruled_lately.clear();
        for drive in self.view.drives.iter().map(|own| own.number) {
            // The age before the permit, so that the permit is at least as new as that.
            if motion.is_ruled_lately(drive) {
                self.ruled_lately.insert(drive);
            }
            let permit = motion.permitted(drive);
            if permit.locks.contains(&Lock::LimitsUnconfirmed) {
                self.unconfirmed.insert(drive);
            }
            let scale = motion.scale(drive);
            let is_other = |(before, at): &(Permit, _)| {
                (before.limits, &before.locks, *at) != (permit.limits, &permit.locks, scale)
            };
            if self.rules.get(&drive).is_some_and(is_other) {
                self.ruled_anew.insert(drive);
            }
            self.rules.insert(drive, (permit, scale));
        }
    }

    /// Drives that may do something else since this was asked last: their parameters were changed, here or by somebody else.
    pub(super) fn take_ruled_anew(&mut self) -> BTreeSet<DriveNumber> {
        std::mem::take(&mut self.ruled_anew)
    }

    /// The cyclic connection was opened since this was asked last.
    pub(super) fn take_taken(&mut self) -> bool {
        std::mem::take(&mut self.taken)
    }

    /// How the last act ended, once it has: to be told once.
    pub(super) fn take_end(&mut self) -> Option<(DriveNumber, Ended)> {
        let act = self.act.filter(|act| !act.told)?;
        let (number, ended) = self.drive(act.drive)?.ended?;
        if number < act.number {
            return None;
        }
        self.act = Some(Act { told: true, ..act });
        Some((act.drive, ended))
    }

    fn has_ended(&self, number: u64, drive: DriveNumber) -> bool {
        self.drive(drive).and_then(|own| own.ended).is_some_and(|(own, _)| own >= number)
    }

    fn intend(&mut self, drive: DriveNumber, wish: Wish, kind: Kind) -> Option<u64> {
        let number = self.motion.as_ref()?.intend(drive, wish);
        self.act = Some(Act { drive, number, kind, told: false });
        Some(number)
    }

    /// A jog is pressed. While one is held, and by a key that repeats itself, nothing begins.
    pub(super) fn press(&mut self, drive: DriveNumber, direction: Direction, repeated: bool) {
        if !repeated && !self.is_held() {
            self.intend(drive, Wish::Jog { direction, effort: self.jog }, Kind::Held);
        }
    }

    /// The jog is still held.
    pub(super) fn hold(&self) {
        if let (Some(motion), Some(act)) = (&self.motion, self.act)
            && act.kind == Kind::Held
            && motion.is_latest(act.number)
        {
            motion.refresh();
        }
    }

    /// The jog was let go, or can be seen no more: the drive stops now, not at the next look.
    pub(in crate::app) fn release(&mut self) {
        self.stop_those(|kind| kind == Kind::Held);
    }

    /// Nobody is there for what has no end of its own: a jog, a run.
    pub(in crate::app) fn let_go(&mut self) {
        self.stop_those(|kind| matches!(kind, Kind::Held | Kind::Run));
    }

    fn stop_those(&mut self, which: impl FnOnce(Kind) -> bool) {
        let Some(act) = self.act.filter(|act| which(act.kind)) else { return };
        if let Some(motion) = self.motion.as_ref().filter(|motion| motion.is_latest(act.number)) {
            motion.intend(act.drive, Wish::Stop);
        }
        // Its end is still to be told; nothing keeps it alive any more.
        self.act = Some(Act { kind: Kind::Other, ..act });
    }

    /// A move, a step, another state: kept alive by pictures. The number of the act; `None` while the session is not open.
    pub(super) fn want(&mut self, drive: DriveNumber, wish: Wish) -> Option<u64> {
        let kind = if matches!(wish, Wish::Run { .. }) { Kind::Run } else { Kind::Other };
        self.intend(drive, wish, kind)
    }

    /// All drives stop, whatever moves them.
    pub(in crate::app) fn stop(&mut self) {
        if let Some(motion) = &self.motion {
            motion.stop();
        }
        if let Some(act) = &mut self.act {
            act.kind = Kind::Other;
        }
    }

    /// The scaling of a drive is another one than it was.
    pub(super) fn unconfirm(&mut self, drive: DriveNumber) {
        self.unconfirmed.insert(drive);
        if let Some(motion) = &self.motion {
            motion.limits_changed(drive);
        }
    }

    /// A person has looked at the limits, by the scale that was shown. Whether that counts.
    pub(super) fn confirm_limits(&mut self, drive: DriveNumber, seen: (i64, i64)) -> bool {
        let counts = self.motion.as_ref().is_none_or(|motion| motion.confirm_limits(drive, seen));
        if counts {
            self.unconfirmed.remove(&drive);
        }
        counts
    }

    /// Drives whose limits nobody has looked at since their scaling was changed.
    pub fn unconfirmed(&self) -> &BTreeSet<DriveNumber> {
        &self.unconfirmed
    }

    pub(super) fn set_jog_effort(&mut self, effort: Effort) {
        self.jog = effort;
    }

    pub(super) fn set_move_effort(&mut self, effort: Effort) {
        self.job = effort;
    }

    pub(super) fn set_expert(&mut self, expert: bool) {
        self.expert = expert;
        if let Some(motion) = &self.motion {
            motion.expert(expert);
        }
    }

    /// The handle of the session's motion; `None` while it is not open.
    pub fn motion(&self) -> Option<&Motion> {
        self.motion.as_ref()
    }

    /// The cyclic connection is open: drives can be moved.
    pub fn is_open(&self) -> bool {
        self.view.open
    }

    /// What the drives said at the last look, and how well their connection works.
    pub fn view(&self) -> &View {
        &self.view
    }

    /// What a drive said at the last look; `None` without a cyclic connection.
    pub fn drive(&self, drive: DriveNumber) -> Option<&DriveView> {
        self.view.drives.iter().find(|own| own.number == drive).filter(|_| self.view.open)
    }

    /// Where a drive is.
    pub fn actual(&self, drive: DriveNumber) -> Option<Actual> {
        self.drive(drive).map(|own| own.actual)
    }

    /// What a drive was sent last.
    pub fn sent(&self, drive: DriveNumber) -> Option<Setpoint> {
        self.drive(drive).map(|own| own.sent)
    }

    /// What is done with a drive.
    pub fn phase(&self, drive: DriveNumber) -> Option<Phase> {
        self.drive(drive).map(|own| own.phase)
    }

    /// What a drive may do; `None` while the session is not open.
    pub fn permit(&self, drive: DriveNumber) -> Option<Permit> {
        self.motion.as_ref().map(|motion| motion.permitted(drive))
    }

    /// The scale in which a drive has its limits, by parameters 154 and 156; `None` where it was not read.
    pub(super) fn scale(&self, drive: DriveNumber) -> Option<(i64, i64)> {
        self.motion.as_ref().and_then(|motion| motion.scale(drive))
    }

    /// What rules a drive was read within the last seconds, and looked at here since.
    pub(super) fn is_ruled_lately(&self, drive: DriveNumber) -> bool {
        self.ruled_lately.contains(&drive)
    }

    /// What rules a drive is to be read before it moves.
    pub(super) fn doubt_rules(&mut self, drive: DriveNumber) {
        self.ruled_lately.remove(&drive);
        if let Some(motion) = &self.motion {
            motion.doubt_rules(drive);
        }
    }

    /// Why a drive may not move.
    pub fn locks(&self, drive: DriveNumber) -> Vec<Lock> {
        self.permit(drive).map(|permit| permit.locks).unwrap_or_default()
    }

    /// A jog is held.
    pub fn is_held(&self) -> bool {
        let held = self.act.filter(|act| act.kind == Kind::Held && !self.has_ended(act.number, act.drive));
        held.is_some_and(|act| self.motion.as_ref().is_some_and(|motion| motion.is_latest(act.number)))
    }

    /// Some drive moves, is about to, or is led to where it may.
    pub fn is_moving(&self) -> bool {
        let moves = |own: &DriveView| {
            own.actual.status.state() == State::Moving
                || matches!(own.phase, Phase::Starting(_) | Phase::Moving(_) | Phase::Stopping(_))
        };
        self.view.open && self.view.drives.iter().any(moves) || self.is_held() || self.is_under_way()
    }

    /// An act is under way that has to be kept alive.
    pub fn is_under_way(&self) -> bool {
        let own = |act: &Act| {
            let is_latest = self.motion.as_ref().is_some_and(|motion| motion.is_latest(act.number));
            self.view.open && is_latest && !self.has_ended(act.number, act.drive)
        };
        self.act.as_ref().is_some_and(own)
    }

    /// How a jog turns.
    pub fn jog_effort(&self) -> Effort {
        self.jog
    }

    /// How a move, a step and a run turn.
    pub fn move_effort(&self) -> Effort {
        self.job
    }

    /// Somebody has said that they know what an endless run is.
    pub fn is_expert(&self) -> bool {
        self.expert
    }
}
