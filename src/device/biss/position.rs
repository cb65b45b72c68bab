//! The position as a person or a plot takes it.

use crate::protocol::biss::{Layout, Reading};
use crate::units::Moment;

/// A position as it was read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PositionReading {
    /// When the encoder sampled it.
    pub at: Moment,
    /// As it came: the frame with its CRC, or the word over the configuration pin.
    pub raw: u64,
    /// Revolutions, as many bits as there are.
    pub turns: u32,
    /// Place within the revolution, in parts of 2 to the power of [`singleturn_bits`](Self::singleturn_bits).
    pub steps: u32,
    /// The encoder says that the position is invalid; `None` where this way does not tell.
    pub error: Option<bool>,
    /// The encoder warns; `None` where this way does not tell.
    pub warning: Option<bool>,
    /// Frames with a wrong CRC that came before it, since the last reading.
    pub crc_errors: u32,
    /// Bits of the revolutions, 0…32.
    pub multiturn_bits: u8,
    /// Bits within a revolution, 0…32.
    pub singleturn_bits: u8,
}

impl PositionReading {
    /// A reading at a moment, without anything that only one way tells.
    pub(super) fn new(at: Moment, raw: u64, reading: &Reading, layout: &Layout) -> Self {
        PositionReading {
            at,
            raw,
            turns: reading.multiturn,
            steps: reading.singleturn,
            error: None,
            warning: None,
            crc_errors: 0,
            multiturn_bits: layout.multiturn_bits(),
            singleturn_bits: layout.singleturn_bits(),
        }
    }

    /// Revolutions and place as one number of steps.
    pub const fn position(&self) -> u64 {
        (self.turns as u64) << self.singleturn_bits | self.steps as u64
    }

    /// Degrees within the revolution, from 0 up to 360.
    pub fn degrees(&self) -> f64 {
        f64::from(self.steps) * 360.0 / (1u64 << self.singleturn_bits) as f64
    }

    /// Nothing says that it is wrong.
    pub fn is_valid(&self) -> bool {
        self.error != Some(true)
    }
}
