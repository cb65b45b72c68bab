//! How far an axis was moved by hand, and the three places that the test moves to.

use super::Seen;
use crate::device::hiperdrive::dead_man::Ended;
use crate::protocol::hiperdrive::Direction;

/// Where a test move leads.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[repr(u8)]
pub enum Place {
    /// In the middle of the range.
    Middle,
    /// To the lower limit.
    Lower,
    /// To the upper limit.
    Upper,
}

/// What came of a test move.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Outcome {
    /// Where it led.
    pub target: i32,
    /// Where the drive stood when it was over.
    pub position: i32,
    /// How it ended.
    pub ended: Ended,
    /// So many steps beside the target are allowed: 1° (reference 5, repeatability).
    pub allowed: i64,
}

/// How far an axis was moved by hand, in steps.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Travel {
    /// The farthest up without a turn-round; 0 until that can be told from nothing.
    pub up: i64,
    /// The farthest down.
    pub down: i64,
    /// Turning clockwise counts up; `None`: not seen yet.
    pub clockwise_is_up: Option<bool>,
    /// The least and the greatest position so far, and the last one.
    seen: Option<(i32, i32, i32)>,
}

impl Place {
    /// All of them, as they are moved to.
    pub const ALL: [Place; 3] = [Place::Middle, Place::Lower, Place::Upper];

    /// The steps between two limits.
    pub const fn between(self, low: i32, high: i32) -> i32 {
        match self {
            Place::Middle => low.midpoint(high),
            Place::Lower => low,
            Place::Upper => high,
        }
    }
}

impl Outcome {
    /// Steps between target and position.
    pub fn missed(&self) -> i64 {
        i64::from(self.position) - i64::from(self.target)
    }

    /// It is there.
    pub fn is_good(&self) -> bool {
        self.ended == Ended::Arrived && self.missed().abs() <= self.allowed
    }
}

impl Travel {
    /// The drive is somewhere. Less than a 64th of a turn is not told from nothing.
    pub(super) fn note(&mut self, seen: &Seen) {
        let (Some(actual), Some(scale)) = (seen.actual, seen.scale) else { return };
        let now = actual.position;
        let Some((least, most, last)) = self.seen else {
            self.seen = Some((now, now, now));
            return;
        };
        let grain = (scale.steps_per_turn() / 64.0).max(1.0) as i64;
        let (up, down) = (i64::from(now) - i64::from(least), i64::from(most) - i64::from(now));
        if up >= grain {
            self.up = self.up.max(up);
        }
        if down >= grain {
            self.down = self.down.max(down);
        }
        if let Some(direction) = seen.turns.filter(|_| now != last) {
            self.clockwise_is_up = Some((now > last) == (direction == Direction::Clockwise));
        }
        self.seen = Some((least.min(now), most.max(now), now));
    }

    /// The numbers were given other places.
    pub(super) fn forget_places(&mut self) {
        self.seen = None;
    }
}
