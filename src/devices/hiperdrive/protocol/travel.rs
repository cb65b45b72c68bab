//! Travel of a drive in scaled steps. Positions are limited by the travel as well as by their 32 bits (manual 6.2, last
//! table, and 9.2).

use super::scaling::{Family, PositionScale};

/// Travel of a drive, given by its number of turns and its scale. If either is unknown, the travel imposes no limit.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Travel {
    /// Drive family, which determines the number of turns.
    pub family: Option<Family>,
    /// Scale given by parameters 154 and 156.
    pub scale: Option<PositionScale>,
}

/// Kind of limit that the travel imposes on a number of steps.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum StepLimit {
    /// A position is limited to the turns of the drive in either direction (parameters 158, 160 and 198).
    Position,
    /// A jog step is limited to the whole travel (parameters 170 and 176). The manual gives a range of 32 bits, but a
    /// longer step would leave the travel from any position (`D`).
    Step,
}

impl Travel {
    /// Travel of an unknown drive.
    pub const UNKNOWN: Travel = Travel { family: None, scale: None };

    /// Returns the maximum number of whole steps in either direction. Returns `None` if the turns or the scale are
    /// unknown.
    pub fn max_steps(self, reach: StepLimit) -> Option<i64> {
        let turns = self.family?.max_turns();
        Some(self.scale?.integer_steps(match reach {
            StepLimit::Position => turns,
            StepLimit::Step => 2 * turns,
        }))
    }
}
