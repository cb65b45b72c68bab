//! Carries out a plan, the same way for every kind of device: reads its base again, carries out the operations in
//! order, and leads the device back. A kind supplies a [`Write`]. Only `worker::commit` calls this, because it saves
//! the before-image in between.

use std::fmt;
use std::hash::Hash;

use super::{Consent, Operation, Plan, WriteRecord};

/// A device into which a plan is written: what differs from kind to kind.
pub trait Write {
    /// The values that a plan is based on.
    type Base: Hash;
    /// An operation of a plan.
    type Op: Operation + Clone + Hash;
    /// Why an operation ended early.
    type Error: OperationError;
    /// What was written.
    type Written: WriteRecord;
    /// In which state a write that ended early has left the device.
    type EndState;

    /// Reads again what the plan rests upon, and writes nothing: first of all, whether it is the device for which the plan
    /// was made.
    ///
    /// # Errors
    /// When anything is no longer as it was.
    fn confirm(&mut self, plan: &Plan<Self::Base, Self::Op>) -> Result<(), <Self::Error as OperationError>::Device>;

    /// Prepares the device for the first operation.
    ///
    /// # Errors
    /// No operation is begun then.
    fn begin(&mut self) -> Result<(), Self::Error> {
        Ok(())
    }

    /// Carries an operation out, reads it back where that is possible, and counts it.
    ///
    /// # Errors
    /// The operations after it are not begun then.
    fn apply(
        &mut self,
        op: &Self::Op,
        confirmed: &Confirmed<'_, Self::Base, Self::Op>,
        done: &mut Self::Written,
    ) -> Result<(), Self::Error>;

    /// Reads back what can only be read when all operations are carried out.
    ///
    /// # Errors
    /// When it is not as it should be.
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
    /// Why the operations ended early, or why the device cannot be led back.
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

/// Why an operation of a plan ended early.
pub trait OperationError: fmt::Display {
    /// The error of the device or its link.
    type Device;

    /// Returns what went wrong with the device or on the way to it; `None` where it was neither.
    fn device(&self) -> Option<&Self::Device>;

    /// The user cancelled it, and nothing else went wrong.
    fn is_only_cancelled(&self) -> bool;
}

/// An error of a device or its link.
pub trait DeviceError: fmt::Display {
    /// The user cancelled it, and nothing else went wrong.
    fn is_only_cancelled(&self) -> bool;

    /// The user cancelled it, whatever went wrong after that.
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

/// A plan that a person consented to and whose base still holds. Without one no operation can be carried out.
pub struct Confirmed<'p, Base, Op> {
    plan: &'p Plan<Base, Op>,
}

/// How far an interrupted write came, and why it ended.
#[derive(Clone, Debug, PartialEq)]
pub struct Interrupted<Op, E, Done, Left> {
    /// What was written until then.
    pub done: Done,
    /// The operation that was not finished, and may have begun; `None` where all were carried out.
    pub unfinished: Option<Op>,
    /// Why it ended.
    pub cause: E,
    /// In which state the device was left.
    pub end_state: Left,
}

/// [`Interrupted`], of a kind of device.
pub(crate) type InterruptedWrite<W> =
    Interrupted<<W as Write>::Op, <W as Write>::Error, <W as Write>::Written, <W as Write>::EndState>;

impl<'p, Base: Hash, Op: Clone + Hash> Confirmed<'p, Base, Op> {
    /// Checks the consent, and has the device read again what the plan rests upon; `None` where the consent is for another
    /// plan.
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

    /// Carries the plan out; each operation is told before it begins, with its number from 0.
    ///
    /// # Errors
    /// How far it came.
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
    /// Returns for the logbook why it ended; `None` where the user cancelled it.
    pub(crate) fn reason(&self) -> Option<String> {
        (!self.cause.is_only_cancelled()).then(|| self.cause.to_string())
    }
}

impl<Op, E: fmt::Display, Done: WriteRecord, Left> fmt::Display for Interrupted<Op, E, Done, Left> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "after {} of the operations: {}", self.done.ops(), self.cause)
    }
}
