//! Tests of streams in virtual time, from the virtual adapter and from a scripted one. Every loss must be reported.

use std::sync::Mutex;

use super::*;
use crate::analysis::quality::Family;
use crate::buses::bridge::procedures::AdapterError;
use crate::buses::bridge::protocol::{
    AnalogData, BissData, BissStatus, Capabilities, ErrorCode, Hello, Message, Operation, Receiver, Reply, Request,
};
use crate::buses::bridge::sim::Adapter;
use crate::kinds::attachable_kinds;
use crate::link::{LinkError, LinkErrorKind, SimLink, VirtualClock};
use crate::sim::ByteDevice;
use crate::units::{CharacterFormat, Moment};
use crate::worker::stream::{MAX_WAIT, Stream};

const MARGIN: Duration = Duration::from_millis(20);

/// A virtual adapter, the clock that it runs on, and the bridge job that produces its sample stream.
pub(crate) struct Bench<S: StreamFormat> {
    pub(crate) clock: Arc<VirtualClock>,
    adapter: Arc<Mutex<dyn ByteDevice>>,
    pub(crate) bridge: Bridge<S>,
}

pub(crate) fn bench<S: StreamFormat>(format: S, device: impl ByteDevice + 'static) -> Bench<S> {
    let clock = Arc::new(VirtualClock::default());
    clock.sleep_until(Moment::from_elapsed(Duration::from_secs(3)));
    let adapter: Arc<Mutex<dyn ByteDevice>> = Arc::new(Mutex::new(device));
    let link = SimLink::connect(adapter.clone(), clock.clone());
    let bridge = Bridge::new(format, None, MARGIN, Box::new(move || Ok(Box::new(link) as Box<dyn ByteLink>)));
    Bench { clock, adapter, bridge }
}

pub(crate) fn virtual_adapter(query: &str) -> Adapter {
    let pair = |item: &str| item.split_once('=').map(|(key, value)| (key.to_owned(), value.to_owned()));
    Adapter::from_pairs(&query.split('&').filter_map(pair).collect::<Vec<_>>(), attachable_kinds()).unwrap()
}

/// Stream format that yields the position frames as received.
pub(crate) struct RawFrames;

impl StreamFormat for RawFrames {
    type Samples = Vec<u64>;

    /// A stream of 20 000 frames per second. At 2 MHz, a frame of 43 clocks takes 21.5 µs, plus 27 µs of waiting.
    fn stream_request(&self) -> StreamRequest {
        StreamRequest::Biss { clock_hz: 2_000_000, data_bits: 35, crc_bits: 6, period_us: 50 }
    }

    fn read(&self, data: StreamData, _: &StreamingAdapter) -> Option<Vec<u64>> {
        let StreamData::Biss(data) = data else { return None };
        Some(data.values.iter().map(|(_, raw)| *raw).collect())
    }
}

impl<S: StreamFormat> Bench<S> {
    fn next(&mut self) -> Result<Option<Batch<S::Samples>>, BridgeError> {
        self.bridge.next(&*self.clock, MAX_WAIT)
    }

    /// Returns the batches received within this time.
    pub(crate) fn take(&mut self, time: Duration) -> Vec<Batch<S::Samples>> {
        let end = self.clock.now() + time;
        let mut batches = Vec::new();
        while self.clock.now() < end {
            batches.extend(self.next().unwrap());
        }
        batches
    }

    /// Returns the error that ends the stream within a few seconds.
    fn error(&mut self) -> BridgeError {
        let end = self.clock.now() + Duration::from_secs(20);
        while self.clock.now() < end {
            if let Err(error) = self.next() {
                return error;
            }
        }
        panic!("it goes on")
    }

    /// Returns the number of bytes that the adapter sends unprompted within a second. Bytes already in transit do not
    /// count.
    pub(crate) fn unsolicited_byte_count(&self) -> usize {
        let mut device = self.adapter.lock().unwrap();
        let mut bytes = |milliseconds| {
            self.clock.sleep_until(self.clock.now() + Duration::from_millis(milliseconds));
            device.poll(self.clock.now()).len()
        };
        bytes(10);
        (0..1000).map(|_| bytes(1)).sum()
    }
}

/// Checks that every sample number is either present or counted as lost before the next batch. Returns both counts.
pub(crate) fn count<T>(batches: &[Batch<Vec<T>>]) -> (u64, u64) {
    let (mut next, mut there, mut lost) = (0, 0, 0);
    for batch in batches {
        assert_eq!(batch.first, next + batch.lost, "{} lost", batch.lost);
        next = batch.first + batch.samples.len() as u64;
        there += batch.samples.len() as u64;
        lost += batch.lost;
    }
    (there, lost)
}

#[test]
fn counts_unfetched_and_damaged_samples() {
    let mut bench = bench(RawFrames, virtual_adapter("fault=flip:0.00002&seed=1"));
    let before = bench.take(Duration::from_secs(1));
    // The computer sleeps for seven seconds, of which the adapter buffers one.
    let asleep = bench.clock.now() + Duration::from_secs(7);
    bench.clock.sleep_until(asleep);
    let batches = [before, bench.take(Duration::from_secs(1))].concat();
    let (there, lost) = count(&batches);
    assert!((179_800..=180_500).contains(&(there + lost)), "nine seconds: {there} and {lost}");
    let slept = batches.iter().map(|batch| batch.lost).max().unwrap();
    assert!((115_000..=125_000).contains(&slept), "six of the seven seconds: {slept}");
    assert!(lost > slept + 100, "damaged packets too: {lost}");
    // Like the sample numbers, the times continue across the gap.
    let begin = batches[0].time.saturating_add_ns(batches[0].first as i64 * -50_000);
    for batch in &batches {
        assert_eq!(batch.time, begin.saturating_add_ns(batch.first as i64 * 50_000), "{}", batch.first);
    }
}

#[test]
fn counts_samples_lost_to_stalled_consumer() {
    let Bench { clock, bridge, .. } = bench(RawFrames, virtual_adapter("rpm=60"));
    let stream = Stream::spawn(bridge, 4_000, clock, Arc::new(|| ())).unwrap();
    // Virtual time passes as fast as the thread can run.
    let begun = std::time::Instant::now();
    while stream.lost_samples() < 100_000 {
        assert!(begun.elapsed() < Duration::from_secs(20));
        std::thread::sleep(Duration::from_millis(1));
    }
    stream.stop();
    assert!(stream.end_signal().wait_for_end(Duration::from_secs(20)));
    let batches = stream.take_batches();
    let (there, lost) = count(&batches);
    assert!(
        there <= 4_000 && there > 3_800 && lost == stream.lost_samples() && batches[0].lost == lost,
        "{there}, {lost}"
    );
    assert!(stream.take_error().is_none());
}

/// Adapter with scripted replies. It also sends scripted data when a stream begins.
struct ScriptedAdapter {
    capabilities: Capabilities,
    /// Amount in millivolts by which the supply exceeds the requested voltage.
    too_high: u16,
    refused: Vec<(Operation, ErrorCode)>,
    /// Operations whose next reply is lost, one entry per lost reply.
    lost_replies: Vec<Operation>,
    /// Data sent when a stream begins.
    data: Vec<Message>,
    heard: Arc<Mutex<Vec<Request>>>,
    receiver: Receiver,
    out: Vec<u8>,
}

fn scripted_adapter(data: Vec<Message>) -> ScriptedAdapter {
    let capabilities = Capabilities::BISS.union(Capabilities::ANALOG);
    ScriptedAdapter {
        capabilities,
        too_high: 0,
        refused: Vec::new(),
        lost_replies: Vec::new(),
        data,
        heard: Arc::default(),
        receiver: Receiver::default(),
        out: Vec::new(),
    }
}

impl ScriptedAdapter {
    fn answer(&mut self, request: &Request) -> Message {
        if let Some((_, code)) = self.refused.iter().find(|(operation, _)| *operation == request.operation()) {
            return Message::Error { op: request.operation().byte(), code: *code, text: "no".to_owned() };
        }
        Message::Reply(match *request {
            Request::Hello => Reply::Hello(Hello {
                capabilities: self.capabilities,
                max_clock_hz: 1_000_000,
                max_sample_hz: 50_000,
                name: "ScriptedAdapter".to_owned(),
                serial: String::new(),
                firmware: String::new(),
            }),
            Request::AnalogConfig { sample_hz } => {
                Reply::AnalogConfig { sample_hz, full_scale_microvolt: 1_250_000, bits: 12 }
            }
            Request::AnalogStream { on } => Reply::AnalogStream { on },
            Request::AnalogSkew => Reply::AnalogSkew { skew_ns: 5_000 },
            Request::Supply { on, millivolt } => {
                Reply::Supply { on, millivolt: millivolt + self.too_high, milliampere: 60 }
            }
            Request::BissConfig { clock_hz, .. } => Reply::BissConfig { clock_hz },
            Request::BissStream { period_us } => Reply::BissStream { period_us },
            _ => panic!("{request:?}"),
        })
    }
}

impl ByteDevice for ScriptedAdapter {
    fn on_bytes(&mut self, _: Moment, bytes: &[u8]) {
        self.receiver.push(bytes);
        while let Some(packet) = self.receiver.next_packet() {
            let request = Request::parse(&packet).unwrap();
            let operation = request.operation();
            let message = self.answer(&request);
            let begins = matches!(request, Request::AnalogStream { on: true })
                || matches!(request, Request::BissStream { period_us } if period_us > 0);
            self.heard.lock().unwrap().push(request);
            if let Some(at) = self.lost_replies.iter().position(|own| *own == operation) {
                self.lost_replies.remove(at);
                continue;
            }
            self.out.extend(message.emit(packet.seq).emit());
            if begins {
                self.out.extend(self.data.iter().flat_map(|data| data.emit(0).emit()));
            }
        }
    }

    fn poll(&mut self, _: Moment) -> Vec<u8> {
        std::mem::take(&mut self.out)
    }

    fn poll_at(&self) -> Option<Moment> {
        None
    }

    fn connect(&mut self, _: Moment) {}
}

fn analog(first_index: u32, lost: u16, samples: Vec<(i16, i16)>) -> Message {
    Message::Data(StreamData::Analog(AnalogData {
        first_index,
        t0_us: 1_000 + u64::from(first_index) * 20,
        lost,
        samples,
    }))
}

const SINE_COSINE: SineCosine = SineCosine { sample_hz: 100_000 };

#[test]
fn converts_full_scale_to_volts() {
    let device = scripted_adapter(vec![
        analog(0, 0, vec![(32_767, 0), (-32_768, 16_384)]),
        analog(2, 0, vec![]),
        analog(12, 3, vec![(0, -32_767)]),
    ]);
    let heard = device.heard.clone();
    let mut bench = bench(SINE_COSINE, device);
    let batches = bench.take(Duration::from_millis(100));
    let [first, second] = batches.as_slice() else { panic!("{batches:?}") };
    let near = |volts: f64, expected: f64| (volts - expected).abs() < 1e-9;
    // 1.25 V · 32768/32767 and 1.25 V · 16384/32767.
    let expected = [1.25, -1.250_038_148_137_455_5, 0.0, 0.625_019_074_068_727_7];
    let volts = [&first.samples.sine_v[..], &first.samples.cosine_v[..]].concat();
    assert!(volts.iter().zip(expected).all(|(volts, expected)| near(*volts, expected)), "{volts:?}");
    // The adapter samples at 50 kHz at most, which is an interval of 20 µs.
    assert_eq!((first.first, first.lost, first.period_ns), (0, 0, 20_000));
    assert_eq!((second.first, second.lost), (12, 10));
    assert_eq!(second.time.nanoseconds_since(first.time), 240_000);
    bench.bridge.end(&*bench.clock);
    let expected = [
        Request::Hello,
        Request::AnalogConfig { sample_hz: 50_000 },
        Request::AnalogStream { on: true },
        Request::AnalogStream { on: false },
    ];
    assert_eq!(*heard.lock().unwrap(), expected);
}

/// The cosine rises by 1000 per interval of 20 µs and is sampled 5 µs late, which is a quarter of the interval.
#[test]
fn corrects_cosine_skew() {
    let ramp = |from: i16, count: i16| (from..from + count).map(|at| (7, at * 1000)).collect::<Vec<_>>();
    let mut device =
        scripted_adapter(vec![analog(0, 0, ramp(0, 10)), analog(10, 0, ramp(10, 1)), analog(20, 9, ramp(20, 5))]);
    device.capabilities = Capabilities::ANALOG.union(Capabilities::ANALOG_SKEW);
    let heard = device.heard.clone();
    let mut bench = bench(SINE_COSINE, device);
    let batches = bench.take(Duration::from_millis(100));
    let unit_v = 1.25 / 32_767.0;
    let cosines = batches.iter().flat_map(|batch| batch.samples.cosine_v.iter().map(|volts| volts / unit_v));
    let expected = (0..11).chain(20..25).map(|at| f64::from(at) * 1000.0 - 250.0);
    let pairs: Vec<(f64, f64)> = cosines.zip(expected).collect();
    assert!(pairs.len() == 16 && pairs.iter().all(|(found, wanted)| (found - wanted).abs() < 1e-6), "{pairs:?}");
    assert!(batches.iter().all(|batch| batch.samples.sine_v.iter().all(|volts| (volts - 7.0 * unit_v).abs() < 1e-12)));
    assert_eq!(bench.bridge.streaming_adapter().get().unwrap().skew_ns, 5_000);
    assert!(heard.lock().unwrap().contains(&Request::AnalogSkew));
}

/// An AFS60 with sine and cosine needs 5 V, and allows at most 5.5 V.
#[test]
fn switches_requested_supply_on() {
    for (too_high, expected) in [(400, Ok((5_400, 60))), (600, Err((5_000, 5_600, 5_500)))] {
        let mut device = scripted_adapter(vec![analog(0, 0, vec![(1, 1)])]);
        device.capabilities = Capabilities::ANALOG.union(Capabilities::SUPPLY);
        device.too_high = too_high;
        let heard = device.heard.clone();
        let mut bench = bench(SINE_COSINE, device);
        bench.bridge.supply = Some(Family::AfsAfm60.supply_voltage());
        let mut requested = vec![Request::Hello, Request::Supply { on: true, millivolt: 5_000 }];
        match expected {
            Ok(supplied) => {
                let begun = bench.clock.now();
                assert_eq!(bench.take(Duration::from_millis(1_100)).len(), 1);
                assert!(bench.clock.now().duration_since(begun) >= Duration::from_secs(1), "it has to start");
                assert_eq!(bench.bridge.streaming_adapter().get().unwrap().supplied, Some(supplied));
                requested.extend([Request::AnalogConfig { sample_hz: 50_000 }, Request::AnalogStream { on: true }]);
            }
            Err((given, measured, greatest)) => {
                let error = adapter_error(bench.error());
                assert_eq!(error, AdapterError::Overvoltage { given, measured, greatest });
                requested.push(Request::Supply { on: false, millivolt: 0 });
            }
        }
        assert_eq!(*heard.lock().unwrap(), requested);
    }
    let mut bench = bench(SINE_COSINE, scripted_adapter(Vec::new()));
    bench.bridge.supply = Some(Family::Hiperface.supply_voltage());
    assert_eq!(adapter_error(bench.error()), AdapterError::NoSupply { name: "ScriptedAdapter".to_owned() });
}

#[test]
fn restarts_unanswered_stream() {
    let mut device = scripted_adapter(vec![analog(0, 0, vec![(1, 1)])]);
    device.lost_replies = vec![Operation::AnalogStream];
    let heard = device.heard.clone();
    let mut bench = bench(SINE_COSINE, device);
    assert_eq!(bench.take(Duration::from_secs(1)).len(), 1);
    let on: Vec<Request> = heard.lock().unwrap().iter().skip(2).cloned().collect();
    assert_eq!(on, [true, false, true].map(|on| Request::AnalogStream { on }));
}

fn adapter_error(error: BridgeError) -> AdapterError {
    match error {
        BridgeError::Tap(AdapterStreamError::Adapter(error)) => error,
        other => panic!("{other:?}"),
    }
}

#[test]
fn reports_missing_capabilities() {
    let mut lame = scripted_adapter(Vec::new());
    lame.capabilities = Capabilities::SSI;
    let error = adapter_error(bench(SINE_COSINE, lame).error());
    assert_eq!(error, AdapterError::NoAnalog { name: "ScriptedAdapter".to_owned() });
    let mut lame = scripted_adapter(Vec::new());
    lame.capabilities = Capabilities::ANALOG;
    assert_eq!(
        adapter_error(bench(RawFrames, lame).error()),
        AdapterError::NoBiss { name: "ScriptedAdapter".to_owned() }
    );
    let error = adapter_error(bench(SINE_COSINE, virtual_adapter("version=2")).error());
    assert_eq!(error, AdapterError::Version { expected: 1, got: 2 });
    let error = adapter_error(bench(SINE_COSINE, virtual_adapter("fault=silent-after:0")).error());
    assert_eq!(error, AdapterError::Silent);
    let mut busy = scripted_adapter(Vec::new());
    busy.refused = vec![(Operation::AnalogStream, ErrorCode::BUSY)];
    let error = adapter_error(bench(SINE_COSINE, busy).error());
    assert!(matches!(error, AdapterError::Refused { code: ErrorCode::BUSY, .. }), "{error}");
}

#[test]
fn reports_unexpected_stream_end() {
    let mut quiet = bench(SINE_COSINE, scripted_adapter(vec![analog(0, 0, vec![(1, 1)])]));
    assert_eq!(adapter_error(quiet.error()), AdapterError::StreamSilent);
    assert!(quiet.clock.now().since_start() < Duration::from_secs(6), "three seconds before it began");
    let data = vec![analog(0, 0, vec![(1, 1); 9]), analog(0, 0, vec![(1, 1)])];
    assert_eq!(adapter_error(bench(SINE_COSINE, scripted_adapter(data)).error()), AdapterError::Restarted);
    let biss = Message::Data(StreamData::Biss(BissData {
        first_index: 0,
        t0_us: 0,
        period_us: 50,
        lost: 0,
        width: 6,
        values: vec![(BissStatus::OK, 0x024_6980_00CF)],
    }));
    let mut other = bench(SINE_COSINE, scripted_adapter(vec![biss, analog(0, 0, vec![(1, 1)])]));
    assert_eq!(other.take(Duration::from_millis(100)).len(), 1, "what another stream has left is let go");
}

/// A connection that is unplugged after the given number of chunks.
struct UnpluggingLink(SimLink, u32);

impl ByteLink for UnpluggingLink {
    fn send(&mut self, bytes: &[u8]) -> Result<(), LinkError> {
        self.0.send(bytes)
    }

    fn receive(&mut self, until: Moment, into: &mut Vec<u8>) -> Result<(), LinkError> {
        self.1 = self.1.checked_sub(1).ok_or(LinkError::new("wire", LinkErrorKind::Lost))?;
        self.0.receive(until, into)
    }

    fn set_format(&mut self, format: CharacterFormat) -> Result<(), LinkError> {
        self.0.set_format(format)
    }

    fn check_connection(&mut self) -> Result<(), LinkError> {
        Ok(())
    }
}

#[test]
fn reports_lost_or_missing_wire() {
    for portions in [0, 1, 2, 3, 10] {
        let clock = Arc::new(VirtualClock::default());
        let link = SimLink::connect(Arc::new(Mutex::new(virtual_adapter("rpm=60"))), clock.clone());
        let open: OpenAdapterFn = Box::new(move || Ok(Box::new(UnpluggingLink(link, portions))));
        let stream =
            Stream::spawn(Bridge::new(SINE_COSINE, None, MARGIN, open), 1_000_000, clock, Arc::new(|| ())).unwrap();
        assert!(stream.end_signal().wait_for_end(Duration::from_secs(20)));
        let error = stream.take_error();
        assert!(
            matches!(error, Some(BridgeError::Tap(AdapterStreamError::Link(error))) if error.is_lost()),
            "{portions}"
        );
    }
    let lost = LinkError::new("/dev/nowhere", LinkErrorKind::NotFound);
    let open: OpenAdapterFn = Box::new(move || Err(lost.into()));
    let stream = Stream::spawn(
        Bridge::new(SINE_COSINE, None, MARGIN, open),
        1,
        Arc::new(VirtualClock::default()),
        Arc::new(|| ()),
    );
    let stream = stream.unwrap();
    assert!(stream.end_signal().wait_for_end(Duration::from_secs(20)));
    assert_eq!(stream.take_error().unwrap().to_string(), "/dev/nowhere: does not exist");
}
