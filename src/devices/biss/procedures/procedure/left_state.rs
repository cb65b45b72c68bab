//! The state of an encoder, as inferred from its replies. It is reported if the link is lost during a procedure.

use super::MotorRun;
use crate::devices::biss::procedures::Error;
use crate::devices::biss::protocol::DeviceMode;

/// The possible values of one part of the encoder's state. After a missing reply, there is more than one.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct PossibleValues<T>(Vec<T>);

#[derive(Clone, Debug, PartialEq, Eq)]
pub struct LeftState {
    pub mode: PossibleValues<DeviceMode>,
    /// Whether the password is set, so that device modes can be selected.
    pub password: PossibleValues<bool>,
    pub activity: Activity,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Activity {
    /// The encoder does nothing that a loss of the link could interrupt.
    Nothing,
    Running(MotorRun),
    /// Values have been entered but not saved. They are lost when the mode is left or the power fails.
    Entered,
    /// The flash has been written, or may have been. It holds either the old or the new values.
    Saving,
    Restarting,
}

impl<T: Copy + PartialEq> PossibleValues<T> {
    pub fn new(value: T) -> Self {
        PossibleValues(vec![value])
    }

    /// Returns all possible values, in the order in which the encoder would reach them.
    pub fn as_slice(&self) -> &[T] {
        &self.0
    }

    pub fn must_equal(&self, value: T) -> bool {
        self.0 == [value]
    }

    pub fn may_equal(&self, value: T) -> bool {
        self.0.contains(&value)
    }

    pub fn add_possible_value(&mut self, value: T) {
        if !self.may_equal(value) {
            self.0.push(value);
        }
    }

    /// Updates the possible values after an attempt to write `after`.
    pub(super) fn update_after_write(&mut self, after: T, ended: &Result<(), Error>) {
        match ended {
            Ok(()) => *self = PossibleValues::new(after),
            // The value was not sent or not accepted.
            Err(Error::Cancelled | Error::Refused { .. }) => {}
            Err(_) => self.add_possible_value(after),
        }
    }
}

impl LeftState {
    pub fn in_operation(password: bool) -> Self {
        LeftState {
            mode: PossibleValues::new(DeviceMode::OPERATION),
            password: PossibleValues::new(password),
            activity: Activity::Nothing,
        }
    }

    /// Returns whether the encoder is certainly in operation mode with the password cleared.
    pub fn is_in_operation(&self) -> bool {
        self.mode.must_equal(DeviceMode::OPERATION) && self.password.must_equal(false)
    }

    /// Records that a restart command was sent. The encoder may not have received it.
    pub(super) fn record_possible_restart(&mut self) {
        self.record_possible_power_loss();
        self.activity = Activity::Restarting;
    }

    /// Records that the encoder can no longer be reached. If it loses power, it restarts in operation mode with the
    /// password cleared.
    pub(in crate::devices::biss::procedures) fn record_possible_power_loss(&mut self) {
        self.mode.add_possible_value(DeviceMode::OPERATION);
        self.password.add_possible_value(false);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::link::{LinkError, LinkErrorKind};

    #[test]
    fn unanswered_write_leaves_two_states() {
        let lost = || Err(Error::Link(LinkError::new("x", LinkErrorKind::Lost)));
        let mut mode = PossibleValues::new(0);
        mode.update_after_write(1, &Ok(()));
        assert!(mode.must_equal(1));
        mode.update_after_write(0, &Err(Error::Cancelled));
        assert!(mode.must_equal(1), "it was not sent");
        mode.update_after_write(0, &lost());
        assert_eq!((mode.as_slice(), mode.must_equal(1)), (&[1, 0][..], false));
        assert!(mode.may_equal(0) && mode.may_equal(1) && !mode.may_equal(2));
        mode.update_after_write(0, &lost());
        assert_eq!(mode.as_slice(), [1, 0]);
        mode.update_after_write(2, &Ok(()));
        assert!(mode.must_equal(2));
    }

    #[test]
    fn possible_restart_allows_operation_mode() {
        let mut standing = LeftState::in_operation(false);
        assert!(standing.is_in_operation());
        standing.mode = PossibleValues::new(DeviceMode::PRESET);
        standing.password = PossibleValues::new(true);
        standing.record_possible_restart();
        assert_eq!(standing.mode.as_slice(), [DeviceMode::PRESET, DeviceMode::OPERATION]);
        assert_eq!(standing.password.as_slice(), [true, false]);
        assert!(!standing.is_in_operation());
    }
}
