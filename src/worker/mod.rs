//! The background I/O worker: one thread a session, one job at a time, and a stop that overtakes everything.
//!
//! Events about a job are never lost. Progress is coalesced: while nobody reads, only the newest is kept. Nobody waits
//! for anybody: a full channel is a state of the worker, not a pause of the line.

pub mod hiperface;
mod open;
mod session;

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread;
use std::time::Duration;

use crossbeam_channel::{Receiver, RecvTimeoutError, Sender, TrySendError, bounded};

pub use hiperface::{
    Change, Commit, Committed, HiperfaceJob, HiperfaceOutput, JobError, JobOutput, Prepared, SavedProfile, Value,
    WEAR_LIMIT,
};
pub use open::{OpenError, open};
pub use session::Session;

use crate::link::{Cancel, LinkError};
use crate::protocol::hiperface::StatusCode;

/// What a session is asked to do.
#[derive(Debug)]
pub enum Job {
    /// Something with a HIPERFACE encoder.
    Hiperface(HiperfaceJob),
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
pub enum Event {
    /// A job has begun.
    Started(JobId),
    /// How far it is.
    Progress(JobId, Progress),
    /// Status codes that the encoder announced on the way.
    Codes(Vec<StatusCode>),
    /// It is done.
    Finished(JobId, Box<JobOutput>),
    /// It failed.
    Failed(JobId, Box<JobError>),
    /// It ended because the user wished it; with what was written until then, where it writes.
    Cancelled(JobId, Box<JobError>),
    /// The wire is gone, found while nothing was to do.
    Lost(LinkError),
}

/// The job slot is taken.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("busy with another job")]
pub struct Busy;

/// A session's thread, seen from outside. Dropping it stops what runs and ends the thread.
pub struct Worker {
    jobs: Sender<(JobId, Job)>,
    events: Receiver<Event>,
    cancel: Cancel,
    busy: Arc<AtomicBool>,
    next: u64,
}

impl Worker {
    /// Events that wait to be read, at most; progress counts once.
    const CAPACITY: usize = 64;
    /// How often an idle worker looks whether its wire is still there.
    const CHECK: Duration = Duration::from_millis(500);

    /// Starts a thread for a session. `wake` is called after each event.
    ///
    /// # Errors
    /// When the system has no thread left.
    pub fn spawn(session: Session, wake: Arc<dyn Fn() + Send + Sync>) -> std::io::Result<Self> {
        let (jobs, incoming) = bounded(1);
        let (outgoing, events) = bounded(Self::CAPACITY);
        let cancel = session.cancel();
        let busy = Arc::new(AtomicBool::new(false));
        let outbox = Outbox { sender: outgoing, wake, waiting: Vec::new(), progress: None };
        let slot = busy.clone();
        thread::Builder::new().name("session".to_owned()).spawn(move || work(session, &incoming, outbox, &slot))?;
        Ok(Worker { jobs, events, cancel, busy, next: 0 })
    }

    /// Gives the worker something to do.
    ///
    /// # Errors
    /// [`Busy`]: jobs do not queue.
    pub fn submit(&mut self, job: Job) -> Result<JobId, Busy> {
        if self.busy.swap(true, Ordering::SeqCst) {
            return Err(Busy);
        }
        self.cancel.reset();
        let id = JobId(self.next);
        self.next += 1;
        self.jobs.try_send((id, job)).map_err(|_| Busy)?;
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
    pub fn events(&self) -> &Receiver<Event> {
        &self.events
    }
}

impl Drop for Worker {
    fn drop(&mut self) {
        self.cancel.request();
    }
}

fn work(mut session: Session, jobs: &Receiver<(JobId, Job)>, mut outbox: Outbox, busy: &AtomicBool) {
    let mut lost = false;
    loop {
        let patience = if outbox.is_empty() { Worker::CHECK } else { Duration::from_millis(5) };
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
struct Outbox {
    sender: Sender<Event>,
    wake: Arc<dyn Fn() + Send + Sync>,
    waiting: Vec<Event>,
    progress: Option<Event>,
}

impl Outbox {
    fn send(&mut self, event: Event) {
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
        if self.sender.len() < Worker::CAPACITY / 2
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

    use super::*;

    fn progress(job: u64) -> Event {
        Event::Progress(JobId(job), Progress { done: 1, total: 2, what: String::new() })
    }

    #[test]
    fn progress_never_overtakes_the_start_of_its_job_and_late_events_wake() {
        let (sender, events) = bounded(Worker::CAPACITY);
        let wakes = Arc::new(AtomicUsize::new(0));
        let counter = wakes.clone();
        let wake = Arc::new(move || {
            counter.fetch_add(1, Ordering::SeqCst);
        });
        let mut outbox = Outbox { sender, wake, waiting: Vec::new(), progress: None };
        for job in 0..Worker::CAPACITY as u64 {
            outbox.send(Event::Started(JobId(job)));
        }
        outbox.send(Event::Started(JobId(1000)));
        outbox.send(progress(1000));
        assert_eq!(events.try_iter().count(), Worker::CAPACITY, "the channel was full");
        let before = wakes.load(Ordering::SeqCst);
        outbox.flush_late();
        assert_eq!(wakes.load(Ordering::SeqCst), before + 1);
        let late: Vec<Event> = events.try_iter().collect();
        assert!(matches!(late.as_slice(), [Event::Started(JobId(1000)), Event::Progress(JobId(1000), _)]), "{late:?}");
    }
}
