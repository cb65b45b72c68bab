//! The user's actions in the set-up of an axis, and the requests to the device that follow.

use std::path::PathBuf;

use super::{Entries, TestTarget};
use crate::app::Language;

/// A request to the device.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum DriveRequest {
    /// Parameters, by the numbers of drive 1, are written through a plan that does not save.
    Try(Vec<(u16, i64)>),
    /// The place where the drive stands gets this position, which is not saved.
    SetPosition(i32),
    /// The user has confirmed the limits.
    ConfirmLimits,
    /// The drive moves slowly.
    Move(i32),
    /// The cyclic connection is opened.
    Take,
    /// It is closed.
    Give,
    /// Everything is saved.
    Save,
    /// Writes the previous values back, without saving them.
    Restore(Vec<(u16, i64)>),
    /// Its fault is acknowledged.
    Acknowledge,
    /// A person says that the supply was off.
    BelieveRestart,
    /// The virtual device's supply goes and comes back.
    PowerCycle,
}

/// A button, besides those that move while they are held.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Button {
    /// The task of the step: request, write, save.
    Do,
    /// The limits are right.
    Confirm,
    /// The limits are to be as wide as the drive turns.
    Widen,
    /// A test move.
    Go(TestTarget),
    /// The cyclic connection.
    Take,
    /// It is closed.
    Give,
    /// The virtual supply.
    PowerCycle,
    /// The supply was off, as a person says.
    Restarted,
    /// The fault of the drive.
    Acknowledge,
    /// Back to what was saved.
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
    /// The place where the axis is becomes the limit of the step.
    TakePlace,
    /// To the next step.
    Next,
    /// To the next one without this one.
    Skip,
    /// To the one before.
    Back,
    /// End it: the drive stops.
    Cancel,
    /// Ask where to save the report of a run that is over.
    AskReport,
    SaveReport(PathBuf, Language),
}
