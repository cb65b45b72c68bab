//! Tests of the virtual adapter from the perspective of a host, in virtual time.

mod host;
mod line;

use std::time::Duration;

use host::SsiTestEncoder;
pub(crate) use host::{BISS, Host, SSI, TestBissDevice};

use crate::buses::bridge::protocol::*;
use crate::buses::bridge::sim::{Adapter, all_setting_names};
use crate::sim::ByteDevice;
use crate::sim::setting::query_pairs;
use crate::units::Moment;

#[test]
fn adapter_identifies_itself() {
    let mut host = Host::with("");
    let Some(Message::Reply(Reply::Hello(hello))) = host.ask(Request::Hello) else { panic!() };
    assert_eq!(hello.capabilities.to_bits(), 0b1111);
    assert_eq!((hello.max_clock_hz, hello.max_sample_hz), (10_000_000, 1_000_000));
    host.refuses(Request::Supply { on: true, millivolt: 8000 }, ErrorCode::NOT_SUPPORTED);
    host.refuses(Request::UartConfig { baud: 9600, parity: 2, turnaround_us: 0 }, ErrorCode::NOT_SUPPORTED);
    // The operation is unknown.
    host.adapter.on_bytes(host.now, &Packet { seq: 9, op: 0x55, body: vec![] }.emit());
    let messages = host.receive(host.now + Duration::from_millis(1));
    let text = "this adapter has no such thing".to_owned();
    assert_eq!(messages, [(9, Message::Error { op: 0x55, code: ErrorCode::NOT_SUPPORTED, text })]);
}

#[test]
fn reports_other_adapter_version() {
    let mut host = Host::with("version=2");
    host.send(&Request::Hello);
    host.now = host.now + Duration::from_millis(1);
    let bytes = host.adapter.poll(host.now);
    host.receiver.push(&bytes);
    let packet = host.receiver.next_packet().unwrap();
    assert_eq!(Message::parse(&packet), Err(BodyError::Version { expected: 1, got: 2 }));
}

#[test]
fn reports_damaged_wires() {
    for (query, expected, word) in [
        ("line=open", BissStatus::NO_ACKNOWLEDGE, 0x1FF_FFFF),
        ("line=low", BissStatus::STUCK_LOW, 0),
        ("line=high", BissStatus::STUCK_HIGH, 0x1FF_FFFF),
    ] {
        let mut host = Host::with(query);
        host.ask(BISS);
        let Some(Message::Reply(Reply::BissRead { status, .. })) = host.ask(Request::BissRead) else { panic!() };
        assert_eq!(status, expected, "{query}");
        host.refuses(Request::BissRegisterRead { slave: 0, address: 0x66 }, ErrorCode::NO_REPLY);
        host.ask(SSI);
        let Some(Message::Reply(Reply::SsiRead { raw, .. })) = host.ask(Request::SsiRead) else { panic!() };
        assert_eq!(raw, word, "{query}");
    }
}

/// In addition to the usual reply time, a register access takes 47 cycles of 47 µs (7 µs for the acknowledgement, 22 µs
/// for the clocks and 18 µs for the time-out).
#[test]
fn register_access_takes_expected_time() {
    let mut host = Host::with("");
    host.ask(BISS);
    let start = host.now;
    host.send(&Request::BissRegisterRead { slave: 0, address: 0x66 });
    assert_eq!(host.adapter.poll_at(), Some(start + Duration::from_micros(250 + 47 * 47)));
}

#[test]
fn period_covers_frame() {
    let mut host = Host::with("");
    host.ask(BISS);
    host.expect(Request::BissStream { period_us: 1 }, Reply::BissStream { period_us: 47 });
}

#[test]
fn stream_blocks_its_bus() {
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

/// The full scale is 1.25 V. The encoder has 1024 periods per revolution, turns at 60 rpm and has an amplitude of 0.5
/// V.
#[test]
fn analog_samples_match_virtual_encoder() {
    let mut host = Host::with("rpm=60");
    let config = Reply::AnalogConfig { sample_hz: 102_396, full_scale_microvolt: 1_250_000, bits: 16 };
    host.expect(Request::AnalogConfig { sample_hz: 102_400 }, config);
    host.send(&Request::AnalogStream { on: true });
    let packets = host.stream(1_000);
    let mut continuity = Continuity::at_start();
    let mut samples = Vec::new();
    for data in packets {
        assert_eq!(continuity.gap_before(&data), PacketGap::None);
        let StreamData::Analog(data) = data else { panic!("{data:?}") };
        samples.extend(data.samples);
    }
    assert!(samples.len() > 101_000);
    // 0.5 V of 1.25 V is 13 107 of 32 767, and 0.5 mV of noise is 13.
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

/// The word of the test encoder has 13 bits per revolution, so a quarter of a revolution is 2048 steps.
#[test]
fn adapter_without_biss_encoder_has_shaft() {
    let mut host = Host::to("rpm=60&supply=switched", &[&SsiTestEncoder]);
    host.ask(SSI);
    let word = |host: &mut Host| match host.ask(Request::SsiRead) {
        Some(Message::Reply(Reply::SsiRead { t_us, raw })) => (t_us, raw),
        other => panic!("{other:?}"),
    };
    assert_eq!(word(&mut host).1, 0x1FF_FFFF, "without power no encoder sends");
    host.ask(Request::Supply { on: true, millivolt: 8000 });
    let (before, after) = (word(&mut host), {
        host.receive(host.now + Duration::from_millis(250));
        word(&mut host)
    });
    for (t_us, raw) in [before, after] {
        assert_eq!(raw, t_us * 8192 / 1_000_000, "at {t_us} µs");
    }
    assert!(after.1 - before.1 >= 2048, "{before:?} {after:?}");
    host.adapter.set_rpm(host.now, 0.0);
    let still = word(&mut host).1;
    host.receive(host.now + Duration::from_millis(100));
    assert_eq!(word(&mut host).1, still);
    assert_eq!(host.adapter.motor().rpm(), 0.0);
    assert!(all_setting_names(&[&SsiTestEncoder]).contains(&"rpm"));
    assert!(Adapter::from_pairs(&query_pairs("rpm=x"), &[&SsiTestEncoder]).is_err());
}

#[test]
fn encoders_share_one_shaft() {
    let mut host = Host::with("");
    host.ask(BISS);
    host.ask(Request::AnalogConfig { sample_hz: 100_000 });
    host.send(&Request::BissStream { period_us: 1000 });
    host.send(&Request::AnalogStream { on: true });
    let still = host.stream(50);
    host.adapter.set_rpm(host.now, 6.0);
    let turning = host.stream(200);
    let moves = |packets: &[StreamData]| {
        let positions = packets.iter().flat_map(|data| match data {
            StreamData::Biss(data) => data.values.iter().map(|(_, raw)| raw >> 6).collect::<Vec<_>>(),
            _ => Vec::new(),
        });
        let sines = packets.iter().flat_map(|data| match data {
            StreamData::Analog(data) => data.samples.iter().map(|(sine, _)| *sine).collect::<Vec<_>>(),
            _ => Vec::new(),
        });
        let (first, last) = (positions.clone().next().unwrap(), positions.last().unwrap());
        (last != first, sines.clone().max().unwrap() > 10_000 && sines.min().unwrap() < -10_000)
    };
    assert_eq!((moves(&still), moves(&turning)), ((false, false), (true, true)));
}

#[test]
fn switches_supply() {
    let mut host = Host::with("supply=switched");
    let Some(Message::Reply(Reply::Hello(hello))) = host.ask(Request::Hello) else { panic!() };
    assert!(hello.capabilities.contains(Capabilities::SUPPLY) && !hello.capabilities.contains(Capabilities::SUPPLY_ON));
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
    // Another host sends HELLO, which does not change the supply and reports it (issue 22.16).
    let Some(Message::Reply(Reply::Hello(hello))) = host.ask(Request::Hello) else { panic!() };
    assert!(hello.capabilities.contains(Capabilities::SUPPLY_ON));
    assert_eq!(status(&mut host), BissStatus::OK);
    let off = Reply::Supply { on: false, millivolt: 0, milliampere: 0 };
    host.expect(Request::Supply { on: false, millivolt: 5000 }, off);
    host.adapter.connect(host.now);
    assert_eq!(status(&mut host), BissStatus::NO_ACKNOWLEDGE);
}

/// Requests that arrive faster than they can be answered are lost, and the adapter answers the next one (issue 22.18).
#[test]
fn answers_after_request_flood() {
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

/// If the host sleeps for ten seconds, the samples that the adapter cannot store are lost, and their number is
/// reported.
#[test]
fn reports_unfetched_samples() {
    let mut host = Host::with("");
    host.ask(BISS);
    host.ask(Request::AnalogConfig { sample_hz: 10_000 });
    host.send(&Request::BissStream { period_us: 1000 });
    host.send(&Request::AnalogStream { on: true });
    host.stream(100);
    host.now = host.now + Duration::from_secs(10);
    let packets = host.stream(0);
    for (is_own, rate) in [
        ((|data| matches!(data, StreamData::Biss(_))) as fn(&StreamData) -> bool, 1_000),
        (|data| matches!(data, StreamData::Analog(_)), 10_000),
    ] {
        let own: Vec<&StreamData> = packets.iter().filter(|data| is_own(data)).collect();
        let samples: usize = own.iter().map(|data| data.sample_range().1).sum();
        assert!((rate * 9 / 10..=rate * 11 / 10).contains(&samples), "{samples}");
        let lost: Vec<u16> = own.iter().map(|data| data.sample_range().2).filter(|lost| *lost > 0).collect();
        assert!(lost.len() == 1 && usize::from(lost[0]) > 8 * rate.min(8_000), "{lost:?}");
    }
}
