//! Actions of the selected INTERBUS encoder.

use std::path::PathBuf;

use super::staged::Edit;
use crate::app::DeviceAction;
use crate::devices::interbus::jobs::Change;
use crate::devices::interbus::profile::Scale;
use crate::devices::interbus::protocol::{ProgramNumber, ReadOutNumber, StartupMode};

pub enum InterbusAction {
    /// Sets whether the user has confirmed that the machine stands still.
    Stopped(bool),
    /// Reads cam programs, which switches the encoder's outputs to each of them in turn.
    ReadPrograms(Vec<ProgramNumber>),
    ReadOut(ReadOutNumber),
    /// Selects the data that the encoder sends: position, speed or the outputs of a program.
    Select(StartupMode),
    Check,
    /// Applies an edit, which is not yet written to the encoder.
    Edit(Box<Edit>),
    Plan(Box<Change>),
    /// Returns the encoder to its earlier mode, regardless of who changed it.
    LeadBack,
    /// Asks the user for a cam table. Rows that do not specify a program belong to the given one.
    AskTable(ProgramNumber),
    OpenTable(PathBuf),
    /// Imports the cams of a pasted table.
    PasteTable(ProgramNumber, String),
    /// Applies the imported table to the edits if true, or else discards it.
    TakeTable(bool),
    /// Asks where to save the cams as a table, with a decimal comma or point.
    AskSaveTable {
        decimal_comma: bool,
    },
    SaveTable {
        path: PathBuf,
        decimal_comma: bool,
    },
    SetScale(Scale),
    /// Turns the shaft of the virtual encoder at the given speed in revolutions per minute.
    Turn(f64),
    Save(PathBuf),
}

impl DeviceAction for InterbusAction {}
