//! Comparison of two positions of an axis at standstill. Parameter 198 is the number that was written last, and no
//! parameter reveals where it was written (manual, 198 and 107). If the reference is set to the same number at another
//! location, the only sign is a position that jumps without motion.

use std::time::Duration;

use super::DriveFacts;
use super::step_outcomes::PositionOrigin;
use super::supply::READJUSTMENT_DEG;
use crate::devices::hiperdrive::procedures::dead_man::MAX_REPORT_DELAY;
use crate::devices::hiperdrive::protocol::{PositionScale, StatusBit};
use crate::units::Moment;

/// Maximum speed of a shaft in rpm, the largest value of parameter 166.
const FASTEST_RPM: f64 = 35.0;
/// Maximum interval between two readings. During a longer interval, an axis may have moved and stopped unnoticed.
const MAX_READING_GAP: Duration = Duration::from_secs(1);

#[derive(Clone, Debug, Default)]
pub(super) struct StandstillMonitor {
    last: Option<StandstillReading>,
    /// Whether the connection has been lost since the reading. The clock of a session is valid only for that session.
    interrupted: bool,
}

#[derive(Clone, Copy, Debug)]
struct StandstillReading {
    /// Time of the reading, or `None` if the reading was part of a complete reading after a loss of the connection.
    at: Option<Moment>,
    position: i32,
    scale: PositionScale,
    origin: PositionOrigin,
    /// Last action of the user that had ended at the time of the reading.
    act: Option<u64>,
}

/// A change of position that cannot be explained by motion.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum PositionChange {
    /// A change that exceeds the possible motion of the shaft in the elapsed time. The reference was set again.
    Jump,
    /// Number of steps by which the position changed while it was not read. The axis was moved, or its reference was
    /// set again.
    Unexplained(i64),
}

impl StandstillMonitor {
    pub(super) const fn interrupt(&mut self) {
        self.interrupted = true;
    }

    /// Discards the last standstill, because the drive was off and may have been turned by hand. The power-cycle check
    /// compares the positions itself.
    pub(super) fn discard(&mut self) {
        *self = StandstillMonitor::default();
    }

    /// Processes a reading. Returns the change since the previous reading if it cannot be explained by motion.
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
    let allowed = |degrees: f64| way.abs() <= i64::from(now.scale.steps_of_degrees(degrees));
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
