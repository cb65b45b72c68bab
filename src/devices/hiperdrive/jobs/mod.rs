//! HIPERDRIVE devices in a session: their jobs, the cyclic connection that moves the drives, and the motion handle.

mod commit;
mod control;
mod cyclic;
mod job;
mod motion;
mod open;
mod prepare;
mod rules_refresh;
mod session_watch;

use std::fmt;
use std::sync::Arc;
use std::time::Duration;

use control::CyclicControl;
pub use cyclic::{Cyclic, CyclicRunner};
pub use job::{
    Change, ChangeKind, Commit, Committed, DeviceMessage, HiperdriveJob, HiperdriveOutput, JobError, JobStep, Prepared,
    WEAR_WARNING, device_key, logbook_key,
};
pub use motion::{DriveSnapshot, DrivesSnapshot, Motion, MotionSnapshot};
pub use open::{check_link, open};
use session_watch::MonitoredLink;

use crate::analysis::check::Verdict;
use crate::devices::hiperdrive::procedures::check::check_device;
use crate::devices::hiperdrive::procedures::{
    DriveReading, Master, PolledSample, Station, Temperature, identify, network, position, read_status, read_survey,
    save, temperature,
};
use crate::devices::hiperdrive::protocol::DriveNumber;
use crate::devices::hiperdrive::sim::Target;
use crate::link::{ByteLink, Clock, DatagramPort, LinkError};
use crate::store::{DeviceKey, Store};
use crate::worker::{Device, IDLE, JobReport, Progress, Session, SessionContext, WatchReply};

pub struct Hiperdrive {
    wire: Box<dyn ByteLink>,
    station: Station,
    control: CyclicControl,
    watched: DriveNumber,
    target: Option<Target>,
    remark: Option<DeviceMessage>,
}

impl fmt::Debug for Hiperdrive {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "Hiperdrive({})", self.station)
    }
}

/// Interval between checks of the drives under control. It must be well below the maximum interval between requests.
const CONTROL_CHECK_INTERVAL: Duration = Duration::from_millis(20);

type ProgressSink<'t> = &'t mut dyn FnMut(JobReport<DeviceMessage, JobStep>);

impl Hiperdrive {
    fn create_master<'a>(&'a mut self, context: &'a mut SessionContext) -> Master<'a> {
        Master::new(context.procedure_context(&mut *self.wire), &mut self.station)
    }
}

pub struct DeviceConnection {
    pub wire: Box<dyn ByteLink>,
    /// Port for cyclic data, or `None` if the link has none.
    pub port: Option<Box<dyn DatagramPort>>,
    pub station: Station,
    /// Virtual device, if it runs in this process.
    pub target: Option<Target>,
}

impl Session<Hiperdrive> {
    /// Creates a session on an open connection. `target` is the virtual device if it runs in this process. Its saves
    /// are counted separately.
    pub fn for_target(way: DeviceConnection, clock: Arc<dyn Clock>, store: Store) -> Self {
        let DeviceConnection { wire, port, station, target } = way;
        let is_virtual = target.is_some();
        let control = CyclicControl::new(port, clock.clone());
        let wire = Box::new(MonitoredLink::new(wire, clock.clone(), control.motion()));
        let device = Hiperdrive { wire, station, control, watched: DriveNumber::FIRST, target, remark: None };
        Session::from_device(device, clock, store, is_virtual)
    }

    /// Returns the handle that moves the drives. The handle stays the same for the whole session and has no effect
    /// while there is no cyclic connection.
    pub fn motion(&self) -> Motion {
        self.device.control.motion()
    }

    pub fn station(&self) -> &Station {
        &self.device.station
    }

    /// Returns the virtual device, if it runs in this process.
    pub fn target(&self) -> Option<Target> {
        self.device.target.clone()
    }
}

impl Device for Hiperdrive {
    type Job = HiperdriveJob;
    type Output = HiperdriveOutput;
    type Error = JobError;
    type DeviceMessage = DeviceMessage;
    type Sample = PolledSample;
    type Watch = Temperature;
    type JobStep = JobStep;

    fn run(
        &mut self,
        context: &mut SessionContext,
        job: HiperdriveJob,
        tell: ProgressSink<'_>,
    ) -> Result<HiperdriveOutput, JobError> {
        use HiperdriveOutput as Out;
        self.release_lost_control(context);
        let mut step = |done, total, what| tell(JobReport::Progress(Progress { done, total, step: what }));
        let mut parameter = |done, total, number| step(done, total, JobStep::Parameter(number));
        Ok(match job {
            HiperdriveJob::Prepare(change) => {
                Out::Prepared(Box::new(prepare::prepare_plan(self, context, &change, tell)?))
            }
            HiperdriveJob::Commit(commit) => Out::Committed(Box::new(self.commit_plan(context, &commit, tell)?)),
            HiperdriveJob::Hello => Out::Hello(Box::new(identify(&mut self.create_master(context), &mut parameter)?)),
            HiperdriveJob::Identify => {
                Out::Identity(Box::new(identify(&mut self.create_master(context), &mut parameter)?))
            }
            HiperdriveJob::Survey => {
                let began = context.clock.now();
                let survey = read_survey(&mut self.create_master(context), &mut parameter)?;
                self.control.update_permits(&survey, began);
                Out::Surveyed(Box::new(survey))
            }
            HiperdriveJob::Status => {
                Out::Status(Box::new(read_status(&mut self.create_master(context), &mut parameter)?))
            }
            HiperdriveJob::Check => {
                let report = &mut |done, total, what| step(done, total, JobStep::Step(what));
                Out::Check(check_device(&mut self.create_master(context), report)?)
            }
            HiperdriveJob::Position(drive) => Out::Position(position(&mut self.create_master(context), drive)?),
            HiperdriveJob::Read(number) => Out::Value(number, self.create_master(context).read(number)?),
            HiperdriveJob::Network => Out::Network(Box::new(network(&mut self.create_master(context))?)),
            HiperdriveJob::Save => Out::Saved(Box::new(save(&mut self.create_master(context), &mut parameter)?)),
            HiperdriveJob::Take => {
                self.take_control(context, &mut parameter)?;
                Out::Taken
            }
            HiperdriveJob::Give => {
                self.release(context)?;
                Out::Given
            }
            HiperdriveJob::Watch(drive) => {
                self.watched = drive;
                self.restart_refresh(context, drive);
                Out::Watched(drive)
            }
        })
    }

    fn identified(&self, is_virtual: bool) -> Option<DeviceKey> {
        let (category, serial_number) = self.station.identified.as_ref()?;
        Some(job::logbook_key(category, serial_number, is_virtual))
    }

    fn status_codes(output: &HiperdriveOutput) -> Option<String> {
        let HiperdriveOutput::Status(status) = output else { return None };
        let codes: Vec<String> = status
            .drives
            .iter()
            .filter(|drive| !drive.buffer.is_empty())
            .map(|drive| {
                let codes: Vec<String> = drive.buffer.iter().map(|code| format!("{:04X}h", code.code())).collect();
                format!("drive {}: {}", drive.number.get(), codes.join(", "))
            })
            .collect();
        (!codes.is_empty()).then(|| codes.join("; "))
    }

    fn check_verdicts(output: &HiperdriveOutput) -> Option<Vec<Verdict>> {
        match output {
            HiperdriveOutput::Check(lines) => Some(lines.iter().map(|line| line.verdict).collect()),
            _ => None,
        }
    }

    fn take_sample(&mut self, context: &mut SessionContext) -> Result<PolledSample, JobError> {
        self.release_lost_control(context);
        let drive = self.watched;
        if let Some(actual) = self.control.actual_values(drive) {
            return Ok(PolledSample::Position(DriveReading { at: context.clock.now(), drive, actual }));
        }
        Ok(PolledSample::Position(position(&mut self.create_master(context), drive)?))
    }

    fn read_watched(
        &mut self,
        desk: &mut SessionContext,
        what: &Temperature,
    ) -> Result<WatchReply<PolledSample>, JobError> {
        self.release_lost_control(desk);
        let reading = match self.control.temperature(*what)? {
            Some(reading) => reading,
            None => temperature(&mut self.create_master(desk), *what)?,
        };
        let sample = PolledSample::Temperature(reading);
        Ok(if reading.celsius.is_some() { WatchReply::Sample(sample) } else { WatchReply::Refused(sample) })
    }

    fn take_device_message(&mut self) -> Option<DeviceMessage> {
        self.remark.take()
    }

    fn check_connection(&mut self) -> Result<(), LinkError> {
        self.wire.check_connection().inspect_err(|_| self.control.stop_after_session_loss())
    }

    fn idle_interval(&self) -> Duration {
        if self.control.controlled_device().is_some() { CONTROL_CHECK_INTERVAL } else { IDLE }
    }

    fn maintain(&mut self, context: &mut SessionContext) -> Option<DeviceMessage> {
        self.release_lost_control(context);
        self.refresh_rules(context);
        self.remark.take()
    }

    /// Stops and releases the drives that are under control.
    fn restore_state(&mut self, context: &mut SessionContext) {
        self.end_session(context);
    }

    fn is_urgent(&self) -> bool {
        self.should_release_control()
    }
}
