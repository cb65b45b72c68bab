//! Tests of an adapter, from the perspective of a host. The wires are simulated.

#![allow(clippy::unwrap_used, clippy::indexing_slicing, clippy::panic)]

mod model;

use bridge_codec::{BissStatus, ErrorCode, Hello, Message, Packet, Reply, Request, SsiFlags, StreamData};
use model::{Bench, Model, refusal};

const SSI_25: Request =
    Request::SsiConfig { clocks: 25, clock_hz: 1_000_000, pause_us: 30, flags: SsiFlags::FALLING_EDGE };
const BISS_41: Request = Request::BissConfig { clock_hz: 2_000_000, data_bits: 35, crc_bits: 6, timeout_us: 20 };

#[test]
fn adapter_identifies_itself() {
    let Message::Reply(Reply::Hello(Hello { name, serial, firmware, max_clock_hz, .. })) =
        Bench::new().ask(&Request::Hello)
    else {
        panic!("no HELLO")
    };
    assert_eq!((name.as_str(), serial.as_str(), firmware.as_str(), max_clock_hz), ("Model", "M1", "1.2", 10_000_000));
}

#[test]
fn reads_words_after_pause() {
    let mut bench = Bench::new();
    assert_eq!(refusal(bench.ask(&Request::SsiRead)), (0x11, ErrorCode::BAD_ARGUMENT), "not configured");
    assert_eq!(bench.ask(&SSI_25), Message::Reply(Reply::SsiConfig { clock_hz: 1_000_000 }));
    for _ in 0..3 {
        let Message::Reply(Reply::SsiRead { t_us, raw }) = bench.ask(&Request::SsiRead) else { panic!("no word") };
        assert_eq!(raw, t_us & 0x1FF_FFFF);
    }
    let starts = &bench.model().frames;
    // A frame of the model takes 40 µs, and the pause is at least 30 µs.
    assert!(starts.windows(2).all(|pair| (70..75).contains(&(pair[1] - pair[0]))), "{starts:?}");
}

#[test]
fn reports_frames_and_status() {
    let mut bench = Bench::new();
    assert_eq!(bench.ask(&BISS_41), Message::Reply(Reply::BissConfig { clock_hz: 2_000_000 }));
    for (head, status, raw) in
        [(0b1010, BissStatus::OK, 0x024_6980_00CF), (0b1110, BissStatus::STUCK_HIGH, 0), (0, BissStatus::STUCK_LOW, 0)]
    {
        bench.model().biss_head = head;
        let Message::Reply(Reply::BissRead { status: got, raw: read, .. }) = bench.ask(&Request::BissRead) else {
            panic!("no frame")
        };
        assert_eq!((got, read), (status, raw));
    }
}

/// A read of address 66h returns 4Bh. The control bits are from `protocol/biss.md`, section 3.
#[test]
fn reads_register_by_control_bits() {
    let mut bench = Bench::new();
    let read = Request::BissRegisterRead { slave: 0, address: 0x66 };
    assert_eq!(refusal(bench.ask(&read)), (0x22, ErrorCode::BAD_ARGUMENT), "not configured");
    bench.ask(&BISS_41);
    let answer = ["0".repeat(14).as_str(), "01000000000000000", "10", "1", "01001011", "0110", "0"].concat();
    bench.model().cds = answer.chars().map(|bit| bit == '1').collect();
    assert_eq!(bench.ask(&read), Message::Reply(Reply::BissRegisterRead { value: 0x4B }));
    let sent: String = bench.model().cdm.iter().map(|bit| if *bit { '1' } else { '0' }).collect();
    assert_eq!(sent, ["0".repeat(14).as_str(), "11000110011000011010000000000000", "0"].concat());
    // If no encoder responds, nothing is written.
    bench.model().cdm.clear();
    let write = Request::BissRegisterWrite { slave: 0, address: 0x6B, value: 0x2A };
    assert_eq!(refusal(bench.ask(&write)), (0x23, ErrorCode::NO_REPLY));
    assert_eq!(bench.model().cdm.len(), 14 + 16, "the access ends with its header");
    for (slave, address) in [(8, 0), (0, 0x80)] {
        assert_eq!(refusal(bench.ask(&Request::BissRegisterRead { slave, address })).1, ErrorCode::BAD_ARGUMENT);
    }
}

#[test]
fn stream_samples_are_complete_and_on_time() {
    let mut bench = Bench::new();
    bench.ask(&SSI_25);
    let Message::Reply(Reply::SsiStream { period_us }) = bench.ask(&Request::SsiStream { period_us: 1 }) else {
        panic!("no stream")
    };
    assert_eq!(period_us, 25 + 30 + 2, "a burst and a pause");
    bench.ask(&Request::SsiStream { period_us: 0 });
    bench.ask(&Request::SsiStream { period_us: 100 });
    let (mut next, mut packets) = (0, 0);
    // The uneven pace of the main loop has no effect.
    for step in (0..2_000).map(|at| 300 + at * 37 % 2_000) {
        for message in bench.run(step) {
            let Message::Data(StreamData::Ssi(data)) = message else { panic!("{message:?}") };
            assert_eq!((data.first_index, data.lost, data.period_us, data.width), (next, 0, 100, 4));
            for (at, value) in (0..).zip(&data.values) {
                assert_eq!(*value, (data.t0_us + 100 * at) & 0x1FF_FFFF);
            }
            next += data.values.len() as u32;
            packets += 1;
        }
    }
    assert!(next > 20_000 && packets > 200, "{next} samples in {packets} packets");
}

/// A word of 64 clocks fills two of the three 32-bit words of a frame.
#[test]
fn streams_words_longer_than_32_bits() {
    let mut bench = Bench::new();
    bench.model().ssi = |t_us| 0x8000_0001_0000_0000 | t_us;
    bench.ask(&Request::SsiConfig { clocks: 64, clock_hz: 4_000_000, pause_us: 0, flags: SsiFlags::FALLING_EDGE });
    bench.ask(&Request::SsiStream { period_us: 200 });
    let values: Vec<u64> = (0..50)
        .flat_map(|_| bench.run(1_000))
        .flat_map(|message| match message {
            Message::Data(StreamData::Ssi(data)) => data.values,
            other => panic!("{other:?}"),
        })
        .collect();
    assert!(values.len() > 200 && values.windows(2).all(|pair| pair[1] - pair[0] == 200), "{values:X?}");
    assert_eq!(values[0] >> 32, 0x8000_0001);
}

#[test]
fn counts_samples_lost_to_slow_host() {
    let mut bench = Bench::new();
    bench.ask(&BISS_41);
    bench.ask(&Request::BissStream { period_us: 100 });
    let samples = |messages: Vec<Message>| {
        let mut found = Vec::new();
        for message in messages {
            let Message::Data(StreamData::Biss(data)) = message else { panic!("{message:?}") };
            assert_eq!(data.width, 6);
            assert!(data.values.iter().all(|value| *value == (BissStatus::OK, 0x024_6980_00CF)));
            found.push((data.first_index, data.values.len() as u32, u32::from(data.lost), data.t0_us));
        }
        found
    };
    let first = samples(bench.run(20_000));
    // The model keeps 1024 words, which are 512 frames, and the adapter leaves an eighth of them alone.
    let late = samples(bench.run(100_000));
    let end = first.last().unwrap().0 + first.last().unwrap().1;
    let (index, _, lost, t0_us) = late[0];
    assert_eq!(index, end + lost, "the index shows the gap");
    assert!((700..1_000).contains(&lost), "{lost}");
    assert_eq!(t0_us - first[0].3, u64::from(index) * 100, "the time of a sample is that of its index");
    assert!(late[1..].iter().all(|packet| packet.2 == 0));
}

#[test]
fn other_requests_wait_for_stream_end() {
    let mut bench = Bench::new();
    bench.ask(&SSI_25);
    bench.ask(&BISS_41);
    bench.ask(&Request::SsiStream { period_us: 1_000 });
    for request in [SSI_25, BISS_41, Request::SsiRead, Request::BissRead, Request::BissStream { period_us: 1_000 }] {
        assert_eq!(refusal(bench.ask(&request)).1, ErrorCode::BUSY, "{request:?}");
    }
    bench.ask(&Request::BissStream { period_us: 0 });
    assert!(bench.adapter.is_streaming(), "the end of the other stream");
    bench.ask(&Request::SsiStream { period_us: 0 });
    assert!(!bench.adapter.is_streaming() && bench.run(50_000).is_empty());
    bench.ask(&Request::SsiStream { period_us: 1_000 });
    bench.ask(&Request::Hello);
    assert!(!bench.adapter.is_streaming(), "HELLO ends it");
    assert!(matches!(bench.ask(&Request::BissRead), Message::Reply(Reply::BissRead { .. })));
}

#[test]
fn stream_ends_without_host() {
    let mut bench = Bench::new();
    bench.ask(&SSI_25);
    bench.ask(&Request::SsiStream { period_us: 1_000 });
    let run = |bench: &mut Bench, ms: u64| {
        for _ in 0..ms {
            bench.model().now_us += 1_000;
            bench.adapter.poll();
        }
    };
    run(&mut bench, 1_900);
    assert!(bench.adapter.is_streaming());
    assert!(bench.adapter.outbox().pending().len() < 32 * 1024, "the memory for a host that does not read is limited");
    run(&mut bench, 500);
    assert!(!bench.adapter.is_streaming() && bench.model().stream.is_none());
    assert!(bench.adapter.outbox().pending().is_empty());
    // After a disconnection, the stream ends immediately.
    bench.ask(&SSI_25);
    bench.ask(&Request::SsiStream { period_us: 1_000 });
    bench.adapter.handle_host_disconnect();
    assert!(!bench.adapter.is_streaming());
    assert!(matches!(bench.ask(&Request::Hello), Message::Reply(Reply::Hello(_))));
}

#[test]
fn host_must_read_before_sending_more() {
    let mut bench = Bench::new();
    let request = Request::Hello.emit(1).emit();
    let mut sent = 0;
    while bench.adapter.accepts_bytes() {
        bench.adapter.receive(&request);
        sent += 1;
        assert!(sent < 1_000, "it never has to wait");
    }
    assert!(bench.adapter.outbox().pending().len() < 32 * 1024);
    assert_eq!(bench.fetch().len(), sent, "no reply is lost");
}

#[test]
fn counts_and_answers_malformed_packets() {
    let mut bench = Bench::new();
    let mut answer = |packet: Packet| {
        bench.adapter.receive(&packet.emit());
        let answers = bench.fetch();
        assert_eq!(answers.len(), 1);
        refusal(Message::parse(&answers[0]).unwrap())
    };
    let packet = |op, body: &[u8]| Packet { seq: 9, op, body: body.to_vec() };
    assert_eq!(answer(packet(0x50, &[])), (0x50, ErrorCode::NOT_SUPPORTED));
    assert_eq!(answer(packet(0x10, &[1, 2])), (0x10, ErrorCode::BAD_ARGUMENT));
    assert_eq!(answer(packet(0x31, &[2])), (0x31, ErrorCode::BAD_ARGUMENT));
    // A damaged packet has no sequence number that could be trusted. The host repeats it.
    let mut damaged = Request::Hello.emit(1).emit();
    damaged[1] ^= 4;
    bench.adapter.receive(&damaged);
    assert!(bench.fetch().is_empty());
    assert_eq!(bench.adapter.faulty_packets(), (1, 3));
}

/// The adapter answers each valid packet once, never panics on random bytes, and still works afterwards. The
/// requirement is a million packets.
#[test]
fn survives_million_random_packets() {
    let count = std::env::var("ADAPTER_FUZZ_PACKETS").map_or(1_000_000, |count| count.parse().unwrap());
    let mut bench = Bench::new();
    bench.model().ssi = |t_us| t_us;
    let mut state = 0x1234_5678_9ABC_DEF1_u64;
    let mut random = || {
        state ^= state << 13;
        state ^= state >> 7;
        state ^= state << 17;
        state
    };
    let (mut valid, mut answered, mut data) = (0_u64, 0_u64, 0_u64);
    for _ in 0..count {
        let (length, kind) = (random() as usize % 24, random() % 8);
        let mut body: Vec<u8> = (0..length).map(|_| random() as u8).collect();
        let ops = [0x01, 0x02, 0x03, 0x10, 0x11, 0x12, 0x20, 0x21, 0x22, 0x23, 0x24, 0x30, 0x31, 0x33, 0x40, 0x41];
        let op = if kind < 6 { ops[random() as usize % ops.len()] } else { random() as u8 };
        // Bodies of the correct length are checked further.
        if kind < 4 {
            let lengths = [0, 3, 0, 8, 0, 4, 8, 0, 2, 3, 4, 4, 1, 0, 7, 12];
            let at = ops.iter().position(|known| *known == op).unwrap();
            body.resize(lengths[at], 1);
            if random() % 2 == 0 && op == 0x10 {
                body[0] = body[0] % 64 + 1;
                body[1..8].copy_from_slice(&[0x40, 0x42, 0x0F, 0, 20, 0, 1]);
            }
            if random() % 2 == 0 && op == 0x20 {
                body.copy_from_slice(&[0x40, 0x42, 0x0F, 0, 35, 6, 20, 0]);
            }
        }
        let mut bytes = Packet { seq: random() as u8, op, body }.emit();
        if kind == 7 {
            let at = random() as usize % bytes.len();
            bytes[at] ^= 1 << (random() % 8);
            bytes.push(0);
        } else {
            valid += 1;
        }
        bench.adapter.receive(&bytes);
        bench.model().now_us += random() % 4_000;
        bench.adapter.poll();
        for packet in bench.fetch() {
            match Message::parse(&packet).unwrap() {
                Message::Data(_) => data += 1,
                _ => answered += 1,
            }
        }
    }
    // One in 65 536 damaged packets may still have a matching checksum. The last transfer may still be waiting for its
    // reply.
    assert!(
        answered + 1 >= valid && answered <= valid + 10 + count / 8 / 1_000,
        "{answered} answers to {valid} packets"
    );
    let (broken, malformed) = bench.adapter.faulty_packets();
    assert!(
        data > count / 1_000 && broken > count / 10 && u64::from(malformed) > count / 10,
        "{data} {broken} {malformed}"
    );
    let _: &Model = bench.adapter.bus();
    bench.adapter.handle_host_disconnect();
    assert!(matches!(bench.ask(&Request::Hello), Message::Reply(Reply::Hello(_))));
}
