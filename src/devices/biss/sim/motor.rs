//! The motor that turns the shaft of a virtual encoder.

use crate::sim::Motor;

/// The motor of a virtual encoder. A clone has an independent motor, because a copied encoder must not share the
/// original's motor.
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
    /// Creates the motor. If `reverses` is set, the motor reverses when a procedure waits for the opposite direction.
    pub(super) fn new(rpm: f64, reverses: bool) -> Self {
        Drive { motor: Motor::with_speed(rpm), reverses }
    }

    pub(super) const fn motor(&self) -> &Motor {
        &self.motor
    }

    /// Reverses the motor, if configured. Called when a procedure waits for the opposite direction.
    pub(super) fn reverse_if_configured(&self) {
        if self.reverses {
            self.motor.set_rpm(-self.motor.rpm());
        }
    }
}
