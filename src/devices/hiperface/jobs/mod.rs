//! Sessions and jobs for HIPERFACE encoders.

mod commit;
mod job;
mod open;
mod prepare;
mod status;
mod types;

use std::fmt;
use std::sync::Arc;

pub use commit::device_key;
pub use job::{
    Change, ChangeKind, Commit, Committed, DeviceMessage, HiperfaceJob, HiperfaceOutput, JobError, JobStep, Prepared,
    SavedProfile, TypeMismatch, Value, WEAR_LIMIT,
};
pub use open::{check_link, may_have_other_master, open};
pub use types::{TypeTableFileError, encoder_types};

use status::RecentStatusCodes;

use crate::analysis::check::Verdict;
use crate::buses::bridge::procedures::log_supply_failure;
use crate::devices::hiperface::procedures::find::SearchProgress;
use crate::devices::hiperface::procedures::{
    self, Codes, Error, Master, PolledSample, Station, WatchedQuantity, check, find, identify, read_analogue,
    read_counter, read_field, read_field_status, read_position, read_range, read_sample, read_status,
    read_watched_value,
};
use crate::devices::hiperface::profile::{FieldRange, Item, PlanError};
use crate::devices::hiperface::protocol::{EncoderTypes, Geometry, StatusCode};
use crate::link::{ByteLink, Clock, LinkError};
use crate::store::{DeviceKey, Store};
use crate::worker::{Device, JobReport, Progress, Session, SessionContext, WatchReply};

pub struct Hiperface {
    wire: Box<dyn ByteLink>,
    station: Station,
    types: Arc<EncoderTypes>,
    /// Geometry from the last identification in this session, used to interpret samples.
    geometry: Option<Geometry>,
    status: RecentStatusCodes,
    /// Number of line errors of each kind that have already been reported.
    reported_line_errors: [u64; 4],
}

impl fmt::Debug for Hiperface {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "Hiperface({})", self.station)
    }
}

impl Hiperface {
    fn create_master<'a>(&'a mut self, context: &'a mut SessionContext) -> Master<'a> {
        Master::new(context.procedure_context(&mut *self.wire), &mut self.station)
    }

    /// Stores status codes before they are displayed. An unknown encoder is identified first, because the codes are
    /// stored in the logbook of the encoder.
    fn store_codes(&mut self, context: &mut SessionContext, codes: &[StatusCode]) {
        if codes.is_empty() {
            return;
        }
        if self.station.identified.is_none() {
            let types = self.types.clone();
            if let Ok(identity) = identify(&mut self.create_master(context), &types) {
                self.geometry = identity.geometry;
            }
        }
        let device = self.identified(context.is_virtual);
        if let Some(device) = &device {
            context.record_identity(device);
        }
        let device = device.unwrap_or_else(|| status::unknown_device(context.is_virtual));
        status::record_codes(&context.store, &device, codes);
    }

    /// Stores the status codes of polled samples. If a code repeats in many samples, it is stored at most once a
    /// minute.
    fn record_sampled_codes(&mut self, context: &mut SessionContext) {
        let codes = self.station.take_unlogged_codes();
        if !codes.is_empty() && self.status.insert_codes(&codes, context.clock.now()) {
            self.store_codes(context, &codes);
        }
    }
}

impl Session<Hiperface> {
    /// Creates a session on an open connection. If `is_virtual` is set, the encoder is simulated in this process, and
    /// its writes are counted separately.
    pub fn new(
        wire: Box<dyn ByteLink>,
        clock: Arc<dyn Clock>,
        station: Station,
        store: Store,
        types: EncoderTypes,
        is_virtual: bool,
    ) -> Self {
        let geometry = station.geometry;
        let (types, status) = (Arc::new(types), RecentStatusCodes::default());
        let device = Hiperface { wire, station, types, geometry, status, reported_line_errors: [0; 4] };
        Session::from_device(device, clock, store, is_virtual)
    }

    pub fn access_codes_mut(&mut self) -> &mut Codes {
        &mut self.device.station.codes
    }

    pub fn station(&self) -> &Station {
        &self.device.station
    }
}

impl Device for Hiperface {
    type Job = HiperfaceJob;
    type Output = HiperfaceOutput;
    type Error = JobError;
    type DeviceMessage = DeviceMessage;
    type Sample = PolledSample;
    type Watch = WatchedQuantity;
    type JobStep = JobStep;

    fn run(
        &mut self,
        context: &mut SessionContext,
        job: HiperfaceJob,
        tell: &mut dyn FnMut(JobReport<DeviceMessage, JobStep>),
    ) -> Result<HiperfaceOutput, JobError> {
        let result = self.execute_job(context, job, tell);
        let codes = self.station.take_unlogged_codes();
        self.store_codes(context, &codes);
        result
    }

    fn identified(&self, is_virtual: bool) -> Option<DeviceKey> {
        let (encoder_type, serial_number) = self.station.identified.as_ref()?;
        Some(commit::logbook_key(*encoder_type, serial_number, is_virtual))
    }

    fn check_verdicts(output: &HiperfaceOutput) -> Option<Vec<Verdict>> {
        match output {
            HiperfaceOutput::Check(lines) => Some(lines.iter().map(|line| line.verdict).collect()),
            _ => None,
        }
    }

    fn take_sample(&mut self, context: &mut SessionContext) -> Result<PolledSample, JobError> {
        let geometry = self.geometry;
        let met_before = self.station.codes_to_display.len();
        let sample = read_sample(&mut self.create_master(context), geometry);
        self.record_sampled_codes(context);
        let sample = sample?;
        // The result already contains these codes.
        self.station.codes_to_display.truncate(met_before);
        Ok(sample)
    }

    fn read_watched(
        &mut self,
        context: &mut SessionContext,
        what: &WatchedQuantity,
    ) -> Result<WatchReply<PolledSample>, JobError> {
        let met_before = self.station.codes_to_display.len();
        let reading = read_watched_value(&mut self.create_master(context), *what);
        self.record_sampled_codes(context);
        let reading = reading?;
        // The result already contains these codes.
        self.station.codes_to_display.truncate(met_before);
        let refused = reading.is_refused();
        let sample = PolledSample::Watched(reading);
        Ok(if refused { WatchReply::Refused(sample) } else { WatchReply::Sample(sample) })
    }

    fn take_device_message(&mut self) -> Option<DeviceMessage> {
        let codes =
            Some(self.station.take_undisplayed_codes()).filter(|codes| !codes.is_empty()).map(DeviceMessage::Codes);
        codes.or_else(|| self.lost_codes_message())
    }

    fn check_connection(&mut self) -> Result<(), LinkError> {
        self.wire.check_connection()
    }

    fn maintain(&mut self, _desk: &mut SessionContext) -> Option<DeviceMessage> {
        if let Some(unheard) = self.lost_codes_message() {
            return Some(unheard);
        }
        let line = &self.station.line;
        // If the line fails, its errors are reported together with the failure.
        if line.has_errors() || line.quality.counts() == self.reported_line_errors {
            return None;
        }
        self.reported_line_errors = line.quality.counts();
        Some(DeviceMessage::Line(line.quality.clone()))
    }

    fn restore_state(&mut self, _context: &mut SessionContext) {
        log_supply_failure(self.wire.restore_state());
    }
}

impl Hiperface {
    fn lost_codes_message(&mut self) -> Option<DeviceMessage> {
        Some(self.station.take_missed_code_count()).filter(|count| *count > 0).map(DeviceMessage::CodesLost)
    }

    fn execute_job(
        &mut self,
        context: &mut SessionContext,
        job: HiperfaceJob,
        tell: &mut dyn FnMut(JobReport<DeviceMessage, JobStep>),
    ) -> Result<HiperfaceOutput, JobError> {
        let types = self.types.clone();
        let steps = &mut |progress| tell(JobReport::Progress(progress));
        Ok(match job {
            HiperfaceJob::Prepare(change) => {
                let prepared = prepare::prepare_plan(self, context, change, steps)?;
                HiperfaceOutput::Prepared(Box::new(prepared))
            }
            HiperfaceJob::Commit(commit) => {
                HiperfaceOutput::Committed(commit::commit_plan(self, context, &commit, steps)?)
            }
            HiperfaceJob::Survey => {
                let progress = &mut |done, total| steps(Progress { done, total, step: JobStep::Field(done) });
                let survey = procedures::read_all_values(&mut self.create_master(context), &types, progress)?;
                self.geometry = survey.identity.geometry;
                HiperfaceOutput::Surveyed(Box::new(survey))
            }
            HiperfaceJob::UseCode { number, code } => {
                self.station.codes.set_code(number, code);
                HiperfaceOutput::CodeNoted
            }
            HiperfaceJob::Identify => {
                let identity = identify(&mut self.create_master(context), &types)?;
                self.geometry = identity.geometry;
                HiperfaceOutput::Identity(identity)
            }
            HiperfaceJob::Status => HiperfaceOutput::Status(read_status(&mut self.create_master(context))?),
            HiperfaceJob::Position(geometry) => {
                HiperfaceOutput::Position(read_position(&mut self.create_master(context), geometry)?)
            }
            HiperfaceJob::Rest => {
                let geometry = self.geometry;
                HiperfaceOutput::Rest(procedures::read_at_rest(&mut self.create_master(context), geometry)?)
            }
            HiperfaceJob::Read(item) => HiperfaceOutput::Value(read_item(&mut self.create_master(context), item)?),
            HiperfaceJob::Save(options) => {
                let progress = &mut |done, total| steps(Progress { done, total, step: JobStep::Field(done) });
                let profile = procedures::save(&mut self.create_master(context), &types, options, progress)?;
                let locked = profile.fields.iter().filter(|field| field.bytes.is_none());
                let locked = locked.map(|field| (field.number, field.status.code())).collect();
                HiperfaceOutput::Saved(Box::new(SavedProfile { profile, locked }))
            }
            HiperfaceJob::Check { restart } => {
                HiperfaceOutput::Check(check::check_encoder(&mut self.create_master(context), &types, restart)?)
            }
            HiperfaceJob::Reset => HiperfaceOutput::Reset(procedures::reset(&mut self.create_master(context))?),
            HiperfaceJob::Find(options) => {
                let watch = &mut |news: SearchProgress<'_>| tell(search_report(news));
                HiperfaceOutput::Found(find::find(&mut self.create_master(context), &options, watch)?)
            }
            HiperfaceJob::ConfigureForNow(settings) => {
                procedures::set_temporary_line_settings(&mut self.create_master(context), settings)?;
                HiperfaceOutput::Configured
            }
        })
    }
}

fn search_report(news: SearchProgress<'_>) -> JobReport<DeviceMessage, JobStep> {
    match news {
        SearchProgress::Trying { done, total, attempt } => {
            JobReport::Progress(Progress { done, total, step: JobStep::Attempt(attempt.clone()) })
        }
        SearchProgress::Found(found) => JobReport::DeviceMessage(DeviceMessage::Found(found.clone())),
    }
}

fn read_item(master: &mut Master<'_>, item: Item) -> Result<Value, JobError> {
    let value = read_value(master, item);
    if let (Item::Field(FieldRange { field, .. }) | Item::Status(field), Err(error)) = (item, &value)
        && error.is_rejection(StatusCode::NO_SUCH_FIELD)
    {
        // The list of existing fields is more helpful than the encoder's rejection.
        let count = procedures::write::read_memory(master)?.fields;
        return Err(PlanError::NoSuchField { field, count }.into());
    }
    Ok(value?)
}

fn read_value(master: &mut Master<'_>, item: Item) -> Result<Value, Error> {
    Ok(match item {
        Item::Field(range) => Value::Bytes(read_field_range(master, range)?),
        Item::Status(field) => Value::Number(read_field_status(master, field)?.byte().into()),
        Item::Analogue(channel) => {
            let value = read_analogue(master, channel)?;
            Value::Analogue { value, limit: procedures::read_analogue_limit(master, channel)? }
        }
        Item::Counter => Value::Number(read_counter(master)?.into()),
        Item::Address => Value::Number(procedures::read_address(master)?.into()),
        Item::Settings => Value::Number(procedures::read_settings(master)?.byte().into()),
    })
}

fn read_field_range(master: &mut Master<'_>, range: FieldRange) -> Result<Vec<u8>, Error> {
    let status = read_field_status(master, range.field)?;
    let size = status.size().bytes();
    let count = range.count.unwrap_or(size.saturating_sub(range.start));
    if count == 0 || range.start.saturating_add(count) > size {
        return Err(Error::OutOfField { field: range.field, address: range.start, count: count.max(1), size });
    }
    if range.start == 0 && count == size {
        let field = read_field(master, range.field)?;
        return field.bytes.ok_or(Error::CodeUnknown { field: range.field, number: status.code() });
    }
    let code = master.station().codes.get(status.code());
    match read_range(master, range.field, range.start, count, code) {
        Err(error) if error.is_rejection(StatusCode::WRONG_CODE) => {
            Err(Error::CodeUnknown { field: range.field, number: status.code() })
        }
        result => result,
    }
}
