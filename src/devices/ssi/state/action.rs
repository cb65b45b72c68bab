//! The actions of an SSI encoder that is shown, or of its layout.

use std::path::PathBuf;

use super::design::Edit;
use super::export::Format;
use super::form::{Field, Input};
use super::strip::Handle;
use crate::app::{DeviceAction, Language};

/// Something in the SSI tab.
pub enum SsiAction {
    /// The device check.
    Check,
    /// Change the layout.
    Edit(Box<Edit>),
    /// Put something into a row of its form.
    Enter(Field, Input),
    /// Move something in its frame to a clock, or as near to it as it can be.
    Move(Handle, u8),
    /// One more error bit.
    AddErrorBit,
    /// No error bit of this number any more.
    RemoveErrorBit(usize),
    /// Try the layout with something.
    Try(Try),
    /// Words have so many clocks while a layout is looked for; `None`: as many as the layout.
    SetClocks(Option<u8>),
    /// Look for the layout of the words that were read last.
    Find,
    /// Ask for a file with frames, to look for their layout.
    AskFrames,
    /// Look for the layout of the frames in a file.
    FindIn(PathBuf),
    /// Forget what was found.
    ForgetSearch,
    /// Take a layout that was found: the number of its class, and its place in that.
    Take(usize, usize),
    /// Forget what error bits have said.
    ForgetErrors,
    /// Ask where to write the layout for other programs, in this language.
    AskExport(Format, Language),
    /// Write the layout for other programs, in this language.
    Export(Format, Language, PathBuf),
    /// Ask where to write the words that are kept.
    AskSaveFrames,
    /// Write the words that are kept.
    SaveFrames(PathBuf),
    /// Let the virtual encoder send this layout.
    SendLayout,
    /// Turn the virtual encoder's shaft, in revolutions a minute.
    Turn(f64),
}

/// A frame to try a layout with.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Try {
    /// The frame of a position.
    Position(u64),
    /// The frame of a turn and the steps within it.
    Place(u64, u64),
    /// A frame as it is written down.
    Bits(String),
    /// The other value for the bit on this clock, counted from 1.
    Toggle(u8),
    /// The word that was read last, again and again.
    Live,
}

impl DeviceAction for SsiAction {}
