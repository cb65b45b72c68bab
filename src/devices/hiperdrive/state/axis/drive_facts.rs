//! Data about a drive on which the axis set-up is based.

use std::collections::BTreeMap;

use crate::devices::hiperdrive::procedures::dead_man::{ActionEnd, MotionLock};
use crate::devices::hiperdrive::protocol::{ActualValues, Direction, ErrorCode, Family, Length, PositionScale, State};
use crate::devices::hiperdrive::state::ruler::Ruler;
use crate::units::Moment;

#[derive(Clone, Debug, Default, PartialEq)]
pub struct DriveFacts {
    pub connected: bool,
    /// Whether a job is running or a plan is open for the user's approval.
    pub busy: bool,
    /// Whether the parameters may have changed since they were read.
    pub stale: bool,
    pub is_virtual: bool,
    pub controlled: bool,
    pub moves: bool,
    /// Action number and direction of the jog whose button is held.
    pub held: Option<(u64, Direction)>,
    pub actual: Option<ActualValues>,
    /// Time of the drive's last report on the session's clock, if known.
    pub actual_at: Option<Moment>,
    pub position: Option<i32>,
    /// Parameter values of the drive as last read, by number for drive 1.
    pub values: BTreeMap<u16, i64>,
    /// Saved values that are known to have been overwritten since, by number for drive 1.
    pub unsaved: BTreeMap<u16, i64>,
    /// How often this program has set the position.
    pub times_set: u32,
    /// Whether parameter 152 (Requested) is 1, if known.
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
    /// Latest error since the last acknowledgement, if read.
    pub error: Option<ErrorCode>,
}

impl DriveFacts {
    pub(super) fn is_settled(&self) -> bool {
        self.connected && !self.busy && !self.stale
    }

    /// Returns whether the drive has a fault, which must be acknowledged before it can move.
    pub fn has_failed(&self) -> bool {
        self.actual.is_some_and(|actual| matches!(actual.status.state(), State::Fault | State::Locked))
    }

    /// Returns the ruler for positions of the drive. It has millimetres if the user has confirmed a pitch.
    pub fn ruler(&self) -> Option<Ruler> {
        Some(Ruler { scale: self.scale?, pitch: self.pitch })
    }
}
