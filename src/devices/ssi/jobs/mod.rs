//! Sessions with an SSI encoder behind an adapter, and their jobs. The encoder has no memory, so nothing is written to
//! it.

mod families;
mod open;

use std::convert::Infallible;
use std::fmt;
use std::sync::Arc;
use std::time::Duration;

pub use families::families;
pub use open::{check_link, open};

use crate::buses::bridge::procedures::log_supply_failure;
use crate::devices::ssi::procedures::{ClockSettings, Error, Identity, Master, Station, Words, check};
use crate::devices::ssi::protocol::Layout;
use crate::link::{ByteLink, Clock, LinkError};
use crate::sim::Motor;
use crate::store::Store;
use crate::worker::{Device, JobInterruption, JobReport, Progress, Session, SessionContext, WatchReply};

pub struct Ssi {
    wire: Box<dyn ByteLink>,
    station: Station,
    motor: Option<Motor>,
    /// Interval between streamed SSI words in microseconds, or `None` if words are requested one at a time.
    streamed_us: Option<u32>,
}

#[derive(Clone, Debug, PartialEq)]
pub enum SsiJob {
    /// Identifies the adapter, switches on the encoder supply if requested, and configures how SSI words are read.
    Hello,
    /// Changes the settings for reading SSI words. A running stream continues with the new settings.
    Set(ClockSettings),
    Read,
    /// Runs the device check, which compares SSI words with the layout.
    Check(Box<Layout>),
}

#[derive(Clone, Debug, PartialEq)]
pub enum SsiOutput {
    Hello(Box<Identity>),
    Set(Box<Identity>),
    Read(Words),
    Check(Vec<check::SsiStepResult>),
}

/// The only step of any job, which is reading SSI words.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct JobStep;

pub type JobError = Error;

impl JobInterruption for Error {
    fn is_cancelled(&self) -> bool {
        *self == Error::Cancelled
    }
}

/// Maximum interval at which SSI words are streamed. At longer intervals, each word is requested individually.
const STREAMING_INTERVAL: Duration = Duration::from_millis(2);

impl fmt::Debug for Ssi {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "Ssi({})", self.station)
    }
}

impl Ssi {
    fn create_master<'a>(&'a mut self, context: &'a mut SessionContext) -> Master<'a> {
        Master::new(context.procedure_context(&mut *self.wire), &mut self.station)
    }
}

impl Session<Ssi> {
    /// Creates a session on an open connection. `motor` is `Some` for a virtual encoder in this process.
    pub fn for_adapter(
        wire: Box<dyn ByteLink>,
        clock: Arc<dyn Clock>,
        station: Station,
        store: Store,
        motor: Option<Motor>,
    ) -> Self {
        let is_virtual = motor.is_some();
        Session::from_device(Ssi { wire, station, motor, streamed_us: None }, clock, store, is_virtual)
    }

    pub fn request_settings(&mut self, clock_settings: ClockSettings) {
        self.device.station.clock_settings = clock_settings;
    }

    pub fn station(&self) -> &Station {
        &self.device.station
    }

    /// Returns the motor that turns the shaft of a virtual encoder in this process.
    pub fn motor(&self) -> Option<Motor> {
        self.device.motor.clone()
    }
}

impl Device for Ssi {
    type Job = SsiJob;
    type Output = SsiOutput;
    type Error = JobError;
    /// SSI encoders send only words, so there are no messages.
    type DeviceMessage = Infallible;
    type Sample = Words;
    /// SSI encoders send only words, so there is nothing else to watch.
    type Watch = Infallible;
    type JobStep = JobStep;

    fn run(
        &mut self,
        context: &mut SessionContext,
        job: SsiJob,
        tell: &mut dyn FnMut(JobReport<Infallible, JobStep>),
    ) -> Result<SsiOutput, JobError> {
        let mut master = self.create_master(context);
        Ok(match job {
            SsiJob::Hello => SsiOutput::Hello(Box::new(master.identify()?)),
            SsiJob::Set(clock_settings) => SsiOutput::Set(Box::new(master.apply_settings(clock_settings)?)),
            SsiJob::Read => SsiOutput::Read(master.read_word()?),
            SsiJob::Check(layout) => {
                let progress = &mut |done, total| tell(JobReport::Progress(Progress { done, total, step: JobStep }));
                SsiOutput::Check(check::check_encoder(&mut master, &layout, progress)?)
            }
        })
    }

    fn set_sample_interval(&mut self, context: &mut SessionContext, interval: Option<Duration>) {
        let streamed = interval.filter(|interval| *interval <= STREAMING_INTERVAL);
        let microseconds = streamed.and_then(|interval| u32::try_from(interval.as_micros()).ok());
        self.streamed_us = microseconds.filter(|microseconds| *microseconds > 0);
        if interval.is_none() {
            self.station.reset_request_count();
        }
        if self.streamed_us.is_none()
            && let Err(error) = self.create_master(context).stop_word_stream()
        {
            tracing::warn!("the adapter's stream could not be ended: {error}");
        }
    }

    fn take_sample(&mut self, context: &mut SessionContext) -> Result<Words, JobError> {
        match self.streamed_us {
            Some(period_us) => self.create_master(context).next_words(period_us),
            None => self.create_master(context).next_word(),
        }
    }

    fn read_watched(&mut self, _desk: &mut SessionContext, what: &Infallible) -> Result<WatchReply<Words>, JobError> {
        match *what {}
    }

    fn check_connection(&mut self) -> Result<(), LinkError> {
        self.wire.check_connection()
    }

    fn restore_state(&mut self, context: &mut SessionContext) {
        log_supply_failure(self.create_master(context).switch_off_after_session());
    }
}
