//! What can be wished of every device, and what its kind makes of it.

use std::path::PathBuf;
use std::time::Duration;

use super::AnyDevice;
use crate::app::Tab;
use crate::app::action::Action;
use crate::app::studio::SessionId;
use crate::devices::biss::state as biss;
use crate::devices::hiperdrive::state as hiperdrive;
use crate::devices::hiperface::state as hiperface;
use crate::devices::interbus::state as interbus;
use crate::devices::ssi::state as ssi;

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

/// A wish among the actions of a kind, which call it by the same name.
macro_rules! own {
    ($kind:ident, $wish:expr) => {
        match $wish {
            Wish::Reconnect => $kind::Action::Reconnect,
            Wish::Read => $kind::Action::Read,
            Wish::AskSave => $kind::Action::AskSave,
            Wish::Review => $kind::Action::Review,
            Wish::Poll(interval) => $kind::Action::Poll(interval),
            Wish::ReadPosition => $kind::Action::ReadPosition,
            Wish::Undo => $kind::Action::Undo,
            Wish::Redo => $kind::Action::Redo,
            Wish::RevertAll => $kind::Action::RevertAll,
            Wish::Restore(path) => $kind::Action::Restore(path),
            Wish::WriteInto(target) => $kind::Action::WriteInto(target),
        }
    };
}

impl AnyDevice {
    /// What is to be asked of the studio for a wish.
    pub fn wish(&self, wish: Wish) -> Action {
        let id = self.id();
        match self.tab() {
            Tab::Hiperface | Tab::Signals => Action::Hiperface(id, own!(hiperface, wish)),
            Tab::Biss => Action::Biss(id, own!(biss, wish)),
            Tab::Ssi => Action::Ssi(id, own!(ssi, wish)),
            Tab::Interbus => Action::Interbus(id, own!(interbus, wish)),
            Tab::Hiperdrive => Action::Hiperdrive(id, own!(hiperdrive, wish)),
        }
    }
}
