//! What a host sees of the virtual adapter, in virtual time.

mod line;

use std::time::Duration;

use super::*;
use crate::protocol::biss::{FrameError, Layout, Reading};
use crate::protocol::bridge::*;
use crate::sim::ByteDevice;
use crate::units::Moment;

struct Host {
    adapter: Adapter,
    receiver: Receiver,
    seq: u8,
    now: Moment,
}

const BISS: Request = Request::BissConfig { clock_hz: 2_000_000, data_bits: 35, crc_bits: 6, timeout_us: 18 };
const SSI: Request = Request::SsiConfig { clocks: 25, clock_hz: 500_000, pause_us: 30, flags: SsiFlags::FALLING_EDGE };

impl Host {
    fn with(query: &str) -> Self {
        let pair = |item: &str| item.split_once('=').map(|(key, value)| (key.to_owned(), value.to_owned()));
        let pairs: Vec<_> = query.split('&').filter_map(pair).collect();
        let adapter = Adapter::new(&Config::from_pairs(&pairs).unwrap());
        Host { adapter, receiver: Receiver::default(), seq: 0, now: Moment::START }
    }

    fn send(&mut self, request: &Request) {
        self.seq += 1;
        self.adapter.on_bytes(self.now, &request.emit(self.seq).emit());
    }

    /// What has arrived until a moment.
    fn receive(&mut self, until: Moment) -> Vec<(u8, Message)> {
        while let Some(at) = self.adapter.poll_at().filter(|at| *at <= until) {
            self.now = self.now.max(at);
            let bytes = self.adapter.poll(self.now);
            self.receiver.push(&bytes);
        }
        self.now = self.now.max(until);
        let packets = std::iter::from_fn(|| self.receiver.next_packet());
        packets.map(|packet| (packet.seq, Message::parse(&packet).unwrap())).collect()
    }

    /// The reply to a request, of which there is no more than one within 100 ms.
    fn ask(&mut self, request: Request) -> Option<Message> {
        self.send(&request);
        let mut messages = self.receive(self.now + Duration::from_millis(100));
        messages.retain(|(_, message)| !matches!(message, Message::Data(_)));
        assert!(messages.len() <= 1, "{messages:?}");
        let (seq, message) = messages.pop()?;
        assert_eq!(seq, self.seq);
        Some(message)
    }

    #[track_caller]
    fn expect(&mut self, request: Request, reply: Reply) {
        assert_eq!(self.ask(request), Some(Message::Reply(reply)));
    }

    #[track_caller]
    fn refuses(&mut self, request: Request, expected: ErrorCode) {
        let own = request.operation().byte();
        match self.ask(request) {
            Some(Message::Error { op, code, text }) => {
                assert_eq!((op, code), (own, expected), "{text}");
                assert!(!text.is_empty());
            }
            other => panic!("{other:?}"),
        }
    }

    fn stream(&mut self, milliseconds: u64) -> Vec<Data> {
        let messages = self.receive(self.now + Duration::from_millis(milliseconds));
        let data = |(_, message)| match message {
            Message::Data(data) => Some(data),
            _ => None,
        };
        messages.into_iter().filter_map(data).collect()
    }
}

#[test]
fn the_adapter_says_what_it_is() {
    let mut host = Host::with("");
    let Some(Message::Reply(Reply::Hello(hello))) = host.ask(Request::Hello) else { panic!() };
    assert_eq!(hello.capabilities.word(), 0b1111);
    assert_eq!((hello.max_clock_hz, hello.max_sample_hz), (10_000_000, 1_000_000));
    host.refuses(Request::Supply { on: true, millivolt: 8000 }, ErrorCode::NOT_SUPPORTED);
    host.refuses(Request::UartConfig { baud: 9600, parity: 2, turnaround_us: 0 }, ErrorCode::NOT_SUPPORTED);
    // An operation that there is not.
    host.adapter.on_bytes(host.now, &Packet { seq: 9, op: 0x55, body: vec![] }.emit());
    let messages = host.receive(host.now + Duration::from_millis(1));
    let text = "this adapter has no such thing".to_owned();
    assert_eq!(messages, [(9, Message::Error { op: 0x55, code: ErrorCode::NOT_SUPPORTED, text })]);
}

#[test]
fn another_version_answers_as_one() {
    let mut host = Host::with("version=2");
    host.send(&Request::Hello);
    host.now = host.now + Duration::from_millis(1);
    let bytes = host.adapter.poll(host.now);
    host.receiver.push(&bytes);
    let packet = host.receiver.next_packet().unwrap();
    assert_eq!(Message::parse(&packet), Err(BodyError::Version { expected: 1, got: 2 }));
}

/// The golden frame of the BiSS reference: MT 1234, ST 18000.
#[test]
fn a_frame_is_read() {
    let mut host = Host::with("");
    host.refuses(Request::BissRead, ErrorCode::BAD_ARGUMENT);
    host.expect(BISS, Reply::BissConfig { clock_hz: 2_000_000 });
    let t_us = host.now.since_start().as_micros() as u64;
    host.expect(Request::BissRead, Reply::BissRead { t_us, status: BissStatus::OK, raw: 0x24_6980_00CF });
    // Fewer and more bits than the encoder sends.
    let of_width = |data_bits| Request::BissConfig { clock_hz: 7_000_000, data_bits, crc_bits: 6, timeout_us: 18 };
    for (data_bits, expected) in [(31, 0x24_6980_00CF >> 4), (39, 0x24_6980_00CF << 4)] {
        host.expect(of_width(data_bits), Reply::BissConfig { clock_hz: 6_666_666 });
        let Some(Message::Reply(Reply::BissRead { raw, .. })) = host.ask(Request::BissRead) else { panic!() };
        assert_eq!(raw, expected);
        let layout = Layout::new(16, data_bits - 18, true, true, Layout::default().crc().cloned()).unwrap();
        assert!(matches!(layout.parse(raw), Err(FrameError::Crc { .. })), "wrong widths are found");
    }
    for (clock_hz, data_bits, crc_bits) in
        [(79_999, 35, 6), (1_000_000, 0, 6), (1_000_000, 60, 5), (1_000_000, 255, 255)]
    {
        let wrong = Request::BissConfig { clock_hz, data_bits, crc_bits, timeout_us: 18 };
        host.refuses(wrong, ErrorCode::BAD_ARGUMENT);
    }
}

#[test]
fn damaged_wires_are_told() {
    for (query, expected, word) in [
        ("line=open", BissStatus::NO_ACKNOWLEDGE, 0x1FF_FFFF),
        ("line=low", BissStatus::STUCK_LOW, 0),
        ("line=high", BissStatus::STUCK_HIGH, 0x1FF_FFFF),
    ] {
        let mut host = Host::with(query);
        host.ask(BISS);
        let Some(Message::Reply(Reply::BissRead { status, .. })) = host.ask(Request::BissRead) else { panic!() };
        assert_eq!(status, expected, "{query}");
        host.refuses(Request::BissRegisterRead { slave: 0, address: 0x66 }, ErrorCode::NO_ANSWER);
        host.ask(SSI);
        let Some(Message::Reply(Reply::SsiRead { raw, .. })) = host.ask(Request::SsiRead) else { panic!() };
        assert_eq!(raw, word, "{query}");
    }
}

#[test]
fn registers_are_read_and_written_by_bank() {
    let mut host = Host::with("temperature=25&cycles=0");
    let read = |address| Request::BissRegisterRead { slave: 0, address };
    let write = |address, value| Request::BissRegisterWrite { slave: 0, address, value };
    let read_back = |value| Reply::BissRegisterWrite { value };
    host.refuses(read(0x66), ErrorCode::BAD_ARGUMENT);
    host.ask(BISS);
    host.expect(read(0x66), Reply::BissRegisterRead { value: 0x4B });
    host.expect(write(0x40, 0x02), read_back(0x02));
    host.expect(read(0x05), Reply::BissRegisterRead { value: 0x1C });
    host.expect(write(0x6A, 0x07), read_back(0x00)); // without the password
    host.expect(write(0x6B, 0x2A), read_back(0x2A));
    host.expect(write(0x6A, 0x07), read_back(0x07));
    host.expect(write(0x40, 0x01), read_back(0x01));
    host.expect(write(0x00, 0x01), read_back(0x01)); // preset, and a restart
    host.refuses(read(0x66), ErrorCode::NO_ANSWER);
    host.now = host.now + Duration::from_millis(500);
    host.expect(read(0x6A), Reply::BissRegisterRead { value: 0x00 });
    assert_eq!(host.adapter.encoder().flash().cycles(), 1);
    host.expect(write(0x40, 0x44), read_back(0x44));
    host.refuses(read(0x00), ErrorCode::NO_ANSWER); // there is no such bank
    host.refuses(Request::BissRegisterRead { slave: 1, address: 0x66 }, ErrorCode::NO_ANSWER);
    host.refuses(read(0x80), ErrorCode::BAD_ARGUMENT);
}

/// 47 cycles of 47 µs (7 of acknowledge, 22 of clocks, 18 of time-out), and the way of the bytes.
#[test]
fn a_register_takes_its_time() {
    let mut host = Host::with("");
    host.ask(BISS);
    let start = host.now;
    host.send(&Request::BissRegisterRead { slave: 0, address: 0x66 });
    assert_eq!(host.adapter.poll_at(), Some(start + Duration::from_micros(250 + 47 * 47)));
}

/// 20 000 frames a second for a second: every one of them, in order, each with its position.
#[test]
fn a_fast_stream_has_no_gap() {
    let mut host = Host::with("rpm=600&position=0");
    host.ask(BISS);
    host.send(&Request::BissStream { period_us: 50 });
    let packets = host.stream(1_000);
    let layout = Layout::default();
    let (mut continuity, mut count) = (Continuity::at_start(), 0u64);
    let start_us = match &packets[0] {
        Data::Biss(data) => data.t0_us,
        other => panic!("{other:?}"),
    };
    for data in &packets {
        assert_eq!(continuity.follow(data), Gap::None);
        let Data::Biss(data) = data else { panic!("{data:?}") };
        assert_eq!((data.t0_us, data.period_us, data.width), (start_us + 50 * count, 50, 6));
        for (status, raw) in &data.values {
            let Reading { multiturn, singleturn, error, .. } = layout.parse(*raw).unwrap();
            // Ten revolutions a second from the start of time.
            let steps = (start_us + 50 * count) * 10 * (1 << 17) / 1_000_000;
            let found = u64::from(multiturn) << 17 | u64::from(singleturn);
            assert!(found.abs_diff(steps) <= 1 && !error && *status == BissStatus::OK, "{count}: {found} {steps}");
            count += 1;
        }
    }
    assert!((19_900..=20_000).contains(&count), "{count}");
    host.expect(Request::BissStream { period_us: 0 }, Reply::BissStream { period_us: 0 });
    assert_eq!(host.stream(100), []);
}

#[test]
fn a_period_is_not_shorter_than_a_frame() {
    let mut host = Host::with("");
    host.ask(BISS);
    host.expect(Request::BissStream { period_us: 1 }, Reply::BissStream { period_us: 47 });
}

#[test]
fn a_stream_keeps_its_bus_busy() {
    let mut host = Host::with("");
    host.ask(BISS);
    host.ask(SSI);
    host.ask(Request::BissStream { period_us: 1000 });
    for request in [
        BISS,
        Request::BissRead,
        Request::BissStream { period_us: 50 },
        Request::BissRegisterRead { slave: 0, address: 0x66 },
        SSI,
        Request::SsiRead,
        Request::SsiStream { period_us: 50 },
    ] {
        host.refuses(request, ErrorCode::BUSY);
    }
    host.expect(Request::SsiStream { period_us: 0 }, Reply::SsiStream { period_us: 0 });
    assert!(!host.stream(100).is_empty(), "the end of another stream does not end this one");
    host.ask(Request::Hello);
    assert_eq!(host.stream(100), []);
}

/// The shaft at 270.0° of turn 1234h: SSI has the lowest 12 bits of the turns and the highest 13 of the turn's.
#[test]
fn ssi_words_in_gray_and_binary_and_with_another_zero() {
    let natural = 0x234 << 13 | 0x1800;
    for (query, word) in [
        ("ssi=atm60", natural),
        ("ssi=atm60,code=gray", natural ^ natural >> 1),
        ("ssi=atm60,preset=8192", 0x235 << 13 | 0x1800),
        ("ssi=atm60,direction=ccw", (1 << 25) - natural),
        ("ssi=atm60,direction=ccw,preset=1", (1 << 25) - natural + 1),
    ] {
        let mut host = Host::with(query);
        host.refuses(Request::SsiRead, ErrorCode::BAD_ARGUMENT);
        host.expect(SSI, Reply::SsiConfig { clock_hz: 500_000 });
        let Some(Message::Reply(Reply::SsiRead { raw, .. })) = host.ask(Request::SsiRead) else { panic!() };
        assert_eq!(raw, word, "{query}");
        host.ask(Request::SsiConfig { clocks: 26, clock_hz: 500_000, pause_us: 30, flags: SsiFlags::FALLING_EDGE });
        host.ask(Request::SsiStream { period_us: 100 });
        let packets = host.stream(100);
        let mut words = packets.iter().flat_map(|data| match data {
            Data::Ssi(data) => data.values.clone(),
            other => panic!("{other:?}"),
        });
        assert!(words.clone().count() > 900 && words.all(|raw| raw == word << 1), "{query}");
    }
    let mut host = Host::with("");
    for clocks in [0, 65] {
        let wrong = Request::SsiConfig { clocks, clock_hz: 500_000, pause_us: 30, flags: SsiFlags::FALLING_EDGE };
        host.refuses(wrong, ErrorCode::BAD_ARGUMENT);
    }
}

/// 1024 periods in a revolution, 60 revolutions a minute, 0.5 V of amplitude, 1.25 V of full scale.
#[test]
fn analogue_samples_are_the_virtual_encoders() {
    let mut host = Host::with("rpm=60");
    let config = Reply::AnalogConfig { sample_hz: 102_396, full_scale_microvolt: 1_250_000, bits: 16 };
    host.expect(Request::AnalogConfig { sample_hz: 102_400 }, config);
    host.send(&Request::AnalogStream { on: true });
    let packets = host.stream(1_000);
    let mut continuity = Continuity::at_start();
    let mut samples = Vec::new();
    for data in packets {
        assert_eq!(continuity.follow(&data), Gap::None);
        let Data::Analog(data) = data else { panic!("{data:?}") };
        samples.extend(data.samples);
    }
    assert!(samples.len() > 101_000);
    // 0.5 V of 1.25 V are 13 107 of 32 767; 0.5 mV of noise are 13.
    let near = |value: i16, expected: f64| (f64::from(value) - expected).abs() < 100.0;
    assert!(near(samples[0].0, 0.0) && near(samples[0].1, 13_106.8));
    for (index, (sine, cosine)) in samples.iter().enumerate() {
        let radius = f64::from(*sine).hypot((*cosine).into());
        assert!((radius - 13_106.8).abs() < 150.0, "{index}: {radius}");
    }
    host.refuses(Request::AnalogStream { on: true }, ErrorCode::BUSY);
    host.refuses(Request::AnalogConfig { sample_hz: 1000 }, ErrorCode::BUSY);
    host.expect(Request::AnalogStream { on: false }, Reply::AnalogStream { on: false });
    assert_eq!(host.stream(100), []);
    host.refuses(Request::AnalogConfig { sample_hz: 0 }, ErrorCode::BAD_ARGUMENT);
    host.refuses(Request::AnalogConfig { sample_hz: 1_000_001 }, ErrorCode::BAD_ARGUMENT);
}

#[test]
fn the_shaft_is_turned_for_all_encoders() {
    let mut host = Host::with("position=0");
    host.ask(BISS);
    host.ask(Request::AnalogConfig { sample_hz: 100_000 });
    host.send(&Request::BissStream { period_us: 1000 });
    host.send(&Request::AnalogStream { on: true });
    let still = host.stream(50);
    host.adapter.set_rpm(host.now, 6.0);
    let turning = host.stream(200);
    let moves = |packets: &[Data]| {
        let positions = packets.iter().flat_map(|data| match data {
            Data::Biss(data) => data.values.iter().map(|(_, raw)| raw >> 6).collect::<Vec<_>>(),
            _ => Vec::new(),
        });
        let sines = packets.iter().flat_map(|data| match data {
            Data::Analog(data) => data.samples.iter().map(|(sine, _)| *sine).collect::<Vec<_>>(),
            _ => Vec::new(),
        });
        let (first, last) = (positions.clone().next().unwrap(), positions.last().unwrap());
        (last != first, sines.clone().max().unwrap() > 10_000 && sines.min().unwrap() < -10_000)
    };
    assert_eq!((moves(&still), moves(&turning)), ((false, false), (true, true)));
}

#[test]
fn the_supply_can_be_switched() {
    let mut host = Host::with("supply=switched");
    let Some(Message::Reply(Reply::Hello(hello))) = host.ask(Request::Hello) else { panic!() };
    assert!(hello.capabilities.has(Capabilities::SUPPLY) && !hello.capabilities.has(Capabilities::SUPPLIED));
    host.ask(BISS);
    let status = |host: &mut Host| match host.ask(Request::BissRead) {
        Some(Message::Reply(Reply::BissRead { status, .. })) => status,
        other => panic!("{other:?}"),
    };
    assert_eq!(status(&mut host), BissStatus::NO_ACKNOWLEDGE);
    host.refuses(Request::Supply { on: true, millivolt: 24_000 }, ErrorCode::BAD_ARGUMENT);
    let on = Reply::Supply { on: true, millivolt: 5000, milliampere: 60 };
    host.expect(Request::Supply { on: true, millivolt: 5000 }, on);
    assert_eq!(status(&mut host), BissStatus::NO_ACKNOWLEDGE, "it starts");
    host.now = host.now + Duration::from_millis(500);
    assert_eq!(status(&mut host), BissStatus::OK);
    // Issue 22.16: another host says HELLO, which leaves the supply as it is and tells it.
    let Some(Message::Reply(Reply::Hello(hello))) = host.ask(Request::Hello) else { panic!() };
    assert!(hello.capabilities.has(Capabilities::SUPPLIED));
    assert_eq!(status(&mut host), BissStatus::OK);
    let off = Reply::Supply { on: false, millivolt: 0, milliampere: 0 };
    host.expect(Request::Supply { on: false, millivolt: 5000 }, off);
    host.adapter.connect(host.now);
    assert_eq!(status(&mut host), BissStatus::NO_ACKNOWLEDGE);
}

/// Issue 22.18: requests that come faster than they can be answered are lost, and the adapter answers the next one.
#[test]
fn a_flood_of_requests_does_not_make_it_deaf() {
    let mut host = Host::with("");
    host.expect(BISS, Reply::BissConfig { clock_hz: 2_000_000 });
    let read = Request::BissRegisterRead { slave: 0, address: 0x42 };
    let packet = read.emit(1).emit();
    (0..20_000).for_each(|_| host.adapter.on_bytes(host.now, &packet));
    host.adapter.on_bytes(host.now, &vec![0x55; 1 << 20]);
    host.adapter.on_bytes(host.now, &[0]);
    let answered = host.receive(host.now + Duration::from_secs(1)).len();
    assert!((1..100).contains(&answered), "{answered}");
    host.expect(read, Reply::BissRegisterRead { value: 0x61 });
}

#[test]
fn noise_is_found_by_the_crc() {
    let mut host = Host::with("noise=0.25&seed=5");
    host.ask(BISS);
    host.ask(Request::BissStream { period_us: 100 });
    let packets = host.stream(1_000);
    let frames = packets.iter().flat_map(|data| match data {
        Data::Biss(data) => data.values.clone(),
        other => panic!("{other:?}"),
    });
    let bad = frames.clone().filter(|(_, raw)| Layout::default().parse(*raw).is_err()).count();
    let share = bad as f64 / frames.count() as f64;
    assert!((0.2..0.3).contains(&share), "{share}");
}

/// A host that sleeps for ten seconds loses what the adapter cannot keep, and is told.
#[test]
fn what_is_not_fetched_is_lost_and_told() {
    let mut host = Host::with("");
    host.ask(BISS);
    host.ask(Request::AnalogConfig { sample_hz: 10_000 });
    host.send(&Request::BissStream { period_us: 1000 });
    host.send(&Request::AnalogStream { on: true });
    host.stream(100);
    host.now = host.now + Duration::from_secs(10);
    let packets = host.stream(0);
    for (is_own, rate) in [
        ((|data| matches!(data, Data::Biss(_))) as fn(&Data) -> bool, 1_000),
        (|data| matches!(data, Data::Analog(_)), 10_000),
    ] {
        let own: Vec<&Data> = packets.iter().filter(|data| is_own(data)).collect();
        let samples: usize = own.iter().map(|data| data.extent().1).sum();
        assert!((rate * 9 / 10..=rate * 11 / 10).contains(&samples), "{samples}");
        let lost: Vec<u16> = own.iter().map(|data| data.extent().2).filter(|lost| *lost > 0).collect();
        assert!(lost.len() == 1 && usize::from(lost[0]) > 8 * rate.min(8_000), "{lost:?}");
    }
}
