//! Actions on the selected adapter or hub, and on its drives.

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
    /// Sets the pitch of a drive's spindle, or removes it.
    SetPitch(DriveNumber, Option<Length>),
    Edit(Box<Edit>),
    Plan(Box<Change>),
    /// Opens the cyclic connection without moving a drive.
    Take,
    Give,
    /// Moves the selected drive, or changes its state.
    Drive(MotorCommand),
    /// Sets up the axis of the selected drive.
    Axis(axis::AxisAction),
    Save(PathBuf),
}

/// A motion request of the user for the selected drive.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MotorCommand {
    Lead(TargetState),
    Acknowledge,
    JogPress {
        direction: Direction,
        /// Whether the press is an automatic key repetition, which starts nothing.
        repeated: bool,
    },
    /// Presses a jog button in the axis set-up. The jog is slow and weak, independent of the jog settings elsewhere.
    SlowJogPress {
        direction: Direction,
        /// Whether the press is an automatic key repetition, which starts nothing.
        repeated: bool,
    },
    /// Allows the next jog in this direction, although it moves the drive further outside its limits.
    AllowOutward(Direction),
    /// Confirms that the jog is still held. It is sent in every frame.
    JogHold,
    JogRelease,
    /// Moves by the given number of steps from the current position and stops there.
    Step {
        /// Signed distance in scaled steps.
        by: i32,
    },
    Move {
        /// Target position in scaled steps.
        target: i32,
    },
    Run {
        direction: Direction,
        end: RunEnd,
    },
    Pause,
    Resume,
    Stop,
    JogEffort(SpeedTorque),
    /// Sets the speed and torque of moves and steps.
    MoveEffort(SpeedTorque),
    RunEffort(SpeedTorque),
    /// Confirms or revokes the warning about endless runs.
    Expert(bool),
    /// Records that the user has checked the limits in the displayed unit and confirmed them.
    ConfirmLimits(DriveNumber),
}

impl DeviceAction for HiperdriveAction {}
