//! The actions of the selected adapter or hub, and of its drives.

use std::path::PathBuf;

use super::axis;
use super::ruler::PositionUnit;
use super::staged::Edit;
use crate::app::DeviceAction;
use crate::devices::hiperdrive::jobs::Change;
use crate::devices::hiperdrive::procedures::Temperature;
use crate::devices::hiperdrive::procedures::dead_man::{SpeedTorque, TargetState};
use crate::devices::hiperdrive::protocol::{Direction, DriveNumber, Length, RunEnd};

pub enum HiperdriveAction {
    ReadStatus,
    Check,
    SelectDrive(DriveNumber),
    Watch(Temperature, bool),
    SetMeasure(PositionUnit),
    /// Set the pitch of a drive's spindle, if it has one.
    SetPitch(DriveNumber, Option<Length>),
    Edit(Box<Edit>),
    Plan(Box<Change>),
    /// Open the cyclic connection, which does not move anything.
    Take,
    Give,
    /// Move the selected drive, or change its state.
    Drive(Motor),
    /// Set up the axis of the selected drive.
    Axis(axis::AxisAction),
    Save(PathBuf),
}

/// A motion request of the user for the selected drive.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Motor {
    Lead(TargetState),
    Acknowledge,
    JogPress {
        direction: Direction,
        /// Whether this is an automatic key repetition, which starts nothing.
        repeated: bool,
    },
    /// Press of a jog button in the axis set-up. Jogging there is slow and weak, independent of other jog settings.
    SlowJogPress {
        direction: Direction,
        /// Whether this is an automatic key repetition, which starts nothing.
        repeated: bool,
    },
    /// Allow the next jog in this direction to lead further outside the limits.
    FreeOutward(Direction),
    /// Confirm that the jog is still held. Sent in every frame.
    JogHold,
    JogRelease,
    /// Move by this number of steps from the present position and stop there.
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
    JogEffort(SpeedTorque),
    /// Set the effort for moves, steps and runs.
    MoveEffort(SpeedTorque),
    /// Confirm or revoke the warning about endless runs.
    Expert(bool),
    /// Confirm the limits after checking them in the user's own unit.
    ConfirmLimits(DriveNumber),
}

impl DeviceAction for HiperdriveAction {}
