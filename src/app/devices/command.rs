//! Commands that every device supports, regardless of its kind.

use std::path::PathBuf;
use std::time::Duration;

use super::AnyDevice;
use crate::app::action::Action;
use crate::app::studio::SessionId;

#[derive(Clone, Debug, PartialEq, Eq)]
pub enum DeviceCommand {
    Reconnect,
    /// Read everything again.
    Read,
    AskSave,
    Review,
    /// Start polling the position, or stop polling.
    Poll(Option<Duration>),
    /// Read the position once.
    ReadPosition,
    Undo,
    Redo,
    RevertAll,
    Restore(PathBuf),
    AskRestore,
    AskCompare,
    Compare(PathBuf),
    /// Show the effect of writing this profile to a connected device.
    WriteInto(SessionId),
}

impl AnyDevice {
    pub fn command(&self, command: DeviceCommand) -> Action {
        Action::Command(self.id(), command)
    }
}
