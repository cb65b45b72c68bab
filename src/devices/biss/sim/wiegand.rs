//! The Wiegand sensor test (manual 6.3), which collects pulses during 515 revolutions in each direction. The encoder
//! cannot tell clockwise from counterclockwise rotation.
//!
//! The manual leaves two details open (`U`). In this model, the encoder detects if the shaft turns in the same
//! direction in both runs. A sensor without pulses fails with code 01h.

use crate::devices::biss::protocol::{WiegandCommand, WiegandResult, WiegandStatus};
use crate::units::Moment;

/// Pulse voltages of the sensor, in tenths of a volt.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct WiegandPulses {
    /// Average voltage, or 0 if there are no pulses.
    pub(super) average: u8,
    pub(super) lowest: u8,
}

#[derive(Clone, Debug)]
pub(super) struct WiegandState {
    pub(super) command: u8,
    pub(super) status: WiegandStatus,
    pub(super) error: u8,
    /// Test results in ascending order of register address.
    pub(super) result: [u8; 4],
    /// Number of revolutions between the start of the run and `since`.
    collected: f64,
    since: Moment,
    /// Whether the first run turned clockwise, or `None` until this is known.
    first_clockwise: Option<bool>,
}

impl WiegandState {
    const REVOLUTIONS: f64 = WiegandResult::REVOLUTIONS as f64;
    const NO_PULSES: u8 = 0x01;

    pub(super) fn new() -> Self {
        WiegandState {
            command: 0,
            status: WiegandStatus::Stopped,
            error: 0,
            result: [0; 4],
            collected: 0.0,
            since: Moment::START,
            first_clockwise: None,
        }
    }

    /// Handles a command. Returns `false` if it is rejected. The [`Encoder`](super::Encoder) saves the result.
    pub(super) fn write(&mut self, now: Moment, value: u8) -> bool {
        let status = match (WiegandCommand::from_byte(value), self.status) {
            (WiegandCommand::Stop, _) => WiegandStatus::Stopped,
            (WiegandCommand::StartClockwise, WiegandStatus::Clockwise | WiegandStatus::Counterclockwise) => {
                return false;
            }
            (WiegandCommand::StartClockwise, _) => {
                (self.result, self.error, self.first_clockwise) = ([0; 4], 0, None);
                WiegandStatus::Clockwise
            }
            (WiegandCommand::StartCounterclockwise, WiegandStatus::WaitForDirection) => WiegandStatus::Counterclockwise,
            _ => return false,
        };
        self.command = value;
        self.status = status;
        (self.collected, self.since) = (0.0, now);
        true
    }

    pub(super) fn is_running(&self) -> bool {
        matches!(self.status, WiegandStatus::Clockwise | WiegandStatus::Counterclockwise)
    }

    /// Adds the revolutions since the previous call at constant speed. A run ends when it has the required number of
    /// revolutions.
    pub(super) fn update(&mut self, now: Moment, rpm: f64, pulses: WiegandPulses) {
        if !self.is_running() {
            return;
        }
        self.collected += now.duration_since(self.since).as_secs_f64() * rpm.abs() / 60.0;
        self.since = now;
        let clockwise = rpm > 0.0;
        let second = self.status == WiegandStatus::Counterclockwise;
        if second && rpm != 0.0 && self.first_clockwise == Some(clockwise) {
            self.status = WiegandStatus::WrongDirection;
        } else if self.collected >= Self::REVOLUTIONS && pulses.average == 0 {
            (self.status, self.error) = (WiegandStatus::Failed, Self::NO_PULSES);
        } else if self.collected >= Self::REVOLUTIONS {
            let [average_cw, lowest_cw, average_ccw, lowest_ccw] = &mut self.result;
            if second {
                (*average_ccw, *lowest_ccw) = (pulses.average, pulses.lowest);
                self.status = WiegandStatus::Complete;
            } else {
                (*average_cw, *lowest_cw) = (pulses.average, pulses.lowest);
                self.first_clockwise = Some(clockwise);
                self.status = WiegandStatus::WaitForDirection;
            }
        }
    }

    /// Ends the run when the device mode is left or power is lost. The result remains until power is lost.
    pub(super) fn abort(&mut self) {
        (self.command, self.status) = (0, WiegandStatus::Stopped);
    }
}
