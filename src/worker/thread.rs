//! The thread of a session, which runs jobs as they arrive. Between jobs, it takes samples and watched values, and
//! regularly checks the connection.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use crossbeam_channel::{Receiver, Select, Sender, TryRecvError};

use super::event_sender::EventSender;
use super::live::{LiveRequests, WatchList};
use super::poll_scheduler::{DueRequest, PollScheduler};
use super::{Device, Event, JobId, JobInterruption as _, Ring, Session, WatchReply};
use crate::link::CancelToken;

/// Interval between attempts to send while the channel is full.
const RETRY: Duration = Duration::from_millis(5);

/// A job that is being passed to the thread.
pub(super) struct SubmittedJob<D: Device> {
    pub(super) id: JobId,
    pub(super) job: D::Job,
    pub(super) cancel: CancelToken,
}

/// A type without values. A channel of this type only signals, by closing, that the thread has ended.
pub(super) enum Never {}

/// The state of a session's thread.
pub(super) struct SessionThread<D: Device> {
    pub(super) session: Session<D>,
    pub(super) jobs: Receiver<SubmittedJob<D>>,
    pub(super) changes: Receiver<()>,
    pub(super) live: LiveRequests,
    pub(super) watches: WatchList<D::Watch>,
    pub(super) samples: Ring<D::Sample>,
    pub(super) events: EventSender<D>,
    pub(super) busy: Arc<AtomicBool>,
}

/// Starts the thread. `alive` is dropped last, when the connection is free.
///
/// # Errors
/// Returns an error if the system cannot start another thread.
pub(super) fn start<D: Device>(bench: SessionThread<D>, alive: Sender<Never>) -> std::io::Result<()> {
    std::thread::Builder::new().name("session".to_owned()).spawn(move || {
        let _alive = alive;
        let _slot = Slot(bench.busy.clone());
        run_loop(bench);
    })?;
    Ok(())
}

/// A guard that marks the thread as free for jobs again when it ends, whatever the reason.
struct Slot(Arc<AtomicBool>);

impl Drop for Slot {
    fn drop(&mut self) {
        self.0.store(false, Ordering::SeqCst);
    }
}

fn run_loop<D: Device>(mut bench: SessionThread<D>) {
    let mut agenda = PollScheduler::default();
    let mut known = 0;
    let mut paced = None;
    let mut lost = false;
    let mut next_check = Instant::now() + bench.session.idle_interval();
    loop {
        // The token is reset before the requests for which it was set are read. See `Live::interrupt_sample`.
        bench.live.sampling_cancel_token().reset();
        match bench.jobs.try_recv() {
            Ok(order) => {
                bench.run_job(order);
                lost = false;
                next_check = Instant::now() + bench.session.idle_interval();
                continue;
            }
            Err(TryRecvError::Disconnected) => break,
            Err(TryRecvError::Empty) => {}
        }
        bench.events.flush_and_wake();
        if let Some(watches) = bench.watches.changed_entries(&mut known) {
            agenda.set_watched(watches);
        }
        let polling = bench.live.polling_interval();
        if std::mem::replace(&mut paced, polling) != polling {
            bench.session.set_sample_interval(polling);
        }
        let now = Instant::now();
        let due = agenda.next(polling, now);
        if let Some((at, due)) = &due
            && *at <= now
        {
            if bench.serve_due_request(due) {
                agenda.mark_completed(due, Instant::now());
            }
            bench.run_idle_work();
            lost = false;
            next_check = Instant::now() + bench.session.idle_interval();
            continue;
        }
        if now >= next_check || bench.session.is_urgent() {
            next_check = now + bench.session.idle_interval();
            if !lost && let Err(error) = bench.session.check_connection() {
                lost = true;
                bench.events.send(Event::Lost(error));
            }
            bench.run_idle_work();
        }
        let retry = (!bench.events.is_empty()).then(|| now + RETRY);
        let until = [due.map(|(at, _)| at), retry].into_iter().flatten().fold(next_check, Instant::min);
        bench.wait_for_work(until.saturating_duration_since(Instant::now()));
    }
    if paced.is_some() {
        bench.session.set_sample_interval(None);
    }
    bench.session.restore_state();
}

impl<D: Device> SessionThread<D> {
    fn run_job(&mut self, order: SubmittedJob<D>) {
        self.session.set_cancel(order.cancel);
        let outbox = &mut self.events;
        let end = self.session.run(order.id, order.job, &mut |event| outbox.send(event));
        // The slot must be free before the last event reports it, because the reader may submit a job at once.
        self.busy.store(false, Ordering::SeqCst);
        self.events.send(end);
    }

    /// Takes the sample or watched value that is due. Returns `false` if a job or another request has interrupted it;
    /// it then remains due.
    fn serve_due_request(&mut self, due: &DueRequest<D::Watch>) -> bool {
        self.session.set_cancel(self.live.sampling_cancel_token().clone());
        let request = self.live.request_number();
        let taken = match due {
            DueRequest::Sample => self.session.take_sample(),
            DueRequest::Watch(what) => self.session.watch_value(what).map(|watched| match watched {
                WatchReply::Sample(sample) => sample,
                WatchReply::Refused(sample) => {
                    self.watches.mark_unsupported(what);
                    sample
                }
            }),
        };
        match taken {
            Ok(sample) => self.samples.push(sample),
            Err(error) if error.is_cancelled() => return false,
            Err(error) => {
                self.live.poll_failed(request);
                while let Some(remark) = self.session.take_device_message() {
                    self.events.send(Event::DeviceMessage(remark));
                }
                self.events.send(Event::PollFailed(Box::new(error)));
            }
        }
        true
    }

    fn run_idle_work(&mut self) {
        // A job interrupts this request, just as it interrupts a sample.
        self.session.set_cancel(self.live.sampling_cancel_token().clone());
        if let Some(remark) = self.session.maintain() {
            self.events.send(Event::DeviceMessage(remark));
        }
    }

    /// Waits until a job arrives, a request changes or `patience` has passed. A job is left in its channel for the main
    /// loop.
    fn wait_for_work(&self, patience: Duration) {
        let mut ready = Select::new();
        ready.recv(&self.jobs);
        ready.recv(&self.changes);
        // An error only means that the time has passed and nothing is ready.
        let _ = ready.ready_timeout(patience);
        let _ = self.changes.try_recv();
    }
}
