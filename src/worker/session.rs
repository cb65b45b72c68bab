//! A session: a connection, the data known about the device, and the context for jobs.

use std::sync::Arc;
use std::time::Duration;

use super::{Device, Event, JobId, JobInterruption as _, JobReport, SessionLog, WatchReply};
use crate::link::{CancelToken, Clock, Ctx, LinkError, Trace, TraceEntry};
use crate::store::{DeviceKey, EntryKind, Event as LogbookEvent, Store};

/// The context in which a job runs: clock, cancellation flag, trace and folders.
pub struct SessionContext {
    /// Clock of the session.
    pub clock: Arc<dyn Clock>,
    pub(super) cancel: CancelToken,
    pub(super) trace: Trace,
    /// Folders for backups and the logbook.
    pub store: Store,
    /// Whether the device is simulated in this process. Write cycles of simulated devices are counted separately.
    pub is_virtual: bool,
    log: SessionLog,
}

impl SessionContext {
    /// Returns the context for a procedure on `wire`.
    pub fn procedure_context<'a, W: ?Sized>(&'a mut self, wire: &'a mut W) -> Ctx<'a, W> {
        Ctx { wire, clock: &*self.clock, cancel: &self.cancel, trace: &mut self.trace }
    }

    /// Returns the log of the session, which stays usable after the context is gone.
    pub fn log(&self) -> SessionLog {
        self.log.clone()
    }

    /// Records that a device was identified. Repeated calls for the same device have no effect.
    pub fn record_identity(&self, device: &DeviceKey) {
        self.log.record_identity(&self.store, device);
    }
}

/// A connection from opening to closing. A worker runs its jobs on a separate thread, tests on their own.
pub struct Session<D> {
    context: SessionContext,
    pub(crate) device: D,
}

impl<D: Device> Session<D> {
    /// Creates a session with a device.
    pub fn from_device(device: D, clock: Arc<dyn Clock>, store: Store, is_virtual: bool) -> Self {
        let (cancel, trace) = (CancelToken::default(), Trace::default());
        let log = SessionLog::default();
        Session { context: SessionContext { clock, cancel, trace, store, is_virtual, log }, device }
    }

    /// Makes this session use the caller's log.
    pub fn share_log(&mut self, log: SessionLog) {
        self.context.log = log;
    }

    /// Returns the cancellation flag of the running job.
    pub fn cancel(&self) -> CancelToken {
        self.context.cancel.clone()
    }

    /// Replaces the cancellation flag. Tests use this to cancel automatically.
    pub fn set_cancel(&mut self, cancel: CancelToken) {
        self.context.cancel = cancel;
    }

    /// Passes all subsequent frames to `watcher`.
    pub fn add_watcher(&mut self, watcher: impl FnMut(&TraceEntry) + Send + 'static) {
        self.context.trace.add_watcher(watcher);
    }

    /// Returns whether the device is simulated in this process.
    pub fn is_virtual(&self) -> bool {
        self.context.is_virtual
    }

    /// Checks that the connection still exists.
    ///
    /// # Errors
    /// Returns an error if the connection is lost.
    pub fn check_connection(&mut self) -> Result<(), LinkError> {
        self.device.check_connection()
    }

    /// Returns the interval at which an idle worker checks the device and its connection.
    pub(super) fn idle_interval(&self) -> Duration {
        self.device.idle_interval()
    }

    /// Maintains the connection between jobs and returns a device message, if any.
    pub fn maintain(&mut self) -> Option<D::DeviceMessage> {
        self.context.log.try_to_complete();
        self.device.maintain(&mut self.context)
    }

    pub(super) fn is_urgent(&self) -> bool {
        self.device.is_urgent()
    }

    /// Restores any device state that must not outlive the session.
    pub fn restore_state(&mut self) {
        self.device.restore_state(&mut self.context);
    }

    /// Runs a job on this thread and returns its last event. `tell` receives all others.
    pub fn run(&mut self, id: JobId, job: D::Job, tell: &mut dyn FnMut(Event<D>)) -> Event<D> {
        tell(Event::Started(id));
        let result = self.run_and_record(job, &mut |report| match report {
            JobReport::Progress(progress) => tell(Event::Progress(id, progress)),
            JobReport::DeviceMessage(remark) => tell(Event::DeviceMessage(remark)),
        });
        while let Some(remark) = self.take_device_message() {
            tell(Event::DeviceMessage(remark));
        }
        match result {
            Ok(output) => Event::Finished(id, Box::new(output)),
            Err(error) if error.is_cancelled() => Event::Cancelled(id, Box::new(error)),
            Err(error) => Event::Failed(id, Box::new(error)),
        }
    }

    /// Sets the sampling interval. `None` stops sampling.
    pub fn set_sample_interval(&mut self, interval: Option<Duration>) {
        self.device.set_sample_interval(&mut self.context, interval);
    }

    /// Takes a sample immediately.
    ///
    /// # Errors
    /// Returns an error if the sample could not be taken.
    pub fn take_sample(&mut self) -> Result<D::Sample, D::Error> {
        self.device.take_sample(&mut self.context)
    }

    /// Reads a watched value immediately.
    ///
    /// # Errors
    /// Returns an error if the device did not reply.
    pub fn watch_value(&mut self, what: &D::Watch) -> Result<WatchReply<D::Sample>, D::Error> {
        self.device.read_watched(&mut self.context, what)
    }

    /// Returns the message that the device has sent since the last call, unless an event already contained it.
    pub(super) fn take_device_message(&mut self) -> Option<D::DeviceMessage> {
        self.device.take_device_message()
    }

    /// Runs a job on this thread and returns only its result.
    ///
    /// # Errors
    /// Returns the error of the job.
    pub fn run_inline(&mut self, job: D::Job) -> Result<D::Output, D::Error> {
        self.run_and_record(job, &mut |_| {})
    }

    /// Runs a job, and records its result in the logbook before it is displayed.
    fn run_and_record(
        &mut self,
        job: D::Job,
        tell: &mut dyn FnMut(JobReport<D::DeviceMessage, D::JobStep>),
    ) -> Result<D::Output, D::Error> {
        let result = self.device.run(&mut self.context, job, tell);
        let SessionContext { log, store, is_virtual, .. } = &self.context;
        if let Some(device) = self.device.identified(*is_virtual) {
            log.record_identity(store, &device);
        }
        if let Ok(output) = &result {
            if let Some(codes) = D::status_codes(output) {
                log.record(store, &LogbookEvent::new(EntryKind::Status, codes));
            }
            if let Some(verdicts) = D::check_verdicts(output) {
                log.record_check(store, verdicts);
            }
        }
        result
    }
}
