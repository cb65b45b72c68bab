//! Commands that every kind of device supports.

use std::path::PathBuf;
use std::time::Duration;

use super::AnyDevice;
use crate::app::action::Action;
use crate::app::comparison::ComparisonSource;
use crate::app::studio::SessionId;
use crate::store::{AssetName, Entry};

#[derive(Clone, Debug, PartialEq, Eq)]
pub enum DeviceCommand {
    Reconnect,
    /// Read everything again.
    Read,
    AskSave,
    Review,
    /// Poll the position at this interval, or stop polling.
    Poll(Option<Duration>),
    ReadPosition,
    Undo,
    Redo,
    RevertAll,
    /// Assign the device to an asset in the logbook.
    Assign(AssetName),
    Restore(PathBuf),
    /// Open the review of undoing a write recorded in the logbook.
    UndoWrite(Box<Entry>),
    AskRestore,
    AskCompare,
    AskReport,
    /// Compare the device with this source, which becomes the left side.
    Compare(Box<ComparisonSource>),
    /// Open the review of writing this profile to the device of the given session.
    WriteInto(SessionId),
}

impl AnyDevice {
    pub fn command(&self, command: DeviceCommand) -> Action {
        Action::Command(self.id(), command)
    }
}
