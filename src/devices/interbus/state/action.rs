//! The actions of an INTERBUS encoder that is shown.

use std::path::PathBuf;

use super::staged::Edit;
use crate::app::DeviceAction;
use crate::devices::interbus::jobs::Change;
use crate::devices::interbus::profile::Scale;
use crate::devices::interbus::protocol::{ProgramNumber, ReadOut, StartupMode};

/// Something in the INTERBUS tab.
pub enum InterbusAction {
    /// A person says that the machine stands, or that it does not any more.
    Stopped(bool),
    /// Read cam programs: the encoder's outputs switch to each of them.
    ReadPrograms(Vec<ProgramNumber>),
    /// Read one thing out.
    ReadOut(ReadOut),
    /// Let the encoder send something else: its position, its speed, the outputs of a program.
    Select(StartupMode),
    /// The device check.
    Check,
    /// Change something that is not written yet.
    Edit(Box<Edit>),
    /// Show what a change would do.
    Plan(Box<Change>),
    /// Leads the encoder back to its earlier mode, whoever changed it.
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
    AskSaveTable { decimal_comma: bool },
    /// Write the cams as a table.
    SaveTable { path: PathBuf, decimal_comma: bool },
    /// The machine counts in this.
    SetScale(Scale),
    /// Turn the virtual encoder's shaft, in revolutions a minute.
    Turn(f64),
    /// Save the profile.
    Save(PathBuf),
}

impl DeviceAction for InterbusAction {}
