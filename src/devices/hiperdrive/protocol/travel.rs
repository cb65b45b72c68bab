//! Travel of a drive in the steps of its scale (manual 6.2, last table; 9.2), which limits positions in addition to
//! their 32 bits.

use super::scaling::{Family, PositionScale};

/// Turns of a drive and the scale of its steps. Unknown values impose no limit.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Travel {
    /// Family, which determines the turns.
    pub family: Option<Family>,
    /// Scale of parameters 154 and 156.
    pub scale: Option<PositionScale>,
}

/// Limit of a number of steps, relative to 0.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum StepLimit {
    /// Position: the number of turns of the drive in either direction (158, 160, 198).
    Position,
    /// Step: no longer than from one end of the turns to the other (170, 176; `D`: the manual gives only 32 bits, and a
    /// longer step ends outside from any start).
    Step,
}

impl Travel {
    /// Travel of an unknown drive.
    pub const UNKNOWN: Travel = Travel { family: None, scale: None };

    /// Returns the maximum whole steps in either direction, or `None` if turns or scale are unknown.
    pub fn steps(self, reach: StepLimit) -> Option<i64> {
        let turns = self.family?.most_turns();
        Some(self.scale?.whole_steps(match reach {
            StepLimit::Position => turns,
            StepLimit::Step => 2 * turns,
        }))
    }
}
