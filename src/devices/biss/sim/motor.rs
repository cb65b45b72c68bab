//! The motor of the shaft, as seen by the encoder.

use crate::sim::Motor;

/// A motor as seen by its encoder. Cloning creates an independent motor, so a copied encoder does not share one with
/// the original.
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
    /// Creates the motor. If `reverses` is set, the motor changes direction by itself when a procedure waits for the
    /// opposite direction.
    pub(super) fn new(rpm: f64, reverses: bool) -> Self {
        Drive { motor: Motor::at(rpm), reverses }
    }

    pub(super) const fn motor(&self) -> &Motor {
        &self.motor
    }

    /// Reports that a procedure is waiting for the opposite direction.
    pub(super) fn reverse_motor(&self) {
        if self.reverses {
            self.motor.set_rpm(-self.motor.rpm());
        }
    }
}
