//! The background I/O worker: one thread a session, one job at a time, sampling and watching while there is none, and a
//! stop that overtakes everything.
//!
//! Nothing here knows a protocol: a [`Device`] has its own types of jobs, results and errors, so that a session with one
//! kind of device cannot receive the jobs of another.
//!
//! Events about a job are never lost. Progress is coalesced: while events are not read, only the newest
//! is kept. Neither side waits for the other: a full channel is a state of the worker, not a pause of the line.

#![warn(missing_docs)]

pub mod commit;
mod event_sender;
mod interruption;
#[cfg(test)]
mod invented;
mod live;
pub mod open;
mod poll_scheduler;
mod ring;
mod session;
pub mod stream;
mod thread;

use std::fmt;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

use crossbeam_channel::{Receiver, RecvTimeoutError, Sender, TryRecvError, bounded};

pub use commit::{Committed, NotBegun, check_wear, is_uncounted};
pub use interruption::{EndedEarly, JobError};
pub use live::Stopper;
pub use open::OpenError;
pub use ring::Ring;
pub use session::{Session, SessionContext};

use event_sender::{CAPACITY, EventSender};
use live::{Live, Watches};
use thread::{Bench, Never, Order};

use crate::link::{Cancel, LinkError};

/// A kind of device at the end of a session: its wire, what is known about it, and what can be done with it.
pub trait Device: Send + 'static {
    /// A request to the device.
    type Job: Send + fmt::Debug;
    /// The result of a job.
    type Output: Send + fmt::Debug;
    /// Why a job ends early.
    type Error: EndedEarly + Send + fmt::Debug;
    /// A message that the device sends along with any reply.
    type DeviceMessage: Send + fmt::Debug;
    /// One polled sample; samples of watched values identify themselves.
    type Sample: Send + fmt::Debug + 'static;
    /// A value that can be watched: asked for between two samples.
    type Watch: Clone + PartialEq + Send + fmt::Debug + 'static;
    /// The steps that its jobs tell.
    type JobStep: Clone + Send + fmt::Debug;

    /// Carries out a job.
    ///
    /// # Errors
    /// When it ended early.
    fn run(
        &mut self,
        context: &mut SessionContext,
        job: Self::Job,
        tell: &mut dyn FnMut(JobReport<Self::DeviceMessage, Self::JobStep>),
    ) -> Result<Self::Output, Self::Error>;

    /// Samples are wished at this interval from now on, or none any more: what the device sends by itself begins with the
    /// next sample and ends here.
    fn pace(&mut self, _desk: &mut SessionContext, _interval: Option<Duration>) {}

    /// Takes one sample: as few exchanges as it needs. What the device says on the way belongs to the sample.
    ///
    /// # Errors
    /// When there is none: polling ends.
    fn sample(&mut self, context: &mut SessionContext) -> Result<Self::Sample, Self::Error>;

    /// Asks for a value that is watched. What the device says on the way belongs to the sample.
    ///
    /// # Errors
    /// When it does not answer: polling ends. A refusal is an answer.
    fn watch(&mut self, context: &mut SessionContext, what: &Self::Watch)
    -> Result<Watched<Self::Sample>, Self::Error>;

    /// Takes what the device said since the last time.
    fn take_remark(&mut self) -> Option<Self::DeviceMessage> {
        None
    }

    /// Looks whether the wire is still there.
    ///
    /// # Errors
    /// When it is not.
    fn check(&mut self) -> Result<(), LinkError>;

    /// Returns how often an idle worker checks the device and its wire.
    fn idle_interval(&self) -> Duration {
        IDLE
    }

    /// No job is to do: looks after what goes on without being asked, and tells what there is to say of it.
    fn idle(&mut self, _desk: &mut SessionContext) -> Option<Self::DeviceMessage> {
        None
    }

    /// Returns whether [`idle`](Self::idle) cannot wait for the next check.
    fn is_urgent(&self) -> bool {
        false
    }

    /// The session ends: what must not be left as it is.
    fn leave(&mut self, _desk: &mut SessionContext) {}
}

/// How often an idle worker checks a device that has no work in progress.
pub(crate) const IDLE: Duration = Duration::from_millis(500);

/// The reply to a request for a watched value.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Watched<S> {
    /// The value, or why there is none at the moment.
    Sample(S),
    /// It does not have it, and is not asked again; with the sample that says so.
    Refused(S),
}

/// The number of a job within its session.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub struct JobId(u64);

/// The progress of a job.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Progress<W> {
    /// Steps done.
    pub done: u64,
    /// Steps in all.
    pub total: u64,
    /// The present step.
    pub step: W,
}

impl<W> Progress<W> {
    /// The same progress, with what is being done in other terms.
    pub fn map<T>(self, terms: impl FnOnce(W) -> T) -> Progress<T> {
        Progress { done: self.done, total: self.total, step: terms(self.step) }
    }
}

/// A report from a running job.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum JobReport<R, W> {
    /// Progress of the job.
    Progress(Progress<W>),
    /// A message of the device; each is passed on.
    Remark(R),
}

/// A report from a worker.
#[derive(Debug)]
pub enum Event<D: Device> {
    /// A job has begun.
    Started(JobId),
    /// Progress of a job.
    Progress(JobId, Progress<D::JobStep>),
    /// A message of the device, during a job or at its end.
    Remark(D::DeviceMessage),
    /// It is done.
    Finished(JobId, Box<D::Output>),
    /// It failed.
    Failed(JobId, Box<D::Error>),
    /// It ended because the user wished it; with what was written until then, where it writes.
    Cancelled(JobId, Box<D::Error>),
    /// A sample failed, and polling is off.
    PollFailed(Box<D::Error>),
    /// The wire is gone, found while nothing was to do.
    Lost(LinkError),
}

/// Why a job cannot be accepted.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum SubmitError {
    /// The job slot is taken; jobs do not queue.
    #[error("busy with another job")]
    Busy,
    /// As many events wait to be read as the channel takes: first those.
    #[error("what was told is not read")]
    Unread,
    /// The worker is gone.
    #[error("the session has ended")]
    Ended,
}

/// A session's thread, seen from outside. Dropping it stops what runs and ends the thread, and does not wait for it.
pub struct Worker<D: Device> {
    orders: Sender<Order<D>>,
    events: Receiver<Event<D>>,
    samples: Ring<D::Sample>,
    live: Live,
    watches: Watches<D::Watch>,
    busy: Arc<AtomicBool>,
    ended: Receiver<Never>,
    next: u64,
}

/// Samples that wait to be taken, at most.
const SAMPLES: usize = 4096;

impl<D: Device> Worker<D> {
    /// Starts a thread for a session. `wake` is called after each event, and not for samples.
    ///
    /// # Errors
    /// When the system has no thread left.
    pub fn spawn(session: Session<D>, wake: Arc<dyn Fn() + Send + Sync>) -> std::io::Result<Self> {
        let (orders, incoming) = bounded(1);
        let (outgoing, events) = bounded(CAPACITY);
        let (alive, ended) = bounded(0);
        let (live, changes) = Live::new();
        let watches = Watches::new(live.clone());
        let samples = Ring::new(SAMPLES);
        let busy = Arc::new(AtomicBool::new(false));
        let bench = Bench {
            session,
            orders: incoming,
            changes,
            live: live.clone(),
            watches: watches.clone(),
            samples: samples.clone(),
            events: EventSender::new(outgoing, wake),
            busy: busy.clone(),
        };
        thread::start(bench, alive)?;
        Ok(Worker { orders, events, samples, live, watches, busy, ended, next: 0 })
    }

    /// Gives the worker something to do. It goes before sampling, and waits for no more than the exchange that runs.
    ///
    /// # Errors
    /// See [`SubmitError`].
    pub fn submit(&mut self, job: D::Job) -> Result<JobId, SubmitError> {
        if self.events.is_full() {
            return Err(SubmitError::Unread);
        }
        if self.busy.swap(true, Ordering::SeqCst) {
            return Err(SubmitError::Busy);
        }
        let id = JobId(self.next);
        self.next += 1;
        // Each job has a wish to end of its own: an old one does not concern it, and none is taken back.
        let cancel = Cancel::default();
        self.live.next_job(cancel.clone());
        if self.orders.try_send(Order { id, job, cancel }).is_err() {
            self.busy.store(false, Ordering::SeqCst);
            return Err(SubmitError::Ended);
        }
        self.live.interrupt_sample();
        Ok(id)
    }

    /// Ends polling, and the running job at the next point at which it can end.
    pub fn stop(&self) {
        self.live.stop();
    }

    /// Returns a handle that can [`stop`](Self::stop) without owning the worker.
    pub fn stopper(&self) -> Stopper {
        self.live.stopper()
    }

    /// Wishes samples, one each `interval` from start to start while no job runs, back to back with zero; or none. The
    /// latest wish counts, from now on.
    pub fn poll(&self, interval: Option<Duration>) {
        self.live.poll(interval);
    }

    /// The wish in force: `None` also after a sample failed or a stop.
    pub fn polling(&self) -> Option<Duration> {
        self.live.polling()
    }

    /// Wishes these values watched, each interval from start to start: while the device is polled, between two samples and
    /// at most one of them there, so that none comes more often than samples do. Each has one pace: the first counts
    /// where one stands twice. What the device does not have is asked for once, as long as it stays in the list. The
    /// latest wish counts, from now on; it outlives polling, and watching goes on when that does.
    pub fn watch(&self, watched: Vec<(D::Watch, Duration)>) {
        self.watches.set_entries(watched);
    }

    /// Returns the watched values in the requested order, without those that the device refused.
    pub fn watching(&self) -> Vec<(D::Watch, Duration)> {
        self.watches.asked_for()
    }

    /// Returns the samples, at most 4096 of them; a new sample wakes no one.
    pub fn samples(&self) -> &Ring<D::Sample> {
        &self.samples
    }

    /// A job runs.
    pub fn is_busy(&self) -> bool {
        self.busy.load(Ordering::SeqCst)
    }

    /// Returns the events. The channel ends with the worker.
    pub fn events(&self) -> &Receiver<Event<D>> {
        &self.events
    }

    /// The thread has ended and the wire is free.
    pub fn is_ended(&self) -> bool {
        has_ended(&self.ended)
    }

    /// Asks what runs to end and lets the thread go, without waiting for it.
    pub fn end(self) -> Ending<D> {
        // Dropping the worker does both.
        Ending { events: self.events.clone(), ended: self.ended.clone() }
    }

    /// Does the same as [`end`](Self::end) without taking the worker: no further jobs are accepted. Waits at most
    /// `patience`; returns true when the thread has ended and the wire is free.
    pub fn finish(&mut self, patience: Duration) -> bool {
        self.live.stop();
        // The thread ends when no more orders can arrive.
        self.orders = bounded(0).0;
        matches!(self.ended.recv_timeout(patience), Err(RecvTimeoutError::Disconnected))
    }

    /// [`end`](Self::end), waiting at most `patience`; true when the thread has ended and the wire is free.
    pub fn close(self, patience: Duration) -> bool {
        self.end().wait(patience)
    }
}

impl<D: Device> Drop for Worker<D> {
    fn drop(&mut self) {
        self.live.stop();
    }
}

/// A worker that was let go: its thread ends as soon as what runs has ended.
pub struct Ending<D: Device> {
    events: Receiver<Event<D>>,
    ended: Receiver<Never>,
}

impl<D: Device> Ending<D> {
    /// Returns the remaining events: how the last job ended.
    pub fn events(&self) -> &Receiver<Event<D>> {
        &self.events
    }

    /// The thread has ended and the wire is free.
    pub fn is_ended(&self) -> bool {
        has_ended(&self.ended)
    }

    /// Waits at most `patience` for the end; true when it has come.
    pub fn wait(&self, patience: Duration) -> bool {
        matches!(self.ended.recv_timeout(patience), Err(RecvTimeoutError::Disconnected))
    }
}

fn has_ended(ended: &Receiver<Never>) -> bool {
    matches!(ended.try_recv(), Err(TryRecvError::Disconnected))
}
