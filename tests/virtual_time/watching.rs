//! Values that are read while an encoder's position is polled: their order, rejections, and interruptions by jobs. The
//! times are tested with the scheduler (`worker/poll_scheduler.rs`).

use std::time::{Duration, Instant};

use encoder_studio::devices::hiperface::jobs::{Hiperface, JobError};
use encoder_studio::devices::hiperface::procedures::{Error, PolledSample, WatchedQuantity, WatchedReading};
use encoder_studio::devices::hiperface::protocol::{Command, StatusCode};
use encoder_studio::units::Moment;
use encoder_studio::worker::{Event, WatchReply, Worker};

use crate::polling::{BACK_TO_BACK, LONG_POLL_INTERVAL, assert_no_more_samples, samples};
use crate::support::Desk;
use crate::threads::{LONG, identify, in_virtual_time, wait_for_job_end};

const TEMPERATURE: WatchedQuantity = WatchedQuantity::Analogue(0x48);
const SINE: WatchedQuantity = WatchedQuantity::Analogue(0x00);
/// A quantity that none of the encoders in these tests provides.
const UNAVAILABLE_QUANTITY: WatchedQuantity = WatchedQuantity::Analogue(0x33);
const ALWAYS: Duration = Duration::ZERO;

fn watched(sample: &PolledSample) -> Option<(WatchedQuantity, Option<i64>)> {
    match sample {
        PolledSample::Watched(WatchedReading { watch: what, value, .. }) => Some((*what, value.as_ref().ok().copied())),
        _ => None,
    }
}

fn at(sample: &PolledSample) -> Moment {
    match sample {
        PolledSample::Position(reading) => reading.at,
        PolledSample::NoPosition { at, .. } => *at,
        PolledSample::Watched(reading) => reading.at,
    }
}

/// Sets a new list of watched values. Returns the first `count` samples with it, starting with a position.
fn course(
    worker: &Worker<Hiperface>,
    wished: &[WatchedQuantity],
    count: usize,
) -> Vec<Option<(WatchedQuantity, Option<i64>)>> {
    worker.poll(None);
    worker.watch_values(wished.iter().map(|what| (*what, ALWAYS)).collect());
    // By then, the requests in progress have ended.
    std::thread::sleep(Duration::from_millis(100));
    worker.samples().drain();
    worker.poll(BACK_TO_BACK);
    samples(worker, count).iter().take(count).map(watched).collect()
}

#[test]
fn watched_values_alternate_with_positions() {
    let bench = in_virtual_time("temperature=-10&position=0x18");
    let temperature = Some((TEMPERATURE, Some(-10)));
    assert_eq!(course(&bench.worker, &[], 4), [None; 4]);
    assert_eq!(
        course(&bench.worker, &[TEMPERATURE], 6),
        [None, temperature, None, temperature, None, temperature],
        "no two in a row, the position first"
    );
    // Three quarters of a period: 2.0 V is 409 counts (sincos.md: 10 bits for 5 V).
    let (sine, counter) = (Some((SINE, Some(409))), Some((WatchedQuantity::Counter, Some(0))));
    assert_eq!(
        course(&bench.worker, &[TEMPERATURE, SINE, WatchedQuantity::Counter], 8),
        [None, temperature, None, sine, None, counter, None, temperature]
    );
    // The request for channel 48h is the one in the reference.
    assert!(bench.tap.lock().unwrap().sent.iter().any(|frame| frame == &[0x40, 0x44, 0x48, 0x4C]));
    let times: Vec<Moment> = samples(&bench.worker, 50).iter().map(at).collect();
    assert!(times.is_sorted(), "{times:?}");
}

#[test]
fn watches_nothing_without_polling() {
    let bench = in_virtual_time("");
    bench.worker.watch_values(vec![(TEMPERATURE, ALWAYS)]);
    assert_no_more_samples(&bench);
    assert_eq!(bench.tap.lock().unwrap().count(Command::ReadAnalogue), 0);
    bench.worker.poll(BACK_TO_BACK);
    samples(&bench.worker, 5);
    bench.worker.stop();
    assert_no_more_samples(&bench);
    assert_eq!(bench.worker.watched_values(), [(TEMPERATURE, ALWAYS)], "the wish outlives a stop");
    bench.worker.poll(LONG_POLL_INTERVAL);
    let seen = samples(&bench.worker, 2);
    assert_eq!(seen.iter().map(watched).collect::<Vec<_>>(), [None, Some((TEMPERATURE, Some(42)))]);
    assert_no_more_samples(&bench);
}

#[test]
fn missing_channel_does_not_stop_polling() {
    let bench = in_virtual_time("");
    let temperature = Some((TEMPERATURE, Some(42)));
    assert_eq!(
        course(&bench.worker, &[UNAVAILABLE_QUANTITY, TEMPERATURE], 8),
        [None, Some((UNAVAILABLE_QUANTITY, None)), None, temperature, None, temperature, None, temperature]
    );
    assert_eq!(bench.worker.watched_values(), [(TEMPERATURE, ALWAYS)]);
    assert!(bench.worker.events().is_empty(), "it is told as a sample");
    // When another value is added to the list, the rejected value is not requested again. After it has been removed and
    // added, it is.
    course(&bench.worker, &[SINE, UNAVAILABLE_QUANTITY], 1);
    assert_eq!(bench.worker.watched_values(), [(SINE, ALWAYS)]);
    course(&bench.worker, &[], 1);
    assert_eq!(
        course(&bench.worker, &[UNAVAILABLE_QUANTITY], 4),
        [None, Some((UNAVAILABLE_QUANTITY, None)), None, None]
    );
    assert_eq!(bench.worker.polling_interval(), BACK_TO_BACK);
}

#[test]
fn watched_reading_includes_status_codes() {
    let mut desk = Desk::new("");
    let WatchReply::Refused(PolledSample::Watched(refusal)) = desk.session.watch_value(&UNAVAILABLE_QUANTITY).unwrap()
    else {
        panic!()
    };
    assert!(matches!(&refusal.value, Err(Error::Rejected { codes, .. }) if codes == &[StatusCode::ARGUMENT]));
    desk.bus().encoder_mut(0).unwrap().set_temperature(130);
    let WatchReply::Sample(PolledSample::Watched(hot)) = desk.session.watch_value(&TEMPERATURE).unwrap() else {
        panic!()
    };
    assert_eq!((hot.value, hot.codes), (Ok(130), vec![StatusCode::TEMPERATURE]));
    assert!(desk.session.station().codes_to_display.is_empty(), "they are told with the reading");
    let now = |code| WatchedReading {
        at: Moment::START,
        watch: SINE,
        value: Err(Error::Rejected { command: Command::ReadAnalogue, codes: vec![StatusCode::new(code)] }),
        codes: Vec::new(),
    };
    for (code, refused) in [(0x0B, true), (0x0D, true), (0x01, false), (0x1C, false), (0x00, false)] {
        assert_eq!(now(code).is_refused(), refused, "{code:02X}h");
    }
}

#[test]
fn watching_continues_around_jobs() {
    let mut bench = in_virtual_time("");
    bench.worker.watch_values(vec![(TEMPERATURE, ALWAYS)]);
    bench.worker.poll(BACK_TO_BACK);
    for _ in 0..10 {
        bench.worker.submit(identify()).unwrap();
        let events = wait_for_job_end(&bench.worker);
        assert!(matches!(events.last(), Some(Event::Finished(..))), "{events:?}");
        bench.worker.samples().drain();
        let seen: Vec<_> = samples(&bench.worker, 6).iter().map(watched).collect();
        let pairs = seen.windows(2).filter(|pair| pair[0].is_some() == pair[1].is_some()).count();
        assert_eq!(pairs, 0, "they alternate: {seen:?}");
    }
}

#[test]
fn lost_line_ends_polling() {
    // The encoder sends five replies: type label, position, temperature, position, temperature.
    let bench = in_virtual_time("fault=silent-after:5");
    bench.worker.watch_values(vec![(TEMPERATURE, ALWAYS)]);
    bench.worker.poll(BACK_TO_BACK);
    let told = bench.worker.events().recv_timeout(LONG).unwrap();
    let Event::PollFailed(error) = &told else { panic!("{told:?}") };
    assert!(matches!(**error, JobError::Device(Error::NoReply { .. })), "{error:?}");
    assert_eq!(bench.worker.polling_interval(), None);
    assert_eq!(bench.worker.samples().drain().0.len(), 4);
    // Here it falls silent during the request for a watched value.
    let bench = in_virtual_time("fault=silent-after:4");
    bench.worker.watch_values(vec![(TEMPERATURE, ALWAYS)]);
    bench.worker.poll(BACK_TO_BACK);
    let told = bench.worker.events().recv_timeout(LONG).unwrap();
    let Event::PollFailed(error) = &told else { panic!("{told:?}") };
    let JobError::Device(Error::NoReply { command, .. }) = **error else { panic!("{error:?}") };
    assert_eq!(command, Command::ReadAnalogue);
    assert_eq!(bench.worker.samples().drain().0.len(), 3);
    assert!(bench.worker.events().recv_timeout(Duration::from_millis(50)).is_err(), "once");
}

#[test]
fn rarely_watched_value_does_not_delay_others() {
    let bench = in_virtual_time("");
    bench.worker.poll(BACK_TO_BACK);
    bench.worker.watch_values(vec![(TEMPERATURE, Duration::from_secs(3600))]);
    let seen: Vec<_> = samples(&bench.worker, 200).iter().filter_map(watched).collect();
    assert_eq!(seen, [(TEMPERATURE, Some(42))], "one at once, and no burst");
    let started = Instant::now();
    (0..1000).for_each(|_| bench.worker.watch_values(vec![(SINE, ALWAYS)]));
    assert!(started.elapsed() < Duration::from_secs(1));
    samples(&bench.worker, 10);
}
