//! The user's actions on an INTERBUS encoder.

use std::path::PathBuf;

use super::staged::Edit;
use crate::app::DeviceAction;
use crate::devices::interbus::jobs::Change;
use crate::devices::interbus::profile::Scale;
use crate::devices::interbus::protocol::{ProgramNumber, ReadOutNumber, StartupMode};

pub enum InterbusAction {
    /// Sets whether the user has confirmed that the machine is at standstill.
    ConfirmStandstill(bool),
    /// Reads cam programs. The outputs of the encoder switch to each program in turn.
    ReadPrograms(Vec<ProgramNumber>),
    ReadOut(ReadOutNumber),
    /// Selects what the encoder sends: its position, its speed or the outputs of a program.
    Select(StartupMode),
    Check,
    /// Applies an edit without writing it to the encoder.
    Edit(Box<Edit>),
    Plan(Box<Change>),
    /// Returns the encoder to its earlier mode, even if another program has changed the mode.
    RestoreMode,
    /// Asks the user for a cam table file. Rows that do not name a program are for the given one.
    AskTable(ProgramNumber),
    OpenTable(PathBuf),
    /// Reads the cams from a pasted table. Rows that do not name a program are for the given one.
    PasteTable(ProgramNumber, String),
    /// Adds the table to the edits if `true`, and discards it otherwise.
    TakeTable(bool),
    /// Asks where to save the cams as a table, with a decimal comma or a decimal point in its numbers.
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
