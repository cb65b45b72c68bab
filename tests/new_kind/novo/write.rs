//! What a Novo encoder brings to a write.

use encoder_studio::profile::{Body, Written};
use encoder_studio::worker::commit::{Agreed, Intended, OldWrite as Write, backup_of};
use encoder_studio::worker::{Desk, Interruption, Progress, Tell};

use super::jobs::{Error, Novo, Prepared, Told};
use super::profile::{NovoProfile, Op};
use super::protocol::{Request, address_of};

/// A write that ended early.
#[derive(Debug, thiserror::Error)]
#[error("after {} operations: {cause}", done.ops)]
pub(crate) struct Interrupted {
    done: Written,
    cause: Error,
}

pub(super) struct NovoWrite<'w> {
    pub(super) novo: &'w mut Novo,
    pub(super) desk: &'w mut Desk,
    pub(super) agreed: &'w Agreed<Prepared>,
    pub(super) tell: Told<'w>,
}

impl NovoWrite<'_> {
    fn perform(&mut self, op: &Op, done: &mut Written) -> Result<(), Error> {
        done.write_cycles += 1;
        self.novo.ask(self.desk, Request::Write(address_of(op.item), op.to))?;
        done.written += 1;
        if self.novo.ask(self.desk, Request::Read(address_of(op.item)))? != op.to {
            return Err(Error::NotTaken(op.name()));
        }
        done.verified += 1;
        done.ops += 1;
        Ok(())
    }
}

impl Write for NovoWrite<'_> {
    type Confirmed = ();
    type Written = Written;
    type Refusal = Error;
    type Interrupted = Interrupted;

    fn confirm(&mut self) -> Result<(), Error> {
        let plan = &self.agreed.prepared.plan;
        let now = self.novo.survey(self.desk)?;
        let holds = self.agreed.consent.covers(plan.id()) && plan.base == (now.serial, now.values);
        if holds { Ok(()) } else { Err(Error::Changed) }
    }
    fn before_image(&self) -> String {
        let (serial, values) = self.agreed.prepared.plan.base;
        backup_of(Body::new(NovoProfile { serial, values })).emit()
    }
    fn carry_out(&mut self, (): &(), _: &Intended) -> Result<Written, Box<Interrupted>> {
        let (ops, mut done) = (&self.agreed.prepared.plan.ops, Written::default());
        for (number, op) in ops.iter().enumerate() {
            (self.tell)(Tell::Progress(Progress::at(ops, number, op.item)));
            if let Err(cause) = self.perform(op, &mut done) {
                return Err(Box::new(Interrupted { done, cause }));
            }
        }
        Ok(done)
    }
    fn write_cycles(written: &Written) -> u64 {
        written.write_cycles
    }
}

impl Interruption for Interrupted {
    type Error = Error;

    fn error(&self) -> Option<&Error> {
        Some(&self.cause)
    }
    fn why(&self) -> Option<String> {
        (self.cause != Error::Cancelled).then(|| self.cause.to_string())
    }
    fn done(&self) -> usize {
        self.done.ops
    }
    fn write_cycles(&self) -> u64 {
        self.done.write_cycles
    }
}
