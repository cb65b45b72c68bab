//! The actions of the selected adapter or hub, and of its drives.

use std::path::PathBuf;

use super::axis;
use super::ruler::Measure;
use super::staged::Edit;
use crate::app::DeviceAction;
use crate::devices::hiperdrive::jobs::Change;
use crate::devices::hiperdrive::procedures::Temperature;
use crate::devices::hiperdrive::procedures::dead_man::{Effort, Goal};
use crate::devices::hiperdrive::protocol::{Direction, DriveNumber, Length, RunEnd};

/// Something in the HIPERDRIVE tab.
pub enum HiperdriveAction {
    /// Read states and errors.
    ReadStatus,
    Check,
    SelectDrive(DriveNumber),
    /// Record a temperature beside the position, or stop recording it.
    Watch(Temperature, bool),
    SetMeasure(Measure),
    /// The drive turns a spindle of this pitch, or none.
    SetPitch(DriveNumber, Option<Length>),
    /// Change something that is not written yet.
    Edit(Box<Edit>),
    Plan(Box<Change>),
    /// Open the cyclic connection. This moves nothing.
    Take,
    Give,
    /// Move the drive that is shown, or lead it to another state.
    Drive(Motor),
    /// Set up the axis of the drive that is shown.
    Axis(axis::AxisAction),
    Save(PathBuf),
}

/// A motion request of the user for the drive that is shown.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Motor {
    Lead(Goal),
    Acknowledge,
    JogPress {
        direction: Direction,
        /// Set for an automatic repetition of the key, which starts nothing.
        repeated: bool,
    },
    /// A jog of the axis set-up is pressed: slow and weak, whatever is set for other jogs.
    SlowJogPress {
        direction: Direction,
        /// Set for an automatic repetition of the key, which starts nothing.
        repeated: bool,
    },
    /// Allow the next jog in this direction to lead further out from outside the limits.
    FreeOutward(Direction),
    /// The jog is still held: sent in every frame.
    JogHold,
    JogRelease,
    /// Move by this many steps from the present position, to the end.
    Step {
        /// In scaled steps.
        by: i32,
    },
    Move {
        /// In scaled steps.
        target: i32,
    },
    Run {
        direction: Direction,
        end: RunEnd,
    },
    /// The job waits.
    Pause,
    Resume,
    Stop,
    /// Jog like this.
    JogEffort(Effort),
    /// Move, step and run like this.
    MoveEffort(Effort),
    /// The user has confirmed the warning about endless runs, or has revoked it.
    Expert(bool),
    /// The user has checked the limits in their own unit.
    ConfirmLimits(DriveNumber),
}

impl DeviceAction for HiperdriveAction {}
