//! The worker on its own thread, with a virtual encoder in real time.

use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};

use encoder_studio::devices::hiperface::jobs::{Hiperface, HiperfaceJob};
use encoder_studio::devices::hiperface::procedures::Station;
use encoder_studio::devices::hiperface::procedures::find::FindOptions;
use encoder_studio::devices::hiperface::protocol::EncoderTypes;
use encoder_studio::link::{Clock, RealClock, VirtualClock};
use encoder_studio::store::Store;
use encoder_studio::worker::{Event, JobId, Session, SubmitError, Worker};

use crate::support::{MARGIN, Tap, TestLink, bus};

/// A time limit longer than any test, to detect a hanging thread.
pub(crate) const LONG: Duration = Duration::from_secs(20);

pub(crate) struct Bench {
    pub(crate) worker: Worker<Hiperface>,
    pub(crate) tap: Arc<Mutex<Tap>>,
    clock: Arc<dyn Clock>,
    pub(crate) wakes: Arc<AtomicUsize>,
    _folder: tempfile::TempDir,
}

fn bench(query: &str, clock: Arc<dyn Clock>) -> Bench {
    let folder = tempfile::tempdir().unwrap();
    let tap = Arc::<Mutex<Tap>>::default();
    let link = TestLink::new(Arc::new(Mutex::new(bus(query))), clock.clone(), tap.clone());
    let store = Store::at_root(folder.path());
    let session =
        Session::new(Box::new(link), clock.clone(), Station::new(MARGIN), store, EncoderTypes::built_in(), true);
    let wakes = Arc::new(AtomicUsize::new(0));
    let counter = wakes.clone();
    let wake = Arc::new(move || {
        counter.fetch_add(1, Ordering::SeqCst);
    });
    Bench { worker: Worker::spawn(session, wake).unwrap(), tap, clock, wakes, _folder: folder }
}

pub(crate) fn in_real_time(query: &str) -> Bench {
    bench(query, Arc::new(RealClock::start()))
}

pub(crate) fn in_virtual_time(query: &str) -> Bench {
    bench(query, Arc::new(VirtualClock::default()))
}

fn is_end(event: &Event<Hiperface>) -> Option<JobId> {
    match event {
        Event::Finished(id, _) | Event::Failed(id, _) | Event::Cancelled(id, _) => Some(*id),
        _ => None,
    }
}

/// Waits for a job to end and returns all events until then.
pub(crate) fn wait_for_job_end(worker: &Worker<Hiperface>) -> Vec<Event<Hiperface>> {
    let mut events = Vec::new();
    loop {
        let event = worker.events().recv_timeout(LONG).expect("an end");
        let ended = is_end(&event).is_some();
        events.push(event);
        if ended {
            return events;
        }
    }
}

fn search() -> HiperfaceJob {
    HiperfaceJob::Find(FindOptions::default())
}

pub(crate) fn identify() -> HiperfaceJob {
    HiperfaceJob::Identify
}

#[test]
fn rejects_second_job_during_search() {
    let mut bench = in_real_time("settings=0xE0&address=0x5F");
    let id = bench.worker.submit(search()).unwrap();
    assert!(bench.worker.is_busy());
    assert_eq!(bench.worker.submit(identify()), Err(SubmitError::Busy));
    std::thread::sleep(Duration::from_millis(1300));
    assert_eq!(bench.worker.submit(identify()), Err(SubmitError::Busy));
    let stopped = Instant::now();
    bench.worker.stop();
    let events = wait_for_job_end(&bench.worker);
    assert!(stopped.elapsed() < Duration::from_secs(1), "{:?}", stopped.elapsed());
    assert!(matches!(events.first(), Some(Event::Started(started)) if *started == id));
    assert!(matches!(events.last(), Some(Event::Finished(ended, _)) if *ended == id), "{events:?}");
    // The earlier cancellation must not stop the next job.
    *bench.tap.lock().unwrap() = Tap::default();
    bench.worker.submit(HiperfaceJob::Status).unwrap();
    assert!(
        matches!(wait_for_job_end(&bench.worker).last(), Some(Event::Failed(..))),
        "no encoder has address 40h at 9600"
    );
}

#[test]
fn job_starts_and_ends_once() {
    let mut bench = in_virtual_time("");
    for round in 0..50 {
        let id = bench.worker.submit(if round % 5 == 4 { search() } else { identify() }).unwrap();
        let events = wait_for_job_end(&bench.worker);
        let starts = events.iter().filter(|event| matches!(event, Event::Started(_))).count();
        assert_eq!(starts, 1, "{events:?}");
        assert_eq!(events.iter().filter_map(is_end).collect::<Vec<_>>(), [id]);
    }
    assert!(bench.wakes.load(Ordering::SeqCst) >= 100);
    assert!(bench.worker.events().recv_timeout(Duration::from_millis(50)).is_err(), "and nothing comes after the end");
}

/// The job reports 672 steps of progress, which are never read. It still ends, and its result can be read afterwards.
#[test]
fn job_ends_with_unread_progress() {
    let mut bench = in_virtual_time("settings=0xE0");
    let id = bench.worker.submit(search()).unwrap();
    let started = Instant::now();
    while bench.worker.is_busy() {
        assert!(started.elapsed() < LONG);
        std::thread::sleep(Duration::from_millis(2));
    }
    std::thread::sleep(Duration::from_millis(50));
    assert!(bench.worker.events().len() <= 64, "the channel is bounded");
    let events = wait_for_job_end(&bench.worker);
    assert!(matches!(events.first(), Some(Event::Started(_))));
    assert_eq!(events.last().and_then(is_end), Some(id));
    let mut done = None;
    for event in &events {
        if let Event::Progress(_, progress) = event {
            assert!(done < Some(progress.done), "{done:?}, then {progress:?}");
            done = Some(progress.done);
        }
    }
    // No outdated events follow the end.
    let late = bench.worker.events().recv_timeout(Duration::from_millis(100));
    assert!(late.is_err(), "{late:?}");
}

#[test]
fn dropped_worker_ends_thread_during_job() {
    for busy in [true, false] {
        let mut bench = in_real_time("settings=0xE0");
        if busy {
            bench.worker.submit(search()).unwrap();
            std::thread::sleep(Duration::from_millis(100));
        }
        let (clock, events) = (Arc::downgrade(&bench.clock), bench.worker.events().clone());
        drop(bench);
        let dropped = Instant::now();
        // Ending drops the session, which has the thread's last reference to the clock.
        while clock.upgrade().is_some() {
            assert!(dropped.elapsed() < Duration::from_secs(2), "the thread goes on");
            std::thread::sleep(Duration::from_millis(5));
        }
        while events.recv_timeout(LONG).is_ok() {}
    }
}

#[test]
fn closed_worker_has_ended_during_job() {
    for busy in [true, false] {
        let mut bench = in_real_time("settings=0xE0");
        if busy {
            bench.worker.submit(search()).unwrap();
        }
        assert!(!bench.worker.is_finished());
        assert!(bench.worker.close(LONG));
        assert_eq!(Arc::strong_count(&bench.clock), 1, "the session is gone");
    }
}

#[test]
fn ending_worker_reports_end_of_job() {
    let mut bench = in_real_time("settings=0xE0");
    let id = bench.worker.submit(search()).unwrap();
    let ending = bench.worker.end();
    assert!(ending.wait_for_end(LONG));
    assert!(ending.is_finished());
    assert_eq!(ending.events().iter().filter_map(|event| is_end(&event)).collect::<Vec<_>>(), [id]);
}

/// A stop from any thread ends the running job, but no job that is submitted later.
#[test]
fn stop_applies_to_one_job() {
    let mut bench = in_virtual_time("");
    let stop_handle = bench.worker.stop_handle();
    stop_handle.stop();
    bench.worker.submit(identify()).unwrap();
    assert!(matches!(wait_for_job_end(&bench.worker).last(), Some(Event::Finished(..))), "the stop came before");

    let mut bench = in_real_time("settings=0xE0");
    let stop_handle = bench.worker.stop_handle();
    bench.worker.submit(search()).unwrap();
    std::thread::spawn(move || stop_handle.stop());
    wait_for_job_end(&bench.worker);
    assert!(bench.tap.lock().unwrap().sent.len() < 32, "the search has ended early");
}

/// No job is accepted while there are unread events.
#[test]
fn unread_events_prevent_new_job() {
    let mut bench = in_virtual_time("");
    let mut jobs = 0;
    let refused = loop {
        match bench.worker.submit(identify()) {
            Ok(_) => jobs += 1,
            Err(refused) => break refused,
        }
        let submitted = Instant::now();
        while bench.worker.is_busy() {
            assert!(submitted.elapsed() < LONG);
            std::thread::sleep(Duration::from_millis(1));
        }
    };
    assert_eq!(refused, SubmitError::Unread);
    let mut ends = 0;
    while ends < jobs {
        ends += usize::from(is_end(&bench.worker.events().recv_timeout(LONG).unwrap()).is_some());
    }
    bench.worker.submit(identify()).unwrap();
}

#[test]
fn reports_idle_link_loss_once() {
    let mut bench = in_virtual_time("");
    bench.worker.submit(identify()).unwrap();
    wait_for_job_end(&bench.worker);
    bench.tap.lock().unwrap().unplugged = true;
    let told = bench.worker.events().recv_timeout(Duration::from_secs(1)).expect("within a second");
    assert!(matches!(&told, Event::Lost(error) if error.is_lost()), "{told:?}");
    assert!(bench.worker.events().recv_timeout(Duration::from_millis(1200)).is_err(), "once");
    bench.worker.submit(identify()).unwrap();
    assert!(matches!(wait_for_job_end(&bench.worker).last(), Some(Event::Failed(..))));
}
