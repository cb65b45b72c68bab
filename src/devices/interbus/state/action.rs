//! What can be asked of an INTERBUS encoder that is shown.

use std::path::PathBuf;
use std::time::Duration;

use super::staged::Edit;
use crate::app::studio::SessionId;
use crate::devices::interbus::jobs::Change;
use crate::devices::interbus::profile::Scale;
use crate::devices::interbus::protocol::{ProgramNumber, ReadOut, StartupMode};

/// Something in the INTERBUS tab.
pub enum Action {
    /// Open the link again, after it was lost or could not be opened.
    Reconnect,
    /// A person says that the machine stands, or that it does not any more.
    Stopped(bool),
    /// Read parameters again, and the cam programs that were read before; edits stay.
    Read,
    /// Read cam programs: the encoder's outputs switch to each of them.
    ReadPrograms(Vec<ProgramNumber>),
    /// Read one thing out.
    ReadOut(ReadOut),
    /// Let the encoder send something else: its position, its speed, the outputs of a program.
    Select(StartupMode),
    /// The device check.
    Check,
    /// Read the IN word once.
    ReadPosition,
    /// Read the IN word all the time, or no more.
    Poll(Option<Duration>),
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
    /// Back to the mode that was found, whoever left the encoder otherwise.
    LeadBack,
    /// Ask for a table of cams; rows that name no program are for this one.
    AskTable(ProgramNumber),
    /// Take the cams of a table.
    OpenTable(PathBuf),
    /// Take the cams of a table that was pasted.
    PasteTable(ProgramNumber, String),
    /// Take what was read of a table into the edits, or leave it.
    TakeTable(bool),
    /// Ask where to write the cams as a table, with a decimal comma or a point.
    AskSaveTable {
        /// With a comma.
        decimal_comma: bool,
    },
    /// Write the cams as a table.
    SaveTable {
        /// Where.
        path: PathBuf,
        /// With a decimal comma.
        decimal_comma: bool,
    },
    /// The machine counts in this.
    SetScale(Scale),
    /// Turn the virtual encoder's shaft, in revolutions a minute.
    Turn(f64),
    /// Ask where to save the profile.
    AskSave,
    /// Save the profile.
    Save(PathBuf),
    /// Show what restoring a backup would do.
    Restore(PathBuf),
    /// Show what writing this profile into a connected encoder would do.
    WriteInto(SessionId),
}
