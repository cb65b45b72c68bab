//! The motor of the shaft, as seen by the encoder.

use crate::sim::Motor;

/// Motor as seen by its encoder. A copy of the encoder gets a motor of its own.
#[derive(Debug)]
pub(super) struct Drive {
    motor: Motor,
    reverses: bool,
}

impl Clone for Drive {
    fn clone(&self) -> Self {
        Drive::new(self.motor.rpm(), self.reverses)
    }
}

impl Drive {
    /// Creates the motor. `reverses`: it changes its direction by itself when a procedure waits for the other one.
    pub(super) fn new(rpm: f64, reverses: bool) -> Self {
        Drive { motor: Motor::at(rpm), reverses }
    }

    pub(super) const fn motor(&self) -> &Motor {
        &self.motor
    }

    /// Notes that a procedure waits for the other direction.
    pub(super) fn other_direction(&self) {
        if self.reverses {
            self.motor.set_rpm(-self.motor.rpm());
        }
    }
}
