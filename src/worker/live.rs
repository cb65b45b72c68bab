//! Requests to a worker while its thread is running: cancellation, sampling interval and watched values. Requests are
//! not queued: a new one replaces the previous one of its type.

use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::Duration;

use crossbeam_channel::{Receiver, Sender, bounded};

use crate::link::CancelToken;

/// Maximum interval of polling and of watched values. Longer intervals are shortened to this.
const MAX_INTERVAL: Duration = Duration::from_secs(24 * 60 * 60);

/// The current requests to a session, shared by all clones.
#[derive(Clone)]
pub(super) struct LiveRequests {
    requests: Arc<Mutex<PollRequests>>,
    sampling: CancelToken,
    /// Channel that wakes the thread. A full channel means that the thread is about to wake anyway.
    changed: Sender<()>,
}

struct PollRequests {
    /// Cancellation token of the running job or, if none is running, of the last one.
    job: CancelToken,
    interval: Option<Duration>,
    /// Number of the polling request. A failed sample ends polling only if it belongs to this request.
    number: u64,
}

impl LiveRequests {
    /// Creates the requests with their initial values, and the receiver that notifies the thread of changes.
    pub(super) fn new() -> (Self, Receiver<()>) {
        let (changed, changes) = bounded(1);
        let requests = Arc::new(Mutex::new(PollRequests { job: CancelToken::default(), interval: None, number: 0 }));
        (LiveRequests { requests, sampling: CancelToken::default(), changed }, changes)
    }

    /// Sets the job that the next stop cancels.
    pub(super) fn set_job_cancel_token(&self, cancel: CancelToken) {
        self.lock().job = cancel;
    }

    pub(super) fn stop(&self) {
        let mut requests = self.lock();
        requests.interval = None;
        requests.job.request();
        drop(requests);
        self.interrupt_sample();
        self.wake_thread();
    }

    pub(super) fn poll(&self, interval: Option<Duration>) {
        let mut requests = self.lock();
        requests.interval = interval.map(|interval| interval.min(MAX_INTERVAL));
        requests.number += 1;
        drop(requests);
        if interval.is_none() {
            self.interrupt_sample();
        }
        self.wake_thread();
    }

    pub(super) fn polling_interval(&self) -> Option<Duration> {
        self.lock().interval
    }

    pub(super) fn request_number(&self) -> u64 {
        self.lock().number
    }

    /// Ends polling after a sample has failed, unless a newer request has replaced `number`. Called by the thread.
    pub(super) fn poll_failed(&self, number: u64) {
        let mut requests = self.lock();
        if requests.number == number {
            requests.interval = None;
        }
    }

    /// Interrupts a running sample. The caller must store its request first, because the thread resets the token before
    /// reading the requests.
    pub(super) fn interrupt_sample(&self) {
        self.sampling.request();
    }

    pub(super) fn sampling_cancel_token(&self) -> &CancelToken {
        &self.sampling
    }

    pub(super) fn stop_handle(&self) -> WorkerStopHandle {
        WorkerStopHandle(self.clone())
    }

    fn wake_thread(&self) {
        // If the channel is full, the thread has not read the previous request yet. It will read both.
        let _ = self.changed.try_send(());
    }

    fn lock(&self) -> MutexGuard<'_, PollRequests> {
        self.requests.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// The values to watch between samples while polling, shared by all clones.
pub(super) struct WatchList<W> {
    list: Arc<Mutex<WatchEntries<W>>>,
    live: LiveRequests,
}

struct WatchEntries<W> {
    entries: Vec<WatchEntry<W>>,
    number: u64,
}

struct WatchEntry<W> {
    value: W,
    interval: Duration,
    /// Whether the device has rejected the value. A rejected value stays in the list but is no longer requested.
    refused: bool,
}

impl<W: Clone + PartialEq> WatchList<W> {
    /// Creates an empty watch list. The thread is notified of changes through `live`.
    pub(super) fn new(live: LiveRequests) -> Self {
        WatchList { list: Arc::new(Mutex::new(WatchEntries { entries: Vec::new(), number: 0 })), live }
    }

    /// Sets the values to watch. If a value is listed twice, its first entry is used.
    pub(super) fn set_entries(&self, watched: Vec<(W, Duration)>) {
        let mut list = self.lock();
        let mut entries: Vec<WatchEntry<W>> = Vec::with_capacity(watched.len());
        for (what, interval) in watched {
            if entries.iter().any(|entry| entry.value == what) {
                continue;
            }
            let refused = list.entries.iter().any(|before| before.value == what && before.refused);
            entries.push(WatchEntry { value: what, interval: interval.min(MAX_INTERVAL), refused });
        }
        list.entries = entries;
        list.number += 1;
        drop(list);
        // The running request may no longer be needed.
        self.live.interrupt_sample();
        self.live.wake_thread();
    }

    /// Returns the [active entries](Self::active_entries) if the list has changed since `known`, and updates `known`.
    pub(super) fn changed_entries(&self, known: &mut u64) -> Option<Vec<(W, Duration)>> {
        let list = self.lock();
        let changed = std::mem::replace(known, list.number) != list.number;
        changed.then(|| list.active_entries())
    }

    /// Returns the watched values and their intervals, except those that the device has rejected.
    pub(super) fn active_entries(&self) -> Vec<(W, Duration)> {
        self.lock().active_entries()
    }

    /// Records that the device does not have a value.
    pub(super) fn mark_unsupported(&self, what: &W) {
        let mut list = self.lock();
        list.number += 1;
        if let Some(entry) = list.entries.iter_mut().find(|entry| entry.value == *what) {
            entry.refused = true;
        }
    }

    fn lock(&self) -> MutexGuard<'_, WatchEntries<W>> {
        self.list.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl<W: Clone> WatchEntries<W> {
    fn active_entries(&self) -> Vec<(W, Duration)> {
        let asked = self.entries.iter().filter(|entry| !entry.refused);
        asked.map(|entry| (entry.value.clone(), entry.interval)).collect()
    }
}

impl<W> Clone for WatchList<W> {
    fn clone(&self) -> Self {
        WatchList { list: self.list.clone(), live: self.live.clone() }
    }
}

/// A handle that can stop a worker without owning it. All clones stop the same worker.
#[derive(Clone)]
pub struct WorkerStopHandle(LiveRequests);

impl WorkerStopHandle {
    /// Ends polling and stops the running job at the next possible point. Jobs submitted later are not affected.
    pub fn stop(&self) {
        self.0.stop();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn failure_ends_only_its_request() {
        let (live, _changes) = LiveRequests::new();
        live.poll(Some(Duration::from_millis(50)));
        let earlier = live.request_number();
        live.poll(Some(Duration::from_millis(200)));
        live.poll_failed(earlier);
        assert_eq!(live.polling_interval(), Some(Duration::from_millis(200)));
        live.poll_failed(live.request_number());
        assert_eq!(live.polling_interval(), None);
    }

    #[test]
    fn rejected_watch_is_retried_after_removal() {
        let second = Duration::from_secs(1);
        let watches = WatchList::new(LiveRequests::new().0);
        let mut known = 0;
        assert_eq!(watches.changed_entries(&mut known), None);
        watches.set_entries(vec![("a", second), ("b", second), ("a", second * 2)]);
        assert_eq!(watches.changed_entries(&mut known), Some(vec![("a", second), ("b", second)]));
        watches.mark_unsupported(&"a");
        assert_eq!(watches.changed_entries(&mut known), Some(vec![("b", second)]));
        assert_eq!(watches.changed_entries(&mut known), None, "known by now");
        watches.set_entries(vec![("a", second), ("b", Duration::MAX)]);
        assert_eq!(watches.active_entries(), [("b", MAX_INTERVAL)]);
        watches.set_entries(vec![]);
        watches.set_entries(vec![("a", second)]);
        assert_eq!(watches.active_entries(), [("a", second)]);
    }
}
