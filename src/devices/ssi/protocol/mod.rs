//! SSI: frames of any layout, the encoder families in the manual, and their timing limits.
//!
//! "The manual" is SICK, *SSI Schnittstellenbeschreibung*, and "reference" is the project's reference. The bit diagrams
//! of the manual are not available, so the layouts follow its text, which numbers the clocks from 1.

#![warn(missing_docs)]

mod code;
mod descriptor;
mod edges;
mod explain;
mod export;
mod family;
mod find;
mod finding_counts;
mod frame_spec;
mod frame_text;
mod layout;
mod range;
mod spec;
mod timing;

/// Keyword for SSI encoders on the command line, in profiles and in stored data.
pub const KIND: &str = "ssi";

pub use code::{Code, CodeError, PositionCode, gray_to_binary, to_gray};
pub use descriptor::{BitMeaning, ErrorBit, FrameDescriptor, GrayCoverage, Parity, Pattern, Repeat, Word};
pub use edges::{BurstError, ExtractedFrames, LineLevels, extract_frames};
pub use explain::{Cell, FrameFinding, Role};
pub use export::{
    ExportText, FormatError, SettingMeaning, TranslateFn, UnsupportedModuleFeature, UnsupportedProperty,
    WordWidthError, bit_table, english_text, frame_drawing, from_linuxcnc, generate_c99, scl_source, settings_sheet,
    structured_text, structured_text_32, timing_drawing, to_linuxcnc,
};
pub use family::{
    Alignment, ErrorPlace, Families, Family, FamilyError, FamilyProblem, Frame, ResolvedFrame, SettingAdvice,
    SettingName, Settings, SettingsError, Signal, StepLimits,
};
pub use find::{ClassEvidence, LayoutClass, LayoutProposal, OpenQuestion, Search, UncertaintyReason, find};
pub use finding_counts::{CountedFinding, FindingCounts};
pub use frame_text::{FrameTextError, frame_bits, parse_frame};
#[cfg(test)]
pub(crate) use layout::any_layouts;
pub use layout::{ClockUse, Flags, FrameReading, Layout, LayoutError, RepeatableElement, WordOperation};
pub use range::{Direction, Fraction, Location, Range, RangeError};
pub use spec::SpecError;
pub use timing::{
    AnySteps, AsynchronousTimes, ReadConditions, SamplingMoment, SynchronousTimes, Times, Timing, Warning,
};
