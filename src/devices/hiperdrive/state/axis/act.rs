//! The user's actions during axis set-up, and the resulting requests to the device.

use std::path::PathBuf;

use super::{LengthEntries, TestTarget};
use crate::app::Language;

#[derive(Clone, Debug, PartialEq, Eq)]
pub enum DriveRequest {
    /// Writes parameters without saving them. Their numbers are those of drive 1.
    Try(Vec<(u16, i64)>),
    /// Assigns a position to the current location of the drive without saving it.
    SetPosition(i32),
    ConfirmLimits,
    Move(i32),
    Take,
    Give,
    Save,
    /// Writes the previous values back without saving them.
    Restore(Vec<(u16, i64)>),
    Acknowledge,
    /// Accepts the statement of the user that the supply was switched off.
    BelieveRestart,
    PowerCycle,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum AxisButton {
    /// Executes the task of the current step: a request, a write or a save.
    Do,
    Confirm,
    /// Widens the limits to the full travel of the drive.
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
    /// Adopts the current position as the limit that the current step sets.
    TakePlace,
    Next,
    Skip,
    Back,
    Cancel,
    /// Asks the user where to save the report of a completed set-up.
    AskReport,
    SaveReport(PathBuf, Language),
}
