//! An INTERBUS encoder behind a gateway, for use in a session, and its jobs.

mod commit;
mod job;
mod journal;
mod open;
mod prepare;

use std::convert::Infallible;
use std::fmt;
use std::sync::Arc;

pub use job::{
    Change, ChangeKind, Commit, Committed, DeviceMessage, InterbusJob, InterbusOutput, JobError, JobStep, Prepared,
    WEAR_CONFIRMATION, WEAR_GUARANTEE, WEAR_LIMIT, WEAR_WARNING, WearAfterPlan, device_key, logbook_key, wear_limit,
};
pub use open::{check_link, open};

pub use journal::PROGRAM_READ_NOTE;
use journal::WriteJournal;

use crate::analysis::check::Verdict;
use crate::devices::interbus::procedures::check::{MemoryWear as Limits, check_encoder as check_device};
use crate::devices::interbus::procedures::{
    Error, Handshake, Identity, Master, SaveStep, Station, WordReading, identify, read_all_values, read_item,
    read_programs, read_single_value, read_status, save, select,
};
use crate::devices::interbus::protocol::Reply;
use crate::link::{ByteLink, Clock, LinkError};
use crate::sim::Motor;
use crate::store::{DeviceKey, Store};
use crate::worker::commit::cycles_seen;
use crate::worker::{Device, JobReport, Progress, Session, SessionContext, WatchReply};

pub struct Interbus {
    wire: Box<dyn ByteLink>,
    station: Station,
    motor: Option<Motor>,
}

impl fmt::Debug for Interbus {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "Interbus({})", self.station)
    }
}

type ProgressSink<'t> = &'t mut dyn FnMut(JobReport<DeviceMessage, JobStep>);

impl Interbus {
    /// Creates the master for the encoder. It calls `on_step` at each step of the handshake.
    fn create_master<'a>(
        &'a mut self,
        context: &'a mut SessionContext,
        on_step: impl FnMut(Handshake) + 'a,
    ) -> Master<'a> {
        let notes = WriteJournal::new(context);
        Master::new(context.procedure_context(&mut *self.wire), &mut self.station)
            .with_reporter(on_step)
            .with_journal(notes)
    }
}

impl Session<Interbus> {
    /// Creates a session from an open connection. `motor` is `Some` for a virtual encoder in this process, whose EEPROM
    /// write cycles are counted separately.
    pub fn for_gateway(
        wire: Box<dyn ByteLink>,
        clock: Arc<dyn Clock>,
        station: Station,
        store: Store,
        motor: Option<Motor>,
    ) -> Self {
        let is_virtual = motor.is_some();
        Session::from_device(Interbus { wire, station, motor }, clock, store, is_virtual)
    }

    pub fn station(&self) -> &Station {
        &self.device.station
    }

    /// Returns the motor that turns the shaft of a virtual encoder in this process, or `None` for other encoders.
    pub fn motor(&self) -> Option<Motor> {
        self.device.motor.clone()
    }
}

impl Device for Interbus {
    type Job = InterbusJob;
    type Output = InterbusOutput;
    type Error = JobError;
    type DeviceMessage = DeviceMessage;
    type Sample = WordReading;
    /// Never used: reading any value would replace the position, so there is nothing to watch.
    type Watch = Infallible;
    type JobStep = JobStep;

    fn run(
        &mut self,
        context: &mut SessionContext,
        job: InterbusJob,
        tell: ProgressSink<'_>,
    ) -> Result<InterbusOutput, JobError> {
        use InterbusOutput as Out;
        match job {
            InterbusJob::Prepare(change) => {
                Ok(Out::Prepared(Box::new(prepare::prepare_plan(self, context, &change, tell)?)))
            }
            InterbusJob::Commit(commit) => {
                Ok(Out::Committed(Box::new(commit::commit_plan(self, context, &commit, tell)?)))
            }
            InterbusJob::Hello => {
                self.run_reading_job(context, tell, |master, _| Ok(Out::Hello(master.read_in_word()?)))
            }
            InterbusJob::Position => {
                self.run_reading_job(context, tell, |master, _| Ok(Out::Position(master.read_in_word()?)))
            }
            InterbusJob::Survey => self.run_reading_job(context, tell, |master, steps| {
                let report = &mut |done, total, what| steps(done, total, JobStep::ReadOut(what));
                Ok(Out::Surveyed(Box::new(read_all_values(master, report)?)))
            }),
            InterbusJob::Programs(wanted) => self.run_reading_job(context, tell, |master, steps| {
                let report = &mut |done, total, what| steps(done, total, JobStep::Program(what));
                let (programs, shift) = read_programs(master, &wanted, report)?;
                Ok(Out::Programs(programs, shift))
            }),
            InterbusJob::Identify => {
                self.run_reading_job(context, tell, |master, _| Ok(Out::Identity(Box::new(identify(master)?))))
            }
            InterbusJob::Status => {
                self.run_reading_job(context, tell, |master, _| Ok(Out::Status(Box::new(read_status(master)?))))
            }
            InterbusJob::Check => {
                let (log, store, is_virtual) = (context.log(), context.store.clone(), context.is_virtual);
                let wear = |identity: &Identity| Limits {
                    seen: cycles_seen(&log, &store, &device_key(identity, is_virtual)),
                    warning: WEAR_WARNING,
                    limit: WEAR_LIMIT,
                };
                self.run_reading_job(context, tell, |master, steps| {
                    let report = &mut |done, total, what| steps(done, total, JobStep::ReadOut(what));
                    Ok(Out::Check(check_device(master, wear, report)?))
                })
            }
            InterbusJob::Read(item) => {
                self.run_reading_job(context, tell, |master, _| Ok(Out::Item(read_item(master, item)?)))
            }
            InterbusJob::ReadOut(what) => self
                .run_reading_job(context, tell, |master, _| Ok(Out::ReadOut(what, read_single_value(master, what)?))),
            InterbusJob::Select(mode) => {
                self.run_reading_job(context, tell, |master, _| Ok(Out::Selected(select(master, mode)?)))
            }
            InterbusJob::Save { programs } => self.run_reading_job(context, tell, |master, steps| {
                let report = &mut |done, total, what| match what {
                    SaveStep::ReadOut(what) => steps(done, total, JobStep::ReadOut(what)),
                    SaveStep::Program(what) => steps(done, total, JobStep::Program(what)),
                };
                Ok(Out::Saved(Box::new(save(master, programs, report)?)))
            }),
            InterbusJob::RestoreMode => self
                .run_reading_job(context, tell, |master, _| Ok(Out::ModeRestored(master.end_interrupted_operation()?))),
        }
    }

    fn identified(&self, is_virtual: bool) -> Option<DeviceKey> {
        Some(job::logbook_key(&self.station.serial_number()?.to_string(), is_virtual))
    }

    fn status_codes(output: &InterbusOutput) -> Option<String> {
        let InterbusOutput::Status(status) = output else { return None };
        status.error.map(|error| format!("error word 0x{:08X}", Reply::Error(error).emit()))
    }

    fn check_verdicts(output: &InterbusOutput) -> Option<Vec<Verdict>> {
        match output {
            InterbusOutput::Check(lines) => Some(lines.iter().map(|line| line.verdict).collect()),
            _ => None,
        }
    }

    fn take_sample(&mut self, context: &mut SessionContext) -> Result<WordReading, JobError> {
        Ok(self.create_master(context, |_| {}).read_in_word()?)
    }

    fn read_watched(
        &mut self,
        _desk: &mut SessionContext,
        what: &Infallible,
    ) -> Result<WatchReply<WordReading>, JobError> {
        match *what {}
    }

    fn check_connection(&mut self) -> Result<(), LinkError> {
        self.wire.check_connection()
    }
}

/// Progress callback, called with the number of completed steps, the total, and the current step.
type Steps<'s> = &'s mut dyn FnMut(u64, u64, JobStep);

impl Interbus {
    /// Runs a job that only reads, or one that returns the encoder to its mode. All of these jobs except reading the IN
    /// word briefly replace the position.
    fn run_reading_job(
        &mut self,
        context: &mut SessionContext,
        tell: ProgressSink<'_>,
        ask: impl FnOnce(&mut Master<'_>, Steps<'_>) -> Result<InterbusOutput, Error>,
    ) -> Result<InterbusOutput, JobError> {
        let tell = std::cell::RefCell::new(tell);
        let mut master = self.create_master(context, |step| {
            (tell.borrow_mut())(JobReport::DeviceMessage(DeviceMessage::Handshake(step)))
        });
        let mut steps =
            |done, total, what| (tell.borrow_mut())(JobReport::Progress(Progress { done, total, step: what }));
        Ok(ask(&mut master, &mut steps)?)
    }
}
