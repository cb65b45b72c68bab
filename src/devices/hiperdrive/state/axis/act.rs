//! The user's actions in the set-up of an axis, and the requests to the device that follow.

use std::path::PathBuf;

use super::{Entries, TestTarget};
use crate::app::Language;

/// A request to the device.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum DriveRequest {
    /// Write parameters, by the numbers of drive 1, through a plan that does not save.
    Try(Vec<(u16, i64)>),
    /// Set the position at the present place of the drive, without saving it.
    SetPosition(i32),
    /// Confirm the limits for the user.
    ConfirmLimits,
    /// Move the drive slowly.
    Move(i32),
    /// Open the cyclic connection.
    Take,
    /// Close the cyclic connection.
    Give,
    /// Save everything.
    Save,
    /// Write the previous values back, without saving them.
    Restore(Vec<(u16, i64)>),
    /// Acknowledge a fault.
    Acknowledge,
    /// Note that the supply was off, as stated by the user.
    BelieveRestart,
    /// Switch the virtual device's supply off and on.
    PowerCycle,
}

/// A button, besides those that move while they are held.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Button {
    /// The task of the step: request, write, save.
    Do,
    /// Confirm the limits.
    Confirm,
    /// Widen the limits to the travel of the drive.
    Widen,
    /// Start a test move.
    Go(TestTarget),
    /// Take control over the cyclic connection.
    Take,
    /// Give up control.
    Give,
    /// Switch the virtual supply off and on.
    PowerCycle,
    /// State that the supply was off.
    Restarted,
    /// Acknowledge the fault of the drive.
    Acknowledge,
    /// Restore the saved values.
    Recall,
}

/// An action of the user in the run.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum AxisAction {
    /// Begin it, or begin it again.
    Begin,
    /// Something was typed.
    Edit(Box<Entries>),
    Press(Button),
    /// Take the present position as the limit of the step.
    TakePlace,
    /// Go to the next step.
    Next,
    /// Skip this step.
    Skip,
    /// Go to the previous step.
    Back,
    /// Cancel: the drive stops.
    Cancel,
    /// Ask where to save the report of a finished run.
    AskReport,
    SaveReport(PathBuf, Language),
}
