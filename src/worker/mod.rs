//! The background I/O worker. Each session has a thread that runs one job at a time. Samples and watched values are
//! read between jobs, and a stop takes precedence over everything else.
//!
//! This module does not depend on a protocol. Each [`Device`] has its own types of jobs, results and errors, so a
//! session with one kind of device cannot receive the jobs of another.
//!
//! Events about jobs are never lost. While events are not read, only the latest progress is kept. Neither side waits
//! for the other: a full channel does not stop communication with the device.

#![warn(missing_docs)]

pub mod commit;
mod event_sender;
mod interruption;
mod live;
pub mod open;
mod poll_scheduler;
mod ring;
mod session;
mod session_log;
pub mod stream;
#[cfg(test)]
mod test_device;
mod thread;

use std::fmt;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

use crossbeam_channel::{Receiver, RecvTimeoutError, Sender, TryRecvError, bounded};

pub use commit::{CommitResult, NotStarted, check_wear, is_incomplete, is_uncounted};
pub use interruption::{JobError, JobInterruption};
pub use live::WorkerStopHandle;
pub use open::OpenError;
pub use ring::Ring;
pub use session::{Session, SessionContext};
pub use session_log::{SessionLog, record_event};

use event_sender::{CAPACITY, EventSender};
use live::{LiveRequests, WatchList};
use thread::{Never, SessionThread, SubmittedJob};

use crate::analysis::check::Verdict;
use crate::link::{CancelToken, LinkError};
use crate::store::DeviceKey;

/// A kind of device as run by a session: its connection, known data and jobs.
pub trait Device: Send + 'static {
    /// A request to the device.
    type Job: Send + fmt::Debug;
    /// The result of a job.
    type Output: Send + fmt::Debug;
    /// The reason why a job was aborted.
    type Error: JobInterruption + Send + fmt::Debug;
    /// A message that the device sends in addition to its replies.
    type DeviceMessage: Send + fmt::Debug;
    /// A polled sample. If it contains a watched value, it also identifies the value.
    type Sample: Send + fmt::Debug + 'static;
    /// A value that can be watched, which means that it is requested between two samples.
    type Watch: Clone + PartialEq + Send + fmt::Debug + 'static;
    /// A step reported by a job.
    type JobStep: Clone + Send + fmt::Debug;

    /// Executes a job.
    ///
    /// # Errors
    /// Returns the reason if the job was aborted.
    fn run(
        &mut self,
        context: &mut SessionContext,
        job: Self::Job,
        tell: &mut dyn FnMut(JobReport<Self::DeviceMessage, Self::JobStep>),
    ) -> Result<Self::Output, Self::Error>;

    /// Returns the key of the device identified last. The default is for devices without a serial number.
    fn identified(&self, _is_virtual: bool) -> Option<DeviceKey> {
        None
    }

    /// Returns the status codes in a result, for the logbook. The default is for devices without status codes, or that
    /// record them as they are read.
    fn status_codes(_output: &Self::Output) -> Option<String> {
        None
    }

    /// Returns the verdicts of a device check, or `None` for the result of any other job.
    fn check_verdicts(_output: &Self::Output) -> Option<Vec<Verdict>> {
        None
    }

    /// Sets the interval of the following samples. `None` stops sampling. Data that the device sends without requests
    /// start with the next sample and stop with `None`.
    fn set_sample_interval(&mut self, _desk: &mut SessionContext, _interval: Option<Duration>) {}

    /// Takes one sample with as few exchanges as possible. Any messages from the device in the meantime are part of the
    /// sample.
    ///
    /// # Errors
    /// Returns an error if there is no sample. This ends polling.
    fn take_sample(&mut self, context: &mut SessionContext) -> Result<Self::Sample, Self::Error>;

    /// Requests a watched value. Any messages from the device in the meantime are part of the sample.
    ///
    /// # Errors
    /// Returns an error if the device does not answer. This ends polling. Rejecting the request counts as an answer.
    fn read_watched(
        &mut self,
        context: &mut SessionContext,
        what: &Self::Watch,
    ) -> Result<WatchReply<Self::Sample>, Self::Error>;

    /// Takes the message that the device has sent since the last call, if any.
    fn take_device_message(&mut self) -> Option<Self::DeviceMessage> {
        None
    }

    /// Checks that the connection still exists.
    ///
    /// # Errors
    /// Returns an error if the connection is lost.
    fn check_connection(&mut self) -> Result<(), LinkError>;

    /// Returns the interval at which an idle worker checks the device and its connection.
    fn idle_interval(&self) -> Duration {
        IDLE
    }

    /// Maintains the connection while no job is running. Returns a message from the device, if any.
    fn maintain(&mut self, _desk: &mut SessionContext) -> Option<Self::DeviceMessage> {
        None
    }

    /// Returns whether [`maintain`](Self::maintain) must be called before the next regular check.
    fn is_urgent(&self) -> bool {
        false
    }

    /// Restores any device state that must not outlive the session.
    fn restore_state(&mut self, _desk: &mut SessionContext) {}
}

/// Interval at which an idle worker checks a device.
pub(crate) const IDLE: Duration = Duration::from_millis(500);

/// The reply to a request for a watched value.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum WatchReply<S> {
    /// The value, or the reason why it is currently not available.
    Sample(S),
    /// The device does not have the value. The sample contains the rejection, and the value is not requested again.
    Refused(S),
}

/// The number of a job, unique within its session.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub struct JobId(u64);

/// The progress of a job.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Progress<W> {
    /// Number of completed steps.
    pub done: u64,
    /// Total number of steps.
    pub total: u64,
    /// Current step.
    pub step: W,
}

impl<W> Progress<W> {
    /// Returns the progress with its step converted by `terms`.
    pub fn map_step<T>(self, terms: impl FnOnce(W) -> T) -> Progress<T> {
        Progress { done: self.done, total: self.total, step: terms(self.step) }
    }
}

/// A report from a running job.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum JobReport<R, W> {
    /// Progress of the job.
    Progress(Progress<W>),
    /// A message from the device. Every message is passed on.
    DeviceMessage(R),
}

/// A report from a worker.
#[derive(Debug)]
pub enum Event<D: Device> {
    /// A job has begun.
    Started(JobId),
    /// Progress of a job.
    Progress(JobId, Progress<D::JobStep>),
    /// A message from the device during a job or at its end.
    DeviceMessage(D::DeviceMessage),
    /// A job has been completed. Contains its result.
    Finished(JobId, Box<D::Output>),
    /// The job failed.
    Failed(JobId, Box<D::Error>),
    /// The user cancelled the job. For a writing job, the error includes the changes already written.
    Cancelled(JobId, Box<D::Error>),
    /// A sample failed, and polling has stopped.
    PollFailed(Box<D::Error>),
    /// The connection was lost while no job was running.
    Lost(LinkError),
}

/// The reason why a job was not accepted.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum SubmitError {
    /// Another job is running. Jobs are not queued.
    #[error("busy with another job")]
    Busy,
    /// The channel is full. Unread events must be read first.
    #[error("the channel is full of unread events")]
    Unread,
    /// The worker has ended.
    #[error("the session has ended")]
    Ended,
}

/// A handle to a session's thread. Dropping it stops the running work and ends the thread, without waiting.
pub struct Worker<D: Device> {
    jobs: Sender<SubmittedJob<D>>,
    events: Receiver<Event<D>>,
    samples: Ring<D::Sample>,
    live: LiveRequests,
    watches: WatchList<D::Watch>,
    busy: Arc<AtomicBool>,
    ended: Receiver<Never>,
    next: u64,
}

/// Maximum number of samples waiting to be taken.
const SAMPLES: usize = 4096;

impl<D: Device> Worker<D> {
    /// Starts a thread for a session. `wake` is called after each event, but not for samples.
    ///
    /// # Errors
    /// Returns an error if the system cannot create a thread.
    pub fn spawn(session: Session<D>, wake: Arc<dyn Fn() + Send + Sync>) -> std::io::Result<Self> {
        let (jobs, incoming) = bounded(1);
        let (outgoing, events) = bounded(CAPACITY);
        let (alive, ended) = bounded(0);
        let (live, changes) = LiveRequests::new();
        let watches = WatchList::new(live.clone());
        let samples = Ring::new(SAMPLES);
        let busy = Arc::new(AtomicBool::new(false));
        let bench = SessionThread {
            session,
            jobs: incoming,
            changes,
            live: live.clone(),
            watches: watches.clone(),
            samples: samples.clone(),
            events: EventSender::new(outgoing, wake),
            busy: busy.clone(),
        };
        thread::start(bench, alive)?;
        Ok(Worker { jobs, events, samples, live, watches, busy, ended, next: 0 })
    }

    /// Submits a job. It takes precedence over sampling and waits only for an exchange in progress.
    ///
    /// # Errors
    /// Returns a [`SubmitError`] if the job is not accepted.
    pub fn submit(&mut self, job: D::Job) -> Result<JobId, SubmitError> {
        if self.events.is_full() {
            return Err(SubmitError::Unread);
        }
        if self.busy.swap(true, Ordering::SeqCst) {
            return Err(SubmitError::Busy);
        }
        let id = JobId(self.next);
        self.next += 1;
        // Each job has its own cancellation token, which is never reset, so the cancellation of an earlier job does not
        // affect it.
        let cancel = CancelToken::default();
        self.live.set_job_cancel_token(cancel.clone());
        if self.jobs.try_send(SubmittedJob { id, job, cancel }).is_err() {
            self.busy.store(false, Ordering::SeqCst);
            return Err(SubmitError::Ended);
        }
        self.live.interrupt_sample();
        Ok(id)
    }

    /// Ends polling and stops the running job at the next possible point.
    pub fn stop(&self) {
        self.live.stop();
    }

    /// Returns a handle that can [`stop`](Self::stop) the worker without owning it.
    pub fn stop_handle(&self) -> WorkerStopHandle {
        self.live.stop_handle()
    }

    /// Requests samples while no job is running. `interval` is the time from the start of one sample to the start of
    /// the next. With an interval of zero, each sample starts as soon as the previous one has ended. `None` stops
    /// sampling. A new request takes effect immediately.
    pub fn poll(&self, interval: Option<Duration>) {
        self.live.poll(interval);
    }

    /// Returns the current polling interval, or `None` if polling is off, for example after a failed sample or a stop.
    pub fn polling_interval(&self) -> Option<Duration> {
        self.live.polling_interval()
    }

    /// Sets the values to watch, each with its request interval, measured from start to start. Duplicates are ignored,
    /// and a new list replaces the previous one. While the device is polled, at most one value is requested between two
    /// samples. A value that the device does not have is requested only once. The list is kept when polling ends, and
    /// watching resumes with polling.
    pub fn watch_values(&self, watched: Vec<(D::Watch, Duration)>) {
        self.watches.set_entries(watched);
    }

    /// Returns the watched values in listed order, without those that the device has rejected.
    pub fn watched_values(&self) -> Vec<(D::Watch, Duration)> {
        self.watches.active_entries()
    }

    /// Returns the ring of samples, which holds at most 4096. New samples do not call `wake`.
    pub fn samples(&self) -> &Ring<D::Sample> {
        &self.samples
    }

    /// Returns whether a job is running.
    pub fn is_busy(&self) -> bool {
        self.busy.load(Ordering::SeqCst)
    }

    /// Returns the event channel, which closes when the worker ends.
    pub fn events(&self) -> &Receiver<Event<D>> {
        &self.events
    }

    /// Returns whether the thread has ended and the connection is free.
    pub fn is_finished(&self) -> bool {
        has_ended(&self.ended)
    }

    /// Cancels the running work and ends the thread, without waiting for it.
    pub fn end(self) -> EndingWorker<D> {
        // Dropping the worker does both.
        EndingWorker { events: self.events.clone(), ended: self.ended.clone() }
    }

    /// Ends the thread like [`end`](Self::end), without consuming the worker. No further jobs are accepted. Waits for
    /// at most `patience` and returns whether the thread has ended and the connection is free.
    pub fn finish(&mut self, patience: Duration) -> bool {
        self.live.stop();
        // The thread ends as soon as no more jobs can arrive.
        self.jobs = bounded(0).0;
        matches!(self.ended.recv_timeout(patience), Err(RecvTimeoutError::Disconnected))
    }

    /// Ends the thread like [`end`](Self::end), then waits for at most `patience`. Returns whether the thread has ended
    /// and the connection is free.
    pub fn close(self, patience: Duration) -> bool {
        self.end().wait_for_end(patience)
    }
}

impl<D: Device> Drop for Worker<D> {
    fn drop(&mut self) {
        self.live.stop();
    }
}

/// A worker that is ending. Its thread ends together with the running work.
pub struct EndingWorker<D: Device> {
    events: Receiver<Event<D>>,
    ended: Receiver<Never>,
}

impl<D: Device> EndingWorker<D> {
    /// Returns the channel with the remaining events, which report how the last job ended.
    pub fn events(&self) -> &Receiver<Event<D>> {
        &self.events
    }

    /// Returns whether the thread has ended and the connection is free.
    pub fn is_finished(&self) -> bool {
        has_ended(&self.ended)
    }

    /// Waits for at most `patience` and returns whether the thread has ended.
    pub fn wait_for_end(&self, patience: Duration) -> bool {
        matches!(self.ended.recv_timeout(patience), Err(RecvTimeoutError::Disconnected))
    }
}

fn has_ended(ended: &Receiver<Never>) -> bool {
    matches!(ended.try_recv(), Err(TryRecvError::Disconnected))
}
