//! The shaft or scale that the encoder measures. Its position is an exact function of time, and so are its sine and
//! cosine signals (manual, "Position lesen", "Position setzen"). The position word is the mechanical position plus an
//! offset. The analogue signals depend only on the mechanical position. As in a real encoder, setting a position may
//! therefore change the phase between position word and signals.

use std::f64::consts::TAU;

use crate::devices::hiperface::protocol::{Geometry, STEPS_PER_PERIOD};
use crate::units::Moment;

/// A shaft that turns at constant speed.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Shaft {
    geometry: Geometry,
    rpm: f64,
    /// Mechanical position at the time `since`, in steps.
    mechanical_steps: f64,
    since: Moment,
    offset: u64,
}

impl Shaft {
    /// Speed in 1/min above which the encoder has no absolute position (from data sheets).
    pub(super) const MAX_RPM: f64 = 6000.0;
    /// Number of values of the 32-bit position word.
    const WORD: u64 = 1 << 32;
    /// Analogue counts per volt, with 10 bits for 5 V.
    const COUNTS_PER_VOLT: f64 = 1023.0 / 5.0;
    const MEAN_VOLTS: f64 = 2.5;
    const AMPLITUDE_VOLTS: f64 = 0.5;

    pub(super) fn new(geometry: Geometry, position: u32, rpm: f64) -> Self {
        Shaft { geometry, rpm, mechanical_steps: f64::from(position), since: Moment::START, offset: 0 }
    }

    pub(super) fn set_rpm(&mut self, now: Moment, rpm: f64) {
        (self.mechanical_steps, self.since) = (self.steps_at(now), now);
        self.rpm = rpm;
    }

    pub(super) fn is_too_fast(&self) -> bool {
        self.rpm.abs() > Self::MAX_RPM
    }

    pub(super) fn can_reach(&self, position: u32) -> bool {
        u64::from(position) < self.position_count()
    }

    pub(super) fn position(&self, at: Moment) -> u32 {
        let word = (self.integer_steps(at) + self.offset) % self.position_count();
        // The range is at most 2³².
        u32::try_from(word).unwrap_or(u32::MAX)
    }

    pub(super) fn set_position(&mut self, at: Moment, position: u32) {
        let range = self.position_count();
        self.offset = (u64::from(position) % range + range - self.integer_steps(at)) % range;
    }

    /// Returns the sine signal in counts, with 10 bits for 5 V. The signal has a mean of 2.5 V and 1 V from peak to
    /// peak, and rises through the mean at the start of a period.
    pub(super) fn sine_at(&self, at: Moment) -> i16 {
        Self::to_counts(self.phase(at).sin())
    }

    /// Returns the cosine signal, scaled like the sine signal.
    pub(super) fn cosine_at(&self, at: Moment) -> i16 {
        Self::to_counts(self.phase(at).cos())
    }

    fn to_counts(signal: f64) -> i16 {
        let volts = Self::MEAN_VOLTS + Self::AMPLITUDE_VOLTS * signal;
        (volts * Self::COUNTS_PER_VOLT) as i16 // between 409 and 614
    }

    fn phase(&self, at: Moment) -> f64 {
        let period = f64::from(STEPS_PER_PERIOD);
        self.steps_at(at) % period / period * TAU
    }

    fn integer_steps(&self, at: Moment) -> u64 {
        self.steps_at(at) as u64 // never negative, and below the range
    }

    /// Returns the mechanical position in steps, from 0 to just below the range.
    fn steps_at(&self, at: Moment) -> f64 {
        // A linear scale has no turns, so `rpm` means periods per minute.
        let steps_per_turn = self.geometry.steps_per_turn().unwrap_or(STEPS_PER_PERIOD.into()) as f64;
        let moved = at.duration_since(self.since).as_secs_f64() * self.rpm / 60.0 * steps_per_turn;
        let range = self.position_count() as f64;
        // rem_euclid may round up to the range itself.
        let place = (self.mechanical_steps + moved).rem_euclid(range);
        if place < range { place } else { 0.0 }
    }

    fn position_count(&self) -> u64 {
        self.geometry.position_count().unwrap_or(Self::WORD).clamp(1, Self::WORD)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::time::Duration;

    const SKM36: Geometry = Geometry::Rotary { periods: 128, turns: 4096 };

    fn at(ms: u64) -> Moment {
        Moment::START + Duration::from_millis(ms)
    }

    #[test]
    fn turning_shaft_reaches_expected_position() {
        let mut shaft = Shaft::new(SKM36, 0, 60.0); // 4096 steps per second
        assert_eq!(shaft.position(at(0)), 0);
        assert_eq!(shaft.position(at(250)), 1024);
        assert_eq!(shaft.position(at(4_096_000)), 0, "after 4096 turns");
        shaft.set_rpm(at(500), -60.0);
        assert_eq!(shaft.position(at(500)), 2048);
        assert_eq!(shaft.position(at(1500)), 0x00FF_F800, "below zero it is at the end of the range");
        assert!(!shaft.is_too_fast());
        shaft.set_rpm(at(1500), -6000.5);
        assert!(shaft.is_too_fast());
    }

    #[test]
    fn set_position_shifts_word_not_signals() {
        let mut shaft = Shaft::new(SKM36, 24, 0.0);
        assert_eq!((shaft.sine_at(at(0)), shaft.cosine_at(at(0))), (409, 511));
        shaft.set_position(at(0), 0);
        assert_eq!(shaft.position(at(9)), 0);
        assert_eq!((shaft.sine_at(at(0)), shaft.cosine_at(at(0))), (409, 511));
        shaft.set_position(at(0), 0x00FF_FFFF);
        assert_eq!(shaft.position(at(9)), 0x00FF_FFFF);
        assert!(!shaft.can_reach(0x0100_0000));
    }

    /// At quarter periods, the signals are 511 counts for 2.5 V, 613 counts for 3 V and 409 counts for 2 V.
    #[test]
    fn signals_repeat_every_period() {
        for (position, sine, cosine) in [(0, 511, 613), (8, 613, 511), (16, 511, 409), (24, 409, 511)] {
            let shaft = Shaft::new(SKM36, 0x531 / 32 * 32 + position, 0.0);
            assert_eq!((shaft.sine_at(at(0)), shaft.cosine_at(at(0))), (sine, cosine), "{position}");
        }
    }

    #[test]
    fn unknown_scale_length_uses_whole_word() {
        let shaft = Shaft::new(Geometry::Linear { period_nm: 1_000_000, periods: 0 }, u32::MAX, 60.0);
        assert_eq!(shaft.position(at(0)), u32::MAX);
        assert_eq!(shaft.position(at(1000)), 31);
    }
}
