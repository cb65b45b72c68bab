//! Streams of samples that arrive without requests. A separate thread collects the samples in a bounded ring, which
//! drops and counts the oldest ones. The thread never waits for the reader, and wakes the window at intervals rather
//! than for each batch.
//!
//! This module does not depend on the source of the samples, which are supplied by a [`Producer`].

mod analogue;
#[cfg(test)]
mod tests;

use std::collections::VecDeque;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::Duration;

use crossbeam_channel::{Receiver, RecvTimeoutError, Sender, bounded};

pub use analogue::{AnalogueSource, StaleSettings};

use super::has_ended;
use super::thread::Never;
use crate::analysis::SampleTime;
use crate::analysis::wiring::Wires;
use crate::link::Clock;

/// Maximum duration of a single wait in a producer, after which a stop or a change takes effect.
pub(crate) const MAX_WAIT: Duration = Duration::from_millis(20);
/// Minimum interval between two wake-ups of the window.
const WAKE_INTERVAL: Duration = Duration::from_millis(50);

/// A series of samples at equal intervals.
#[derive(Clone, Debug, PartialEq)]
pub struct Batch<S> {
    /// Number of the first sample, as counted by the source from 0.
    pub first: u64,
    /// Time at which the first sample was taken.
    pub time: SampleTime,
    /// Interval between samples in nanoseconds.
    pub period_ns: i64,
    /// Number of samples lost before this batch, either at the source or because they were not read in time.
    pub lost: u64,
    /// The samples.
    pub samples: S,
}

/// A collection that knows its number of samples.
pub trait SampleCount: Send + 'static {
    /// Returns the number of samples.
    fn count(&self) -> usize;
}

/// A source of samples, either virtual or an adapter.
pub trait Producer: Send + 'static {
    /// A change of settings while the source is running.
    type Request: Send + 'static;
    /// The samples of a batch.
    type Samples: SampleCount;
    /// The reason why the source ended unexpectedly.
    type Error: Send + 'static;

    /// Applies a change of settings, starting with the next sample.
    fn apply_change(&mut self, request: Self::Request);

    /// Waits for samples for at most `patience`. Returns `None` if none have arrived.
    ///
    /// # Errors
    /// Returns an error if no more samples will arrive.
    fn next(&mut self, clock: &dyn Clock, patience: Duration) -> Result<Option<Batch<Self::Samples>>, Self::Error>;

    /// Ends the stream at the source, which would otherwise keep sending.
    fn end(&mut self, _clock: &dyn Clock) {}
}

/// A signal that a stream has ended, for code that needs the same resources.
#[derive(Clone, Debug)]
pub struct StreamEnd(Receiver<Never>);

impl StreamEnd {
    /// Waits for at most `patience`, and returns whether the thread has ended and its resources are free.
    pub fn wait_for_end(&self, patience: Duration) -> bool {
        matches!(self.0.recv_timeout(patience), Err(RecvTimeoutError::Disconnected))
    }

    /// Returns whether the thread has ended and its resources are free.
    pub fn has_ended(&self) -> bool {
        has_ended(&self.0)
    }
}

/// A producer running on a separate thread. Dropping the stream ends the thread without waiting for it.
pub struct Stream<P: Producer> {
    shared: Arc<Shared<P>>,
    ended: Receiver<Never>,
}

struct Shared<P: Producer> {
    ring: Mutex<Ring<P::Samples>>,
    /// Latest request that the thread has not taken yet.
    request: Mutex<Option<P::Request>>,
    error: Mutex<Option<P::Error>>,
    stop: AtomicBool,
}

struct Ring<S> {
    batches: VecDeque<Batch<S>>,
    held: usize,
    capacity: usize,
    /// Number of samples lost since the start.
    lost: u64,
}

impl<P: Producer> Stream<P> {
    /// Starts a thread for a producer. The buffer holds at most `capacity` samples, or one larger batch. `wake` is
    /// called when the stream ends, and at most 20 times per second while there is data to read.
    ///
    /// # Errors
    /// Returns an error if the system cannot create a thread.
    pub fn spawn(
        producer: P,
        capacity: usize,
        clock: Arc<dyn Clock>,
        wake: Arc<dyn Fn() + Send + Sync>,
    ) -> std::io::Result<Self> {
        let shared = Arc::new(Shared {
            ring: Mutex::new(Ring { batches: VecDeque::new(), held: 0, capacity, lost: 0 }),
            request: Mutex::new(None),
            error: Mutex::new(None),
            stop: AtomicBool::new(false),
        });
        let (alive, ended) = bounded(0);
        let (own, end) = (shared.clone(), ExitSignal { alive: Some(alive), wake });
        std::thread::Builder::new().name("stream".to_owned()).spawn(move || run_loop(producer, &own, &*clock, &end))?;
        Ok(Stream { shared, ended })
    }

    /// Requests a change of the producer's settings, starting with its next sample. An earlier pending request is
    /// replaced.
    pub fn request_change(&self, request: P::Request) {
        *lock(&self.shared.request) = Some(request);
    }

    /// Takes the batches received since the last call, oldest first.
    pub fn take_batches(&self) -> Vec<Batch<P::Samples>> {
        let mut ring = lock(&self.shared.ring);
        ring.held = 0;
        let batches = std::mem::take(&mut ring.batches);
        drop(ring);
        batches.into()
    }

    /// Returns the number of samples lost since the start, at the source or because they were not read in time.
    pub fn lost_samples(&self) -> u64 {
        lock(&self.shared.ring).lost
    }

    /// Returns, only once, the reason why the stream ended unexpectedly.
    pub fn take_error(&self) -> Option<P::Error> {
        lock(&self.shared.error).take()
    }

    /// Ends the thread. Batches already received can still be taken.
    pub fn stop(&self) {
        self.shared.stop.store(true, Ordering::SeqCst);
    }

    /// Returns whether the thread has ended and its resources are free.
    pub fn is_finished(&self) -> bool {
        has_ended(&self.ended)
    }

    /// Returns a signal for the end of the stream. It stays valid after the stream is dropped.
    pub fn end_signal(&self) -> StreamEnd {
        StreamEnd(self.ended.clone())
    }
}

impl<P: Producer> Drop for Stream<P> {
    fn drop(&mut self) {
        self.stop();
    }
}

impl<S: SampleCount> Ring<S> {
    /// Adds a batch and returns the batches it displaces, which the caller drops after releasing the lock.
    fn push(&mut self, mut batch: Batch<S>) -> Vec<Batch<S>> {
        self.lost += batch.lost;
        self.held += batch.samples.count();
        let mut dropped = Vec::new();
        while self.held > self.capacity {
            let Some(oldest) = self.batches.pop_front() else { break };
            let count = oldest.samples.count();
            self.held -= count;
            self.lost += count as u64;
            // The loss before the oldest batch is now the loss before its successor.
            self.batches.front_mut().unwrap_or(&mut batch).lost += oldest.lost + count as u64;
            dropped.push(oldest);
        }
        self.batches.push_back(batch);
        dropped
    }
}

impl<T: Send + 'static> SampleCount for Vec<T> {
    fn count(&self) -> usize {
        self.len()
    }
}

impl SampleCount for Wires {
    fn count(&self) -> usize {
        self.len()
    }
}

/// A guard that signals the end of a thread, whatever the reason.
struct ExitSignal {
    alive: Option<Sender<Never>>,
    wake: Arc<dyn Fn() + Send + Sync>,
}

impl Drop for ExitSignal {
    fn drop(&mut self) {
        self.alive = None;
        (self.wake)();
    }
}

fn run_loop<P: Producer>(mut producer: P, shared: &Shared<P>, clock: &dyn Clock, end: &ExitSignal) {
    let (mut woken, mut unread) = (None, false);
    while !shared.stop.load(Ordering::SeqCst) {
        let request = lock(&shared.request).take();
        if let Some(request) = request {
            producer.apply_change(request);
        }
        match producer.next(clock, MAX_WAIT) {
            Ok(Some(batch)) => {
                let dropped = lock(&shared.ring).push(batch);
                drop(dropped);
                unread = true;
            }
            Ok(None) => {}
            Err(error) => {
                *lock(&shared.error) = Some(error);
                break;
            }
        }
        let now = clock.now();
        if unread && woken.is_none_or(|woken| now.duration_since(woken) >= WAKE_INTERVAL) {
            (end.wake)();
            (woken, unread) = (Some(now), false);
        }
    }
    producer.end(clock);
}

fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    // Code that holds one of these locks cannot panic half-way, so a poisoned lock is still valid.
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}
