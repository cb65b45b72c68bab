//! Tests of timing, gaps, echoes, character formats and several encoders.

use super::*;
use crate::units::{Baud, Parity};

const POSITION: &str = "40 42 00 0E 05 31 38";

/// According to the manual, 42h at 9600 baud takes 16.04 to 26.04 ms from the first bit of the request to the last bit
/// of the reply.
#[test]
fn durations_at_9600_baud() {
    // request, minimum and maximum in ms (from the reference's table of total durations)
    let cases = [
        ("40 42 02", 16.04, 26.05),
        ("40 43 00 00 00 00 55 56", 17.2, 57.3),
        ("40 44 48 4C", 16.0, 21.1),
        ("40 4E 0E", 13.7, 18.8),
        ("40 52 12", 16.0, 21.1),
        ("40 47 07", 11.4, 41.5),
        ("40 55 40 55 00", 14.8, 54.9),
    ];
    for (request, shortest, longest) in cases {
        let typical = Host::with("").duration(request);
        let worst = Host::with("pace=worst").duration(request);
        assert!(ms(shortest) <= typical && typical < worst && worst <= ms(longest), "{request}: {typical:?} {worst:?}");
    }
    let worst = Host::with("pace=worst").duration("40 42 02");
    assert!(worst.abs_diff(ms(26.04)) < ms(0.01), "{worst:?}");
    // 3 characters, 44 bits, 3.7 ms, 7 characters
    let typical = Host::with("").duration("40 42 02");
    assert!(typical.abs_diff(ms(19.74)) < ms(0.01), "{typical:?}");
}

#[test]
fn longer_store_takes_longer() {
    let mut host = Host::with("");
    // 11 + 6 characters, 44 bits, 20 ms and 4 · 1.5 ms
    let duration = host.duration("40 4B 00 00 04 55 DE AD BE EF 78");
    assert!(duration.abs_diff(ms(50.06)) < ms(0.01), "{duration:?}");
}

#[test]
fn store_takes_effect_after_processing() {
    let mut host = Host::with("");
    host.send("40 4B 00 00 04 55 DE AD BE EF 78");
    // 11 characters, 44 bits, 26 ms: 43.19 ms
    host.bus.poll(host.now + ms(43.0));
    assert_eq!(host.encoder().memory().field_bytes(0).unwrap()[0], b'E');
    host.bus.poll(host.now + ms(43.3));
    assert_eq!(host.encoder().memory().field_bytes(0).unwrap()[0], 0xDE);
}

#[test]
fn bytes_arrive_one_by_one() {
    let mut host = Host::with("");
    host.send("40 42 02");
    assert_eq!(host.bus.poll(host.now + ms(12.8)), [0u8; 0]); // the first byte is complete at 12.87 ms
    assert_eq!(host.bus.poll(host.now + ms(13.0)), [0x40]);
    assert_eq!(host.bus.poll(host.now + ms(15.3)), [0x42, 0x00]);
    assert_eq!(host.receive().0, "0E 05 31 38");
    assert_eq!(host.bus.poll_at(), None);
}

#[test]
fn short_gap_does_not_end_frame() {
    let mut host = Host::with("");
    host.send("40 42");
    host.wait(CHARACTER * 2 + ms(4.5));
    host.expect("02", POSITION);
}

#[test]
fn timeout_gap_splits_frame() {
    let mut host = Host::with("");
    host.send("40 42");
    host.wait(CHARACTER * 2 + ms(4.6));
    // The rest is lost, because it arrives while the first half is being checked.
    host.expect("02", "40 50 0A 1A");
    host.expect("40 42 02", POSITION);
}

#[test]
fn short_timeout_is_11_bits() {
    let mut host = Host::with("settings=0xA4");
    host.expect("40 42 02", POSITION);
    host.send("40 42");
    host.wait(CHARACTER * 2 + ms(1.2));
    host.expect("02", "40 50 0A 1A");
}

#[test]
fn busy_encoder_ignores_bytes() {
    let mut host = Host::with("");
    host.send("40 4B 00 00 04 55 DE AD BE EF 78");
    host.wait(ms(25.0));
    host.expect("40 42 02", "40 4B 00 00 04 0F");
}

#[test]
fn echo_precedes_reply() {
    let mut host = Host::with("echo=on");
    host.expect("40 42 02", &format!("40 42 02 {POSITION}"));
    host.expect("41 42 03", "41 42 03");
}

#[test]
fn supports_every_character_format() {
    for speed in 0..7u8 {
        for parity in [0x00, 0x20, 0x30] {
            let settings = 0xC0 | parity | speed;
            let mut host = Host::with(&format!("settings={settings}"));
            host.set_format(settings);
            host.expect("40 42 02", POSITION);
        }
    }
}

#[test]
fn mismatched_format_garbles_both_directions() {
    let mut host = Host::with("");
    for settings in [0xE5, 0xE3, 0xC4, 0xF4] {
        host.set_format(settings);
        host.expect("40 42 02", "");
    }
    // The host changes its format while the encoder processes the request, so the reply is garbled.
    host.set_format(0xE4);
    host.send("40 42 02");
    host.wait(ms(10.0));
    host.set_format(0xE5);
    let (garbage, _) = host.receive();
    let garbage = parse_hex(&garbage).unwrap();
    assert_eq!(garbage.len(), 7);
    assert!(garbage.iter().all(|byte| (0x80..0xFF).contains(byte)), "{garbage:02X?}");
    let format = CharacterFormat { baud: Baud::B9600, parity: Parity::Even };
    host.bus.set_host_format(host.now, format);
    host.wait(ms(20.0));
    host.expect("40 42 02", POSITION);
}

#[test]
fn encoders_answer_at_own_address() {
    let mut host = Host::with("encoders=3");
    host.expect("40 42 02", POSITION);
    host.expect("41 42 03", "41 42 00 0E 05 31 39");
    host.expect("42 42 00", "42 42 00 0E 05 31 3A");
    host.expect("43 42 01", "");
    assert_eq!(host.bus.encoders().len(), 3);
    // "GB0450180": each encoder has its own serial number
    host.expect("41 56 17", "41 56 47 42 30 34 35 30 31 38 30 56 31 2E 32 33 30 31 2E 30 32 2E 31 36 66");
}

#[test]
fn broadcast_replies_collide() {
    let mut host = Host::with("encoders=2");
    let garbage = parse_hex(&host.ask("FF 42 BD")).unwrap();
    assert!(!garbage.is_empty() && garbage.iter().all(|byte| (0x80..0xFF).contains(byte)), "{garbage:02X?}");
    host.expect("FF 53 AC", "");
    host.wait(ms(200.0));
    host.expect("41 42 03", "41 42 00 0E 05 31 39");
}

#[test]
fn long_poll_equals_short_polls() {
    let mut short = Host::with("fault=flip:0.02,garbage:0.02&seed=3");
    let mut long = Host::with("fault=flip:0.02,garbage:0.02&seed=3");
    for _ in 0..50 {
        short.send("40 42 02");
        long.send("40 42 02");
        let mut bytes = Vec::new();
        for _ in 0..100 {
            short.wait(ms(1.0));
            bytes.extend(short.bus.poll(short.now));
        }
        long.wait(ms(100.0));
        assert_eq!(long.bus.poll(long.now), bytes);
        long.now = short.now;
    }
}

/// A UART drops bytes that exceed its buffer, so the line is idle again as soon as the buffer is empty (issue 22.18).
#[test]
fn encoder_recovers_from_byte_flood() {
    let mut host = Host::with("");
    for _ in 0..2_000 {
        host.bus.on_bytes(host.now, &[0x55; 512]);
    }
    // 512 characters of 11 bits at 9600 bit/s take 587 ms.
    host.wait(ms(700.0));
    host.bus.poll(host.now);
    host.expect("40 42 02", POSITION);
}
