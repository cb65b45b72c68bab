//! Tests of every operation and stream with literal bytes. A short Python script composed the bytes with `struct.pack`,
//! a bitwise CRC and its own COBS encoder.

use alloc::borrow::ToOwned;
use alloc::string::{String, ToString};
use alloc::vec::Vec;
use alloc::{format, vec};

use proptest::prelude::*;

use super::*;

fn request_vectors() -> Vec<(u8, Request, &'static str)> {
    vec![
        (1, Request::Hello, "05 01 01 1F 3E 00"),
        (2, Request::Supply { on: true, millivolt: 8000 }, "08 02 02 01 40 1F C5 61 00"),
        (16, Request::Status, "05 10 03 1F 2E 00"),
        (
            3,
            Request::SsiConfig { clocks: 25, clock_hz: 500_000, pause_us: 30, flags: SsiFlags::FALLING_EDGE },
            "07 03 10 19 20 A1 07 02 1E 04 01 5C 82 00",
        ),
        (4, Request::SsiRead, "05 04 11 DB D3 00"),
        (5, Request::SsiStream { period_us: 50 }, "04 05 12 32 01 01 03 49 CC 00"),
        (
            6,
            Request::BissConfig { clock_hz: 2_000_000, data_bits: 35, crc_bits: 6, timeout_us: 18 },
            "06 06 20 80 84 1E 04 23 06 12 03 C0 43 00",
        ),
        (7, Request::BissRead, "05 07 21 DB B0 00"),
        (8, Request::BissRegisterRead { slave: 0, address: 0x66 }, "03 08 22 04 66 C5 E5 00"),
        (9, Request::BissRegisterWrite { slave: 0, address: 0x6B, value: 0x2A }, "03 09 23 05 6B 2A 1A 47 00"),
        (10, Request::BissStream { period_us: 50 }, "04 0A 24 32 01 01 03 21 C8 00"),
        (11, Request::AnalogConfig { sample_hz: 100_000 }, "06 0B 30 A0 86 01 03 E1 91 00"),
        (12, Request::AnalogStream { on: true }, "06 0C 31 01 78 9F 00"),
        (15, Request::AnalogSkew, "05 0F 33 01 0B 00"),
        (
            13,
            Request::UartConfig { baud: 9600, parity: 2, turnaround_us: 5000 },
            "05 0D 40 80 25 01 06 02 88 13 62 B3 00",
        ),
        (
            14,
            Request::UartTransfer { timeout_us: 50_000, idle_us: 5000, tx: vec![0x40, 0x42, 0x02] },
            "05 0E 41 50 C3 01 03 88 13 01 06 40 42 02 70 FE 00",
        ),
    ]
}

fn message_vectors() -> Vec<(u8, Message, &'static str)> {
    vec![
        (
            1,
            Message::Reply(Reply::Hello(Hello {
                capabilities: Capabilities::SSI
                    .union(Capabilities::BISS)
                    .union(Capabilities::BISS_REGISTERS)
                    .union(Capabilities::ANALOG),
                max_clock_hz: 10_000_000,
                max_sample_hz: 1_000_000,
                name: "Bench".to_owned(),
                serial: "A1".to_owned(),
                firmware: "0.9".to_owned(),
            })),
            "05 01 81 01 0F 01 01 04 80 96 98 04 40 42 0F 10 05 42 65 6E 63 68 02 41 31 03 30 2E 39 79 48 00",
        ),
        (
            2,
            Message::Reply(Reply::Supply { on: true, millivolt: 8010, milliampere: 42 }),
            "07 02 82 01 4A 1F 2A 03 54 E4 00",
        ),
        (
            16,
            Message::Reply(Reply::Status(AdapterStatus {
                t_us: 5_000_000,
                restart: RestartReason::WATCHDOG,
                faults: SupplyFaults::OVERLOAD,
                input_millivolt: 8010,
                damaged: 2,
                malformed: 1,
                lost: 700,
            })),
            "06 10 83 40 4B 4C 01 01 01 01 06 03 01 4A 1F 02 01 01 02 01 01 01 03 BC 02 01 03 38 3A 00",
        ),
        (3, Message::Reply(Reply::SsiConfig { clock_hz: 498_000 }), "06 03 90 50 99 07 03 7E EC 00"),
        (
            4,
            Message::Reply(Reply::SsiRead { t_us: 1_000_000, raw: 0x123_4567 }),
            "06 04 91 40 42 0F 01 01 01 01 05 67 45 23 01 01 01 01 03 20 84 00",
        ),
        (5, Message::Reply(Reply::SsiStream { period_us: 50 }), "04 05 92 32 01 01 03 99 EE 00"),
        (6, Message::Reply(Reply::BissConfig { clock_hz: 2_000_000 }), "06 06 A0 80 84 1E 03 4B B3 00"),
        (
            7,
            Message::Reply(Reply::BissRead { t_us: 1_000_001, status: BissStatus::OK, raw: 0x24_6980_00CF }),
            "06 07 A1 41 42 0F 01 01 01 01 01 02 CF 04 80 69 24 01 01 03 56 DA 00",
        ),
        (8, Message::Reply(Reply::BissRegisterRead { value: 0x4B }), "06 08 A2 4B 8E E7 00"),
        (9, Message::Reply(Reply::BissRegisterWrite { value: 0x2A }), "06 09 A3 2A 08 9F 00"),
        (10, Message::Reply(Reply::BissStream { period_us: 50 }), "04 0A A4 32 01 01 03 F1 EA 00"),
        (
            11,
            Message::Reply(Reply::AnalogConfig { sample_hz: 100_000, full_scale_microvolt: 1_250_000, bits: 16 }),
            "06 0B B0 A0 86 01 04 D0 12 13 04 10 9E 53 00",
        ),
        (12, Message::Reply(Reply::AnalogStream { on: true }), "06 0C B1 01 E0 84 00"),
        (15, Message::Reply(Reply::AnalogSkew { skew_ns: 2_000 }), "07 0F B3 D0 07 41 92 00"),
        (13, Message::Reply(Reply::UartConfig { baud: 9600 }), "05 0D C0 80 25 01 03 E5 C3 00"),
        (
            14,
            Message::Reply(Reply::UartTransfer { t_us: 1_500_000, rx: vec![0x40, 0x42, 0x00, 0x0E, 0x05, 0x31, 0x38] }),
            "06 0E C1 60 E3 16 01 01 01 01 03 40 42 07 0E 05 31 38 4B B8 00",
        ),
        (
            7,
            Message::Error { op: 0x21, code: ErrorCode::NO_REPLY, text: "no slave".to_owned() },
            "10 07 FF 21 04 08 6E 6F 20 73 6C 61 76 65 4E E1 00",
        ),
        (
            0,
            Message::Data(StreamData::Ssi(SsiData {
                first_index: 100,
                t0_us: 5_000_000,
                period_us: 50,
                lost: 0,
                width: 4,
                values: vec![0x123_4567, 0x123_4568],
            })),
            "01 03 93 64 01 01 04 40 4B 4C 01 01 01 01 02 32 01 01 01 01 0D 04 02 67 45 23 01 68 45 23 01 A7 7F 00",
        ),
        (
            1,
            Message::Data(StreamData::Biss(BissData {
                first_index: 0xFFFF_FFFE,
                t0_us: 5_000_000,
                period_us: 50,
                lost: 3,
                width: 6,
                values: vec![(BissStatus::OK, 0x24_6980_00CF), (BissStatus::STUCK_HIGH, 0x1FF_FFFF_FFFF)],
            })),
            "0A 01 A5 FE FF FF FF 40 4B 4C 01 01 01 01 02 32 01 01 02 03 03 06 02 02 CF 04 80 69 24 0A 03 FF FF FF FF FF 01 45 43 00",
        ),
        (
            2,
            Message::Data(StreamData::Analog(AnalogData {
                first_index: 7,
                t0_us: 5_000_000,
                lost: 0,
                samples: vec![(32_767, -32_768), (0, -1)],
            })),
            "04 02 B2 07 01 01 04 40 4B 4C 01 01 01 01 01 01 04 02 FF 7F 02 80 01 05 FF FF 85 BE 00",
        ),
    ]
}

fn hex(bytes: &[u8]) -> String {
    bytes.iter().map(|byte| format!("{byte:02X}")).collect::<Vec<_>>().join(" ")
}

fn parse_hex(text: &str) -> Vec<u8> {
    text.split(' ').map(|byte| u8::from_str_radix(byte, 16).unwrap()).collect()
}

/// Parses the single packet in the bytes, which end with 00.
fn parse_packet(bytes: &[u8]) -> Result<Packet, PacketError> {
    assert_eq!(bytes.last(), Some(&0));
    Packet::parse(&bytes[..bytes.len() - 1])
}

#[test]
fn every_request_round_trips() {
    let requests = request_vectors();
    assert_eq!(requests.iter().map(|(_, request, _)| request.operation()).collect::<Vec<_>>(), Operation::ALL);
    for (seq, request, text) in requests {
        assert_eq!(hex(&request.emit(seq).emit()), text);
        let packet = parse_packet(&parse_hex(text)).unwrap();
        assert_eq!((packet.seq, Request::parse(&packet)), (seq, Ok(request)), "{text}");
    }
}

#[test]
fn every_message_round_trips() {
    for (seq, message, text) in message_vectors() {
        assert_eq!(hex(&message.emit(seq).emit()), text);
        let packet = parse_packet(&parse_hex(text)).unwrap();
        assert_eq!((packet.seq, Message::parse(&packet)), (seq, Ok(message)), "{text}");
    }
}

#[test]
fn detects_every_flipped_bit() {
    let texts = request_vectors()
        .into_iter()
        .map(|(.., text)| text)
        .chain(message_vectors().into_iter().map(|(.., text)| text));
    for text in texts {
        let bytes = parse_hex(text);
        let stuffed = &bytes[..bytes.len() - 1];
        for bit in 0..stuffed.len() * 8 {
            let mut damaged = stuffed.to_vec();
            damaged[bit / 8] ^= 1 << (bit % 8);
            assert!(Packet::parse(&damaged).is_err(), "{text} bit {bit}");
        }
        for cut in 0..stuffed.len() {
            assert!(Packet::parse(&stuffed[..cut]).is_err(), "{text} cut at {cut}");
        }
    }
}

/// A body that is truncated or has an extra byte is rejected, unless it ends with data of variable length.
#[test]
fn rejects_truncated_bodies() {
    for (seq, request, _) in request_vectors() {
        let whole = request.emit(seq);
        let open_end = request.operation() == Operation::UartTransfer;
        for cut in 0..whole.body.len() {
            let packet = Packet { body: whole.body[..cut].to_vec(), ..whole.clone() };
            assert_eq!(Request::parse(&packet).is_ok(), open_end && cut >= 8, "{request:?} cut at {cut}");
        }
        let longer = Packet { body: [whole.body.as_slice(), &[0]].concat(), ..whole };
        assert_eq!(Request::parse(&longer).is_ok(), open_end, "{request:?}");
    }
    for (seq, message, _) in message_vectors() {
        let whole = message.emit(seq);
        let open_end = matches!(message, Message::Reply(Reply::UartTransfer { .. }));
        for cut in 0..whole.body.len() {
            let packet = Packet { body: whole.body[..cut].to_vec(), ..whole.clone() };
            assert_eq!(Message::parse(&packet).is_ok(), open_end && cut >= 8, "{message:?} cut at {cut}");
        }
        let longer = Packet { body: [whole.body.as_slice(), &[0]].concat(), ..whole };
        assert_eq!(Message::parse(&longer).is_ok(), open_end, "{message:?}");
    }
}

#[test]
fn version_mismatch_names_both_versions() {
    let packet = Packet { seq: 0, op: 0x81, body: vec![2, 1, 2, 3] };
    let error = Message::parse(&packet).unwrap_err();
    assert_eq!(error.to_string(), "the adapter uses version 2 of the bridge protocol, but this program uses version 1");
}

#[test]
fn rejects_unknown_operations_but_keeps_error_codes() {
    let packet = |op, body: &[u8]| Packet { seq: 0, op, body: body.to_vec() };
    assert_eq!(Request::parse(&packet(0x50, &[])), Err(BodyError::Operation(0x50)));
    assert_eq!(Request::parse(&packet(0x81, &[])), Err(BodyError::Operation(0x81)));
    assert_eq!(Message::parse(&packet(0x01, &[])), Err(BodyError::Operation(0x01)));
    assert_eq!(Message::parse(&packet(0xD0, &[])), Err(BodyError::Operation(0xD0)));
    let on = BodyError::Value { op: 0x31, field: "on", got: 2 };
    assert_eq!(Request::parse(&packet(0x31, &[2])), Err(on));
    let body = [&[0; 18][..], &[9, 0]].concat();
    assert_eq!(Message::parse(&packet(0x93, &body)), Err(BodyError::Value { op: 0x93, field: "width", got: 9 }));
    let text = [&[1][..], &[0; 12], &[1, 0xFF, 0, 0]].concat();
    assert_eq!(Message::parse(&packet(0x81, &text)), Err(BodyError::Text { op: 0x81 }));
    let error = Message::Error { op: 0x77, code: ErrorCode::new(99), text: "ü".repeat(200) };
    let back = Message::parse(&error.emit(3)).unwrap();
    let cut = Message::Error { op: 0x77, code: ErrorCode::new(99), text: "ü".repeat(127) };
    assert_eq!(back, cut, "a long text is cut between two characters");
    let all = Capabilities::new(u32::MAX);
    assert!(
        all.contains(Capabilities::SUPPLY.union(Capabilities::UART)) && !Capabilities::SSI.contains(Capabilities::BISS)
    );
}

proptest! {
    #[test]
    fn streams_round_trip(
        first_index: u32, t0_us: u64, period_us: u32, lost: u16, width in 1u8..=8, values: Vec<(u8, u64)>,
        samples: Vec<(i16, i16)>,
    ) {
        let fit = |value: u64| if width == 8 { value } else { value & ((1 << (8 * width)) - 1) };
        let values: Vec<(BissStatus, u64)> =
            values.into_iter().take(50).map(|(status, value)| (BissStatus::new(status), fit(value))).collect();
        let words = values.iter().map(|(_, value)| *value).collect();
        for data in [
            StreamData::Ssi(SsiData { first_index, t0_us, period_us, lost, width, values: words }),
            StreamData::Biss(BissData { first_index, t0_us, period_us, lost, width, values }),
            StreamData::Analog(AnalogData { first_index, t0_us, lost, samples }),
        ] {
            let message = Message::Data(data);
            prop_assert_eq!(Message::parse(&message.emit(1)), Ok(message));
        }
    }

    #[test]
    fn arbitrary_body_round_trips(op: u8, body: Vec<u8>) {
        let packet = Packet { seq: 0, op, body };
        if let Ok(request) = Request::parse(&packet) {
            prop_assert_eq!(request.emit(0), packet.clone());
        }
        if let Ok(message) = Message::parse(&packet) {
            prop_assert_eq!(message.emit(0), packet);
        }
    }
}
