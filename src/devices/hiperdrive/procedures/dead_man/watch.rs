//! Supervision of a motion: the position in every report is compared with the limits and the target. A drive that
//! ignores its limits or turns the wrong way is stopped in the very next packet.
//!
//! | case | rule |
//! |---|---|
//! | endless run | only the direction of an expert's endless run is supervised, since no limit applies |
//! | unread limits | no drive may move, and a moving drive is stopped, as the permit states |
//! | already outside | the way back in is free; further out only if enabled for this press |
//! | outside by status bit 15 alone, more than a degree inside or near both limits | only the direction enabled for this press, since the way in is unknown |
//! | overrun while braking | a stop in progress continues and keeps its reason |
//!
//! A run that ends within one degree beyond a limit is considered to have reached the end of its range, since the
//! repeatability of a drive is ±1° (manual, technical data; reference, section 5).

use super::{
    ActionEnd, DeadMan, MISSED_TARGET_TIME, Motion, MotionKind, MotionLock, MotionRejection, MotionRequest, Permit,
    Stage,
};
use crate::devices::hiperdrive::protocol::{ActualValues, Direction, RunEnd, State, StatusBit};
use crate::units::Moment;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LimitSide {
    Below,
    Above,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LimitViolation {
    At(LimitSide),
    /// Status bit 15 is set, but the position does not show which limit the drive has passed, because it is close to
    /// both limits or more than a degree inside them.
    Unclear,
}

#[derive(Clone, Copy, Debug)]
pub(super) struct ActionMonitor {
    /// Limit that the drive had passed at the start, or `None` once the drive has been inside.
    outside: Option<LimitViolation>,
    /// Shortest distance so far to the target of a job, or a measure of progress for a run.
    best: i64,
    /// Position after braking, while a job is paused.
    waits_at: Option<i32>,
    /// Whether the user allows motion further outward while the button is pressed.
    freed: bool,
    /// Whether a run started at the end of the range in its own direction, so that there may be no travel left.
    pub(super) at_end: bool,
}

/// Positioning accuracy in whole degrees: ±2.5° (manual, technical data; reference, section 5), rounded up.
const ACCURACY_DEG: i64 = 3;

impl LimitViolation {
    /// Returns whether motion in this direction may take the drive further outside.
    pub fn is_outward(self, direction: Direction) -> bool {
        match self {
            LimitViolation::At(side) => side.outward_direction() == direction,
            LimitViolation::Unclear => true,
        }
    }
}

impl Permit {
    /// Returns which limit a drive has passed according to its position or, if the position is inside, to status bit
    /// 15. Bit 15 is attributed to a limit within one degree. Returns `None` if the drive is inside or no limits are
    /// known.
    pub fn outside_limits(&self, actual: ActualValues) -> Option<LimitViolation> {
        let (limits, degree) = (self.limits?, i64::from(self.degree));
        let by_status = || {
            // In a very narrow range both limits are within a degree, and the drive may be at either of them.
            match [LimitSide::Below, LimitSide::Above]
                .map(|side| side.overshoot_steps(actual.position, limits) >= -degree)
            {
                [true, false] => LimitViolation::At(LimitSide::Below),
                [false, true] => LimitViolation::At(LimitSide::Above),
                _ => LimitViolation::Unclear,
            }
        };
        let beyond = nearest_side(actual.position, limits).map(LimitViolation::At);
        beyond.or_else(|| actual.status.is_set(StatusBit::PositionLimit).then(by_status))
    }
}

fn nearest_side(position: i32, (low, high): (i32, i32)) -> Option<LimitSide> {
    (position > high).then_some(LimitSide::Above).or_else(|| (position < low).then_some(LimitSide::Below))
}

impl LimitSide {
    /// Returns the number of steps beyond this limit, negative if the position is inside.
    pub fn overshoot_steps(self, position: i32, (low, high): (i32, i32)) -> i64 {
        match self {
            LimitSide::Above => i64::from(position) - i64::from(high),
            LimitSide::Below => i64::from(low) - i64::from(position),
        }
    }

    /// Returns the direction that takes the drive further outside. Positions increase clockwise (manual 7.2: the step
    /// of parameter 170, +4096, is clockwise).
    pub const fn outward_direction(self) -> Direction {
        match self {
            LimitSide::Above => Direction::Clockwise,
            LimitSide::Below => Direction::Counterclockwise,
        }
    }
}

impl Motion {
    /// Returns the limits that apply to the motion, or `None` for an endless run.
    fn limits(&self, permit: &Permit) -> Option<(i32, i32)> {
        let endless = matches!(self.kind, MotionKind::Run { end: RunEnd::Endless, .. });
        permit.limits.filter(|_| !endless)
    }

    /// Returns the distance from the position to the target of a job, in steps. A run has no target; its result
    /// decreases as the drive moves in the direction of the run.
    fn distance_to_target(&self, actual: ActualValues) -> i64 {
        let position = i64::from(actual.position);
        match self.kind {
            MotionKind::Job { target } => (position - i64::from(target)).abs(),
            MotionKind::Run { direction: Direction::Clockwise, .. } => -position,
            MotionKind::Run { direction: Direction::Counterclockwise, .. } => position,
        }
    }
}

impl ActionMonitor {
    pub(super) fn start(motion: &Motion, actual: ActualValues, permit: &Permit) -> Self {
        let limits = motion.limits(permit);
        let outside = limits.and_then(|_| permit.outside_limits(actual));
        let best = motion.distance_to_target(actual);
        let at_end = match (motion.kind, limits) {
            (MotionKind::Run { direction, .. }, Some(limits)) => {
                [LimitSide::Below, LimitSide::Above].into_iter().any(|side| {
                    side.outward_direction() == direction
                        && side.overshoot_steps(actual.position, limits) >= -i64::from(permit.degree)
                })
            }
            _ => false,
        };
        let freed = matches!(motion.request, MotionRequest::Jog { outward: true, .. }) && outside.is_some();
        ActionMonitor { outside, best, waits_at: None, freed, at_end }
    }

    /// Checks a position report against the limits and the target, and returns the reason if the motion must end.
    pub(super) fn check_report(&mut self, motion: &Motion, actual: ActualValues, permit: &Permit) -> Option<ActionEnd> {
        let degree = i64::from(permit.degree);
        let distance = motion.distance_to_target(actual);
        self.best = self.best.min(distance);
        let is_job = matches!(motion.kind, MotionKind::Job { .. });
        // The target of a job is within the limits, so a deviation of up to a degree is no overrun.
        let beyond = if is_job && distance <= degree { None } else { self.check_limits(motion, actual, permit) };
        // Near its target, a job may overshoot by its accuracy.
        let arrives = is_job && self.best <= ACCURACY_DEG * degree;
        let allowed = if arrives { ACCURACY_DEG * degree } else { degree };
        // A user who allows outward motion watches the axis. A drive that counts the wrong way moves inward on this
        // path.
        let leaves = distance > self.best.saturating_add(allowed) && !self.freed;
        beyond.or_else(|| leaves.then_some(ActionEnd::WrongWay { position: actual.position }))
    }

    /// Checks whether the drive moves while its job is paused, that is, by more than a degree from the position after
    /// braking.
    fn check_paused(&mut self, has_braked: bool, actual: ActualValues, permit: &Permit) -> Option<ActionEnd> {
        if !has_braked {
            self.waits_at = None;
            return None;
        }
        let at = i64::from(*self.waits_at.get_or_insert(actual.position));
        let moves = i64::from(actual.position).abs_diff(at) > u64::from(permit.degree);
        moves.then_some(ActionEnd::Left(State::Moving))
    }

    fn check_limits(&mut self, motion: &Motion, actual: ActualValues, permit: &Permit) -> Option<ActionEnd> {
        let (limits, degree) = (motion.limits(permit)?, i64::from(permit.degree));
        let runs = matches!(motion.kind, MotionKind::Run { .. });
        let beyond = Some(ActionEnd::Beyond { position: actual.position });
        let Some(began) = self.outside else {
            let is_end = match permit.outside_limits(actual)? {
                LimitViolation::At(side) => side.overshoot_steps(actual.position, limits).abs() <= degree,
                LimitViolation::Unclear => false,
            };
            return if runs && is_end { Some(ActionEnd::RangeEnd) } else { beyond };
        };
        match nearest_side(actual.position, limits) {
            // The drive has crossed the whole range and left it on the other side.
            Some(side) if LimitViolation::At(side) != began => return beyond,
            // Status bit 15 may be late.
            None if !actual.status.is_set(StatusBit::PositionLimit) => self.outside = None,
            _ => {}
        }
        None
    }
}

impl Permit {
    /// Checks whether a motion may start at this position. A drive outside its limits may only move back inside, unless
    /// the user allows outward motion while the button is pressed.
    ///
    /// # Errors
    /// Returns [`MotionRejection::Outward`] if the motion would take the drive further outside, or
    /// [`MotionRejection::Unclear`] if it could do so.
    pub fn check_position_limits(&self, request: MotionRequest, actual: ActualValues) -> Result<(), MotionRejection> {
        let direction = match request {
            MotionRequest::Jog { outward: true, .. } | MotionRequest::Run { end: RunEnd::Endless, .. } => return Ok(()),
            MotionRequest::Jog { direction, .. } | MotionRequest::Run { direction, .. } => Some(direction),
            MotionRequest::Move { .. } | MotionRequest::Step { .. } => None,
            _ => return Ok(()),
        };
        let (Some((low, high)), Some(outside), position) = (self.limits, self.outside_limits(actual), actual.position)
        else {
            return Ok(());
        };
        match outside {
            LimitViolation::Unclear => Err(MotionRejection::Unclear { position, low, high }),
            LimitViolation::At(side) if direction == Some(side.outward_direction()) => {
                Err(MotionRejection::Outward { position, low, high })
            }
            LimitViolation::At(_) => Ok(()),
        }
    }
}

impl DeadMan {
    pub(super) fn watch_motion(&mut self, now: Moment, actual: ActualValues, permit: &Permit) -> Option<ActionEnd> {
        let mark = self.current_mark(now);
        let act = self.act.as_mut()?;
        let motion = act.motion.as_ref()?;
        if !self.stage.has_motion() {
            act.watch = None;
        }
        let Some(watch) = &mut act.watch else {
            // The motion has not started yet, so the conditions for a start apply. This includes the first report after
            // the drive was brought to the required state.
            let doubted = permit.doubted.then_some(MotionRejection::Locked(MotionLock::Outdated));
            let refusal = doubted.or_else(|| permit.check_position_limits(motion.request, actual).err());
            if refusal.is_none() && self.stage.has_motion() {
                act.watch = Some(ActionMonitor::start(motion, actual, permit));
            }
            return refusal.map(ActionEnd::Refused);
        };
        let has_braked =
            matches!(self.stage, Stage::Paused { since, .. } if mark.has_elapsed_since(since, MISSED_TARGET_TIME));
        let waits = watch.check_paused(has_braked, actual, permit);
        watch.check_report(motion, actual, permit).or(waits)
    }
}
