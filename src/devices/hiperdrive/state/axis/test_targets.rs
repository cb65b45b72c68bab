//! The three targets of the test moves, and the distance by which the axis was jogged.

use super::DriveFacts;
use crate::devices::hiperdrive::procedures::dead_man::ActionEnd;
use crate::devices::hiperdrive::protocol::Direction;

#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[repr(u8)]
pub enum TestTarget {
    Middle,
    Lower,
    Upper,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Outcome {
    pub target: i32,
    pub position: i32,
    pub ended: ActionEnd,
    /// Allowed deviation from the target in steps. It corresponds to the repeatability of 1° (reference, section 5).
    pub allowed: i64,
}

/// Distance in steps by which the user jogged an axis. Only motion while a button is held counts.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct JogTravel {
    /// Longest upward distance of a single jog. Distances too small to be significant count as 0.
    pub up: i64,
    pub down: i64,
    /// Whether the position increases clockwise, or `None` if not observed yet.
    pub clockwise_is_up: Option<bool>,
    /// The current jog action and the position at which it started.
    from: Option<(u64, i32)>,
}

impl TestTarget {
    /// All targets, in the order of the test moves.
    pub const ALL: [TestTarget; 3] = [TestTarget::Middle, TestTarget::Lower, TestTarget::Upper];

    /// Returns the position of the target between two limits, in steps.
    pub const fn position_between(self, low: i32, high: i32) -> i32 {
        match self {
            TestTarget::Middle => low.midpoint(high),
            TestTarget::Lower => low,
            TestTarget::Upper => high,
        }
    }
}

impl Outcome {
    /// Returns the deviation from the target in steps.
    pub fn position_deviation(&self) -> i64 {
        i64::from(self.position) - i64::from(self.target)
    }

    pub fn is_good(&self) -> bool {
        self.ended == ActionEnd::Arrived && self.position_deviation().abs() <= self.allowed
    }
}

impl JogTravel {
    /// Processes a position of the drive. A distance of less than a 64th of a turn is not significant.
    pub(super) fn add_position(&mut self, seen: &DriveFacts) {
        let (Some((act, direction)), Some(position), Some(scale)) = (seen.held, seen.position, seen.scale) else {
            self.from = None;
            return;
        };
        let Some((_, from)) = self.from.filter(|(own, _)| *own == act) else {
            self.from = Some((act, position));
            return;
        };
        let grain = (scale.steps_per_turn() / 64.0).max(1.0) as i64;
        let way = i64::from(position) - i64::from(from);
        if way.abs() < grain {
            return;
        }
        self.up = self.up.max(way);
        self.down = self.down.max(-way);
        self.clockwise_is_up = Some((way > 0) == (direction == Direction::Clockwise));
    }
}
