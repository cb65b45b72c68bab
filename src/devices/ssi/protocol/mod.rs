//! SSI: frames of any layout, the families that the manual describes, and what their times allow.
//!
//! Source: SICK, *SSI Schnittstellenbeschreibung* ("the manual" below; the project's reference of it where a section is
//! named so). The manual's pictures of bits are not to be had; layouts follow its text, which numbers the clocks from 1.

#![warn(missing_docs)]

mod code;
mod descriptor;
mod edges;
mod explain;
mod export;
mod family;
mod find;
mod frame_spec;
mod frame_text;
mod layout;
mod range;
mod spec;
mod tally;
mod timing;

/// The word for this kind of device: on the command line, in profiles, and where something is kept of one.
pub const KIND: &str = "ssi";

pub use code::{Code, CodeError, Coding, gray, ungray};
pub use descriptor::{Coded, Descriptor, ErrorBit, Meaning, Parity, Pattern, Repeat, Word};
pub use edges::{Bursts, Levels, NoBursts, bursts};
pub use explain::{Cell, FrameFinding, Role};
pub use export::{
    ExportText, FormatError, ModuleObstacle, NoFormat, PathStep, Picture, PictureLabel, PictureLength, PictureShape,
    Say, SettingMeaning, WideNumbers, bit_table, c99, english, frame_picture, from_linuxcnc, scl, settings_sheet,
    structured_text, structured_text_32, timing_picture, to_linuxcnc,
};
pub use family::{
    Advice, Align, ErrorPlace, Families, Family, FamilyError, FamilyProblem, Frame, Resolved, SettingName, Settings,
    SettingsError, Signal, StepLimits,
};
pub use find::{Class, Doubt, Evidence, Open, Proposal, Search, find};
pub use frame_text::{FrameTextError, frame_bits, parse_frame};
#[cfg(test)]
pub(crate) use layout::any_layouts;
pub use layout::{AsAWhole, Flags, FrameReading, Layout, LayoutError, Several, Taker};
pub use range::{Direction, Fraction, Location, Range, RangeError};
pub use spec::SpecError;
pub use tally::{Noted, Tally};
pub use timing::{AnySteps, Asynchronous, Reads, Synchronous, Taken, Times, Timing, Warning};
