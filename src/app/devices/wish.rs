//! What can be wished of every device, and what its kind makes of it.

use std::path::PathBuf;
use std::time::Duration;

use super::AnyDevice;
use crate::app::action::Action;
use crate::app::studio::SessionId;
use crate::app::{biss, hiperface};

/// What can be wished of every device.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Wish {
    /// Open the link again.
    Reconnect,
    /// Read everything again.
    Read,
    /// Ask where to save a profile.
    AskSave,
    /// Show what writing the edits would do.
    Review,
    /// Read the position all the time, or no more.
    Poll(Option<Duration>),
    /// Read the position once.
    ReadPosition,
    /// Take the last edit back.
    Undo,
    /// Do it again.
    Redo,
    /// Take all edits back.
    RevertAll,
    /// Show what restoring a backup would do.
    Restore(PathBuf),
    /// Show what writing this profile into a connected device would do.
    WriteInto(SessionId),
}

impl AnyDevice {
    /// What is to be asked of the studio for a wish.
    pub fn wish(&self, wish: Wish) -> Action {
        match self {
            AnyDevice::Hiperface(own) => {
                use hiperface::Action as Own;
                let action = match wish {
                    Wish::Reconnect => Own::Reconnect,
                    Wish::Read => Own::Read,
                    Wish::AskSave => Own::AskSave,
                    Wish::Review => Own::Review,
                    Wish::Poll(interval) => Own::Poll(interval),
                    Wish::ReadPosition => Own::ReadPosition,
                    Wish::Undo => Own::Undo,
                    Wish::Redo => Own::Redo,
                    Wish::RevertAll => Own::RevertAll,
                    Wish::Restore(path) => Own::Restore(path),
                    Wish::WriteInto(target) => Own::WriteInto(target),
                };
                Action::Hiperface(own.session.id, action)
            }
            AnyDevice::Biss(own) => {
                use biss::Action as Own;
                let action = match wish {
                    Wish::Reconnect => Own::Reconnect,
                    Wish::Read => Own::Read,
                    Wish::AskSave => Own::AskSave,
                    Wish::Review => Own::Review,
                    Wish::Poll(interval) => Own::Poll(interval),
                    Wish::ReadPosition => Own::ReadPosition,
                    Wish::Undo => Own::Undo,
                    Wish::Redo => Own::Redo,
                    Wish::RevertAll => Own::RevertAll,
                    Wish::Restore(path) => Own::Restore(path),
                    Wish::WriteInto(target) => Own::WriteInto(target),
                };
                Action::Biss(own.session.id, action)
            }
        }
    }
}
