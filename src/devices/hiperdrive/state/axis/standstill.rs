//! Compares the positions of an axis at standstill, to detect that its reference was set again. Parameter 198 is only
//! the number that was written last, and no parameter tells where it was written (manual, 198 and 107). If the same
//! number is set at another location, the only sign is a position that jumps without motion.

use std::time::Duration;

use super::DriveFacts;
use super::step_outcomes::PositionOrigin;
use super::supply::READJUSTMENT_DEG;
use crate::devices::hiperdrive::procedures::dead_man::MAX_REPORT_DELAY;
use crate::devices::hiperdrive::protocol::{PositionScale, StatusBit};
use crate::units::Moment;

/// Maximum speed of a shaft in rpm, which is the maximum of parameter 166.
const FASTEST_RPM: f64 = 35.0;
/// Maximum interval between two readings. In a longer interval, an axis could move and stop unnoticed.
const MAX_READING_GAP: Duration = Duration::from_secs(1);

#[derive(Clone, Debug, Default)]
pub(super) struct StandstillMonitor {
    last: Option<StandstillReading>,
    /// Whether the connection has been lost since the reading. Each session has its own clock, so times before and
    /// after the loss cannot be compared.
    interrupted: bool,
}

#[derive(Clone, Copy, Debug)]
struct StandstillReading {
    /// Time of the reading, or `None` if all parameters were read after a loss of the connection.
    at: Option<Moment>,
    position: i32,
    scale: PositionScale,
    origin: PositionOrigin,
    /// Last action of the user that had ended when the reading was taken.
    act: Option<u64>,
}

/// A change of position that motion cannot explain.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum PositionChange {
    /// The position changed by more than the shaft could turn in the elapsed time, so the reference was set again.
    Jump,
    /// The position changed by this number of steps while it was not read. Either the axis was moved or its reference
    /// was set again.
    Unexplained(i64),
}

impl StandstillMonitor {
    pub(super) const fn interrupt(&mut self) {
        self.interrupted = true;
    }

    /// Discards the previous reading. The drive was off and may have been turned by hand, and the power-cycle check
    /// compares the positions itself.
    pub(super) fn discard(&mut self) {
        *self = StandstillMonitor::default();
    }

    /// Processes a reading. Returns the change since the previous reading if motion cannot explain it.
    pub(super) fn check_reading(&mut self, seen: &DriveFacts, origin: PositionOrigin) -> Option<PositionChange> {
        let (actual, position, scale, at) = (seen.actual?, seen.position?, seen.scale?, seen.actual_at);
        if at.is_none() && !self.interrupted {
            return None;
        }
        let stands = !seen.moves && actual.status.is_set(StatusBit::Standstill) && actual.speed == 0;
        let now = StandstillReading { at, position, scale, origin, act: seen.ended.map(|(act, _)| act) };
        let is_interrupted = std::mem::take(&mut self.interrupted);
        // A change of position after a motion proves nothing.
        let before = std::mem::replace(&mut self.last, stands.then_some(now))?;
        let same_act = is_interrupted || stands && before.act == now.act;
        let is_comparable = same_act && before.scale == scale && before.origin == origin;
        if is_comparable { shift(&before, &now, is_interrupted) } else { None }
    }
}

fn shift(before: &StandstillReading, now: &StandstillReading, is_interrupted: bool) -> Option<PositionChange> {
    let way = i64::from(now.position) - i64::from(before.position);
    let allowed = |degrees: f64| way.abs() <= i64::from(now.scale.degrees_to_steps(degrees));
    // Each session has its own clock.
    let elapsed = now.at.zip(before.at).filter(|_| !is_interrupted).map(|(now, before)| now.duration_since(before));
    let turned = |elapsed: Duration| FASTEST_RPM * 6.0 * (elapsed + MAX_REPORT_DELAY).as_secs_f64();
    match elapsed {
        _ if allowed(READJUSTMENT_DEG) => None,
        Some(elapsed) if !allowed(READJUSTMENT_DEG + turned(elapsed)) => Some(PositionChange::Jump),
        Some(elapsed) if elapsed <= MAX_READING_GAP => None,
        _ => Some(PositionChange::Unexplained(way)),
    }
}
