//! Saved content of an SSI encoder. [`text`](super::text) defines the file format.

use std::time::Duration;

use crate::devices::ssi::protocol::{Descriptor, Direction, Family, Range, Reads, ResolvedFrame};
use crate::profile::ron_text::Unknown;

/// A profile of an SSI encoder.
#[derive(Clone, Debug, PartialEq)]
pub struct SsiProfile {
    /// User-defined name; may be empty.
    pub name: String,
    /// Key of the family whose times and limits apply, or `None` if unknown.
    pub family: Option<String>,
    /// Frame layout, which has been validated if it was read from a file.
    pub descriptor: Descriptor,
    /// Counting direction.
    pub direction: Direction,
    /// Position at the zero of the shaft, within the range of the frame.
    pub preset: u64,
    /// Reading settings.
    pub reading: ReadingSettings,
    /// Unknown entries, preserved when the profile is saved.
    pub unknown: UnknownEntries,
}

/// Settings for reading an encoder.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ReadingSettings {
    /// Clock in hertz, 1000…20 000 000.
    pub clock_hz: u32,
    /// Pause between the last clock of a burst and the first of the next, in microseconds, at least 1.
    pub pause_us: u16,
    /// Cable length in metres, or `None` to skip the check.
    pub cable_metres: Option<u16>,
    /// Whether the encoder samples its position when the host clocks.
    pub synchronous: bool,
}

/// Unknown entries by structure.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct UnknownEntries {
    pub(super) frame: Unknown,
    pub(super) reading: Unknown,
    pub(super) parity: Unknown,
    pub(super) repeat: Unknown,
    /// Unknown entries keyed by error bit name, so that reordering the bits does not mix them up.
    pub(super) errors: Vec<(String, Unknown)>,
    pub(super) patterns: Vec<(String, Unknown)>,
}

impl Default for ReadingSettings {
    /// Returns the clock rate for 50 m of cable (SICK SSI description 2.7), and a pause that suits every family,
    /// including an ATM60 with any number of steps (more than 200 µs, reference section 5).
    fn default() -> Self {
        ReadingSettings { clock_hz: 400_000, pause_us: 250, cable_metres: None, synchronous: false }
    }
}

impl SsiProfile {
    /// Creates a profile for a frame without a family, with default counting.
    pub fn new(descriptor: Descriptor) -> Self {
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

    /// Returns the parameters for checking the timing of the frame.
    pub fn reads(&self) -> Reads {
        let ReadingSettings { clock_hz, pause_us, cable_metres, synchronous } = self.reading;
        Reads {
            clocks: self.descriptor.clocks,
            clock_hz: clock_hz.into(),
            pause: Duration::from_micros(pause_us.into()),
            cable_metres: cable_metres.map(f64::from),
            synchronous,
            any_steps: !matches!(self.descriptor.range, Range::Bits { .. } | Range::Length { .. }),
        }
    }

    /// Creates a profile with the settings resolved for a family.
    pub fn of_family(family: &Family, resolved: &ResolvedFrame) -> Self {
        SsiProfile {
            family: Some(family.key.clone()),
            direction: resolved.direction,
            preset: resolved.preset,
            ..Self::new(resolved.layout.descriptor().clone())
        }
    }
}
