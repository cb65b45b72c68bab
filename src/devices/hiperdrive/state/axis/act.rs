//! Actions of the user during axis set-up, and the resulting requests to the device.

use std::path::PathBuf;

use super::{Entries, TestTarget};
use crate::app::Language;

/// A request to the device.
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

/// A button other than those that move a drive while held.
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

/// An action of the user in the run.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum AxisAction {
    Begin,
    Edit(Box<Entries>),
    Press(Button),
    /// Adopt the present position as the limit of the step.
    TakePlace,
    /// Go to the next step.
    Next,
    Skip,
    /// Go to the previous step.
    Back,
    Cancel,
    /// Ask where to save the report of a finished run.
    AskReport,
    SaveReport(PathBuf, Language),
}
