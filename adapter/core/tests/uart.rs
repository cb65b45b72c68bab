//! Tests of an adapter's serial line, from the perspective of a host. The wires are simulated.

#![allow(clippy::unwrap_used, clippy::indexing_slicing, clippy::panic)]

mod model;

use bridge_codec::{ErrorCode, Message, Reply, Request, SsiFlags};
use model::{Bench, refusal};

const CONFIG: Request = Request::UartConfig { baud: 9_600, parity: 2, turnaround_us: 5_000 };

fn transfer(timeout_us: u32, idle_us: u32) -> Request {
    Request::UartTransfer { timeout_us, idle_us, tx: vec![0x40, 0x42, 0x02] }
}

/// Returns the bits of a received character with even parity. The stop bit is the highest, followed by parity and data.
fn received(byte: u8) -> u32 {
    1 << 31 | (byte.count_ones() % 2) << 30 | u32::from(byte) << 22
}

/// Sends a request without waiting for its reply.
fn send(bench: &mut Bench, request: &Request) {
    bench.adapter.receive(&request.emit(77).emit());
}

#[test]
fn reply_ends_with_silence() {
    let mut bench = Bench::new();
    assert_eq!(refusal(bench.ask(&transfer(50_000, 5_000))), (0x41, ErrorCode::BAD_ARGUMENT), "not configured");
    assert_eq!(bench.ask(&CONFIG), Message::Reply(Reply::UartConfig { baud: 9_600 }));
    let rx = [0x40, 0x42, 0x00, 0x0E, 0x05, 0x31, 0x38];
    bench.model().reply = rx.map(received).to_vec();
    let start = bench.model().now_us;
    send(&mut bench, &transfer(50_000, 5_000));
    assert!(bench.adapter.is_transferring());
    let mut answers = Vec::new();
    while answers.is_empty() {
        answers = bench.run(250);
    }
    assert_eq!(answers, [Message::Reply(Reply::UartTransfer { t_us: start + 3_000 + 3_000, rx: rx.to_vec() })]);
    // The last character ends 7 ms after the edge.
    let took = bench.model().now_us - start;
    assert!((18_000..18_600).contains(&took), "{took} µs");
    // Start bit, 40h with the lowest bit first, even parity, stop bit.
    assert_eq!(bench.model().sent[0], 0b110_1000_0000);
    // The next transfer waits for the turnaround.
    let before = bench.model().now_us;
    send(&mut bench, &transfer(50_000, 5_000));
    assert!((4_700..=5_000).contains(&(bench.model().now_us - before)));
}

#[test]
fn timeout_ends_transfer() {
    let mut bench = Bench::new();
    bench.ask(&CONFIG);
    let start = bench.model().now_us;
    send(&mut bench, &transfer(50_000, 5_000));
    assert_eq!(refusal(bench.ask(&transfer(1, 1))).1, ErrorCode::BUSY);
    assert_eq!(refusal(bench.ask(&CONFIG)).1, ErrorCode::BUSY);
    assert!(matches!(bench.ask(&Request::Hello), Message::Reply(Reply::Hello(_))), "other requests are answered");
    let mut answers = Vec::new();
    while answers.is_empty() {
        answers = bench.run(500);
    }
    let [Message::Reply(Reply::UartTransfer { rx, .. })] = answers.as_slice() else { panic!("{answers:?}") };
    assert!(rx.is_empty());
    assert!((53_000..54_500).contains(&(bench.model().now_us - start)));
    for request in [transfer(2_000_001, 1), transfer(1, 500_001)] {
        assert_eq!(refusal(bench.ask(&request)).1, ErrorCode::BAD_ARGUMENT);
    }
}

#[test]
fn streams_continue_during_transfer() {
    let mut bench = Bench::new();
    bench.ask(&Request::SsiConfig { clocks: 25, clock_hz: 1_000_000, pause_us: 30, flags: SsiFlags::FALLING_EDGE });
    bench.ask(&Request::SsiStream { period_us: 1_000 });
    bench.ask(&CONFIG);
    send(&mut bench, &transfer(1_000_000, 5_000));
    let (mut packets, mut replies) = (0, 0);
    for _ in 0..1_100 {
        for message in bench.run(1_000) {
            match message {
                Message::Data(data) => {
                    assert_eq!(data.sample_range().2, 0);
                    packets += 1;
                }
                _ => replies += 1,
            }
        }
    }
    assert!(packets > 90 && replies == 1, "{packets} packets, {replies} replies");
}
