//! Actions of the selected INTERBUS encoder.

use std::path::PathBuf;

use super::staged::Edit;
use crate::app::DeviceAction;
use crate::devices::interbus::jobs::Change;
use crate::devices::interbus::profile::Scale;
use crate::devices::interbus::protocol::{ProgramNumber, ReadOut, StartupMode};

/// Something in the INTERBUS tab.
pub enum InterbusAction {
    /// The user states whether the machine stands still.
    Stopped(bool),
    /// Read cam programs: the encoder's outputs switch to each of them.
    ReadPrograms(Vec<ProgramNumber>),
    ReadOut(ReadOut),
    /// Select what the encoder sends: its position, its speed, the outputs of a program.
    Select(StartupMode),
    Check,
    /// Change something that is not written yet.
    Edit(Box<Edit>),
    Plan(Box<Change>),
    /// Return the encoder to its earlier mode, whoever changed it.
    LeadBack,
    /// Ask for a table of cams; rows without a program are for this one.
    AskTable(ProgramNumber),
    OpenTable(PathBuf),
    /// Take the cams of a table that was pasted.
    PasteTable(ProgramNumber, String),
    /// Take the table that was read into the edits, or discard it.
    TakeTable(bool),
    /// Ask where to write the cams as a table, with a decimal comma or a point.
    AskSaveTable {
        decimal_comma: bool,
    },
    /// Write the cams as a table.
    SaveTable {
        path: PathBuf,
        decimal_comma: bool,
    },
    SetScale(Scale),
    /// Turn the virtual encoder's shaft, in revolutions per minute.
    Turn(f64),
    Save(PathBuf),
}

impl DeviceAction for InterbusAction {}
