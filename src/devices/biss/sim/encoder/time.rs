//! What happens as time passes: the start-up is completed, procedure runs end, and the shaft follows its motor.

use super::{Encoder, Power};
use crate::devices::biss::protocol::{CalibrationStatus, WiegandStatus};
use crate::devices::biss::sim::calibration::RunOutcome;
use crate::units::Moment;

impl Encoder {
    pub(super) fn update(&mut self, now: Moment) {
        if let Power::Starting { ready } = self.power
            && ready <= now
        {
            self.power = Power::On;
        }
        self.update_procedures(now);
        let rpm = self.drive.motor().rpm();
        if rpm != self.shaft.rpm() {
            self.calibration.force_failure(now);
            self.shaft.set_rpm(now, rpm);
            self.update_procedures(now);
        }
    }

    fn update_procedures(&mut self, now: Moment) {
        let waited = self.needs_reversal();
        match self.calibration.update(now) {
            RunOutcome::No => {}
            RunOutcome::Saved => self.write_flash(|flash, whole| flash.calibrated = whole),
            RunOutcome::Lost => self.flash.calibrated = false,
        }
        self.wiegand.update(now, self.shaft.rpm(), self.pulses);
        if self.needs_reversal() && !waited {
            self.drive.reverse_if_configured();
        }
    }

    /// Returns whether a procedure has completed its first run, so that the motor must reverse for the second run.
    fn needs_reversal(&self) -> bool {
        self.calibration.status == CalibrationStatus::CounterclockwiseDone
            || self.wiegand.status == WiegandStatus::WaitForDirection
    }
}
