//! Executes a plan for any kind of device: reads the base of the plan again, executes the operations in order, and
//! restores the mode of the device. Each kind of device implements [`Write`].
//!
//! This module is used only by `worker::commit`, which saves the backup before the first operation.

use std::fmt;
use std::hash::Hash;

use super::{Consent, Operation, Plan, WriteRecord};

/// The device-specific part of writing a plan.
pub trait Write {
    /// The device values on which a plan is based.
    type Base: Hash;
    /// An operation of a plan.
    type Op: Operation + Clone + Hash;
    /// The error of an operation.
    type Error: OperationError;
    /// The record of what was written.
    type Written: WriteRecord;
    /// The state of the device after an interrupted write.
    type EndState;

    /// Checks that the device is the one for which the plan was made, then reads the base of the plan again. Nothing is
    /// written.
    ///
    /// # Errors
    /// Returns an error if the device or the values have changed.
    fn confirm_base(
        &mut self,
        plan: &Plan<Self::Base, Self::Op>,
    ) -> Result<(), <Self::Error as OperationError>::Device>;

    /// Prepares the device for the first operation.
    ///
    /// # Errors
    /// Returns an error if the preparation failed. In this case, no operation has begun.
    fn begin(&mut self) -> Result<(), Self::Error> {
        Ok(())
    }

    /// Executes an operation, counts it, and reads back the result if possible.
    ///
    /// # Errors
    /// Returns an error if the operation failed. In this case, no further operation begins.
    fn apply(
        &mut self,
        op: &Self::Op,
        confirmed: &ConfirmedPlan<'_, Self::Base, Self::Op>,
        done: &mut Self::Written,
    ) -> Result<(), Self::Error>;

    /// Reads back the values that can be read only after all operations.
    ///
    /// # Errors
    /// Returns an error if a value differs from the plan.
    fn finish(
        &mut self,
        _confirmed: &ConfirmedPlan<'_, Self::Base, Self::Op>,
        _done: &mut Self::Written,
    ) -> Result<(), Self::Error> {
        Ok(())
    }

    /// Returns the device to a safe state after the operations, whether they succeeded or not.
    ///
    /// # Errors
    /// Returns the reason why the operations were aborted, or why the mode of the device could not be restored.
    fn return_to_safe_state(
        &mut self,
        _confirmed: &ConfirmedPlan<'_, Self::Base, Self::Op>,
        ended: Result<(), Self::Error>,
        _done: &mut Self::Written,
    ) -> Result<(), Self::Error> {
        ended
    }

    /// Returns the state of the device after an interrupted write.
    fn end_state(&mut self, cause: &Self::Error) -> Self::EndState;
}

/// The error of an aborted operation.
pub trait OperationError: fmt::Display {
    /// The error type of the device and its connection.
    type Device;

    /// Returns the error from the device or its connection, or `None` for any other cause.
    fn device(&self) -> Option<&Self::Device>;

    /// Returns whether the only cause is that the user cancelled.
    fn is_only_cancelled(&self) -> bool;
}

/// An error from a device or its connection.
pub trait DeviceError: fmt::Display {
    /// Returns whether the user cancelled and no other error occurred.
    fn is_only_cancelled(&self) -> bool;

    /// Returns whether the user cancelled, even if errors followed.
    fn is_cancelled(&self) -> bool {
        self.is_only_cancelled()
    }
}

impl<E: DeviceError> OperationError for E {
    type Device = E;

    fn device(&self) -> Option<&E> {
        Some(self)
    }

    fn is_only_cancelled(&self) -> bool {
        DeviceError::is_only_cancelled(self)
    }
}

/// A plan that the user has approved and whose base is unchanged. It is required to execute any operation.
pub struct ConfirmedPlan<'p, Base, Op> {
    plan: &'p Plan<Base, Op>,
}

/// The progress and cause of an interrupted write.
#[derive(Clone, Debug, PartialEq)]
pub struct InterruptedWrite<Op, E, Done, Left> {
    /// Changes that were written before the interruption.
    pub done: Done,
    /// Operation that was interrupted and may have begun, or `None` if all operations were completed.
    pub unfinished: Option<Op>,
    /// Cause of the interruption.
    pub cause: E,
    /// State in which the device was left.
    pub end_state: Left,
}

pub(crate) type WriteInterruption<W> =
    InterruptedWrite<<W as Write>::Op, <W as Write>::Error, <W as Write>::Written, <W as Write>::EndState>;

impl<'p, Base: Hash, Op: Clone + Hash> ConfirmedPlan<'p, Base, Op> {
    /// Checks the consent, then reads the base of the plan again. Returns `None` if the consent is for another plan.
    pub(crate) fn confirm<W: Write<Base = Base, Op = Op>>(
        plan: &'p Plan<Base, Op>,
        consent: Consent,
        write: &mut W,
    ) -> Option<Result<Self, <W::Error as OperationError>::Device>> {
        consent.covers(plan.id()).then(|| write.confirm_base(plan).map(|()| ConfirmedPlan { plan }))
    }

    /// Returns the confirmed plan.
    pub fn plan(&self) -> &'p Plan<Base, Op> {
        self.plan
    }

    /// Executes the plan. `tell` is called before each operation, with the operation and its index.
    ///
    /// # Errors
    /// Returns the progress and the cause if the write was interrupted.
    pub(crate) fn execute<W: Write<Base = Base, Op = Op>>(
        &self,
        write: &mut W,
        tell: &mut dyn FnMut(usize, &Op),
    ) -> Result<W::Written, Box<WriteInterruption<W>>> {
        let (mut at, mut done) = (0, W::Written::default());
        let mut execute = || {
            write.begin()?;
            for op in &self.plan.ops {
                tell(at, op);
                write.apply(op, self, &mut done)?;
                at += 1;
            }
            write.finish(self, &mut done)
        };
        let ended = execute();
        let Err(cause) = write.return_to_safe_state(self, ended, &mut done) else { return Ok(done) };
        let (unfinished, left) = (self.plan.ops.get(at).cloned(), write.end_state(&cause));
        Err(Box::new(InterruptedWrite { done, unfinished, cause, end_state: left }))
    }
}

impl<Op, E: OperationError, Done: WriteRecord, Left> InterruptedWrite<Op, E, Done, Left> {
    /// Returns the cause to record in the logbook, or `None` if the user cancelled.
    pub(crate) fn reason(&self) -> Option<String> {
        (!self.cause.is_only_cancelled()).then(|| self.cause.to_string())
    }
}

impl<Op, E: fmt::Display, Done: WriteRecord, Left> fmt::Display for InterruptedWrite<Op, E, Done, Left> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "after {} of the operations: {}", self.done.operation_count(), self.cause)
    }
}
