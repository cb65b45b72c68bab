//! The bits of a BiSS or SSI frame that the adapter clocks out of the encoder, including simulated noise and wiring
//! faults.

use fastrand::Rng;

use super::attached::{BissDevice, SsiDevice};
use super::config::{self, Config, EncoderWiring, Shared};
use super::shaft::Shaft;
use crate::buses::bridge::protocol::BissStatus;
use crate::sim::Motor;
use crate::units::Moment;

#[derive(Clone)]
pub(super) struct Bus {
    pub(super) biss: Option<Box<dyn BissDevice>>,
    pub(super) ssi: Option<Box<dyn SsiDevice>>,
    /// Shaft of an adapter whose BiSS connector has no device.
    shaft: Shaft,
    pub(super) is_supplied: bool,
    line: EncoderWiring,
    noise: f64,
    rng: Rng,
}

impl Bus {
    pub(super) fn new(config: &Config, shared: &Shared, shaft: &config::Shaft) -> Self {
        Bus {
            biss: None,
            ssi: None,
            shaft: Shaft::with_speed(shaft.rpm),
            is_supplied: true,
            line: config.line,
            noise: config.noise,
            rng: Rng::with_seed(shared.seed),
        }
    }

    pub(super) fn motor(&self) -> Motor {
        self.biss.as_ref().map_or_else(|| self.shaft.motor().clone(), |device| device.motor())
    }

    /// Changes the speed of the shaft from `now` on.
    pub(super) fn set_rpm(&mut self, now: Moment, rpm: f64) {
        match &mut self.biss {
            Some(device) => device.set_rpm(now, rpm),
            None => self.shaft.motor().set_rpm(rpm),
        }
        self.follow_motor(now);
    }

    /// Changes the speed of the adapter's shaft to that of its motor from `now` on. An attached device updates its own
    /// shaft at the next access.
    pub(super) fn follow_motor(&mut self, now: Moment) {
        self.shaft.follow_motor(now);
    }

    /// Returns the shaft position in steps and the number of steps per revolution, or `None` if the power is off.
    fn shaft_position(&mut self, at: Moment) -> Option<(u64, u64)> {
        match &mut self.biss {
            Some(device) => device.shaft_position(at),
            None => self.is_supplied.then(|| self.shaft.position_at(at)),
        }
    }

    /// Returns the device if its registers can be read at `now`.
    pub(super) fn readable_device(&mut self, now: Moment) -> Option<&mut Box<dyn BissDevice>> {
        let is_good = self.line == EncoderWiring::Good;
        self.biss.as_mut().filter(|_| is_good)?.can_access_registers(now).then_some(())?;
        self.biss.as_mut()
    }

    /// Returns the given number of bits after the control bit of the BiSS frame that is latched at `at`.
    pub(super) fn frame_at(&mut self, at: Moment, bits: u8) -> (BissStatus, u64) {
        match (self.line, self.biss.as_mut().and_then(|device| device.frame_at(at))) {
            (EncoderWiring::Low, _) => (BissStatus::STUCK_LOW, 0),
            (EncoderWiring::High, _) => (BissStatus::STUCK_HIGH, low_bits_mask(bits)),
            (EncoderWiring::Open, _) | (EncoderWiring::Good, None) => (BissStatus::NO_ACKNOWLEDGE, 0),
            (EncoderWiring::Good, Some((frame, own))) => {
                (BissStatus::OK, self.corrupt_frame(first_bits_on_line(frame, own, bits), bits))
            }
        }
    }

    /// Returns the given number of bits of the SSI word that is latched at `at`.
    pub(super) fn word_at(&mut self, at: Moment, bits: u8) -> u64 {
        // Without power, neither of the encoders sends.
        let place = self.shaft_position(at);
        match (self.line, place, &mut self.ssi) {
            (EncoderWiring::Low, _, _) => 0,
            (EncoderWiring::Good, Some(place), Some(ssi)) => {
                let (word, own) = ssi.word_at(at, place);
                self.corrupt_frame(first_bits_on_line(word, own, bits), bits)
            }
            _ => low_bits_mask(bits),
        }
    }

    /// Inverts one bit in the configured fraction of frames.
    fn corrupt_frame(&mut self, frame: u64, bits: u8) -> u64 {
        if bits > 0 && self.rng.f64() < self.noise { frame ^ 1 << self.rng.u8(..bits) } else { frame }
    }
}

/// Returns the first `wanted` bits of a frame with `bits` bits. After the end of the frame, the line is low.
fn first_bits_on_line(frame: u64, bits: u8, wanted: u8) -> u64 {
    let shifted =
        if wanted >= bits { frame.checked_shl((wanted - bits).into()) } else { Some(frame >> (bits - wanted)) };
    shifted.unwrap_or(0)
}

fn low_bits_mask(bits: u8) -> u64 {
    u64::MAX.checked_shr(64 - u32::from(bits.min(64))).unwrap_or(0)
}
