//! Travel of a drive in the steps of its scale. It limits positions in addition to their 32 bits. See manual 6.2, last
//! table, and 9.2.

use super::scaling::{Family, PositionScale};

/// Turns of a drive and the scale of its steps. Together they limit its values. Unknown values impose no limit.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Travel {
    /// Drive family, which determines the number of turns.
    pub family: Option<Family>,
    /// Scale given by parameters 154 and 156.
    pub scale: Option<PositionScale>,
}

/// Limit on a number of steps, relative to 0.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum StepLimit {
    /// Limit of a position: the number of turns of the drive in either direction (parameters 158, 160 and 198).
    Position,
    /// Limit of a step, which is no longer than the whole travel (parameters 170 and 176). The manual gives only 32
    /// bits, but a longer step ends outside the travel from any start (`D`).
    Step,
}

impl Travel {
    /// Travel of an unknown drive.
    pub const UNKNOWN: Travel = Travel { family: None, scale: None };

    /// Returns the maximum number of whole steps in either direction, or `None` if the turns or the scale are unknown.
    pub fn max_steps(self, reach: StepLimit) -> Option<i64> {
        let turns = self.family?.max_turns();
        Some(self.scale?.integer_steps(match reach {
            StepLimit::Position => turns,
            StepLimit::Step => 2 * turns,
        }))
    }
}
