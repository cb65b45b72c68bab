//! Known data about a drive, on which the axis set-up is based.

use std::collections::BTreeMap;

use crate::devices::hiperdrive::procedures::dead_man::{ActionEnd, MotionLock};
use crate::devices::hiperdrive::protocol::{ActualValues, Direction, ErrorCode, Family, Length, PositionScale, State};
use crate::devices::hiperdrive::state::ruler::Ruler;
use crate::units::Moment;

#[derive(Clone, Debug, Default, PartialEq)]
pub struct DriveFacts {
    pub connected: bool,
    /// Whether a job is running or a review is open.
    pub busy: bool,
    /// Whether the parameters may differ from the values read.
    pub stale: bool,
    pub is_virtual: bool,
    pub controlled: bool,
    pub moves: bool,
    /// Action number and direction of a held jog button.
    pub held: Option<(u64, Direction)>,
    pub actual: Option<ActualValues>,
    /// Time of the last report from the drive on the session's clock, if known.
    pub actual_at: Option<Moment>,
    pub position: Option<i32>,
    /// Parameters of the drive as last read, by their numbers for drive 1.
    pub values: BTreeMap<u16, i64>,
    /// Saved values known to differ from those written since, by their numbers for drive 1.
    pub unsaved: BTreeMap<u16, i64>,
    /// Number of times that this program has set the position.
    pub times_set: u32,
    /// Whether the drive is requested, parameter 152.
    pub requested: Option<bool>,
    /// Position scale, parameters 154 and 156.
    pub scale: Option<PositionScale>,
    /// Pitch of the spindle, if confirmed by the user.
    pub pitch: Option<Length>,
    /// Lower and upper limit in scaled steps, parameters 158 and 160.
    pub limits: Option<(i32, i32)>,
    pub family: Option<Family>,
    pub locks: Vec<MotionLock>,
    pub ended: Option<(u64, ActionEnd)>,
    /// Latest error since the last acknowledgement, if it was read.
    pub error: Option<ErrorCode>,
}

impl DriveFacts {
    pub(super) fn is_settled(&self) -> bool {
        self.connected && !self.busy && !self.stale
    }

    /// Returns whether the drive has failed and cannot move until the fault is acknowledged.
    pub fn has_failed(&self) -> bool {
        self.actual.is_some_and(|actual| matches!(actual.status.state(), State::Fault | State::Locked))
    }

    /// Returns the ruler of the drive, in millimetres if the user has confirmed a pitch.
    pub fn ruler(&self) -> Option<Ruler> {
        Some(Ruler { scale: self.scale?, pitch: self.pitch })
    }
}
