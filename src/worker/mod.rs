//! The background I/O worker: one thread a session, one job at a time, and a stop that overtakes everything.
//!
//! Nothing here knows a protocol: a [`Device`] brings its jobs, its results and its errors as types of its own, so that a
//! session with one kind of device cannot be asked for another's.
//!
//! Events about a job are never lost. Progress is coalesced: while nobody reads, only the newest is kept. Nobody waits
//! for anybody: a full channel is a state of the worker, not a pause of the line.

pub mod hiperface;
mod open;
mod session;

use std::fmt;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread;
use std::time::Duration;

use crossbeam_channel::{Receiver, RecvTimeoutError, Sender, TrySendError, bounded};

pub use open::OpenError;
pub use session::{Desk, Session};

use crate::link::{Cancel, LinkError};

/// A kind of device at the end of a session: its wire, what is known about it, and what can be done with it.
pub trait Device: Send + 'static {
    /// What it is asked to do.
    type Job: Send + fmt::Debug;
    /// What a job gives.
    type Output: Send + fmt::Debug;
    /// Why a job ends early.
    type Error: Send + fmt::Debug;
    /// What the device says on the way, whatever it is asked.
    type Remark: Send + fmt::Debug;

    /// Carries out a job.
    ///
    /// # Errors
    /// When it ended early.
    fn run(
        &mut self,
        desk: &mut Desk,
        job: Self::Job,
        tell: &mut dyn FnMut(Progress),
    ) -> Result<Self::Output, Self::Error>;

    /// The error is the user's wish.
    fn is_cancelled(error: &Self::Error) -> bool;

    /// Takes what the device said since the last time.
    fn take_remark(&mut self) -> Option<Self::Remark>;

    /// Looks whether the wire is still there.
    ///
    /// # Errors
    /// When it is not.
    fn check(&mut self) -> Result<(), LinkError>;
}

/// The number of a job within its session.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct JobId(u64);

/// How far a job is.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Progress {
    /// Steps done.
    pub done: u64,
    /// Steps in all.
    pub total: u64,
    /// What is being done: an item, an address.
    pub what: String,
}

/// What a worker tells.
#[derive(Debug)]
pub enum Event<D: Device> {
    /// A job has begun.
    Started(JobId),
    /// How far it is.
    Progress(JobId, Progress),
    /// What the device said on the way.
    Remark(D::Remark),
    /// It is done.
    Finished(JobId, Box<D::Output>),
    /// It failed.
    Failed(JobId, Box<D::Error>),
    /// It ended because the user wished it; with what was written until then, where it writes.
    Cancelled(JobId, Box<D::Error>),
    /// The wire is gone, found while nothing was to do.
    Lost(LinkError),
}

/// Why a job cannot be taken.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum SubmitError {
    /// The job slot is taken; jobs do not queue.
    #[error("busy with another job")]
    Busy,
    /// The worker is gone.
    #[error("the session has ended")]
    Ended,
}

/// A session's thread, seen from outside. Dropping it stops what runs and ends the thread.
pub struct Worker<D: Device> {
    jobs: Sender<(JobId, D::Job)>,
    events: Receiver<Event<D>>,
    cancel: Cancel,
    busy: Arc<AtomicBool>,
    next: u64,
}

/// Events that wait to be read, at most; progress counts once.
const CAPACITY: usize = 64;
/// How often an idle worker looks whether its wire is still there.
const CHECK: Duration = Duration::from_millis(500);

impl<D: Device> Worker<D> {
    /// Starts a thread for a session. `wake` is called after each event.
    ///
    /// # Errors
    /// When the system has no thread left.
    pub fn spawn(session: Session<D>, wake: Arc<dyn Fn() + Send + Sync>) -> std::io::Result<Self> {
        let (jobs, incoming) = bounded(1);
        let (outgoing, events) = bounded(CAPACITY);
        let cancel = session.cancel();
        let busy = Arc::new(AtomicBool::new(false));
        let outbox = Outbox { sender: outgoing, wake, waiting: Vec::new(), progress: None };
        let slot = busy.clone();
        thread::Builder::new().name("session".to_owned()).spawn(move || {
            let slot = Slot(slot);
            work(session, &incoming, outbox, &slot.0);
        })?;
        Ok(Worker { jobs, events, cancel, busy, next: 0 })
    }

    /// Gives the worker something to do.
    ///
    /// # Errors
    /// See [`SubmitError`].
    pub fn submit(&mut self, job: D::Job) -> Result<JobId, SubmitError> {
        if self.busy.swap(true, Ordering::SeqCst) {
            return Err(SubmitError::Busy);
        }
        self.cancel.reset();
        let id = JobId(self.next);
        self.next += 1;
        self.jobs.try_send((id, job)).map_err(|_| SubmitError::Ended)?;
        Ok(id)
    }

    /// Ends the running job at the next point at which it can end.
    pub fn stop(&self) {
        self.cancel.request();
    }

    /// A job runs.
    pub fn is_busy(&self) -> bool {
        self.busy.load(Ordering::SeqCst)
    }

    /// What the worker tells. The channel ends with the worker.
    pub fn events(&self) -> &Receiver<Event<D>> {
        &self.events
    }
}

impl<D: Device> Drop for Worker<D> {
    fn drop(&mut self) {
        self.cancel.request();
    }
}

/// The job slot of a thread: free when the thread is gone, however it ended.
struct Slot(Arc<AtomicBool>);

impl Drop for Slot {
    fn drop(&mut self) {
        self.0.store(false, Ordering::SeqCst);
    }
}

fn work<D: Device>(
    mut session: Session<D>,
    jobs: &Receiver<(JobId, D::Job)>,
    mut outbox: Outbox<D>,
    busy: &AtomicBool,
) {
    let mut lost = false;
    loop {
        let patience = if outbox.is_empty() { CHECK } else { Duration::from_millis(5) };
        match jobs.recv_timeout(patience) {
            Ok((id, job)) => {
                lost = false;
                // The slot is free before the last event tells so: whoever reads it may submit at once.
                let end = session.run(id, job, &mut |event| outbox.send(event));
                busy.store(false, Ordering::SeqCst);
                outbox.send(end);
            }
            Err(RecvTimeoutError::Timeout) => {
                outbox.flush_late();
                if !lost && let Err(error) = session.check() {
                    lost = true;
                    outbox.send(Event::Lost(error));
                }
            }
            Err(RecvTimeoutError::Disconnected) => return,
        }
    }
}

/// Events on their way out. What does not fit into the channel waits here; the number of those is bounded, because a job
/// has a handful and the next one comes from whoever reads them.
struct Outbox<D: Device> {
    sender: Sender<Event<D>>,
    wake: Arc<dyn Fn() + Send + Sync>,
    waiting: Vec<Event<D>>,
    progress: Option<Event<D>>,
}

impl<D: Device> Outbox<D> {
    fn send(&mut self, event: Event<D>) {
        match event {
            Event::Progress(..) => self.progress = Some(event),
            other => {
                // It makes the progress before it old: that goes first or not at all.
                self.flush();
                self.progress = None;
                self.waiting.push(other);
            }
        }
        self.flush();
        (self.wake)();
    }

    fn is_empty(&self) -> bool {
        self.waiting.is_empty() && self.progress.is_none()
    }

    fn flush(&mut self) {
        let mut waiting = std::mem::take(&mut self.waiting).into_iter();
        while let Some(event) = waiting.next() {
            match self.sender.try_send(event) {
                Ok(()) => {}
                Err(TrySendError::Full(event)) => {
                    self.waiting.push(event);
                    self.waiting.extend(waiting);
                    return;
                }
                Err(TrySendError::Disconnected(_)) => return,
            }
        }
        // Behind the start of its job, never before it. Half of the channel is for progress, so that it never stands in
        // the way of an end.
        if self.sender.len() < CAPACITY / 2
            && let Some(progress) = self.progress.take()
        {
            let _ = self.sender.try_send(progress);
        }
    }

    /// Sends what had to wait, and wakes whoever reads.
    fn flush_late(&mut self) {
        if !self.is_empty() {
            self.flush();
            (self.wake)();
        }
    }
}

#[cfg(test)]
mod tests {
    use std::sync::atomic::AtomicUsize;

    use super::hiperface::Hiperface;
    use super::*;

    fn progress(job: u64) -> Event<Hiperface> {
        Event::Progress(JobId(job), Progress { done: 1, total: 2, what: String::new() })
    }

    #[test]
    fn progress_never_overtakes_the_start_of_its_job_and_late_events_wake() {
        let (sender, events) = bounded(CAPACITY);
        let wakes = Arc::new(AtomicUsize::new(0));
        let counter = wakes.clone();
        let wake = Arc::new(move || {
            counter.fetch_add(1, Ordering::SeqCst);
        });
        let mut outbox = Outbox { sender, wake, waiting: Vec::new(), progress: None };
        for job in 0..CAPACITY as u64 {
            outbox.send(Event::Started(JobId(job)));
        }
        outbox.send(Event::Started(JobId(1000)));
        outbox.send(progress(1000));
        assert_eq!(events.try_iter().count(), CAPACITY, "the channel was full");
        let before = wakes.load(Ordering::SeqCst);
        outbox.flush_late();
        assert_eq!(wakes.load(Ordering::SeqCst), before + 1);
        let late: Vec<Event<Hiperface>> = events.try_iter().collect();
        assert!(matches!(late.as_slice(), [Event::Started(JobId(1000)), Event::Progress(JobId(1000), _)]), "{late:?}");
    }
}
