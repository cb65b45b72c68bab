//! The user's actions in the axis set-up, and the requests to the device that result from them.

use std::path::PathBuf;

use super::{LengthEntries, TestTarget};
use crate::app::Language;

#[derive(Clone, Debug, PartialEq, Eq)]
pub enum DriveRequest {
    /// Writes parameters, given by their numbers for drive 1, without saving them.
    Try(Vec<(u16, i64)>),
    /// Assigns a position to the current location of the axis without saving it.
    SetPosition(i32),
    ConfirmLimits,
    Move(i32),
    Take,
    Give,
    Save,
    /// Writes the previous values back without saving them.
    Restore(Vec<(u16, i64)>),
    Acknowledge,
    /// Accepts the user's claim that the supply was switched off.
    BelieveRestart,
    PowerCycle,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum AxisButton {
    /// Executes the current step: sends its request, writes or saves.
    Do,
    Confirm,
    /// Extends the limits to the full travel of the drive.
    Widen,
    Go(TestTarget),
    Take,
    Give,
    PowerCycle,
    Restarted,
    Acknowledge,
    Recall,
}

#[derive(Clone, Debug, PartialEq, Eq)]
pub enum AxisAction {
    Begin,
    Edit(Box<LengthEntries>),
    Press(AxisButton),
    /// Takes the current position as the limit that this step sets.
    TakePlace,
    Next,
    Skip,
    Back,
    Cancel,
    /// Asks the user where to save the report of a completed set-up.
    AskReport,
    SaveReport(PathBuf, Language),
}
