//! What a person does in the set-up of an axis, and what that asks of the device.

use std::path::PathBuf;

use super::{Entries, TestTarget};
use crate::app::Language;

/// What is to be done for it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Ask {
    /// Parameters, by the numbers of drive 1, are written through a plan that does not save.
    Try(Vec<(u16, i64)>),
    /// The place where the drive stands gets this position, which is not saved.
    SetPosition(i32),
    /// Somebody has seen what the limits are.
    ConfirmLimits,
    /// The drive moves slowly.
    Move(i32),
    /// The cyclic connection is opened.
    Take,
    /// It is closed.
    Give,
    /// Everything is saved.
    Save,
    /// What it was before is written back, and not saved.
    Restore(Vec<(u16, i64)>),
    /// Its fault is acknowledged.
    Acknowledge,
    /// A person says that the supply was off.
    BelieveRestart,
    /// The virtual device's supply goes and comes back.
    PowerCycle,
}

/// What can be pressed, beside what moves while it is held.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Button {
    /// What the step is about: request, write, save.
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

/// What a person does in the run.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Action {
    /// Begin it, or begin it again.
    Begin,
    /// Something was typed.
    Edit(Box<Entries>),
    /// A button.
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
    /// Save it, in this language.
    SaveReport(PathBuf, Language),
}
