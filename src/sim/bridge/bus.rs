//! What one frame of BiSS or SSI carries: the bits that the adapter clocks out of the encoder, whatever it takes them
//! for. Damaged wires and noise are here.

use fastrand::Rng;

use super::config::{Config, Line, SsiEncoder};
use super::trouble::Trouble;
use crate::protocol::bridge::BissStatus;
use crate::protocol::ssi::Flags;
use crate::sim::biss::Encoder;
use crate::units::Moment;

/// The wires with their encoder.
#[derive(Clone)]
pub(super) struct Bus {
    pub(super) encoder: Encoder,
    line: Line,
    noise: f64,
    ssi: Option<SsiEncoder>,
    troubles: Vec<Trouble>,
    /// The last SSI word.
    transferred: Option<Moment>,
    rng: Rng,
}

impl Bus {
    pub(super) fn new(config: &Config) -> Self {
        Bus {
            encoder: Encoder::new(&config.encoder),
            line: config.line,
            noise: config.noise,
            ssi: config.ssi.clone(),
            troubles: config.troubles.clone(),
            transferred: None,
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
        // Without power neither encoder sends.
        let place = self.encoder.reading(at).map(|_| self.encoder.shaft_place(at));
        match (self.line, place, &self.ssi) {
            (Line::Low, _, _) => 0,
            (Line::Good, Some(place), Some(ssi)) => {
                let frame = clocked(self.ssi_frame(ssi, place, at), ssi.layout.clocks(), bits);
                self.transferred = Some(at);
                self.damaged(frame, bits)
            }
            _ => ones(bits),
        }
    }

    /// The frame of an SSI encoder on the same shaft.
    fn ssi_frame(&self, ssi: &SsiEncoder, (raw, per_turn): (u64, u64), at: Moment) -> u64 {
        let happening = || self.troubles.iter().filter(|trouble| trouble.happens(at, self.transferred));
        if let Some(word) = happening().find_map(Trouble::word) {
            return word;
        }
        let flags = happening().fold(Flags::NONE, |flags, trouble| flags.with(trouble.flag()));
        let range = ssi.layout.descriptor().range;
        let position = range.of_shaft_set(raw, per_turn, ssi.direction, ssi.preset);
        ssi.layout.encode(position, flags).unwrap_or(0)
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
