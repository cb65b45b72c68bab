//! What can be asked of a BiSS encoder that is shown.

use std::path::PathBuf;
use std::time::Duration;

use crate::app::studio::SessionId;
use crate::protocol::biss::{Register, RegisterAddress};

/// Something in the BiSS tab.
pub enum Action {
    /// Open the link again, after it was lost or could not be opened.
    Reconnect,
    /// Read everything again; edits stay.
    Read,
    /// Read errors, warnings, temperature and mode.
    ReadStatus,
    /// Read the position once.
    ReadPosition,
    /// Read the position all the time, or no more.
    Poll(Option<Duration>),
    /// While the position is read all the time, read this too, or no more.
    Watch(Box<Register>, bool),
    /// Read a bank; `None`: the direct registers.
    ReadBank(Option<u8>),
    /// Read a bank that is in sight and was never read, when nothing else is to be done.
    SeeBank(Option<u8>),
    /// Read an area of plain data, by its first bank.
    ReadArea(u8),
    /// Edit bytes of plain data.
    Put {
        /// First byte.
        start: RegisterAddress,
        /// The bytes.
        bytes: Vec<u8>,
    },
    /// Take the last edit back.
    Undo,
    /// Do it again.
    Redo,
    /// Take all edits back.
    RevertAll,
    /// Take the edits of a range back.
    Revert {
        /// First byte.
        start: RegisterAddress,
        /// How many.
        count: usize,
    },
    /// Show what writing the edits would do.
    Review,
    /// Turn the virtual encoder's shaft, in revolutions a minute.
    Turn(f64),
    /// Ask where to save the profile.
    AskSave,
    /// Save the profile.
    Save(PathBuf),
    /// Show what restoring a backup would do.
    Restore(PathBuf),
    /// Show what writing this profile into a connected encoder would do.
    WriteInto(SessionId),
}
