//! How far a drive turns, in the steps of its scale (manual 6.2, last table; 9.2): what bounds positions beside their 32 bits.

use super::scaling::{Family, PositionScale};

/// A drive's turns and the steps in which they are told. What is not known bounds nothing.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Travel {
    /// Which turns it has.
    pub family: Option<Family>,
    /// Parameters 154 and 156.
    pub scale: Option<PositionScale>,
}

/// How far from 0 a number of steps may be.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Reach {
    /// A position: as many turns as the drive has either way (158, 160, 198).
    Position,
    /// A step: no further than from one end of the turns to the other (170, 176; `D`: the manual names 32 bits alone, and a
    /// longer one ends outside from wherever it begins).
    Step,
}

impl Travel {
    /// Nothing is known of the drive.
    pub const UNKNOWN: Travel = Travel { family: None, scale: None };

    /// The most whole steps either way; `None` where turns or scale are not known.
    pub fn steps(self, reach: Reach) -> Option<i64> {
        let turns = self.family?.most_turns();
        Some(self.scale?.whole_steps(match reach {
            Reach::Position => turns,
            Reach::Step => 2 * turns,
        }))
    }
}
