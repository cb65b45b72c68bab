//! Tests of streams on threads: neither side waits for the other, and lost samples are counted.

use std::sync::atomic::AtomicUsize;
use std::time::Instant;

use super::*;
use crate::link::{RealClock, VirtualClock};
use crate::sim::sine_cosine::{Quantity, Settings};
use crate::units::Moment;

/// A time limit that exceeds the duration of any test.
const TEST_TIMEOUT: Duration = Duration::from_secs(20);

/// A producer of consecutive numbers, as fast as possible until it stalls or fails. Each batch advances its clock by
/// one millisecond.
struct Numbers {
    sizes: VecDeque<usize>,
    next: u64,
    fails: bool,
    /// Received requests.
    requests: Sender<u64>,
    /// Dropped together with the producer.
    _alive: Sender<Never>,
}

fn numbers(sizes: impl IntoIterator<Item = usize>, fails: bool) -> (Numbers, Receiver<u64>, Receiver<Never>) {
    let ((requests, wishes), (alive, gone)) = (crossbeam_channel::unbounded(), bounded(0));
    (Numbers { sizes: sizes.into_iter().collect(), next: 0, fails, requests, _alive: alive }, wishes, gone)
}

impl Producer for Numbers {
    type Request = u64;
    type Samples = Vec<u64>;
    type Error = &'static str;

    fn apply_change(&mut self, wish: u64) {
        self.requests.send(wish).unwrap();
    }

    fn next(&mut self, clock: &dyn Clock, patience: Duration) -> Result<Option<Batch<Vec<u64>>>, &'static str> {
        let Some(size) = self.sizes.pop_front() else {
            std::thread::sleep(patience / 10);
            return if self.fails { Err("unplugged") } else { Ok(None) };
        };
        clock.sleep_until(clock.now() + Duration::from_millis(1));
        let (first, time) = (self.next, SampleTime::from_nanoseconds(self.next as i64 * 1_000));
        self.next += size as u64;
        Ok(Some(Batch { first, time, period_ns: 1_000, lost: 0, samples: (first..self.next).collect() }))
    }
}

fn wait_until(what: impl Fn() -> bool) {
    let begun = Instant::now();
    while !what() {
        assert!(begun.elapsed() < TEST_TIMEOUT);
        std::thread::sleep(Duration::from_millis(1));
    }
}

/// Checks that every number is either present or counted as lost in the correct batch.
fn check(batches: &[Batch<Vec<u64>>], from: u64) -> u64 {
    batches.iter().fold(from, |next, batch| {
        assert_eq!(batch.first, next + batch.lost, "{batch:?}");
        assert_eq!(batch.samples.first(), Some(&batch.first));
        batch.first + batch.samples.len() as u64
    })
}

#[test]
fn idle_reader_does_not_block() {
    let sizes: Vec<usize> = (0..2_000).map(|at| 1 + at * 37 % 100).collect();
    let total: usize = sizes.iter().sum();
    let (producer, ..) = numbers(sizes, true);
    let stream = Stream::spawn(producer, 1_000, Arc::new(VirtualClock::default()), Arc::new(|| ())).unwrap();
    wait_until(|| stream.is_finished());
    let batches = stream.take_batches();
    let held: usize = batches.iter().map(|batch| batch.samples.len()).sum();
    assert!(held <= 1_000 && held > 900, "{held}");
    assert_eq!(check(&batches, 0), total as u64);
    assert_eq!(stream.lost_samples(), (total - held) as u64);
    assert_eq!(batches[0].lost, stream.lost_samples(), "all of it before what is left");
    assert_eq!((stream.take_error(), stream.take_error()), (Some("unplugged"), None));
    assert!(stream.take_batches().is_empty());
}

#[test]
fn occasional_reader_locates_gaps() {
    let (producer, ..) = numbers(std::iter::repeat_n(70, 3_000), true);
    let stream = Stream::spawn(producer, 500, Arc::new(VirtualClock::default()), Arc::new(|| ())).unwrap();
    let (mut next, mut read, mut lost) = (0, 0, 0);
    loop {
        let over = stream.is_finished();
        let batches = stream.take_batches();
        next = check(&batches, next);
        read += batches.iter().map(|batch| batch.samples.len() as u64).sum::<u64>();
        lost += batches.iter().map(|batch| batch.lost).sum::<u64>();
        if over {
            break;
        }
        std::thread::sleep(Duration::from_micros(300));
    }
    assert_eq!((next, read + lost, stream.lost_samples()), (210_000, 210_000, lost));
}

#[test]
fn keeps_batch_larger_than_ring() {
    let batch = |first: u64, count: u64, lost| Batch {
        first,
        time: SampleTime::ORIGIN,
        period_ns: 1,
        lost,
        samples: (first..first + count).collect::<Vec<u64>>(),
    };
    let mut ring = Ring { batches: VecDeque::new(), held: 0, capacity: 10, lost: 0 };
    assert!(ring.push(batch(3, 8, 3)).is_empty());
    assert_eq!(ring.push(batch(12, 30, 1)).len(), 1);
    assert_eq!((ring.batches.len(), ring.held, ring.lost), (1, 30, 12));
    assert_eq!(ring.batches[0].lost, 12);
    assert_eq!(ring.push(batch(42, 10, 0)).len(), 1);
    assert_eq!((ring.held, ring.lost, ring.batches[0].lost), (10, 42, 42));
}

#[test]
fn wakes_window_twenty_times_per_second() {
    // One second with a batch every millisecond.
    let (producer, ..) = numbers(std::iter::repeat_n(1, 1_000), true);
    let wakes = Arc::new(AtomicUsize::new(0));
    let counter = wakes.clone();
    let wake = Arc::new(move || {
        counter.fetch_add(1, Ordering::SeqCst);
    });
    let stream = Stream::spawn(producer, 10, Arc::new(VirtualClock::default()), wake).unwrap();
    wait_until(|| stream.is_finished());
    wait_until(|| wakes.load(Ordering::SeqCst) >= 21);
    // At 1, 51, … 951 ms, and at the end.
    assert_eq!(wakes.load(Ordering::SeqCst), 21);
}

#[test]
fn last_batch_before_silence_wakes_reader() {
    let (producer, ..) = numbers([1, 1], false);
    let (told, wakes) = bounded(8);
    let wake = Arc::new(move || {
        let _ = told.try_send(());
    });
    let stream = Stream::spawn(producer, 10, Arc::new(RealClock::start()), wake).unwrap();
    wakes.recv_timeout(TEST_TIMEOUT).unwrap();
    wakes.recv_timeout(TEST_TIMEOUT).unwrap();
    assert_eq!(check(&stream.take_batches(), 0), 2);
    assert!(!stream.is_finished());
    assert!(wakes.recv_timeout(Duration::from_millis(120)).is_err(), "silence wakes no thread");
}

#[test]
fn latest_change_arrives_before_drop() {
    let (producer, wishes, gone) = numbers([], false);
    let stream = Stream::spawn(producer, 10, Arc::new(RealClock::start()), Arc::new(|| ())).unwrap();
    (0..1_000).for_each(|wish| stream.request_change(wish));
    while wishes.recv_timeout(TEST_TIMEOUT).unwrap() != 999 {}
    assert!(wishes.is_empty());
    drop(stream);
    assert!(matches!(gone.recv_timeout(TEST_TIMEOUT), Err(crossbeam_channel::RecvTimeoutError::Disconnected)));
}

fn settings(rate_hz: f64) -> crate::sim::sine_cosine::CheckedSettings {
    Settings { rate_hz, ..Settings::default() }.validate().unwrap()
}

fn next(source: &mut AnalogueSource, clock: &VirtualClock) -> Option<Batch<Wires>> {
    source.next(clock, MAX_WAIT).unwrap()
}

#[test]
fn virtual_source_follows_clock() {
    let clock = VirtualClock::default();
    clock.sleep_until(Moment::from_elapsed(Duration::from_secs(5)));
    let mut source = AnalogueSource::new(settings(100_000.0), clock.now());
    let first = next(&mut source, &clock).unwrap();
    assert_eq!((first.first, first.samples.count(), first.lost, first.period_ns), (0, 1_000, 0, 10_000));
    assert_eq!(first.time, SampleTime::from_nanoseconds(5_000_000_000));
    assert_eq!(clock.now().since_start(), Duration::from_nanos(5_009_990_000));
    let second = next(&mut source, &clock).unwrap();
    assert_eq!((second.first, second.samples.count(), second.lost), (1_000, 1_000, 0));
    assert_eq!(second.time, first.time.saturating_add_ns(10_000_000));
    // The computer slept for a minute, and the source catches up on a quarter of a second.
    clock.sleep_until(Moment::from_elapsed(Duration::from_secs(65)));
    let late = next(&mut source, &clock).unwrap();
    assert_eq!((late.first, late.samples.count(), late.lost), (5_975_001, 25_000, 5_973_001));
    assert_eq!(late.time, first.time.saturating_add_ns(5_975_001 * 10_000));
    // Another rate, starting with the next sample, 10 µs after the last one.
    source.apply_change(settings(10.0));
    let slow: Vec<_> = (0..12).map(|_| next(&mut source, &clock)).collect();
    let slow: Vec<_> = slow.into_iter().flatten().collect();
    assert_eq!((slow[0].first, slow[0].samples.count(), slow[0].lost), (6_000_001, 1, 0));
    assert_eq!((slow[1].first, slow[1].period_ns), (6_000_002, 100_000_000));
    assert_eq!(slow[1].time.nanoseconds_since(slow[0].time), 100_000_000);
}

#[test]
fn virtual_source_yields_samples_by_index() {
    let clock = VirtualClock::default();
    let mut source = AnalogueSource::new(settings(50_000.0), clock.now());
    let whole =
        crate::sim::sine_cosine::Source::new(settings(50_000.0), SampleTime::ORIGIN).samples_from(0, 5_000).unwrap();
    let mut sines = Vec::new();
    (0..10).filter_map(|_| next(&mut source, &clock)).for_each(|batch| sines.extend(batch.samples.sin_v));
    assert_eq!(sines, whole.sin_v);
}

#[test]
fn loses_no_samples_at_full_speed() {
    // At 44.1 kHz, the sample period is 22 676 ns.
    let clock = VirtualClock::default();
    let checked =
        Settings::default().with_value(Quantity::Rate, 44_100.0).with_value(Quantity::Noise, 0.0).validate().unwrap();
    let mut source = AnalogueSource::new(checked, clock.now());
    let mut expected = 0;
    while clock.now().since_start() < Duration::from_secs(4) {
        let Some(batch) = next(&mut source, &clock) else { continue };
        assert_eq!((batch.first, batch.lost), (expected, 0));
        assert_eq!(batch.time.as_nanoseconds(), expected as i64 * 22_676);
        expected += batch.samples.count() as u64;
    }
    // 4 s contain 176 398 samples, and the last batch of 10 ms ends later.
    assert!((176_398..=176_840).contains(&expected), "{expected}");
}
