//! Positions at a higher rate than single requests allow. The adapter streams them, and the stream is stopped before
//! any other request.

use std::sync::{Arc, Mutex};
use std::time::Duration;

use encoder_studio::buses::bridge::procedures::AdapterError;
use encoder_studio::buses::bridge::protocol::{Operation, Receiver};
use encoder_studio::buses::bridge::sim::Adapter;
use encoder_studio::devices::biss::jobs::{Biss, BissJob, JobError};
use encoder_studio::devices::biss::procedures::{ConsecutiveFrames, Error, PolledSample, Station, Supply};
use encoder_studio::devices::biss::profile::RegisterRange;
use encoder_studio::kinds::attachable_kinds;
use encoder_studio::link::{Clock, VirtualClock};
use encoder_studio::sim::ByteDevice;
use encoder_studio::store::Store;
use encoder_studio::units::Moment;
use encoder_studio::worker::{Session, WatchReply};

use super::support::{Transport, at, pairs};
use crate::support::{MARGIN, Tap, TestLink};

const FAST: Duration = Duration::from_micros(50);

struct Stand {
    clock: Arc<VirtualClock>,
    adapter: Arc<Mutex<Adapter>>,
    tap: Arc<Mutex<Tap>>,
    session: Session<Biss>,
    _folder: tempfile::TempDir,
}

/// Returns an encoder on an adapter whose bus clock allows 20 000 frames per second.
fn stand(query: &str) -> Stand {
    stand_with_supply(query, None)
}

/// Returns the same as [`stand`], but with the encoder supplied by the adapter.
fn stand_with_supply(query: &str, supply: Option<Supply>) -> Stand {
    stand_with_clock(query, supply, 2_000_000)
}

fn stand_with_clock(query: &str, supply: Option<Supply>, clock_hz: u32) -> Stand {
    let folder = tempfile::tempdir().unwrap();
    let clock = Arc::new(VirtualClock::default());
    let tap = Arc::<Mutex<Tap>>::default();
    let adapter = Arc::new(Mutex::new(Adapter::from_pairs(&pairs(query), attachable_kinds()).unwrap()));
    let link = TestLink::new(adapter.clone(), clock.clone(), tap.clone());
    let mut station = Station::new(Transport::Adapter, MARGIN);
    (station.clock_hz, station.supply) = (clock_hz, supply);
    let session = Session::from_connection(Box::new(link), clock.clone(), station, Store::at_root(folder.path()), None);
    Stand { clock, adapter, tap, session, _folder: folder }
}

impl Stand {
    fn run(&mut self) -> ConsecutiveFrames {
        match self.session.take_sample().unwrap() {
            PolledSample::Frames(run) => run,
            other => panic!("{other:?}"),
        }
    }

    /// Returns all frames streamed within the given time.
    fn runs(&mut self, time: Duration) -> Vec<ConsecutiveFrames> {
        let end = self.clock.now() + time;
        let mut runs = Vec::new();
        while self.clock.now() < end {
            runs.push(self.run());
        }
        runs
    }

    /// Returns the number of bytes that the adapter sends in one second without a request.
    fn unsolicited_byte_count(&mut self) -> usize {
        let mut adapter = self.adapter.lock().unwrap();
        let mut bytes = |milliseconds| {
            self.clock.sleep_until(self.clock.now() + Duration::from_millis(milliseconds));
            adapter.poll(self.clock.now()).len()
        };
        bytes(10);
        (0..1000).map(|_| bytes(1)).sum()
    }

    /// Returns how many requests for an operation were sent.
    fn count(&self, operation: Operation) -> usize {
        let mut receiver = Receiver::default();
        self.tap.lock().unwrap().sent.iter().for_each(|bytes| receiver.push(bytes));
        std::iter::from_fn(|| receiver.next_packet()).filter(|packet| packet.op == operation.byte()).count()
    }
}

/// Checks that numbers and times have no gaps, and that the position follows the shaft: 50 revolutions per second are
/// 327.68 steps per frame.
fn check(runs: &[ConsecutiveFrames]) {
    let first = &runs[0];
    let mut before: Option<(Moment, u64)> = None;
    let mut next = first.first;
    for run in runs {
        assert_eq!((run.first, run.lost, run.period_ns), (next, 0, 50_000));
        next = run.first + run.frames.len() as u64;
        for (moment, frame) in run.iter_with_times() {
            let position = run.layout.position_to_steps(&frame.unwrap());
            if let Some((earlier, from)) = before {
                assert_eq!(moment.duration_since(earlier), FAST);
                assert!((327..=328).contains(&(position - from)), "{from} to {position}");
            }
            before = Some((moment, position));
        }
    }
}

#[test]
fn streams_short_polling_intervals() {
    let mut stand = stand("rpm=3000&position=0");
    stand.session.set_sample_interval(Some(FAST));
    let runs = stand.runs(Duration::from_secs(3));
    check(&runs);
    assert!(runs[0].is_stream_start() && runs[1..].iter().all(|run| !run.is_stream_start()));
    // The last samples may still be in transit.
    let frames: usize = runs.iter().map(|run| run.frames.len()).sum();
    let streamed = stand.clock.now().duration_since(runs[0].at).as_micros() as usize / 50;
    assert!(frames > 50_000 && (streamed - 200..=streamed + 1).contains(&frames), "{frames} of {streamed}");
    assert_eq!(stand.count(Operation::BissStream), 1);
    stand.session.set_sample_interval(None);
    assert_eq!(stand.unsolicited_byte_count(), 0);
}

#[test]
fn job_interrupts_stream() {
    let mut stand = stand("rpm=3000&position=0");
    stand.session.set_sample_interval(Some(FAST));
    let mut last = None;
    for round in 0..3 {
        let runs = stand.runs(Duration::from_millis(200));
        check(&runs);
        let begin = runs[0].at;
        assert!(runs[0].is_stream_start() && last.is_none_or(|last| begin > last), "{round}: {begin:?}, {last:?}");
        last = runs.last().and_then(|run| run.iter_with_times().last()).map(|(at, _)| at);
        stand.session.run_inline(BissJob::Status).unwrap();
        let watched = stand.session.watch_value(&RegisterRange::single(at("0x66"))).unwrap();
        assert!(matches!(watched, WatchReply::Sample(PolledSample::Watched(_))));
    }
    stand.session.set_sample_interval(Some(Duration::from_millis(5)));
    assert!(matches!(stand.session.take_sample(), Ok(PolledSample::Position(_))), "slow enough to be asked");
    assert_eq!(stand.unsolicited_byte_count(), 0);
    stand.session.set_sample_interval(Some(FAST));
    stand.run();
    stand.session.set_sample_interval(Some(FAST * 2));
    assert_eq!(stand.run().period_ns, 100_000, "another pace is another stream");
}

#[test]
fn reports_corrupt_and_missing_frames() {
    let mut noisy = stand("noise=0.05&seed=2");
    noisy.session.set_sample_interval(Some(FAST));
    let runs = noisy.runs(Duration::from_secs(1));
    let frames: usize = runs.iter().map(|run| run.frames.len()).sum();
    let wrong: usize = runs.iter().map(ConsecutiveFrames::crc_errors).sum();
    assert!((0.04..0.06).contains(&(wrong as f64 / frames as f64)), "{wrong} of {frames}");
    let mut open = stand("line=open");
    open.session.set_sample_interval(Some(FAST));
    let error = open.session.take_sample().unwrap_err();
    assert!(matches!(error, JobError::Device(Error::NoAcknowledge { .. })), "{error}");
}

#[test]
fn restored_wire_starts_new_stream() {
    let mut stand = stand("rpm=60");
    stand.session.set_sample_interval(Some(FAST));
    stand.run();
    let sent = stand.tap.lock().unwrap().sent.len();
    stand.tap.lock().unwrap().mute_from = Some(0);
    let error = stand.session.take_sample().unwrap_err();
    assert!(matches!(error, JobError::Device(Error::Adapter(AdapterError::StreamSilent))), "{error}");
    assert!(stand.tap.lock().unwrap().sent.len() > sent, "it was told to stop");
    stand.tap.lock().unwrap().mute_from = None;
    // HELLO ends the stream.
    assert!(stand.run().is_stream_start());
    assert_eq!(stand.count(Operation::Hello), 2);
    stand.tap.lock().unwrap().unplugged = true;
    assert!(matches!(stand.session.take_sample(), Err(JobError::Device(Error::Link(error))) if error.is_lost()));
}

/// At 1 MHz, 43 bits, 7 µs for the acknowledgement and 20 µs for the timeout add up to 70 µs.
#[test]
fn reports_clock_too_slow_for_interval() {
    for (clock_hz, period_ns, is_limited) in [(1_000_000, 70_000, true), (2_000_000, 50_000, false)] {
        let mut stand = stand_with_clock("rpm=60", None, clock_hz);
        stand.session.set_sample_interval(Some(FAST));
        let run = stand.run();
        assert_eq!((run.period_ns, run.clock_hz, run.is_limited), (period_ns, clock_hz, is_limited));
    }
}

/// A reset stops the stream and clears supply and clock. The next job or sample detects this and continues.
#[test]
fn reconfigures_adapter_after_reset() {
    let query = "supply=switched&rpm=60";
    let supply = Supply { millivolt: 5_000, measured: None };
    for by_job in [true, false] {
        let mut stand = stand_with_supply(query, Some(supply));
        stand.session.set_sample_interval(Some(FAST));
        stand.runs(Duration::from_millis(100));
        *stand.adapter.lock().unwrap() = Adapter::from_pairs(&pairs(query), attachable_kinds()).unwrap();
        if by_job {
            stand.session.run_inline(BissJob::Status).unwrap();
        } else {
            // Data that were sent before still arrive.
            let error = (0..100).find_map(|_| stand.session.take_sample().err()).unwrap();
            assert!(matches!(error, JobError::Device(Error::Adapter(AdapterError::StreamSilent))), "{error}");
        }
        assert!(stand.run().is_stream_start());
        let counts = [Operation::Hello, Operation::Supply, Operation::BissConfig].map(|own| stand.count(own));
        assert_eq!(counts, [1, 2, 2], "{by_job}");
        assert!(stand.runs(Duration::from_secs(1)).iter().all(|run| run.crc_errors() == 0));
    }
}

/// An adapter that falls silent may have been reset, which switches the supply off. The supply is switched on again,
/// and the encoder is given time to start.
#[test]
fn repowers_encoder_after_reset() {
    let supply = Supply { millivolt: 5_000, measured: None };
    let mut stand = stand_with_supply("supply=switched&rpm=60", Some(supply));
    stand.session.set_sample_interval(Some(FAST));
    stand.run();
    stand.tap.lock().unwrap().mute_from = Some(0);
    assert!(matches!(stand.session.take_sample(), Err(JobError::Device(Error::Adapter(AdapterError::StreamSilent)))));
    stand.tap.lock().unwrap().mute_from = None;
    assert!(stand.run().is_stream_start());
    assert_eq!((stand.count(Operation::Hello), stand.count(Operation::Supply)), (2, 2));
    let measured = Some(Supply { measured: Some((5_000, 60)), ..supply });
    assert_eq!(stand.session.station().supply, measured);
}
