//! The BiSS encoder as the device in a session, and its jobs.

mod commit;
mod descriptions;
mod frames;
mod job;
mod open;
mod prepare;

use std::fmt;
use std::sync::Arc;
use std::time::Duration;

pub use descriptions::load_descriptions;
pub use frames::BissFrames;
pub use job::{
    BissJob, BissOutput, Change, ChangeKind, Commit, Committed, DeviceMessage, JobError, JobStep, OperatorPresence,
    Prepared, RegisterValues, WEAR_LIMIT, WEAR_WARNING, device_key, logbook_key,
};
pub use open::{check_link, open};

use crate::analysis::check::Verdict;
use crate::buses::bridge::procedures::log_supply_failure;
use crate::devices::biss::procedures::check::MemoryWear;
use crate::devices::biss::procedures::{
    self, EncoderStatus, Error, FlagRegister, Identity, Master, PolledSample, ReadStep, Station, UnsavedValues,
    identify, procedure, read_position, read_registers, read_sample, read_status, read_watched_value,
};
use crate::devices::biss::profile::RegisterRange;
use crate::devices::biss::protocol::{Descriptions, DeviceMode, RegisterAddress};
use crate::link::{ByteLink, Clock, LinkError};
use crate::sim::Motor;
use crate::store::{DeviceKey, Store, StoreError};
use crate::worker::commit::cycles_seen;
use crate::worker::{Device, JobReport, Progress, Session, SessionContext, WatchReply};

pub struct Biss {
    wire: Box<dyn ByteLink>,
    station: Station,
    types: Arc<Descriptions>,
    /// Errors in user-defined descriptions. They are reported once.
    broken: Vec<StoreError>,
    motor: Option<Motor>,
    /// Interval between streamed frames in microseconds. `None` if single requests are fast enough.
    streamed_us: Option<u32>,
}

/// Longest interval at which an adapter streams positions. At longer intervals, they are requested one by one.
const STREAMING_INTERVAL: Duration = Duration::from_millis(2);

impl fmt::Debug for Biss {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "Biss({})", self.station)
    }
}

impl Biss {
    fn create_master<'a>(&'a mut self, context: &'a mut SessionContext) -> Master<'a> {
        Master::new(context.procedure_context(&mut *self.wire), &mut self.station)
    }

    /// Identifies the encoder, unless this session has already done so. The frame layout and the registers depend on
    /// its type.
    fn ensure_identified(&mut self, context: &mut SessionContext) -> Result<(), Error> {
        if self.station.description.is_none() {
            let types = self.types.clone();
            identify(&mut self.create_master(context), &types)?;
        }
        Ok(())
    }
}

impl Session<Biss> {
    /// Creates a session on an open connection, with the descriptions in `store`. If `motor` is `Some`, the encoder is
    /// simulated in this process and its writes are counted separately.
    pub fn from_connection(
        wire: Box<dyn ByteLink>,
        clock: Arc<dyn Clock>,
        station: Station,
        store: Store,
        motor: Option<Motor>,
    ) -> Self {
        let (types, broken) = load_descriptions(&store);
        let is_virtual = motor.is_some();
        Session::from_device(
            Biss { wire, station, types: Arc::new(types), broken, motor, streamed_us: None },
            clock,
            store,
            is_virtual,
        )
    }

    pub fn station(&self) -> &Station {
        &self.device.station
    }

    /// Returns the motor on the encoder's shaft if the encoder is simulated in this process.
    pub fn motor(&self) -> Option<Motor> {
        self.device.motor.clone()
    }
}

impl Device for Biss {
    type Job = BissJob;
    type Output = BissOutput;
    type Error = JobError;
    type DeviceMessage = DeviceMessage;
    type Sample = PolledSample;
    type Watch = RegisterRange;
    type JobStep = JobStep;

    fn run(
        &mut self,
        context: &mut SessionContext,
        job: BissJob,
        tell: &mut dyn FnMut(JobReport<DeviceMessage, JobStep>),
    ) -> Result<BissOutput, JobError> {
        let types = self.types.clone();
        let steps = &mut |done, total, what| tell(JobReport::Progress(Progress { done, total, step: what }));
        Ok(match job {
            BissJob::Survey => {
                let progress = &mut |done, total, at| steps(done, total, JobStep::Register(at));
                BissOutput::Surveyed(Box::new(procedures::read_all_registers(
                    &mut self.create_master(context),
                    &types,
                    progress,
                )?))
            }
            BissJob::Identify => BissOutput::Identity(Box::new(identify(&mut self.create_master(context), &types)?)),
            BissJob::Status => {
                self.ensure_identified(context)?;
                BissOutput::Status(Box::new(read_status(&mut self.create_master(context))?))
            }
            BissJob::Check => {
                let (log, store, is_virtual) = (context.log(), context.store.clone(), context.is_virtual);
                let wear = |identity: &Identity| MemoryWear {
                    seen: cycles_seen(&log, &store, &device_key(identity, is_virtual)),
                    warning: WEAR_WARNING,
                    limit: WEAR_LIMIT,
                };
                let progress = &mut |done, total, at| steps(done, total, JobStep::Register(at));
                BissOutput::Check(procedures::check::check_encoder(
                    &mut self.create_master(context),
                    &types,
                    wear,
                    progress,
                )?)
            }
            BissJob::Position => {
                self.ensure_identified(context)?;
                BissOutput::Position(read_position(&mut self.create_master(context))?)
            }
            BissJob::Read(range) => self.read(context, range.start(), range.count())?,
            BissJob::ReadDirect => self.read(context, RegisterAddress::BANK_SELECT, RegisterAddress::BANK_SIZE)?,
            BissJob::ReadBank(bank) => {
                self.read(context, RegisterAddress::bank_start(bank), RegisterAddress::BANK_SIZE)?
            }
            BissJob::ReadArea(area) => {
                self.ensure_identified(context)?;
                let first = area.first;
                let total = area.banks().count() as u64;
                let report = &mut |bank: u8| steps(u64::from(bank.saturating_sub(first)), total, JobStep::Bank(bank));
                let banks = procedures::read_area_at_standstill(&mut self.create_master(context), &area, report)?;
                BissOutput::Area { banks, unsaved: self.unsaved_mode(context)? }
            }
            BissJob::Save | BissJob::SaveToCompare => {
                let unsaved = if matches!(job, BissJob::Save) { UnsavedValues::Marked } else { UnsavedValues::Refused };
                let progress = &mut |done, total, place| steps(done, total, read_step(place));
                BissOutput::Saved(Box::new(procedures::save(
                    &mut self.create_master(context),
                    &types,
                    unsaved,
                    progress,
                )?))
            }
            BissJob::Prepare(change) => {
                let steps = &mut |progress| tell(JobReport::Progress(progress));
                BissOutput::Prepared(Box::new(prepare::prepare_plan(self, context, &change, steps)?))
            }
            BissJob::Commit(commit) => {
                let steps = &mut |progress| tell(JobReport::Progress(progress));
                BissOutput::Committed(Box::new(commit::commit_plan(self, context, *commit, steps)?))
            }
            BissJob::ReturnToOperation => {
                let mode = procedure::return_to_operation(&mut self.create_master(context), &types)?;
                self.station.unfinished = false;
                BissOutput::ReturnedToOperation(mode)
            }
        })
    }

    fn identified(&self, is_virtual: bool) -> Option<DeviceKey> {
        let (kind, serial_number) = self.station.identified.as_ref()?;
        Some(job::logbook_key(kind, serial_number, is_virtual))
    }

    fn status_codes(output: &BissOutput) -> Option<String> {
        match output {
            BissOutput::Status(status) => flags_for_logbook(status),
            BissOutput::Surveyed(survey) => flags_for_logbook(&survey.status),
            _ => None,
        }
    }

    fn check_verdicts(output: &BissOutput) -> Option<Vec<Verdict>> {
        match output {
            BissOutput::Check(lines) => Some(lines.iter().map(|line| line.verdict).collect()),
            _ => None,
        }
    }

    fn set_sample_interval(&mut self, context: &mut SessionContext, interval: Option<Duration>) {
        let streamed = interval.filter(|interval| *interval <= STREAMING_INTERVAL);
        let microseconds = streamed.and_then(|interval| u32::try_from(interval.as_micros()).ok());
        self.streamed_us = microseconds.filter(|microseconds| *microseconds > 0);
        if self.streamed_us.is_none()
            && let Err(error) = self.create_master(context).stop_frame_stream()
        {
            tracing::warn!("the adapter's stream could not be ended: {error}");
        }
    }

    fn take_sample(&mut self, context: &mut SessionContext) -> Result<PolledSample, JobError> {
        self.ensure_identified(context)?;
        if let Some(period_us) = self.streamed_us
            && let Some(run) = self.create_master(context).next_frames(period_us)?
        {
            return Ok(PolledSample::Frames(run));
        }
        Ok(read_sample(&mut self.create_master(context))?)
    }

    fn read_watched(
        &mut self,
        context: &mut SessionContext,
        what: &RegisterRange,
    ) -> Result<WatchReply<PolledSample>, JobError> {
        // Determines the data areas, which must not be read while the shaft turns.
        self.ensure_identified(context)?;
        let reading = read_watched_value(&mut self.create_master(context), *what)?;
        let refused = reading.value.is_err();
        let sample = PolledSample::Watched(reading);
        Ok(if refused { WatchReply::Refused(sample) } else { WatchReply::Sample(sample) })
    }

    fn take_device_message(&mut self) -> Option<DeviceMessage> {
        if !self.broken.is_empty() {
            return Some(DeviceMessage::Descriptions(std::mem::take(&mut self.broken)));
        }
        Some(self.station.take_crc_errors()).filter(|count| *count > 0).map(DeviceMessage::CrcErrors)
    }

    fn check_connection(&mut self) -> Result<(), LinkError> {
        self.wire.check_connection()
    }

    fn restore_state(&mut self, context: &mut SessionContext) {
        log_supply_failure(self.create_master(context).switch_off_after_session());
        log_supply_failure(self.wire.restore_state());
    }
}

impl Biss {
    fn read(
        &mut self,
        context: &mut SessionContext,
        start: RegisterAddress,
        count: u8,
    ) -> Result<BissOutput, JobError> {
        self.ensure_identified(context)?;
        let bytes = read_registers(&mut self.create_master(context), start, count)?;
        // Direct registers do not show values that are entered first and saved later.
        let unsaved = if start.bank().is_some() { self.unsaved_mode(context)? } else { None };
        Ok(BissOutput::Registers(RegisterValues { start, bytes, unsaved }))
    }

    /// Returns the device mode if the registers may show values that were never saved.
    fn unsaved_mode(&mut self, context: &mut SessionContext) -> Result<Option<DeviceMode>, Error> {
        let mut master = self.create_master(context);
        let description = master.description()?;
        procedures::write::non_operational_mode(&mut master, &description)
    }
}

fn read_step(place: ReadStep) -> JobStep {
    match place {
        ReadStep::Register(address) => JobStep::Register(address),
        ReadStep::Bank(bank) => JobStep::Bank(bank),
    }
}

/// Returns the errors and warnings that the encoder reports, or `None` if there are none.
fn flags_for_logbook(status: &EncoderStatus) -> Option<String> {
    let list = |weight: &'static str, flags: &Option<FlagRegister>| {
        let bits = flags.as_ref().map(|flags| flags.set.clone()).unwrap_or_default().into_iter();
        let words = bits.map(move |(bit, name)| match name {
            Some(name) => format!("{weight}: {}", name.english()),
            None => format!("{weight}: bit {bit}"),
        });
        words.collect::<Vec<_>>()
    };
    let flags = [list("error", &status.errors), list("warning", &status.warnings)].concat();
    (!flags.is_empty()).then(|| flags.join(", "))
}
