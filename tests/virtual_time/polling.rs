//! Polling on a session's thread: samples are taken while there is no job, jobs come first, and the end of polling is
//! reported once.

use std::sync::atomic::Ordering;
use std::time::{Duration, Instant};

use encoder_studio::devices::hiperface::jobs::{Hiperface, HiperfaceJob, JobError};
use encoder_studio::devices::hiperface::procedures::{Error, PolledSample};
use encoder_studio::devices::hiperface::protocol::StatusCode;
use encoder_studio::link::Clock;
use encoder_studio::worker::{Event, Worker};

use crate::support::Desk;
use crate::threads::{Bench, LONG, identify, in_real_time, in_virtual_time, wait_for_job_end};

pub(crate) const BACK_TO_BACK: Option<Duration> = Some(Duration::ZERO);
/// An interval longer than any test.
pub(crate) const LONG_POLL_INTERVAL: Option<Duration> = Some(Duration::from_secs(3600));

/// Waits for at least `count` samples and returns them.
pub(crate) fn samples(worker: &Worker<Hiperface>, count: usize) -> Vec<PolledSample> {
    let started = Instant::now();
    let mut samples = Vec::new();
    while samples.len() < count {
        assert!(started.elapsed() < LONG, "{} samples", samples.len());
        samples.extend(worker.samples().drain().0);
        std::thread::sleep(Duration::from_millis(1));
    }
    samples
}

/// Checks that no further samples arrive, except for any in progress.
pub(crate) fn assert_no_more_samples(bench: &Bench) {
    let started = Instant::now();
    loop {
        std::thread::sleep(Duration::from_millis(50));
        if bench.worker.samples().drain() == (vec![], 0) {
            return;
        }
        assert!(started.elapsed() < LONG, "it goes on");
    }
}

fn position(sample: &PolledSample) -> Option<Option<u64>> {
    match sample {
        PolledSample::Position(reading) => Some(reading.position.and_then(|position| position.turns())),
        PolledSample::NoPosition { .. } | PolledSample::Watched(_) => None,
    }
}

#[test]
fn jobs_run_between_samples() {
    let mut bench = in_virtual_time("");
    assert_eq!(bench.worker.polling_interval(), None);
    bench.worker.poll(BACK_TO_BACK);
    let blind = samples(&bench.worker, 3);
    assert_eq!(position(&blind[0]), Some(None), "the encoder has not been identified");
    assert_eq!(bench.wakes.load(Ordering::SeqCst), 0, "a sample wakes no thread");
    for _ in 0..20 {
        bench.worker.submit(identify()).unwrap();
        let events = wait_for_job_end(&bench.worker);
        assert!(matches!(events.last(), Some(Event::Finished(..))), "{events:?}");
        assert_eq!(events.len(), 2, "{events:?}");
        bench.worker.samples().drain();
        let seen = samples(&bench.worker, 2);
        assert!(position(&seen[1]).flatten().is_some(), "{:?}", seen[1]);
    }
    assert_eq!(bench.worker.polling_interval(), BACK_TO_BACK);
}

#[test]
fn new_interval_applies_immediately() {
    let bench = in_virtual_time("");
    bench.worker.poll(LONG_POLL_INTERVAL);
    samples(&bench.worker, 1);
    assert_no_more_samples(&bench);
    bench.worker.poll(Some(Duration::from_millis(1)));
    samples(&bench.worker, 10);
    bench.worker.poll(LONG_POLL_INTERVAL);
    assert_no_more_samples(&bench);
    bench.worker.poll(BACK_TO_BACK);
    samples(&bench.worker, 10);
    bench.worker.poll(None);
    assert_no_more_samples(&bench);
    assert_eq!(bench.worker.polling_interval(), None);
}

#[test]
fn stop_ends_polling() {
    let bench = in_virtual_time("");
    for stop in [Worker::stop, |worker: &Worker<Hiperface>| worker.stop_handle().stop()] {
        bench.worker.poll(BACK_TO_BACK);
        samples(&bench.worker, 3);
        stop(&bench.worker);
        assert_eq!(bench.worker.polling_interval(), None);
        assert_no_more_samples(&bench);
    }
    bench.worker.poll(BACK_TO_BACK);
    assert!(bench.worker.close(LONG));
}

#[test]
fn failed_polling_reports_once() {
    let mut bench = in_virtual_time("fault=silent-after:5");
    bench.worker.poll(BACK_TO_BACK);
    let told = bench.worker.events().recv_timeout(LONG).unwrap();
    let Event::PollFailed(error) = &told else { panic!("{told:?}") };
    assert!(matches!(**error, JobError::Device(Error::NoReply { .. })), "{error:?}");
    assert_eq!(bench.worker.polling_interval(), None);
    assert_eq!(bench.worker.samples().drain().0.len(), 4, "five replies, the first of which is the type label");
    assert!(bench.worker.events().recv_timeout(Duration::from_millis(50)).is_err(), "once");
    bench.worker.submit(identify()).unwrap();
    assert!(matches!(wait_for_job_end(&bench.worker).last(), Some(Event::Failed(..))));
    bench.worker.poll(BACK_TO_BACK);
    assert!(matches!(bench.worker.events().recv_timeout(LONG), Ok(Event::PollFailed(_))), "once each time");
}

/// A job does not have to wait for all five tries of a sample. Polling continues after the job.
#[test]
fn job_interrupts_sample_retries() {
    let mut bench = in_real_time("fault=silent-after:0");
    bench.worker.poll(LONG_POLL_INTERVAL);
    let started = Instant::now();
    while bench.tap.lock().unwrap().sent.is_empty() {
        assert!(started.elapsed() < LONG);
        std::thread::sleep(Duration::from_millis(1));
    }
    let id = bench.worker.submit(HiperfaceJob::Status).unwrap();
    let events = wait_for_job_end(&bench.worker);
    assert!(matches!(events[0], Event::Started(started) if started == id), "{events:?}");
    assert!(matches!(events.last(), Some(Event::Failed(..))));
    let told = bench.worker.events().recv_timeout(LONG).unwrap();
    assert!(matches!(told, Event::PollFailed(_)), "the sample that was due is tried again: {told:?}");
}

/// A reply without a position also counts as a sample. Any other rejection does not.
#[test]
fn polling_continues_without_position() {
    let mut desk = Desk::new("rpm=9000");
    for _ in 0..3 {
        let PolledSample::NoPosition { codes, .. } = desk.session.take_sample().unwrap() else { panic!("too fast") };
        assert!(codes.contains(&StatusCode::TOO_FAST), "{codes:?}");
        assert!(desk.session.station().codes_to_display.is_empty(), "they are told with the sample");
    }
    let now = desk.clock.now();
    desk.bus().encoder_mut(0).unwrap().set_rpm(now, 0.0);
    let sample = desk.session.take_sample().unwrap();
    assert!(matches!(&sample, PolledSample::Position(reading) if reading.valid), "{sample:?}");
}
