//! What one frame of BiSS or SSI carries: the bits that the adapter clocks out of the encoder, whatever it takes them
//! for. Damaged wires and noise are here.

use fastrand::Rng;

use super::config::{Config, Line};
use crate::protocol::biss::Reading;
use crate::protocol::bridge::BissStatus;
use crate::sim::biss::Encoder;
use crate::units::Moment;

/// The wires with their encoder.
#[derive(Clone)]
pub(super) struct Bus {
    pub(super) encoder: Encoder,
    line: Line,
    noise: f64,
    gray: bool,
    rng: Rng,
}

impl Bus {
    /// The SSI encoder: 12 bits of revolutions, 13 within one.
    const SSI_MULTITURN: u8 = 12;
    const SSI_SINGLETURN: u8 = 13;
    const SSI_BITS: u8 = Self::SSI_MULTITURN + Self::SSI_SINGLETURN;

    pub(super) fn new(config: &Config) -> Self {
        Bus {
            encoder: Encoder::new(&config.encoder),
            line: config.line,
            noise: config.noise,
            gray: config.gray,
            rng: Rng::with_seed(config.encoder.seed()),
        }
    }

    /// The encoder's registers can be asked at `now`.
    pub(super) fn answers(&mut self, now: Moment) -> bool {
        self.line == Line::Good && self.encoder.answers(now)
    }

    /// `bits` bits behind the control bit of a BiSS frame taken at a moment.
    pub(super) fn biss(&mut self, at: Moment, bits: u8) -> (BissStatus, u64) {
        match (self.line, self.encoder.reading(at)) {
            (Line::Low, _) => (BissStatus::STUCK_LOW, 0),
            (Line::High, _) => (BissStatus::STUCK_HIGH, ones(bits)),
            (Line::Open, _) | (Line::Good, None) => (BissStatus::NO_ACKNOWLEDGE, 0),
            (Line::Good, Some(reading)) => {
                let layout = self.encoder.layout();
                let frame = clocked(layout.emit(&reading), layout.bits(), bits);
                (BissStatus::OK, self.damaged(frame, bits))
            }
        }
    }

    /// The first `bits` bits of an SSI word taken at a moment.
    pub(super) fn ssi(&mut self, at: Moment, bits: u8) -> u64 {
        match (self.line, self.encoder.reading(at)) {
            (Line::Low, _) => 0,
            (Line::High | Line::Open, _) | (Line::Good, None) => ones(bits),
            (Line::Good, Some(reading)) => {
                let word = clocked(self.ssi_word(&reading), Self::SSI_BITS, bits);
                self.damaged(word, bits)
            }
        }
    }

    fn ssi_word(&self, reading: &Reading) -> u64 {
        let spare = self.encoder.layout().singleturn_bits().saturating_sub(Self::SSI_SINGLETURN);
        let multiturn = u64::from(reading.multiturn) & ones(Self::SSI_MULTITURN);
        let word = multiturn << Self::SSI_SINGLETURN | u64::from(reading.singleturn >> spare);
        if self.gray { word ^ word >> 1 } else { word }
    }

    /// One bit is inverted in some frames.
    fn damaged(&mut self, frame: u64, bits: u8) -> u64 {
        if bits > 0 && self.rng.f64() < self.noise { frame ^ 1 << self.rng.u8(..bits) } else { frame }
    }
}

/// `wanted` bits of a frame of `bits` bits, the first first; behind its end the line is low.
fn clocked(frame: u64, bits: u8, wanted: u8) -> u64 {
    let shifted =
        if wanted >= bits { frame.checked_shl((wanted - bits).into()) } else { Some(frame >> (bits - wanted)) };
    shifted.unwrap_or(0)
}

fn ones(bits: u8) -> u64 {
    u64::MAX.checked_shr(64 - u32::from(bits.min(64))).unwrap_or(0)
}
