//! Tests of the kit encoder on the bus of a virtual adapter, from the perspective of a host.

use std::time::Duration;

use crate::buses::bridge::protocol::*;
use crate::buses::bridge::sim::tests::{BISS, Host};
use crate::devices::biss::protocol::{FrameError, Layout, PositionData};
use crate::devices::biss::sim::{AttachableEncoder, Encoder};
use crate::sim::ByteDevice;

fn behind_adapter(query: &str) -> Host {
    Host::to(query, &[&AttachableEncoder])
}

/// Reads the example frame of the BiSS reference, with multiturn 1234h and singleturn 18000h.
#[test]
fn reads_frame() {
    let mut host = behind_adapter("");
    host.refuses(Request::BissRead, ErrorCode::BAD_ARGUMENT);
    host.expect(BISS, Reply::BissConfig { clock_hz: 2_000_000 });
    let t_us = host.now.since_start().as_micros() as u64;
    host.expect(Request::BissRead, Reply::BissRead { t_us, status: BissStatus::OK, raw: 0x24_6980_00CF });
    // The host reads fewer or more bits than the encoder sends.
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
fn reads_and_writes_registers_by_bank() {
    let mut host = behind_adapter("temperature=25&cycles=0");
    let read = |address| Request::BissRegisterRead { slave: 0, address };
    let write = |address, value| Request::BissRegisterWrite { slave: 0, address, value };
    let read_back = |value| Reply::BissRegisterWrite { value };
    host.refuses(read(0x66), ErrorCode::BAD_ARGUMENT);
    host.ask(BISS);
    host.expect(read(0x66), Reply::BissRegisterRead { value: 0x4B });
    host.expect(write(0x40, 0x02), read_back(0x02));
    host.expect(read(0x05), Reply::BissRegisterRead { value: 0x1C });
    host.expect(write(0x6A, 0x07), read_back(0x00)); // rejected without the password
    host.expect(write(0x6B, 0x2A), read_back(0x2A));
    host.expect(write(0x6A, 0x07), read_back(0x07));
    host.expect(write(0x40, 0x01), read_back(0x01));
    host.expect(write(0x00, 0x01), read_back(0x01)); // preset, followed by a restart
    host.refuses(read(0x66), ErrorCode::NO_REPLY);
    host.now = host.now + Duration::from_millis(500);
    host.expect(read(0x6A), Reply::BissRegisterRead { value: 0x00 });
    assert_eq!(host.adapter.device::<Encoder>().unwrap().flash().write_cycles(), 1);
    host.expect(write(0x40, 0x44), read_back(0x44));
    host.refuses(read(0x00), ErrorCode::NO_REPLY); // the bank does not exist
    host.refuses(Request::BissRegisterRead { slave: 1, address: 0x66 }, ErrorCode::NO_REPLY);
    host.refuses(read(0x80), ErrorCode::BAD_ARGUMENT);
}

/// Streams 20,000 frames per second for one second. Every frame arrives, in order and with the correct position.
#[test]
fn fast_stream_has_no_gap() {
    let mut host = behind_adapter("rpm=600&position=0");
    host.ask(BISS);
    host.send(&Request::BissStream { period_us: 50 });
    let packets = host.stream(1_000);
    let layout = Layout::default();
    let (mut continuity, mut count) = (Continuity::at_start(), 0u64);
    let start_us = match &packets[0] {
        StreamData::Biss(data) => data.t0_us,
        other => panic!("{other:?}"),
    };
    for data in &packets {
        assert_eq!(continuity.gap_before(data), PacketGap::None);
        let StreamData::Biss(data) = data else { panic!("{data:?}") };
        assert_eq!((data.t0_us, data.period_us, data.width), (start_us + 50 * count, 50, 6));
        for (status, raw) in &data.values {
            let PositionData { multiturn, singleturn, error, .. } = layout.parse(*raw).unwrap();
            // The shaft makes ten revolutions per second from the start.
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
fn crc_detects_noise() {
    let mut host = behind_adapter("noise=0.25&seed=5");
    host.ask(BISS);
    host.ask(Request::BissStream { period_us: 100 });
    let packets = host.stream(1_000);
    let frames = packets.iter().flat_map(|data| match data {
        StreamData::Biss(data) => data.values.clone(),
        other => panic!("{other:?}"),
    });
    let bad = frames.clone().filter(|(_, raw)| Layout::default().parse(*raw).is_err()).count();
    let share = bad as f64 / frames.count() as f64;
    assert!((0.2..0.3).contains(&share), "{share}");
}

#[test]
fn next_host_restores_lost_power() {
    let mut host = behind_adapter("fault=die-in-store:1");
    host.ask(BISS);
    for (address, value) in [(0x6B, 0x2A), (0x6A, 0x07), (0x40, 0x01)] {
        host.expect(Request::BissRegisterWrite { slave: 0, address, value }, Reply::BissRegisterWrite { value });
    }
    host.refuses(Request::BissRegisterWrite { slave: 0, address: 0, value: 1 }, ErrorCode::NO_REPLY);
    assert!(!host.adapter.device::<Encoder>().unwrap().has_power());
    host.adapter.connect(host.now);
    assert!(host.adapter.device::<Encoder>().unwrap().has_power());
}
