//! Tests of noise, silence, power failures and random input.

use proptest::prelude::{Just, Strategy, any, prop_oneof, proptest};

use super::*;
use crate::devices::hiperface::protocol::Command;

const POSITION: &str = "40 42 00 0E 05 31 38";

#[test]
fn flipped_bit_causes_parity_error() {
    // Requests whose address byte is intact are rejected because of their parity.
    let refused = |settings: u8, fault: &str| {
        let mut host = Host::with(&format!("settings={settings}&fault={fault}&seed=11"));
        host.set_format(settings);
        (0..400).map(|_| host.ask("40 42 02")).collect::<Vec<_>>()
    };
    let replies = refused(0xE4, "flip:0.1");
    assert!(replies.iter().any(|reply| reply == "40 50 09 19"));
    assert!(replies.iter().any(|reply| reply == POSITION));
    assert!(replies.iter().all(|reply| reply != "40 50 0A 1A"));
    let replies = refused(0xC4, "flip:0.1");
    assert!(replies.iter().any(|reply| reply == "40 50 0A 1A"));
    assert!(replies.iter().all(|reply| reply != "40 50 09 19"));
    let replies = refused(0xE4, "garbage:0.1");
    assert!(replies.iter().any(|reply| reply == "40 50 0A 1A"));
    assert!(replies.iter().any(|reply| parse_hex(reply).unwrap().len() == 8), "a byte too many in the reply");
}

#[test]
fn lossy_line_drops_bytes_both_ways() {
    let mut host = Host::with("fault=drop:0.05&seed=5");
    let lengths: Vec<usize> = (0..200).map(|_| parse_hex(&host.ask("40 42 02")).unwrap().len()).collect();
    for length in [0, 4, 6, 7] {
        assert!(lengths.contains(&length), "{length}");
    }
    let mut host = Host::with("fault=drop:1");
    host.expect("40 42 02", "");
}

#[test]
fn seed_determines_faults() {
    let run = |seed: u32| {
        let mut host = Host::with(&format!("fault=drop:0.1,flip:0.1,garbage:0.1&seed={seed}"));
        (0..50).map(|_| host.ask("40 42 02")).collect::<Vec<_>>()
    };
    assert_eq!(run(1), run(1));
    assert_ne!(run(1), run(2));
}

#[test]
fn delays_each_reply() {
    let prompt = Host::with("").duration("40 42 02");
    let delayed = Host::with("fault=delay:100").duration("40 42 02");
    assert_eq!(delayed, prompt + ms(100.0));
}

#[test]
fn configured_silence_is_permanent() {
    let mut host = Host::with("fault=silent-after:3");
    host.expect("40 42 02", POSITION);
    host.expect("41 42 03", ""); // addressed to another encoder
    host.expect("40 42 03", "40 50 0A 1A");
    host.expect("40 47 07", "40 47 07");
    host.expect("40 47 07", "");
    assert_eq!(host.encoder().counter(), 1);
    host.bus.connect(host.now);
    host.wait(ms(2000.0));
    host.expect("40 42 02", "");
    Host::with("fault=silent-after:0").expect("40 42 02", "");
}

#[test]
fn power_fails_during_second_store() {
    let mut host = Host::with("fault=die-in-store:2&settings=0xE4");
    host.expect("40 4B 00 00 04 55 DE AD BE EF 78", "40 4B 00 00 04 0F");
    host.expect("40 4B 00 00 04 66 DE AD BE EF 4B", "40 50 0F 1F"); // rejected, so nothing is stored
    host.expect("40 4B 00 00 03 55 01 02 03 5D", "");
    assert_eq!(host.encoder().memory().field_bytes(0).unwrap()[..4], [0x01, 0x02, 0xBE, 0xEF]);
    assert_eq!(host.encoder().wear().write_count(Command::StoreData), 2);
    host.wait(ms(5000.0));
    host.expect("40 42 02", "");
    host.bus.connect(host.now);
    host.expect("40 42 02", ""); // INIT
    host.wait(ms(150.0));
    host.expect("40 42 02", POSITION);
    host.expect("40 4B 00 00 03 55 01 02 03 5D", "40 4B 00 00 03 08");
    host.bus.connect(host.now);
    host.expect("40 42 02", POSITION); // the power was never off
}

#[test]
fn power_loss_keeps_single_stored_byte() {
    let mut host = Host::with("fault=die-in-store:1");
    host.expect("40 4B 00 00 01 55 77 28", "");
    assert_eq!(host.encoder().memory().field_bytes(0).unwrap()[..2], [0x77, b'M']);
}

#[test]
fn discards_bytes_before_opening() {
    let mut host = Host::with("");
    host.send("40 42 02");
    host.wait(ms(50.0));
    host.bus.connect(host.now);
    host.expect("40 50 10", "40 50 00 10");
}

/// Generates random bytes. Some of the sequences start like a request or form a complete request.
fn noise() -> impl Strategy<Value = Vec<u8>> {
    prop_oneof![
        proptest::collection::vec(any::<u8>(), 0..200),
        proptest::collection::vec(any::<u8>(), 0..12).prop_map(|tail| [&[0x40, 0x4B][..], &tail].concat()),
        proptest::collection::vec(any::<u8>(), 0..12).prop_map(|body| {
            let frame = [&[0x40, 0x40 | body.first().unwrap_or(&2) & 0x3F], body.get(1..).unwrap_or(&[])].concat();
            let sum = frame.iter().fold(0, |sum, byte| sum ^ byte);
            [frame, vec![sum]].concat()
        }),
        Just(vec![0x40, 0x53, 0x13]),
        Just(vec![0x40, 0x42, 0x02]),
    ]
}

proptest! {
    #[test]
    fn bus_becomes_idle_after_noise(
        calls in proptest::collection::vec((0..400_000u64, noise(), any::<u8>(), 0..12u8), 1..25),
        encoders in 1..4u8,
        seed in any::<u32>(),
    ) {
        let query = format!("encoders={encoders}&seed={seed}&echo=on&fault=drop:0.01,flip:0.01,garbage:0.01,die-in-store:2");
        let mut host = Host::with(&query);
        for (micros, bytes, settings, what) in calls {
            // Time may also run backwards.
            host.now = if what == 0 { Moment::START } else { host.now + Duration::from_micros(micros) };
            match what {
                1 => host.bus.power_cycle(host.now),
                2 => host.bus.connect(host.now),
                3 => if let Some(format) = LineSettings::from_byte(settings).character_format() {
                    host.bus.set_host_format(host.now, format);
                },
                4 => drop(host.bus.poll(host.now)),
                _ => host.bus.on_bytes(host.now, &bytes),
            }
        }
        host.receive();
        assert_eq!(host.bus.poll_at(), None);
    }
}
