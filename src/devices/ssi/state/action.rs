//! Actions on the selected SSI encoder or layout.

use std::path::PathBuf;

use super::design::Edit;
use super::export::ExportFormat;
use super::form::{Field, FieldInput};
use super::strip::Handle;
use crate::app::{DeviceAction, Language};

pub enum SsiAction {
    Check,
    Edit(Box<Edit>),
    Enter(Field, FieldInput),
    /// Moves a part of the frame to a clock, or as close to it as possible.
    Move(Handle, u8),
    AddErrorBit,
    RemoveErrorBit(usize),
    Try(TrialInput),
    /// Sets the number of clocks per word for a search. `None` selects the number of the layout.
    SetClocks(Option<u8>),
    Find,
    /// Asks for a file with frames, and searches for their layout.
    AskFrames,
    FindIn(PathBuf),
    ForgetSearch,
    /// Adopts a layout found by a search. The numbers are the index of its class and its index in the class.
    Take(usize, usize),
    ForgetErrors,
    AskExport(ExportFormat, Language),
    Export(ExportFormat, Language, PathBuf),
    AskSaveFrames,
    SaveFrames(PathBuf),
    SendLayout,
    /// Turns the shaft of the virtual encoder at a speed in revolutions per minute.
    Turn(f64),
}

#[derive(Clone, Debug, PartialEq, Eq)]
pub enum TrialInput {
    Position(u64),
    /// Sets the trial frame to a turn and a step within the turn.
    Place(u64, u64),
    Bits(String),
    /// Inverts the bit of the trial frame at the given clock, counted from 1.
    Toggle(u8),
    /// Shows the most recently read word in place of the trial frame.
    Live,
}

impl DeviceAction for SsiAction {}
