//! The actions of an adapter or a hub that is shown, and of its drives.

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
    /// The device check.
    Check,
    /// Show another drive.
    SelectDrive(DriveNumber),
    /// Record a temperature beside the position, or stop recording it.
    Watch(Temperature, bool),
    /// Show positions in this.
    SetMeasure(Measure),
    /// The drive turns a spindle of this pitch, or none.
    SetPitch(DriveNumber, Option<Length>),
    /// Change something that is not written yet.
    Edit(Box<Edit>),
    /// Show what a change would do.
    Plan(Box<Change>),
    /// Open the cyclic connection. Nothing moves by that.
    Take,
    /// Stop all drives and close it.
    Give,
    /// Move the drive that is shown, or lead it to another state.
    Drive(Motor),
    /// Set up the axis of the drive that is shown.
    Axis(axis::AxisAction),
    /// Save the profile.
    Save(PathBuf),
}

/// A motion request of the user for the drive that is shown.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Motor {
    /// Another state.
    Lead(Goal),
    /// Acknowledge its fault.
    Acknowledge,
    /// A jog is pressed.
    JogPress {
        direction: Direction,
        /// The key repeats by itself: nothing begins by that.
        repeated: bool,
    },
    /// A jog of the axis set-up is pressed: slow and weak, whatever is chosen for the others.
    SlowJogPress {
        direction: Direction,
        /// The key repeats by itself: nothing begins by that.
        repeated: bool,
    },
    /// From outside the limits the next jog this way may lead further out.
    FreeOutward(Direction),
    /// It is still held: said with every picture.
    JogHold,
    /// It was let go.
    JogRelease,
    /// This many steps from the present position; runs to its end.
    Step {
        /// In steps as scaled.
        by: i32,
    },
    /// To a place.
    Move {
        /// In steps as scaled.
        target: i32,
    },
    /// Turning in speed mode.
    Run { direction: Direction, end: RunEnd },
    /// The job waits.
    Pause,
    /// It goes on.
    Resume,
    /// Stops the motion.
    Stop,
    /// Jog like this.
    JogEffort(Effort),
    /// Move, step and run like this.
    MoveEffort(Effort),
    /// The user has confirmed to know what an endless run is, or has revoked it.
    Expert(bool),
    /// A person has looked at the limits in their own unit.
    ConfirmLimits(DriveNumber),
}

impl DeviceAction for HiperdriveAction {}
