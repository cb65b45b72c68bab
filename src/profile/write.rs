//! Execution of a plan, the same for every kind of device: reads its base again, carries out the operations in order,
//! and restores the mode of the device. A kind supplies a [`Write`]. Only `worker::commit` calls this module, because
//! it saves the backup in between.

use std::fmt;
use std::hash::Hash;

use super::{Consent, Operation, Plan, WriteRecord};

/// A device to which a plan is written, with the operations that differ between device kinds.
pub trait Write {
    /// Device values on which a plan is based.
    type Base: Hash;
    /// An operation of a plan.
    type Op: Operation + Clone + Hash;
    /// Reason why an operation failed.
    type Error: OperationError;
    /// Record of a write.
    type Written: WriteRecord;
    /// State in which an interrupted write left the device.
    type EndState;

    /// Reads the base of the plan again without writing, after checking that the device is the one for which the plan
    /// was made.
    ///
    /// # Errors
    /// The device or the values have changed.
    fn confirm(&mut self, plan: &Plan<Self::Base, Self::Op>) -> Result<(), <Self::Error as OperationError>::Device>;

    /// Prepares the device for the first operation.
    ///
    /// # Errors
    /// Preparation failed, and no operation has begun.
    fn begin(&mut self) -> Result<(), Self::Error> {
        Ok(())
    }

    /// Carries out an operation, reads back the result if possible, and counts the operation.
    ///
    /// # Errors
    /// The operation failed, and subsequent operations do not begin.
    fn apply(
        &mut self,
        op: &Self::Op,
        confirmed: &Confirmed<'_, Self::Base, Self::Op>,
        done: &mut Self::Written,
    ) -> Result<(), Self::Error>;

    /// Reads back the values that are only readable after all operations.
    ///
    /// # Errors
    /// A value differs from the plan.
    fn finish(
        &mut self,
        _confirmed: &Confirmed<'_, Self::Base, Self::Op>,
        _done: &mut Self::Written,
    ) -> Result<(), Self::Error> {
        Ok(())
    }

    /// Returns the device to a safe state, however the operations ended.
    ///
    /// # Errors
    /// Returns the reason why the operations ended early, or why the mode of the device cannot be restored.
    fn lead_back(
        &mut self,
        _confirmed: &Confirmed<'_, Self::Base, Self::Op>,
        ended: Result<(), Self::Error>,
        _done: &mut Self::Written,
    ) -> Result<(), Self::Error> {
        ended
    }

    /// Returns the state in which a write that ended early has left the device.
    fn end_state(&mut self, cause: &Self::Error) -> Self::EndState;
}

/// The reason why an operation of a plan ended early.
pub trait OperationError: fmt::Display {
    /// Error type of the device and its connection.
    type Device;

    /// Returns the error of the device or its connection, or `None` for other causes.
    fn device(&self) -> Option<&Self::Device>;

    /// Returns whether the user cancelled and no other error occurred.
    fn is_only_cancelled(&self) -> bool;
}

/// An error of a device or its connection.
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

/// A plan with the user's consent and an unchanged base, required for every operation.
pub struct Confirmed<'p, Base, Op> {
    plan: &'p Plan<Base, Op>,
}

/// The progress and cause of an interrupted write.
#[derive(Clone, Debug, PartialEq)]
pub struct Interrupted<Op, E, Done, Left> {
    /// Changes that were written before the interruption.
    pub done: Done,
    /// Operation that was not completed and may have begun, or `None` if all operations were carried out.
    pub unfinished: Option<Op>,
    /// Cause of the interruption.
    pub cause: E,
    /// State in which the device was left.
    pub end_state: Left,
}

/// [`Interrupted`] for one kind of device.
pub(crate) type InterruptedWrite<W> =
    Interrupted<<W as Write>::Op, <W as Write>::Error, <W as Write>::Written, <W as Write>::EndState>;

impl<'p, Base: Hash, Op: Clone + Hash> Confirmed<'p, Base, Op> {
    /// Checks the consent and makes the device read the plan's base values again. Returns `None` if the consent was
    /// given for another plan.
    pub(crate) fn confirm<W: Write<Base = Base, Op = Op>>(
        plan: &'p Plan<Base, Op>,
        consent: Consent,
        write: &mut W,
    ) -> Option<Result<Self, <W::Error as OperationError>::Device>> {
        consent.covers(plan.id()).then(|| write.confirm(plan).map(|()| Confirmed { plan }))
    }

    /// Returns the confirmed plan.
    pub fn plan(&self) -> &'p Plan<Base, Op> {
        self.plan
    }

    /// Executes the plan. Each operation is reported with its index, starting at 0, before it begins.
    ///
    /// # Errors
    /// Returns the progress of the interrupted write.
    pub(crate) fn carry_out<W: Write<Base = Base, Op = Op>>(
        &self,
        write: &mut W,
        tell: &mut dyn FnMut(usize, &Op),
    ) -> Result<W::Written, Box<InterruptedWrite<W>>> {
        let (mut at, mut done) = (0, W::Written::default());
        let mut carry_out = || {
            write.begin()?;
            for op in &self.plan.ops {
                tell(at, op);
                write.apply(op, self, &mut done)?;
                at += 1;
            }
            write.finish(self, &mut done)
        };
        let ended = carry_out();
        let Err(cause) = write.lead_back(self, ended, &mut done) else { return Ok(done) };
        let (unfinished, left) = (self.plan.ops.get(at).cloned(), write.end_state(&cause));
        Err(Box::new(Interrupted { done, unfinished, cause, end_state: left }))
    }
}

impl<Op, E: OperationError, Done: WriteRecord, Left> Interrupted<Op, E, Done, Left> {
    /// Returns the cause to record in the logbook, or `None` if the user cancelled.
    pub(crate) fn reason(&self) -> Option<String> {
        (!self.cause.is_only_cancelled()).then(|| self.cause.to_string())
    }
}

impl<Op, E: fmt::Display, Done: WriteRecord, Left> fmt::Display for Interrupted<Op, E, Done, Left> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "after {} of the operations: {}", self.done.ops(), self.cause)
    }
}
