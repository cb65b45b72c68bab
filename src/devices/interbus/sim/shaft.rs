//! The shaft of a virtual encoder. Its position is an exact function of time. A turn has 8192 disc steps.

use crate::devices::interbus::protocol::STEPS_PER_TURN;
use crate::units::Moment;

/// A shaft that turns at constant speed. Its position is not wrapped here, since where it wraps depends on the gear.
#[derive(Clone, Copy, Debug)]
pub(super) struct Shaft {
    rpm: f64,
    /// Position at `since`, in disc steps.
    place: f64,
    since: Moment,
}

impl Shaft {
    pub(super) fn new(place: u32, rpm: f64) -> Self {
        Shaft { rpm, place: f64::from(place), since: Moment::START }
    }

    /// Returns the speed in revolutions per minute. Positive speeds are clockwise and increase the position.
    pub(super) const fn rpm(&self) -> f64 {
        self.rpm
    }

    pub(super) fn set_rpm(&mut self, now: Moment, rpm: f64) {
        (self.place, self.since) = (self.exact_position_at(now), now);
        self.rpm = rpm;
    }

    pub(super) fn set_position(&mut self, now: Moment, place: i32) {
        (self.place, self.since) = (f64::from(place), now);
    }

    /// Returns the shaft position in whole disc steps. It may be negative.
    pub(super) fn position_at(&self, at: Moment) -> i64 {
        self.exact_position_at(at).floor() as i64
    }

    fn exact_position_at(&self, at: Moment) -> f64 {
        self.place + at.duration_since(self.since).as_secs_f64() * self.rpm / 60.0 * f64::from(STEPS_PER_TURN)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::time::Duration;

    #[test]
    fn turning_shaft_reaches_expected_position() {
        let at = |ms| Moment::START + Duration::from_millis(ms);
        let mut shaft = Shaft::new(100, 60.0);
        assert_eq!((shaft.position_at(at(0)), shaft.position_at(at(1_000))), (100, 8292));
        shaft.set_rpm(at(1_000), -120.0);
        assert_eq!((shaft.position_at(at(1_500)), shaft.position_at(at(2_000))), (100, -8092));
        shaft.set_position(at(2_000), 7);
        assert_eq!(shaft.position_at(at(2_000)), 7);
    }
}
