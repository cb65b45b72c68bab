//! HIPERDRIVE drives behind an adapter or a hub, at the end of a session: its jobs, the cyclic connection that moves them and
//! the handle for it.

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

use control::Control;
pub use cyclic::{Cyclic, Pump};
pub use job::{
    Change, ChangeKind, Commit, Committed, DeviceMessage, HiperdriveJob, HiperdriveOutput, JobError, JobStep, Prepared,
    WEAR_WARNING, device_key,
};
pub use motion::{DriveView, Glance, Motion, MotionSnapshot};
pub use open::{check, open};
use session_watch::WatchedWire;

use crate::devices::hiperdrive::procedures::check::check as check_device;
use crate::devices::hiperdrive::procedures::{
    DriveReading, Master, Sample, Station, Temperature, identify, network, position, read_status, save, survey,
    temperature,
};
use crate::devices::hiperdrive::protocol::DriveNumber;
use crate::devices::hiperdrive::sim::Target;
use crate::link::{ByteLink, Clock, DatagramPort, LinkError};
use crate::store::Store;
use crate::worker::{Device, IDLE, Progress, Session, SessionContext, Tell, Watched};

/// An adapter or a hub with its drives.
pub struct Hiperdrive {
    wire: Box<dyn ByteLink>,
    station: Station,
    control: Control,
    /// The polled drive.
    watched: DriveNumber,
    /// The virtual one.
    target: Option<Target>,
    remark: Option<DeviceMessage>,
}

impl fmt::Debug for Hiperdrive {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "Hiperdrive({})", self.station)
    }
}

/// Interval of checking drives under control: a fraction of the time allowed between two requests.
const IDLE_IN_CONTROL: Duration = Duration::from_millis(20);

/// Receives the reports of a job.
type ProgressSink<'t> = &'t mut dyn FnMut(Tell<DeviceMessage, JobStep>);

impl Hiperdrive {
    /// The host's side of explicit messages.
    fn master<'a>(&'a mut self, desk: &'a mut SessionContext) -> Master<'a> {
        Master::new(desk.ctx(&mut *self.wire), &mut self.station)
    }
}

/// The start of a session with an adapter or a hub.
pub struct Way {
    /// Explicit messages.
    pub wire: Box<dyn ByteLink>,
    /// Port of cyclic data; `None` for a link without any.
    pub port: Option<Box<dyn DatagramPort>>,
    /// The known state of the device.
    pub station: Station,
    /// The device, where it lives in this process.
    pub target: Option<Target>,
}

impl Session<Hiperdrive> {
    /// A session on open wires. With a target the device lives in this process, and its wear counts apart.
    pub fn to_target(way: Way, clock: Arc<dyn Clock>, store: Store) -> Self {
        let Way { wire, port, station, target } = way;
        let is_virtual = target.is_some();
        let control = Control::new(port, clock.clone());
        let wire = Box::new(WatchedWire::new(wire, clock.clone(), control.motion()));
        let device = Hiperdrive { wire, station, control, watched: DriveNumber::FIRST, target, remark: None };
        Session::with(device, clock, store, is_virtual)
    }

    /// Returns the handle that moves the drives. It is the same for the whole session; without the cyclic connection it
    /// has no effect.
    pub fn motion(&self) -> Motion {
        self.device.control.motion()
    }

    /// Returns the state of the device.
    pub fn station(&self) -> &Station {
        &self.device.station
    }

    /// The device, where it lives in this process.
    pub fn target(&self) -> Option<Target> {
        self.device.target.clone()
    }
}

impl Device for Hiperdrive {
    type Job = HiperdriveJob;
    type Output = HiperdriveOutput;
    type Error = JobError;
    type DeviceMessage = DeviceMessage;
    type Sample = Sample;
    type Watch = Temperature;
    type JobStep = JobStep;

    fn run(
        &mut self,
        desk: &mut SessionContext,
        job: HiperdriveJob,
        tell: ProgressSink<'_>,
    ) -> Result<HiperdriveOutput, JobError> {
        use HiperdriveOutput as Out;
        self.let_go_of_lost(desk);
        let mut step = |done, total, what| tell(Tell::Progress(Progress { done, total, what }));
        let mut parameter = |done, total, number| step(done, total, JobStep::Parameter(number));
        Ok(match job {
            HiperdriveJob::Prepare(change) => Out::Prepared(Box::new(prepare::prepare(self, desk, &change, tell)?)),
            HiperdriveJob::Commit(commit) => Out::Committed(Box::new(self.commit(desk, &commit, tell)?)),
            HiperdriveJob::Hello => Out::Hello(Box::new(identify(&mut self.master(desk), &mut parameter)?)),
            HiperdriveJob::Identify => Out::Identity(Box::new(identify(&mut self.master(desk), &mut parameter)?)),
            HiperdriveJob::Survey => {
                let began = desk.clock.now();
                let survey = survey(&mut self.master(desk), &mut parameter)?;
                self.control.rule_by(&survey, began);
                Out::Surveyed(Box::new(survey))
            }
            HiperdriveJob::Status => Out::Status(Box::new(read_status(&mut self.master(desk), &mut parameter)?)),
            HiperdriveJob::Check => {
                let told = &mut |done, total, what| step(done, total, JobStep::Step(what));
                Out::Check(check_device(&mut self.master(desk), told)?)
            }
            HiperdriveJob::Position(drive) => Out::Position(position(&mut self.master(desk), drive)?),
            HiperdriveJob::Read(number) => Out::Value(number, self.master(desk).read(number)?),
            HiperdriveJob::Network => Out::Network(Box::new(network(&mut self.master(desk))?)),
            HiperdriveJob::Save => Out::Saved(Box::new(save(&mut self.master(desk), &mut parameter)?)),
            HiperdriveJob::Take => {
                self.take(desk, &mut parameter)?;
                Out::Taken
            }
            HiperdriveJob::Give => {
                self.give(desk)?;
                Out::Given
            }
            HiperdriveJob::Watch(drive) => {
                self.watched = drive;
                self.look_anew(desk, drive);
                Out::Watched(drive)
            }
        })
    }

    fn sample(&mut self, desk: &mut SessionContext) -> Result<Sample, JobError> {
        self.let_go_of_lost(desk);
        let drive = self.watched;
        if let Some(actual) = self.control.actual(drive) {
            return Ok(Sample::Position(DriveReading { at: desk.clock.now(), drive, actual }));
        }
        Ok(Sample::Position(position(&mut self.master(desk), drive)?))
    }

    fn watch(&mut self, desk: &mut SessionContext, what: &Temperature) -> Result<Watched<Sample>, JobError> {
        self.let_go_of_lost(desk);
        let reading = temperature(&mut self.master(desk), *what)?;
        let sample = Sample::Temperature(reading);
        Ok(if reading.celsius.is_some() { Watched::Sample(sample) } else { Watched::Refused(sample) })
    }

    fn take_remark(&mut self) -> Option<DeviceMessage> {
        self.remark.take()
    }

    fn check(&mut self) -> Result<(), LinkError> {
        self.wire.check().inspect_err(|_| self.control.lose_session())
    }

    fn idle_interval(&self) -> Duration {
        if self.control.held().is_some() { IDLE_IN_CONTROL } else { IDLE }
    }

    fn idle(&mut self, desk: &mut SessionContext) -> Option<DeviceMessage> {
        self.let_go_of_lost(desk);
        self.look_at_rules(desk);
        self.remark.take()
    }

    /// Drives that are in control are stopped and let go.
    fn leave(&mut self, desk: &mut SessionContext) {
        self.end(desk);
    }

    fn is_urgent(&self) -> bool {
        self.is_to_end()
    }
}
