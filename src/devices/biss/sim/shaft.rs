//! A model of the shaft, whose position is calculated from the time without accumulating errors. A preset changes the
//! reported position, but does not move the shaft.

use crate::devices::biss::protocol::{Layout, PositionData};
use crate::units::Moment;

/// Number of fractional bits in a step.
pub(super) const FRACTIONAL_BITS: u8 = 8;

/// A shaft that turns at constant speed, as measured by an encoder with 16 multiturn and 17 singleturn bits.
#[derive(Clone, Debug)]
pub(super) struct Shaft {
    rpm: f64,
    /// Mechanical position in steps at the time `since`.
    place: f64,
    since: Moment,
    offset: u64,
    layout: Layout,
}

impl Shaft {
    pub(super) fn new(layout: Layout, position: u64, rpm: f64) -> Self {
        Shaft { rpm, place: position as f64, since: Moment::START, offset: 0, layout }
    }

    pub(super) const fn layout(&self) -> &Layout {
        &self.layout
    }

    /// Returns the speed in revolutions per minute, positive clockwise. The position increases during clockwise
    /// rotation.
    pub(super) const fn rpm(&self) -> f64 {
        self.rpm
    }

    pub(super) fn set_rpm(&mut self, now: Moment, rpm: f64) {
        (self.place, self.since) = (self.steps_at(now), now);
        self.rpm = rpm;
    }

    /// Returns the position at a moment, with error and warning cleared.
    pub(super) fn position_at(&self, at: Moment) -> PositionData {
        let position = (self.integer_steps(at) + self.offset) % self.position_count();
        let singleturn = position % self.steps_per_turn();
        let multiturn = position / self.steps_per_turn();
        // Fields are at most 32 bits wide.
        let [singleturn, multiturn] = [singleturn, multiturn].map(|field| u32::try_from(field).unwrap_or(u32::MAX));
        PositionData { multiturn, singleturn, error: false, warning: false }
    }

    /// Returns the position at time `at` as a fixed-point number with [`FRACTIONAL_BITS`] fractional bits. Another
    /// encoder on the same shaft needs this resolution.
    pub(super) fn fractional_position_at(&self, at: Moment) -> u64 {
        let whole = (self.integer_steps(at) + self.offset) % self.position_count();
        // The product is at least 0 and below 1 << FRACTIONAL_BITS.
        let parts = (self.steps_at(at).fract() * f64::from(1_u32 << FRACTIONAL_BITS)) as u64;
        whole << FRACTIONAL_BITS | parts
    }

    /// Presets the singleturn position, the multiturn position or both at time `at`. A part that is `None` does not
    /// change.
    pub(super) fn preset(&mut self, at: Moment, singleturn: Option<u32>, multiturn: Option<u32>) {
        let now = self.position_at(at);
        let wanted = PositionData {
            singleturn: singleturn.unwrap_or(now.singleturn),
            multiturn: multiturn.unwrap_or(now.multiturn),
            ..now
        };
        let range = self.position_count();
        self.offset = (self.layout.position_to_steps(&wanted) % range + range - self.integer_steps(at)) % range;
    }

    fn steps_per_turn(&self) -> u64 {
        1 << self.layout.singleturn_bits()
    }

    fn position_count(&self) -> u64 {
        self.steps_per_turn() << self.layout.multiturn_bits()
    }

    fn integer_steps(&self, at: Moment) -> u64 {
        self.steps_at(at) as u64 // never negative, and below the range
    }

    fn steps_at(&self, at: Moment) -> f64 {
        let moved = at.duration_since(self.since).as_secs_f64() * self.rpm / 60.0 * self.steps_per_turn() as f64;
        let range = self.position_count() as f64;
        // rem_euclid may round up to the range itself.
        let place = (self.place + moved).rem_euclid(range);
        if place < range { place } else { 0.0 }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::time::Duration;

    fn at(ms: u64) -> Moment {
        Moment::START + Duration::from_millis(ms)
    }

    #[test]
    fn turning_shaft_has_expected_position() {
        let mut shaft = Shaft::new(Layout::default(), 0, 60.0);
        let place = |shaft: &Shaft, ms| (shaft.position_at(at(ms)).multiturn, shaft.position_at(at(ms)).singleturn);
        assert_eq!(place(&shaft, 0), (0, 0));
        assert_eq!(place(&shaft, 1_750), (1, 0x18000));
        shaft.set_rpm(at(1_750), -60.0);
        assert_eq!(place(&shaft, 2_750), (0, 0x18000));
        assert_eq!(place(&shaft, 3_750), (0xFFFF, 0x18000), "below zero it is at the end of the range");
    }

    #[test]
    fn fine_positions_include_step_fractions() {
        // At 60 rpm, the shaft moves by 2¹⁷ steps per second, or 131.072 steps per millisecond. 0.072 steps are 18.4 of
        // 256 parts.
        let shaft = Shaft::new(Layout::default(), 5, 60.0);
        assert_eq!((shaft.fractional_position_at(at(0)), shaft.fractional_position_at(at(1))), (5 << 8, 136 << 8 | 18));
    }

    #[test]
    fn preset_shifts_singleturn_or_multiturn() {
        let mut shaft = Shaft::new(Layout::default(), 5 << 17 | 0x100, 0.0);
        let place = |shaft: &Shaft| (shaft.position_at(at(9)).multiturn, shaft.position_at(at(9)).singleturn);
        shaft.preset(at(0), Some(0x18000), None);
        assert_eq!(place(&shaft), (5, 0x18000));
        shaft.preset(at(0), None, Some(0xFFFF));
        assert_eq!(place(&shaft), (0xFFFF, 0x18000));
        shaft.preset(at(0), Some(0), Some(0));
        assert_eq!(place(&shaft), (0, 0));
    }
}
