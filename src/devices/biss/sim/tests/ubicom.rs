//! Tests of the line to the configuration pin: frames from the reference, timing, noise and silence.

use super::*;
use crate::bits::{hex, parse_hex};
use crate::sim::ByteDevice;
use crate::units::{Baud, CharacterFormat, Parity};

struct Line {
    port: UbicomPort,
    now: Moment,
}

impl Line {
    fn with(query: &str) -> Self {
        Line { port: UbicomPort::new(&config(query)), now: Moment::START }
    }

    /// Receives until the line is idle. Returns the bytes in hexadecimal and the arrival time of the last byte.
    fn receive(&mut self) -> (String, Moment) {
        let (mut bytes, mut last) = (Vec::new(), self.now);
        while let Some(at) = self.port.poll_at() {
            self.now = self.now.max(at);
            let arrived = self.port.poll(at);
            if !arrived.is_empty() {
                last = at;
            }
            bytes.extend(arrived);
        }
        (hex(&bytes), last)
    }

    fn ask(&mut self, request: &str) -> String {
        self.port.on_bytes(self.now, &parse_hex(request).unwrap());
        let (reply, _) = self.receive();
        reply
    }

    #[track_caller]
    fn expect(&mut self, request: &str, reply: &str) {
        assert_eq!(self.ask(request), reply, "reply to {request}");
    }

    fn wait(&mut self, seconds: f64) {
        self.now = self.now + Duration::from_secs_f64(seconds);
    }
}

const READ_TEMPERATURE: &str = "80 01 01 02 00 26 00 55";
/// Reply with the temperature 4Bh, which means 25 °C.
const TEMPERATURE: &str = "80 01 01 01 00 4B 31";

/// Requests and replies from section 6 of the UBICOM reference.
#[test]
fn published_exchanges_match() {
    let mut line = Line::with("temperature=25");
    line.expect(READ_TEMPERATURE, TEMPERATURE);
    line.expect("80 01 01 02 00 C5 00 B6", "80 01 01 01 00 1C 60");
    line.expect("80 01 03 01 00 01 79", "80 01 03 05 00 00 80 69 24 00 69");
    line.expect("80 01 02 03 00 2A 00 07 48", "80 01 02 01 00 A0 DB"); // rejected without the password
    line.expect("80 01 02 03 00 2B 00 2A 24", "80 01 02 01 00 90 EB");
    line.expect("80 01 02 03 00 2A 00 07 48", "80 01 02 01 00 90 EB");
    for (position, reply) in [
        ("0", "80 01 03 05 00 00 00 00 00 00 76"),
        ("0x1FFFFFFFF", "80 01 03 05 00 FF FF FF FF 01 79"),
        ("0x20000", "80 01 03 05 00 00 00 02 00 00 74"),
    ] {
        Line::with(&format!("position={position}")).expect("80 01 03 01 00 01 79", reply);
    }
}

/// Sends the probe from section 2 of the UBICOM reference.
#[test]
fn probe_reveals_byte_order() {
    Line::with("").expect("80 01 01 02 00 01 00 7A", "80 01 01 01 00 02 7A");
    Line::with("order=high-first").expect("80 01 01 02 00 01 00 7A", "80 01 01 01 00 01 7B");
}

/// An exchange takes eight bytes, one millisecond, and seven bytes, at 86.8 µs per byte.
#[test]
fn exchange_takes_expected_time() {
    let mut line = Line::with("");
    line.port.on_bytes(line.now, &parse_hex(READ_TEMPERATURE).unwrap());
    let (_, last) = line.receive();
    let micros = last.duration_since(Moment::START).as_micros();
    assert!((2_301..=2_303).contains(&micros), "{micros}");
    let mut slow = Line::with("fault=delay:50");
    slow.port.on_bytes(slow.now, &parse_hex(READ_TEMPERATURE).unwrap());
    let micros = slow.receive().1.duration_since(Moment::START).as_micros();
    assert!((52_301..=52_303).contains(&micros), "{micros}");
}

/// Invalid requests from section 6, "Negative", of the UBICOM reference.
#[test]
fn invalid_requests_get_no_reply() {
    let mut line = Line::with("temperature=25");
    let silent = [
        "80 01 01 02 00 26 00 54", // wrong checksum
        "80 01 01 03 00 26 00 54", // LEN 3 with two bytes
        "80 02 01 02 00 26 00 54", // addressed to another node
        "80 01 04 01 00 01 78",    // unknown command
        "80 01 03 01 00 02 78",    // unknown position
        "80 01 01 02 00 40 11 2A", // unknown bank
        "80 01 01 02 00 00 7B",    // the manual's example, which is one byte too short
    ];
    for request in silent {
        line.expect(request, "");
        line.expect(READ_TEMPERATURE, TEMPERATURE);
    }
    line.expect("80 01 02 03 00 40 11 00 28", "80 01 02 01 00 A0 DB");
}

#[test]
fn discards_partial_frame_after_20_ms() {
    let mut line = Line::with("temperature=25");
    line.port.on_bytes(line.now, &[0x80, 0x01, 0x01, 0x02]);
    assert_eq!(line.receive().0, "");
    line.expect(READ_TEMPERATURE, TEMPERATURE);
    // If the rest of a frame arrives in time, the frame is complete.
    let request = parse_hex(READ_TEMPERATURE).unwrap();
    line.port.on_bytes(line.now, &request[..3]);
    line.port.poll(line.now);
    line.wait(0.015);
    line.port.on_bytes(line.now, &request[3..]);
    assert_eq!(line.receive().0, TEMPERATURE);
}

#[test]
fn single_wire_echoes_sent_bytes() {
    let mut line = Line::with("temperature=25&echo=on&fault=delay:10");
    line.expect(READ_TEMPERATURE, &format!("{READ_TEMPERATURE} {TEMPERATURE}"));
}

#[test]
fn busy_encoder_ignores_request() {
    let mut line = Line::with("temperature=25");
    line.expect(&format!("{READ_TEMPERATURE} {READ_TEMPERATURE}"), TEMPERATURE);
    line.wait(1.0);
    // The encoder sends from 1.69 to 2.30 ms. Part of a request that starts during this time is lost.
    line.port.on_bytes(line.now, &parse_hex(READ_TEMPERATURE).unwrap());
    line.wait(0.0018);
    line.expect(READ_TEMPERATURE, TEMPERATURE);
}

#[test]
fn acknowledges_restart_then_stays_silent() {
    let mut line = Line::with("cycles=0");
    for request in ["80 01 02 03 00 2B 00 2A 24", "80 01 02 03 00 2A 00 07 48", "80 01 02 03 00 80 00 01 F8"] {
        line.expect(request, "80 01 02 01 00 90 EB");
    }
    line.expect(READ_TEMPERATURE, "");
    line.wait(0.5);
    line.expect("80 01 03 01 00 01 79", "80 01 03 05 00 00 00 00 00 00 76");
}

#[test]
fn encoder_is_silent_during_calibration() {
    let mut line = Line::with("rpm=-500&temperature=25");
    for request in ["80 01 02 03 00 2B 00 2A 24", "80 01 02 03 00 2A 00 01 4E", "80 01 02 03 00 40 00 01 38"] {
        line.expect(request, "80 01 02 01 00 90 EB");
    }
    line.expect(READ_TEMPERATURE, "");
    line.wait(5.0);
    line.expect("80 01 01 02 00 41 00 3A", "80 01 01 01 00 02 7A");
}

#[test]
fn injects_line_faults() {
    Line::with("fault=drop:1").expect(READ_TEMPERATURE, "");
    Line::with("fault=flip:1").expect(READ_TEMPERATURE, "");
    let mut line = Line::with("fault=silent-after:2&temperature=25");
    line.expect(READ_TEMPERATURE, TEMPERATURE);
    line.expect(READ_TEMPERATURE, TEMPERATURE);
    line.expect(READ_TEMPERATURE, "");
    line.port.set_faults(&crate::sim::SimulatedFaults::default());
    line.expect(READ_TEMPERATURE, TEMPERATURE);
    let noisy = |seed: u64| {
        let mut line = Line::with(&format!("seed={seed}&fault=flip:0.05,drop:0.05,garbage:0.05"));
        (0..50).map(|_| line.ask(READ_TEMPERATURE)).collect::<Vec<_>>()
    };
    assert_eq!(noisy(7), noisy(7), "the same seed, the same noise");
    assert_ne!(noisy(7), noisy(8));
}

#[test]
fn wrong_baud_rate_yields_no_frame() {
    let mut line = Line::with("temperature=25");
    let format = CharacterFormat { baud: Baud::B9600, parity: Parity::None };
    line.port.set_host_format(line.now, format);
    line.expect(READ_TEMPERATURE, "");
    line.port.set_host_format(line.now, crate::buses::ubicom::protocol::FORMAT);
    line.expect(READ_TEMPERATURE, TEMPERATURE);
}

/// The encoder loses power during a save and does not reply. Reopening the link restores its power.
#[test]
fn reopened_link_revives_dead_encoder() {
    let mut line = Line::with("fault=die-in-store:1");
    for request in ["80 01 02 03 00 2B 00 2A 24", "80 01 02 03 00 2A 00 07 48"] {
        line.expect(request, "80 01 02 01 00 90 EB");
    }
    line.expect("80 01 02 03 00 80 00 01 F8", "");
    line.wait(10.0);
    line.expect(READ_TEMPERATURE, "");
    line.port.connect(line.now);
    line.wait(0.5);
    assert_ne!(line.ask(READ_TEMPERATURE), "");
    assert_eq!(line.port.encoder().flash().write_cycles(), 4);
    assert_eq!(line.port.encoder().motor().rpm(), 0.0);
}

/// Bytes that do not fit into a UART's buffer are lost, so the line becomes idle as soon as the buffer is empty (issue
/// 22.18).
#[test]
fn answers_after_flood_of_bytes() {
    let mut line = Line::with("temperature=25");
    for _ in 0..2_000 {
        line.port.on_bytes(line.now, &[0x55; 512]);
    }
    line.receive();
    // 512 characters of 10 bits take 44 ms at 115200 bit/s.
    assert!(line.now.since_start() < Duration::from_millis(50), "{:?}", line.now);
    line.wait(0.1);
    line.expect(READ_TEMPERATURE, TEMPERATURE);
}
