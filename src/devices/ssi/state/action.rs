//! Actions of the selected SSI encoder or its layout.

use std::path::PathBuf;

use super::design::Edit;
use super::export::Format;
use super::form::{Field, Input};
use super::strip::Handle;
use crate::app::{DeviceAction, Language};

/// Something in the SSI tab.
pub enum SsiAction {
    Check,
    Edit(Box<Edit>),
    /// Enter a value into a row of its form.
    Enter(Field, Input),
    /// Move a part of its frame to a clock, or as near to it as possible.
    Move(Handle, u8),
    /// Add an error bit.
    AddErrorBit,
    /// Remove the error bit of this number.
    RemoveErrorBit(usize),
    Try(Try),
    /// Set the clocks of the words during a search; `None`: those of the layout.
    SetClocks(Option<u8>),
    /// Search for the layout of the words read last.
    Find,
    /// Ask for a file with frames, to search for their layout.
    AskFrames,
    /// Search for the layout of the frames in a file.
    FindIn(PathBuf),
    /// Discard the result of the search.
    ForgetSearch,
    /// Take a layout from the result: the number of its class, and its place in that.
    Take(usize, usize),
    /// Forget the error bits reported so far.
    ForgetErrors,
    /// Ask where to write the layout for other programs, in this language.
    AskExport(Format, Language),
    /// Write the layout for other programs, in this language.
    Export(Format, Language, PathBuf),
    AskSaveFrames,
    SaveFrames(PathBuf),
    SendLayout,
    /// Turn the virtual encoder's shaft, in revolutions per minute.
    Turn(f64),
}

/// A frame to try a layout with.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Try {
    Position(u64),
    /// The frame of a turn and the steps within it.
    Place(u64, u64),
    /// Frame as text.
    Bits(String),
    /// The other value for the bit on this clock, counted from 1.
    Toggle(u8),
    /// The word that was read last, again and again.
    Live,
}

impl DeviceAction for SsiAction {}
