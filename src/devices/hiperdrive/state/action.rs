//! What can be asked of an adapter or a hub that is shown, and of its drives.

use std::path::PathBuf;
use std::time::Duration;

use super::axis;
use super::ruler::Measure;
use super::staged::Edit;
use crate::app::studio::SessionId;
use crate::devices::hiperdrive::jobs::Change;
use crate::devices::hiperdrive::procedures::dead_man::{Effort, Goal};
use crate::devices::hiperdrive::protocol::{Direction, DriveNumber, Length, RunEnd};

/// Something in the HIPERDRIVE tab.
pub enum Action {
    /// Open the link again, after it was lost or could not be opened.
    Reconnect,
    /// Read everything again; edits stay.
    Read,
    /// Read states and errors.
    ReadStatus,
    /// The device check.
    Check,
    /// Read where the drive is, once.
    ReadPosition,
    /// Read where the drive is all the time, or no more.
    Poll(Option<Duration>),
    /// Show another drive.
    SelectDrive(DriveNumber),
    /// Show positions in this.
    SetMeasure(Measure),
    /// The drive turns a spindle of this pitch, or none.
    SetPitch(DriveNumber, Option<Length>),
    /// Change something that is not written yet.
    Edit(Box<Edit>),
    /// Take the last edit back.
    Undo,
    /// Do it again.
    Redo,
    /// Take all edits back.
    RevertAll,
    /// Show what writing the edits would do.
    Review,
    /// Show what a change would do.
    Plan(Box<Change>),
    /// Open the cyclic connection. Nothing moves by that.
    Take,
    /// Stop all drives and close it.
    Give,
    /// Move the drive that is shown, or lead it to another state.
    Drive(Motor),
    /// Set up the axis of the drive that is shown.
    Axis(axis::Action),
    /// Ask where to save the profile.
    AskSave,
    /// Save the profile.
    Save(PathBuf),
    /// Show what restoring a backup would do.
    Restore(PathBuf),
    /// Show what writing this profile into a connected device would do.
    WriteInto(SessionId),
}

/// What a person wants of the drive that is shown.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Motor {
    /// Another state.
    Lead(Goal),
    /// Acknowledge its fault.
    Acknowledge,
    /// A jog is pressed.
    JogPress {
        /// Which way.
        direction: Direction,
        /// The key repeats by itself: nothing begins by that.
        repeated: bool,
    },
    /// A jog of the axis set-up is pressed: slow and weak, whatever is chosen for the others.
    SlowJogPress {
        /// Which way.
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
    /// So many steps from where it stands; runs to its end.
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
    Run {
        /// Which way.
        direction: Direction,
        /// How far.
        end: RunEnd,
    },
    /// The job waits.
    Pause,
    /// It goes on.
    Resume,
    /// What moves stops.
    Stop,
    /// Jog like this.
    JogEffort(Effort),
    /// Move, step and run like this.
    MoveEffort(Effort),
    /// Somebody knows what an endless run is, or nobody any more.
    Expert(bool),
    /// A person has looked at the limits in their own unit.
    ConfirmLimits(DriveNumber),
}
