//! The shaft of an adapter without a BiSS device. Its position is an exact function of time.

use crate::sim::Motor;
use crate::units::Moment;

/// A shaft with its motor. Copies have separate motors.
#[derive(Debug)]
pub(super) struct Shaft {
    motor: Motor,
    /// Speed in revolutions per minute since its last change.
    rpm: f64,
    since: Moment,
    /// Position in revolutions at the last change of the speed.
    revolutions: f64,
}

impl Clone for Shaft {
    fn clone(&self) -> Self {
        Shaft { motor: Motor::with_speed(self.motor.rpm()), ..*self }
    }
}

impl Shaft {
    const PER_TURN: u64 = 1 << 25;
    /// Number of revolutions after which the position wraps.
    const TURNS: f64 = 65_536.0;

    /// Creates a shaft that starts at zero and turns at the given speed.
    pub(super) fn with_speed(rpm: f64) -> Self {
        Shaft { motor: Motor::with_speed(rpm), rpm, since: Moment::START, revolutions: 0.0 }
    }

    pub(super) const fn motor(&self) -> &Motor {
        &self.motor
    }

    /// Changes the speed to that of the motor from `now` on.
    pub(super) fn follow_motor(&mut self, now: Moment) {
        let rpm = self.motor.rpm();
        if rpm != self.rpm {
            (self.revolutions, self.since, self.rpm) = (self.revolutions_at(now), now, rpm);
        }
    }

    /// Returns the position in steps and the number of steps per revolution.
    pub(super) fn position_at(&mut self, at: Moment) -> (u64, u64) {
        self.follow_motor(at);
        // The result is not negative and below 2^41.
        ((self.revolutions_at(at) * Self::PER_TURN as f64) as u64, Self::PER_TURN)
    }

    fn revolutions_at(&self, at: Moment) -> f64 {
        let revolutions = self.revolutions + at.duration_since(self.since).as_secs_f64() * self.rpm / 60.0;
        let revolutions = revolutions.rem_euclid(Self::TURNS);
        // `rem_euclid` may round up to the divisor.
        if revolutions < Self::TURNS { revolutions } else { 0.0 }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::time::Duration;

    fn at(ms: u64) -> Moment {
        Moment::START + Duration::from_millis(ms)
    }

    /// At 60 rpm the shaft makes a revolution of 2^25 steps per second, and wraps after 65 536 revolutions.
    #[test]
    fn turning_shaft_reaches_expected_position() {
        let mut shaft = Shaft::with_speed(60.0);
        assert_eq!([0, 250, 1_500].map(|ms| shaft.position_at(at(ms)).0), [0, 1 << 23, 3 << 24]);
        let copy = shaft.clone();
        shaft.motor().set_rpm(-60.0);
        assert_eq!(shaft.position_at(at(2_000)), (2 << 25, 1 << 25), "it follows when it is asked");
        assert_eq!(shaft.position_at(at(5_000)).0, 65_535 << 25, "below zero it is at the end");
        assert_eq!(copy.motor().rpm(), 60.0);
    }
}
