//! Content of an SSI profile. [`text`](super::text) defines the file format.

use std::time::Duration;

use crate::devices::ssi::protocol::{Direction, Family, FrameDescriptor, Range, ReadConditions, ResolvedFrame};
use crate::profile::ron_text::UnknownValues;

/// A profile of an SSI encoder: its frame, counting direction, preset and reading settings.
#[derive(Clone, Debug, PartialEq)]
pub struct SsiProfile {
    /// User-defined name. It may be empty.
    pub name: String,
    /// Key of the family that defines timing and other limits, or `None` if the family is unknown.
    pub family: Option<String>,
    /// Description of the frame. A description from a file has been validated.
    pub descriptor: FrameDescriptor,
    /// Direction of rotation in which positions increase.
    pub direction: Direction,
    /// Position at the zero point of the shaft, within the range of the frame.
    pub preset: u64,
    /// Settings with which the encoder is read.
    pub reading: ReadingSettings,
    /// Unknown entries, preserved when the profile is saved.
    pub unknown: UnknownEntries,
}

/// Settings with which an SSI encoder is read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ReadingSettings {
    /// Clock frequency in hertz, from 1000 to 20 000 000.
    pub clock_hz: u32,
    /// Pause between the last clock of a burst and the first of the next, in microseconds, at least 1.
    pub pause_us: u16,
    /// Cable length in metres, or `None` if the cable is not checked.
    pub cable_metres: Option<u16>,
    /// Whether the encoder is in synchronous mode, in which the host's clock triggers the sampling of a position.
    pub synchronous: bool,
}

/// Unknown entries of a profile, grouped by the structure that contains them.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct UnknownEntries {
    pub(super) frame: UnknownValues,
    pub(super) reading: UnknownValues,
    pub(super) parity: UnknownValues,
    pub(super) repeat: UnknownValues,
    /// Unknown entries of error bits, keyed by the name of the bit, so that they stay with the bit if the order
    /// changes.
    pub(super) errors: Vec<(String, UnknownValues)>,
    pub(super) patterns: Vec<(String, UnknownValues)>,
}

impl Default for ReadingSettings {
    /// Returns the clock frequency for 50 m of cable, and a pause that suits every family. An ATM60 needs a pause of
    /// more than 200 µs if its number of steps is not a power of two. See SICK SSI description 2.7 and reference
    /// section 5.
    fn default() -> Self {
        ReadingSettings { clock_hz: 400_000, pause_us: 250, cable_metres: None, synchronous: false }
    }
}

impl SsiProfile {
    /// Creates a profile for a frame without an encoder family. Counting direction and preset have their defaults.
    pub fn new(descriptor: FrameDescriptor) -> Self {
        SsiProfile {
            name: String::new(),
            family: None,
            descriptor,
            direction: Direction::default(),
            preset: 0,
            reading: ReadingSettings::default(),
            unknown: UnknownEntries::default(),
        }
    }

    /// Returns the conditions under which the encoder is read, for a check of the timing limits.
    pub fn read_conditions(&self) -> ReadConditions {
        let ReadingSettings { clock_hz, pause_us, cable_metres, synchronous } = self.reading;
        ReadConditions {
            clocks: self.descriptor.clocks,
            clock_hz: clock_hz.into(),
            pause: Duration::from_micros(pause_us.into()),
            cable_metres: cable_metres.map(f64::from),
            synchronous,
            any_steps: !matches!(self.descriptor.range, Range::Bits { .. } | Range::Length { .. }),
        }
    }

    /// Creates a profile from a family and the frame that its settings yield.
    pub fn from_family(family: &Family, resolved: &ResolvedFrame) -> Self {
        SsiProfile {
            family: Some(family.key.clone()),
            direction: resolved.direction,
            preset: resolved.preset,
            ..Self::new(resolved.layout.descriptor().clone())
        }
    }
}
