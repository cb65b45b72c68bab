//! Sending of events from a session's thread. Events about jobs are never lost, but only the latest progress is kept.
//! The thread never blocks.

use std::sync::Arc;

use crossbeam_channel::{Sender, TrySendError};

use super::{Device, Event};

/// Maximum number of unread events. Pending progress counts as one event.
pub(super) const CAPACITY: usize = 64;

/// A sender with a queue for events that do not fit into the channel. The queue never holds events of more than one
/// job, because no job starts while the channel is full.
pub(super) struct EventSender<D: Device> {
    sender: Sender<Event<D>>,
    wake: Arc<dyn Fn() + Send + Sync>,
    waiting: Vec<Event<D>>,
    progress: Option<Event<D>>,
}

impl<D: Device> EventSender<D> {
    pub(super) fn new(sender: Sender<Event<D>>, wake: Arc<dyn Fn() + Send + Sync>) -> Self {
        EventSender { sender, wake, waiting: Vec::new(), progress: None }
    }

    pub(super) fn send(&mut self, event: Event<D>) {
        match event {
            Event::Progress(..) => self.progress = Some(event),
            other => {
                // The event makes earlier progress obsolete. Progress is therefore sent first or not at all.
                self.flush();
                self.progress = None;
                self.waiting.push(other);
            }
        }
        self.flush();
        (self.wake)();
    }

    pub(super) fn is_empty(&self) -> bool {
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
        // Progress is never sent before the start of its job. It uses only half of the channel, so it never blocks the
        // end of a job.
        if self.sender.len() < CAPACITY / 2
            && let Some(progress) = self.progress.take()
        {
            let _ = self.sender.try_send(progress);
        }
    }

    /// Sends the queued events and wakes the reader.
    pub(super) fn flush_and_wake(&mut self) {
        if !self.is_empty() {
            self.flush();
            (self.wake)();
        }
    }
}

#[cfg(test)]
mod tests {
    use std::sync::atomic::{AtomicUsize, Ordering};

    use crossbeam_channel::bounded;

    use super::*;
    use crate::worker::test_device::TestDevice;
    use crate::worker::{JobId, Progress};

    fn progress(job: u64) -> Event<TestDevice> {
        Event::Progress(JobId(job), Progress { done: 1, total: 2, step: () })
    }

    #[test]
    fn progress_follows_job_start() {
        let (sender, events) = bounded(CAPACITY);
        let wakes = Arc::new(AtomicUsize::new(0));
        let counter = wakes.clone();
        let wake = Arc::new(move || {
            counter.fetch_add(1, Ordering::SeqCst);
        });
        let mut outbox = EventSender::new(sender, wake);
        for job in 0..CAPACITY as u64 {
            outbox.send(Event::Started(JobId(job)));
        }
        outbox.send(Event::Started(JobId(1000)));
        outbox.send(progress(1000));
        assert_eq!(events.try_iter().count(), CAPACITY, "the channel was full");
        let before = wakes.load(Ordering::SeqCst);
        outbox.flush_and_wake();
        assert_eq!(wakes.load(Ordering::SeqCst), before + 1);
        let late: Vec<Event<TestDevice>> = events.try_iter().collect();
        assert!(matches!(late.as_slice(), [Event::Started(JobId(1000)), Event::Progress(JobId(1000), _)]), "{late:?}");
    }
}
