//! Carries out a plan in the same way for every kind of device: reads its base again, carries out the operations in order,
//! and restores the mode of the device. A kind supplies a [`Write`]. Only `worker::commit` calls this, because it saves the
//! before-image in between.

use std::fmt;
use std::hash::Hash;

use super::{Consent, Operation, Plan, WriteRecord};

/// The device that a plan is written into: the parts that differ between kinds.
pub trait Write {
    /// The values that a plan is based on.
    type Base: Hash;
    /// An operation of a plan.
    type Op: Operation + Clone + Hash;
    /// The reason why an operation ended early.
    type Error: OperationError;
    /// Record of the write that the profile was the backup of.
    type Written: WriteRecord;
    /// The state in which an interrupted write left the device.
    type EndState;

    /// Reads the base of the plan again, and writes nothing: first it checks that it is the device for which the plan was
    /// made.
    ///
    /// # Errors
    /// Returns an error if anything has changed.
    fn confirm(&mut self, plan: &Plan<Self::Base, Self::Op>) -> Result<(), <Self::Error as OperationError>::Device>;

    /// Prepares the device for the first operation.
    ///
    /// # Errors
    /// Returns an error before any operation begins.
    fn begin(&mut self) -> Result<(), Self::Error> {
        Ok(())
    }

    /// Carries an operation out, reads it back if possible, and counts it.
    ///
    /// # Errors
    /// Returns an error; the operations after it do not begin.
    fn apply(
        &mut self,
        op: &Self::Op,
        confirmed: &Confirmed<'_, Self::Base, Self::Op>,
        done: &mut Self::Written,
    ) -> Result<(), Self::Error>;

    /// Reads back the values that can only be read after all operations.
    ///
    /// # Errors
    /// Returns an error if a value is not as planned.
    fn finish(
        &mut self,
        _confirmed: &Confirmed<'_, Self::Base, Self::Op>,
        _done: &mut Self::Written,
    ) -> Result<(), Self::Error> {
        Ok(())
    }

    /// Leads the device back to a safe state, however the operations ended.
    ///
    /// # Errors
    /// The reason why the operations ended early, or why the mode of the device cannot be restored.
    fn lead_back(
        &mut self,
        _confirmed: &Confirmed<'_, Self::Base, Self::Op>,
        ended: Result<(), Self::Error>,
        _done: &mut Self::Written,
    ) -> Result<(), Self::Error> {
        ended
    }

    /// Returns in which state a write that ended early has left the device.
    fn end_state(&mut self, cause: &Self::Error) -> Self::EndState;
}

/// The reason why an operation of a plan ended early.
pub trait OperationError: fmt::Display {
    /// The error of the device or its connection.
    type Device;

    /// Returns the error of the device or its connection; `None` if the cause was another one.
    fn device(&self) -> Option<&Self::Device>;

    /// Returns whether the user cancelled and no other error occurred.
    fn is_only_cancelled(&self) -> bool;
}

/// An error of a device or its connection.
pub trait DeviceError: fmt::Display {
    /// Returns whether the user cancelled and no other error occurred.
    fn is_only_cancelled(&self) -> bool;

    /// Returns whether the user cancelled, whatever failed after that.
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

/// A plan that a user consented to and whose base is unchanged. Without it no operation can be carried out.
pub struct Confirmed<'p, Base, Op> {
    plan: &'p Plan<Base, Op>,
}

/// The progress of an interrupted write, and its cause.
#[derive(Clone, Debug, PartialEq)]
pub struct Interrupted<Op, E, Done, Left> {
    /// The changes written before.
    pub done: Done,
    /// The operation that was not finished, and may have begun; `None` if all were carried out.
    pub unfinished: Option<Op>,
    /// The cause of the interruption.
    pub cause: E,
    /// The state in which the device was left.
    pub end_state: Left,
}

/// [`Interrupted`], of a kind of device.
pub(crate) type InterruptedWrite<W> =
    Interrupted<<W as Write>::Op, <W as Write>::Error, <W as Write>::Written, <W as Write>::EndState>;

impl<'p, Base: Hash, Op: Clone + Hash> Confirmed<'p, Base, Op> {
    /// Checks the consent, and lets the device read the base of the plan again; `None` if the consent is for another plan.
    pub(crate) fn confirm<W: Write<Base = Base, Op = Op>>(
        plan: &'p Plan<Base, Op>,
        consent: Consent,
        write: &mut W,
    ) -> Option<Result<Self, <W::Error as OperationError>::Device>> {
        consent.covers(plan.id()).then(|| write.confirm(plan).map(|()| Confirmed { plan }))
    }

    /// Returns the plan.
    pub fn plan(&self) -> &'p Plan<Base, Op> {
        self.plan
    }

    /// Carries the plan out; each operation is reported before it begins, with its number from 0.
    ///
    /// # Errors
    /// Returns the progress of an interrupted write.
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
    /// Returns the cause for the logbook; `None` if the user cancelled.
    pub(crate) fn reason(&self) -> Option<String> {
        (!self.cause.is_only_cancelled()).then(|| self.cause.to_string())
    }
}

impl<Op, E: fmt::Display, Done: WriteRecord, Left> fmt::Display for Interrupted<Op, E, Done, Left> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "after {} of the operations: {}", self.done.ops(), self.cause)
    }
}
