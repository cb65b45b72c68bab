//! An INTERBUS encoder behind its gateway, at the end of a session, and its jobs.

mod commit;
mod job;
mod open;
mod prepare;

use std::convert::Infallible;
use std::fmt;
use std::sync::Arc;

pub use job::{
    Change, ChangeKind, Commit, Committed, Doing, InterbusJob, InterbusOutput, JobError, Prepared, Remark, WEAR_ASK,
    WEAR_LAST, WEAR_LIMIT, WEAR_WARNING, Wear, device_key,
};
pub use open::{check, open};

use super::commit::cycles_seen;
use super::{Desk, Device, Progress, Session, Tell, Watched};
use crate::device::interbus::check::{Wear as Limits, check as check_device};
use crate::device::interbus::{
    Handshake, Identity, Kept, Master, Reading, Station, identify, read_item, read_one, read_programs, read_status,
    save, select, survey,
};
use crate::link::{ByteLink, Clock, LinkError};
use crate::protocol::interbus::{ProgramNumber, ReadOut};
use crate::sim::Motor;
use crate::store::Store;

/// An INTERBUS encoder behind its gateway.
pub struct Interbus {
    wire: Box<dyn ByteLink>,
    station: Station,
    /// What turns a virtual encoder.
    motor: Option<Motor>,
}

impl fmt::Debug for Interbus {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "Interbus({})", self.station)
    }
}

/// What a job tells on its way.
type Told<'t> = &'t mut dyn FnMut(Tell<Remark, Doing>);

impl Interbus {
    /// The host's side of the process data; each step of the handshake is told.
    fn master<'a>(&'a mut self, desk: &'a mut Desk, told: impl FnMut(Handshake) + 'a) -> Master<'a> {
        Master::new(desk.ctx(&mut *self.wire), &mut self.station).telling(told)
    }
}

impl Session<Interbus> {
    /// A session on an open wire. With a motor the encoder lives in this process, and its wear counts apart.
    pub fn to_gateway(
        wire: Box<dyn ByteLink>,
        clock: Arc<dyn Clock>,
        station: Station,
        store: Store,
        motor: Option<Motor>,
    ) -> Self {
        let is_virtual = motor.is_some();
        Session::with(Interbus { wire, station, motor }, clock, store, is_virtual)
    }

    /// What is known about the gateway.
    pub fn station(&self) -> &Station {
        &self.device.station
    }

    /// What turns the shaft, where the encoder lives in this process.
    pub fn motor(&self) -> Option<Motor> {
        self.device.motor.clone()
    }
}

impl Device for Interbus {
    type Job = InterbusJob;
    type Output = InterbusOutput;
    type Error = JobError;
    type Remark = Remark;
    type Sample = Reading;
    /// Whatever else there is replaces the position.
    type Watch = Infallible;
    type Doing = Doing;

    fn run(&mut self, desk: &mut Desk, job: InterbusJob, tell: Told<'_>) -> Result<InterbusOutput, JobError> {
        match job {
            InterbusJob::Prepare(change) => {
                Ok(InterbusOutput::Prepared(Box::new(prepare::prepare(self, desk, &change, tell)?)))
            }
            InterbusJob::Commit(commit) => {
                Ok(InterbusOutput::Committed(Box::new(commit::commit(self, desk, &commit, tell)?)))
            }
            job => self.ask(desk, job, tell),
        }
    }

    fn sample(&mut self, desk: &mut Desk) -> Result<Reading, JobError> {
        Ok(self.master(desk, |_| {}).reading()?)
    }

    fn watch(&mut self, _desk: &mut Desk, what: &Infallible) -> Result<Watched<Reading>, JobError> {
        match *what {}
    }

    fn is_cancelled(error: &JobError) -> bool {
        match error {
            JobError::Device(error) => error.is_cancelled(),
            JobError::Interrupted { interrupted, .. } => interrupted.cause.is_cancelled(),
            _ => false,
        }
    }

    fn take_remark(&mut self) -> Option<Remark> {
        None
    }

    fn check(&mut self) -> Result<(), LinkError> {
        self.wire.check()
    }
}

impl Interbus {
    /// What only asks. All of it replaces the position for a moment, but for the IN word alone.
    fn ask(&mut self, desk: &mut Desk, job: InterbusJob, tell: Told<'_>) -> Result<InterbusOutput, JobError> {
        let (store, is_virtual) = (desk.store.clone(), desk.is_virtual);
        let tell = std::cell::RefCell::new(tell);
        let mut master = self.master(desk, |step| (tell.borrow_mut())(Tell::Remark(Remark::Handshake(step))));
        let steps = |done, total, what| (tell.borrow_mut())(Tell::Progress(Progress { done, total, what }));
        let read_out = &mut |done, total, what: ReadOut| steps(done, total, Doing::ReadOut(what));
        let program = &mut |done, total, what: ProgramNumber| steps(done, total, Doing::Program(what));
        Ok(match job {
            InterbusJob::Hello => InterbusOutput::Hello(master.reading()?),
            InterbusJob::Survey => InterbusOutput::Surveyed(Box::new(survey(&mut master, read_out)?)),
            InterbusJob::Programs(wanted) => {
                let (programs, shift) = read_programs(&mut master, &wanted, program)?;
                InterbusOutput::Programs(programs, shift)
            }
            InterbusJob::Identify => InterbusOutput::Identity(Box::new(identify(&mut master)?)),
            InterbusJob::Status => InterbusOutput::Status(Box::new(read_status(&mut master)?)),
            InterbusJob::Check => {
                let wear = |identity: &Identity| Limits {
                    seen: cycles_seen(&store, &device_key(identity, is_virtual)),
                    warning: WEAR_WARNING,
                    limit: WEAR_LIMIT,
                };
                InterbusOutput::Check(check_device(&mut master, wear, read_out)?)
            }
            InterbusJob::Position => InterbusOutput::Position(master.reading()?),
            InterbusJob::Read(item) => InterbusOutput::Item(read_item(&mut master, item)?),
            InterbusJob::ReadOut(what) => InterbusOutput::ReadOut(what, read_one(&mut master, what)?),
            InterbusJob::Select(mode) => InterbusOutput::Selected(select(&mut master, mode)?),
            InterbusJob::Save { programs } => {
                let told = &mut |done, total, what| match what {
                    Kept::ReadOut(what) => steps(done, total, Doing::ReadOut(what)),
                    Kept::Program(what) => steps(done, total, Doing::Program(what)),
                };
                InterbusOutput::Saved(Box::new(save(&mut master, programs, told)?))
            }
            InterbusJob::LeadBack | InterbusJob::Prepare(_) | InterbusJob::Commit(_) => {
                InterbusOutput::LedBack(master.end_what_was_left()?)
            }
        })
    }
}
