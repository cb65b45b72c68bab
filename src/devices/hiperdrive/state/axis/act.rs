//! Actions of the user during axis set-up, and the resulting requests to the device.

use std::path::PathBuf;

use super::{Entries, TestTarget};
use crate::app::Language;

#[derive(Clone, Debug, PartialEq, Eq)]
pub enum DriveRequest {
    /// Write parameters, by their numbers for drive 1, through a plan that does not save.
    Try(Vec<(u16, i64)>),
    /// Assign a position to the present location of the drive, without saving.
    SetPosition(i32),
    ConfirmLimits,
    Move(i32),
    Take,
    Give,
    Save,
    /// Write the previous values back, without saving.
    Restore(Vec<(u16, i64)>),
    Acknowledge,
    /// Record the user's statement that the supply was off.
    BelieveRestart,
    PowerCycle,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum AxisButton {
    /// Execute the task of the current step, which is a request, a write or a save.
    Do,
    Confirm,
    /// Widen the limits to the full travel of the drive.
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
    Edit(Box<Entries>),
    Press(AxisButton),
    /// Adopt the present position as the limit that the current step sets.
    TakePlace,
    Next,
    Skip,
    Back,
    Cancel,
    /// Ask where to save the report of a completed set-up.
    AskReport,
    SaveReport(PathBuf, Language),
}
