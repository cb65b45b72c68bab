//! A BiSS encoder at the end of a session, and its jobs.

mod commit;
mod descriptions;
mod frames;
mod job;
mod open;
mod prepare;

use std::fmt;
use std::sync::Arc;
use std::time::Duration;

pub use descriptions::descriptions;
pub use frames::BissFrames;
pub use job::{
    BissJob, BissOutput, Change, ChangeKind, Commit, Committed, DeviceMessage, JobError, JobStep, OperatorPresence,
    Prepared, ReadRegisters, WEAR_LIMIT, WEAR_WARNING, device_key,
};
pub use open::{check, open};

use crate::buses::bridge::procedures::warn_of_supply;
use crate::devices::biss::procedures::check::Wear;
use crate::devices::biss::procedures::{
    self, Error, Identity, Master, ReadStage, Sample, Station, Unsaved, identify, procedure, read_position,
    read_registers, read_sample, read_status, read_watched,
};
use crate::devices::biss::profile::RegisterRange;
use crate::devices::biss::protocol::{Descriptions, DeviceMode, RegisterAddress};
use crate::link::{ByteLink, Clock, LinkError};
use crate::sim::Motor;
use crate::store::{Store, StoreError};
use crate::worker::commit::cycles_seen;
use crate::worker::{Device, Progress, Session, SessionContext, Tell, Watched};

/// A BiSS encoder at the end of its wire.
pub struct Biss {
    wire: Box<dyn ByteLink>,
    station: Station,
    types: Arc<Descriptions>,
    /// Descriptions of the user's own that cannot be used; told once.
    broken: Vec<StoreError>,
    /// Motor of a virtual encoder.
    motor: Option<Motor>,
    /// Microseconds between the frames of a stream, where they are wished closer than one can ask for them.
    streamed_us: Option<u32>,
}

/// Positions that are wished as close as this come as a stream, where there is an adapter.
const STREAMED: Duration = Duration::from_millis(2);

impl fmt::Debug for Biss {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "Biss({})", self.station)
    }
}

impl Biss {
    /// The host's side of the line.
    fn master<'a>(&'a mut self, desk: &'a mut SessionContext) -> Master<'a> {
        Master::new(desk.ctx(&mut *self.wire), &mut self.station)
    }

    /// Identifies the encoder if it is not known in this session yet: frame and registers depend on it.
    fn know(&mut self, desk: &mut SessionContext) -> Result<(), Error> {
        if self.station.description.is_none() {
            let types = self.types.clone();
            identify(&mut self.master(desk), &types)?;
        }
        Ok(())
    }
}

impl Session<Biss> {
    /// A session on an open wire, with the descriptions of `store`. With a motor the encoder lives in this process, and
    /// its wear counts apart.
    pub fn over(
        wire: Box<dyn ByteLink>,
        clock: Arc<dyn Clock>,
        station: Station,
        store: Store,
        motor: Option<Motor>,
    ) -> Self {
        let (types, broken) = descriptions(&store);
        let is_virtual = motor.is_some();
        Session::with(
            Biss { wire, station, types: Arc::new(types), broken, motor, streamed_us: None },
            clock,
            store,
            is_virtual,
        )
    }

    /// Returns the state of the line and the encoder.
    pub fn station(&self) -> &Station {
        &self.device.station
    }

    /// Returns the motor of the shaft, if the encoder is in this process.
    pub fn motor(&self) -> Option<Motor> {
        self.device.motor.clone()
    }
}

impl Device for Biss {
    type Job = BissJob;
    type Output = BissOutput;
    type Error = JobError;
    type DeviceMessage = DeviceMessage;
    type Sample = Sample;
    type Watch = RegisterRange;
    type JobStep = JobStep;

    fn run(
        &mut self,
        desk: &mut SessionContext,
        job: BissJob,
        tell: &mut dyn FnMut(Tell<DeviceMessage, JobStep>),
    ) -> Result<BissOutput, JobError> {
        let types = self.types.clone();
        let steps = &mut |done, total, what| tell(Tell::Progress(Progress { done, total, what }));
        Ok(match job {
            BissJob::Survey => {
                let progress = &mut |done, total, at| steps(done, total, JobStep::Register(at));
                BissOutput::Surveyed(Box::new(procedures::survey(&mut self.master(desk), &types, progress)?))
            }
            BissJob::Identify => BissOutput::Identity(Box::new(identify(&mut self.master(desk), &types)?)),
            BissJob::Status => {
                self.know(desk)?;
                BissOutput::Status(Box::new(read_status(&mut self.master(desk))?))
            }
            BissJob::Check => {
                let (store, is_virtual) = (desk.store.clone(), desk.is_virtual);
                let wear = |identity: &Identity| Wear {
                    seen: cycles_seen(&store, &device_key(identity, is_virtual)),
                    warning: WEAR_WARNING,
                    limit: WEAR_LIMIT,
                };
                let progress = &mut |done, total, at| steps(done, total, JobStep::Register(at));
                BissOutput::Check(procedures::check::check(&mut self.master(desk), &types, wear, progress)?)
            }
            BissJob::Position => {
                self.know(desk)?;
                BissOutput::Position(read_position(&mut self.master(desk))?)
            }
            BissJob::Read(range) => self.read(desk, range.start(), range.count())?,
            BissJob::ReadDirect => self.read(desk, RegisterAddress::BANK_SELECT, RegisterAddress::BANK_SIZE)?,
            BissJob::ReadBank(bank) => self.read(desk, RegisterAddress::start_of(bank), RegisterAddress::BANK_SIZE)?,
            BissJob::ReadArea(area) => {
                self.know(desk)?;
                let first = area.first;
                let total = area.banks().count() as u64;
                let told = &mut |bank: u8| steps(u64::from(bank.saturating_sub(first)), total, JobStep::Bank(bank));
                let banks = procedures::read_area_surely(&mut self.master(desk), &area, told)?;
                BissOutput::Area { banks, unsaved: self.unsaved(desk)? }
            }
            BissJob::Save | BissJob::SaveToCompare => {
                let unsaved = if matches!(job, BissJob::Save) { Unsaved::Marked } else { Unsaved::Refused };
                let progress = &mut |done, total, place| steps(done, total, read_step(place));
                BissOutput::Saved(Box::new(procedures::save(&mut self.master(desk), &types, unsaved, progress)?))
            }
            BissJob::Prepare(change) => {
                let steps = &mut |progress| tell(Tell::Progress(progress));
                BissOutput::Prepared(Box::new(prepare::prepare(self, desk, &change, steps)?))
            }
            BissJob::Commit(commit) => {
                let steps = &mut |progress| tell(Tell::Progress(progress));
                BissOutput::Committed(Box::new(commit::commit(self, desk, *commit, steps)?))
            }
            BissJob::LeadBack => {
                let mode = procedure::lead_back(&mut self.master(desk), &types)?;
                self.station.unfinished = false;
                BissOutput::LedBack(mode)
            }
        })
    }

    fn pace(&mut self, desk: &mut SessionContext, interval: Option<Duration>) {
        let streamed = interval.filter(|interval| *interval <= STREAMED);
        let microseconds = streamed.and_then(|interval| u32::try_from(interval.as_micros()).ok());
        self.streamed_us = microseconds.filter(|microseconds| *microseconds > 0);
        if self.streamed_us.is_none()
            && let Err(error) = self.master(desk).end_frames()
        {
            tracing::warn!("the adapter's stream could not be ended: {error}");
        }
    }

    fn sample(&mut self, desk: &mut SessionContext) -> Result<Sample, JobError> {
        self.know(desk)?;
        if let Some(period_us) = self.streamed_us
            && let Some(run) = self.master(desk).frames(period_us)?
        {
            return Ok(Sample::Frames(run));
        }
        Ok(read_sample(&mut self.master(desk))?)
    }

    fn watch(&mut self, desk: &mut SessionContext, what: &RegisterRange) -> Result<Watched<Sample>, JobError> {
        // Determines the data areas, which must not be read while the shaft turns.
        self.know(desk)?;
        let reading = read_watched(&mut self.master(desk), *what)?;
        let refused = reading.value.is_err();
        let sample = Sample::Watched(reading);
        Ok(if refused { Watched::Refused(sample) } else { Watched::Sample(sample) })
    }

    fn take_remark(&mut self) -> Option<DeviceMessage> {
        if !self.broken.is_empty() {
            return Some(DeviceMessage::Descriptions(std::mem::take(&mut self.broken)));
        }
        Some(self.station.take_crc_errors()).filter(|count| *count > 0).map(DeviceMessage::CrcErrors)
    }

    fn check(&mut self) -> Result<(), LinkError> {
        self.wire.check()
    }

    fn leave(&mut self, desk: &mut SessionContext) {
        warn_of_supply(self.master(desk).leave_supply());
    }
}

impl Biss {
    fn read(&mut self, desk: &mut SessionContext, start: RegisterAddress, count: u8) -> Result<BissOutput, JobError> {
        self.know(desk)?;
        let bytes = read_registers(&mut self.master(desk), start, count)?;
        // Direct registers hold nothing that is entered first and saved later.
        let unsaved = if start.bank().is_some() { self.unsaved(desk)? } else { None };
        Ok(BissOutput::Registers(ReadRegisters { start, bytes, unsaved }))
    }

    /// The device mode in which registers may show what was never saved.
    fn unsaved(&mut self, desk: &mut SessionContext) -> Result<Option<DeviceMode>, Error> {
        let mut master = self.master(desk);
        let description = master.description()?;
        procedures::write::unsaved_mode(&mut master, &description)
    }
}

fn read_step(place: ReadStage) -> JobStep {
    match place {
        ReadStage::Register(address) => JobStep::Register(address),
        ReadStage::Bank(bank) => JobStep::Bank(bank),
    }
}
