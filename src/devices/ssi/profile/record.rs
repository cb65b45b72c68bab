//! The saved content of an SSI encoder. Its text is in [`text`](super::text).

use std::time::Duration;

use crate::devices::ssi::protocol::{Descriptor, Direction, Family, Range, Reads, Resolved};
use crate::profile::ron_text::Unknown;

/// Profile of an SSI encoder.
#[derive(Clone, Debug, PartialEq)]
pub struct SsiProfile {
    /// The user's name for it; may be empty.
    pub name: String,
    /// Key of the family whose times and limits apply; `None`: they are not known.
    pub family: Option<String>,
    /// The frame. One read from a file is known to be valid.
    pub descriptor: Descriptor,
    /// Direction in which positions grow.
    pub direction: Direction,
    /// The position at the shaft's zero, within the frame's range.
    pub preset: u64,
    /// How it is read.
    pub reading: ReadingSettings,
    /// Entries that this program does not know.
    pub unknown: UnknownEntries,
}

/// Settings for reading an encoder.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ReadingSettings {
    /// Clock in hertz, 1000…20 000 000.
    pub clock_hz: u32,
    /// From the last clock of a burst to the first of the next, in microseconds, at least 1.
    pub pause_us: u16,
    /// Cable in metres; `None`: not checked.
    pub cable_metres: Option<u16>,
    /// Positions are made when the host clocks.
    pub synchronous: bool,
}

/// Unknown entries, by their structure, which are preserved.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct UnknownEntries {
    pub(super) frame: Unknown,
    pub(super) reading: Unknown,
    pub(super) parity: Unknown,
    pub(super) repeat: Unknown,
    /// By the name of the error bit, to stay with it.
    pub(super) errors: Vec<(String, Unknown)>,
    /// By the name of the pattern.
    pub(super) patterns: Vec<(String, Unknown)>,
}

impl Default for ReadingSettings {
    /// Returns a clock for 50 m of cable (SICK SSI description 2.7), and a pause after which every family is ready,
    /// including an ATM60 with any number of steps (more than 200 µs, reference section 5).
    fn default() -> Self {
        ReadingSettings { clock_hz: 400_000, pause_us: 250, cable_metres: None, synchronous: false }
    }
}

impl SsiProfile {
    /// Creates the profile of a frame without a family, with the default counting.
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

    /// Returns how its frame is read, for checking the times.
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

    /// Returns the settings resolved for a family.
    pub fn of_family(family: &Family, resolved: &Resolved) -> Self {
        SsiProfile {
            family: Some(family.key.clone()),
            direction: resolved.direction,
            preset: resolved.preset,
            ..Self::new(resolved.layout.descriptor().clone())
        }
    }
}
