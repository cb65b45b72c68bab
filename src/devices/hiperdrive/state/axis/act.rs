//! Actions of the user during axis set-up, and the resulting requests to the device.

use std::path::PathBuf;

use super::{Entries, TestTarget};
use crate::app::Language;

#[derive(Clone, Debug, PartialEq, Eq)]
pub enum DriveRequest {
    /// Write parameters, by the numbers of drive 1, through a plan that does not save.
    Try(Vec<(u16, i64)>),
    /// Set the position at the present location of the drive, without saving.
    SetPosition(i32),
    ConfirmLimits,
    Move(i32),
    Take,
    Give,
    Save,
    /// Write the previous values back, without saving.
    Restore(Vec<(u16, i64)>),
    Acknowledge,
    /// Note that the supply was off, as stated by the user.
    BelieveRestart,
    PowerCycle,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Button {
    /// Execute the task of the step: request, write or save.
    Do,
    Confirm,
    /// Widen the limits to the travel of the drive.
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
    Press(Button),
    /// Adopt the present position as the limit of the step.
    TakePlace,
    Next,
    Skip,
    Back,
    Cancel,
    /// Ask where to save the report of a finished run.
    AskReport,
    SaveReport(PathBuf, Language),
}
