//! Actions of the user on the selected adapter or hub and on its drives.

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
    /// Moves the selected drive or changes its state.
    Drive(MotorCommand),
    /// Executes an action in the axis set-up of the selected drive.
    Axis(axis::AxisAction),
    Save(PathBuf),
}

/// A command from the user that moves the selected drive or changes its state.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MotorCommand {
    Lead(TargetState),
    Acknowledge,
    JogPress {
        direction: Direction,
        /// Whether the press comes from automatic key repetition, which must not start a motion.
        repeated: bool,
    },
    /// Presses a jog button in the axis set-up. Speed and torque of the jog are low, whatever is set for other jogs.
    SlowJogPress {
        direction: Direction,
        /// Whether the press comes from automatic key repetition, which must not start a motion.
        repeated: bool,
    },
    /// Allows the next jog in this direction to move the drive further outside its limits.
    AllowOutward(Direction),
    /// Sent in every frame while a jog button is still held.
    JogHold,
    JogRelease,
    /// Moves by a number of steps from the current position.
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
    /// Sets the speed and torque for moves and steps.
    MoveEffort(SpeedTorque),
    RunEffort(SpeedTorque),
    /// Accepts or revokes the warning about endless runs.
    Expert(bool),
    /// Confirms the limits, which the user has checked in the displayed unit.
    ConfirmLimits(DriveNumber),
}

impl DeviceAction for HiperdriveAction {}
