//! Tests of the golden vectors, the manual's example, rejections, the status queue and EEPROM wear.

use super::*;
use crate::devices::hiperface::protocol::{Command, StatusCode};

#[test]
fn manual_example_works_with_correct_checksum() {
    let mut host = Host::new(&blank());
    host.expect("40 4E 0E", "40 4E 08 00 06");
    host.expect("40 4D 00 C9 55 91", "40 4D 00 C9 C4");
    host.expect("40 4E 0E", "40 4E 06 01 09");
    host.expect("40 4D 01 E0 55 69", "40 50 0A 1A"); // misprinted checksum
    host.expect("40 4D 01 E0 55 B9", "40 4D 01 E0 EC");
    host.expect("40 4E 0E", "40 4E 05 02 09");
    host.expect("40 4C 01 0D", "40 4C 01 E0 ED");
    host.expect("40 4F 02 55 66 3E", "40 4F 02 0D");
    host.expect("40 4B 01 05 02 66 08 15 76", "40 4B 01 05 02 0D");
    host.expect("40 4A 01 05 02 66 6A", "40 4A 01 05 02 08 15 11");
    host.expect("40 4F 02 00 66 6B", "40 50 0F 1F");
    host.expect("40 4D 01 A8 66 C2", "40 4D 01 A8 A4");
    host.expect("40 4B 01 05 02 66 08 15 76", "40 50 0E 1E");
    host.expect("40 4D 01 68 66 02", "40 4D 01 68 64");
    host.expect("40 4E 0E", "40 4E 06 01 09");
    assert_eq!(host.encoder().wear().write_count(Command::DefineField), 4);
    assert_eq!(host.encoder().wear().write_count(Command::StoreData), 1, "what is refused wears nothing");
    assert_eq!(host.encoder().wear().total(), 6);
}

#[test]
fn reads_default_encoder() {
    let mut host = Host::with("");
    host.expect("40 42 02", "40 42 00 0E 05 31 38");
    host.expect("FF 42 BD", "40 42 00 0E 05 31 38");
    host.expect("40 44 48 4C", "40 44 48 00 2A 66");
    host.expect("40 46 06", "40 46 00 00 00 06");
    host.expect("40 50 10", "40 50 00 10");
    host.expect("FF 50 AF", "40 50 00 10");
    host.expect("40 52 12", "40 52 E4 37 80 01 40");
    host.expect("40 56 16", "40 56 47 42 30 34 35 30 31 37 39 56 31 2E 32 33 30 31 2E 30 32 2E 31 36 61");
    host.expect("40 4C 00 0C", "40 4C 00 C9 C5");
    host.expect("40 4E 0E", "40 4E 6E 01 61"); // 112 blocks minus 2
    host.expect("40 4A 00 00 04 55 5B", "40 4A 00 00 04 45 4D 44 37 75"); // "EMD7"
    assert_eq!(host.encoder().wear().total(), 0, "reading wears nothing");
    assert_eq!(host.encoder().memory().field_bytes(0).unwrap().len(), 32);
}

#[test]
fn remaining_reference_vectors_match() {
    let mut host = Host::with("temperature=-10");
    host.expect("40 44 48 4C", "40 44 48 FF F6 45");
    host.expect("40 4B 00 00 04 55 DE AD BE EF 78", "40 4B 00 00 04 0F");
    host.expect("40 4A 00 00 04 55 5B", "40 4A 00 00 04 DE AD BE EF 2C");
    host.expect("40 43 00 00 00 00 55 56", "40 43 03");
    host.expect("40 42 02", "40 42 00 00 00 00 02");
    host.expect("40 43 00 00 12 34 55 70", "40 43 03");
    host.expect("40 42 02", "40 42 00 00 12 34 24");
    host.expect("40 47 07", "40 47 07");
    host.expect("40 46 06", "40 46 00 00 01 07");
    host.expect("40 49 55 5C", "40 49 09");
    host.expect("40 46 06", "40 46 00 00 00 06");
    host.encoder_mut().set_counter(0x0001_2345);
    host.expect("40 46 06", "40 46 01 23 45 61");
    let mut host = Host::new(&Config { position: Some(0), ..Config::default() });
    host.expect("40 44 00 04", "40 44 00 01 FF FA");
    host.expect("40 44 01 05", "40 44 01 02 65 62"); // 613 counts for 3 V
}

#[test]
fn kit_encoder_describes_itself() {
    let mut host = Host::with("model=sel37");
    host.expect("40 52 12", "40 52 E4 FF 80 01 88");
    host.expect("40 4C FF F3", "40 4C FF 83 70");
    host.expect("40 4A FF 00 0A 55 AA", "40 4A FF 00 0A 53 00 00 00 00 10 00 00 10 00 AC");
    let label = "53 00 00 00 00 10 00 00 10 00 53 45 4C 33 37 2D 48 46 42 30 2D 4B 30 32 20 20 20 20 00 03 00 48 00 73";
    let whole = host.ask("40 4A FF 00 40 55 E0");
    assert!(whole.starts_with(&format!("40 4A FF 00 40 {label} 00 00")), "{whole}");
    assert_eq!(parse_hex(&whole).unwrap().len(), 5 + 64 + 1);
    host.expect("40 63 00 00 12 34 55 50", "40 63 23");
    host.expect("40 42 02", "40 42 00 00 12 34 24");
    host.expect("40 63 00 00 00 00 55 76", "40 63 23");
    assert_eq!(host.encoder().wear().write_count(Command::Synchronise), 2);
    assert_eq!(&host.encoder().memory().field_bytes(0).unwrap()[..8], b"SMK42-08");
}

#[test]
fn simulates_chosen_model_and_type() {
    let mut host = Host::with("model=sks36");
    host.expect("40 42 02", "40 42 00 00 05 31 36");
    host.expect("40 52 12", "40 52 E4 32 80 01 45");
    let mut host = Host::with("type=0x22&position=0x5A5&settings=0xE4");
    host.expect("40 52 12", "40 52 E4 22 80 01 55");
    host.expect("40 43 00 00 80 00 55 D6", "40 50 0D 1D"); // the range is 15 bits
    let mut host = Host::with("type=0x47");
    host.expect("40 63 00 00 00 00 55 76", "40 63 23");
}

#[test]
fn checks_requests_in_order() {
    let mut host = Host::with("");
    let cases = [
        ("checksum", "40 42 03", "40 50 0A 1A"),
        ("half a frame", "40 42", "40 50 0A 1A"),
        ("two bytes whose XOR is 0", "40 40", "40 50 0C 1C"),
        ("unknown command", "40 54 14", "40 50 0B 1B"),
        ("error bit in a request", "40 C2 82", "40 50 0B 1B"),
        ("63h without being a kit, before its length", "40 63 23", "40 50 0B 1B"),
        ("63h without being a kit", "40 63 00 00 00 00 55 76", "40 50 0B 1B"),
        ("length", "40 42 00 02", "40 50 0C 1C"),
        ("count 0", "40 4A 00 00 00 55 5F", "40 50 0D 1D"),
        ("channel", "40 44 02 06", "40 50 0D 1D"),
        ("position beyond the range, before the code", "40 43 01 00 00 00 00 02", "40 50 0D 1D"),
        ("code 0", "40 43 00 00 00 00 00 03", "40 50 0F 1F"),
        ("code 0 of 49h", "40 49 00 09", "40 50 0F 1F"),
        ("code 0 of 55h", "40 55 41 00 54", "40 50 0F 1F"),
        ("code 0 of 57h", "40 57 E5 00 F2", "40 50 0F 1F"),
        ("reserved settings", "40 67 E7 C0", "40 50 0D 1D"),
        ("field", "40 4C 01 0D", "40 50 12 02"),
        ("no extended label", "40 4C FF F3", "40 50 12 02"),
        ("range, before the code", "40 4A 00 1F 02 00 17", "40 50 11 01"),
        ("access code", "40 4A 00 00 04 00 0E", "40 50 0F 1F"),
        ("a field number is left out", "40 4D 02 C9 55 93", "40 50 12 02"),
    ];
    for (what, request, reply) in cases {
        assert_eq!(host.ask(request), reply, "{what}");
    }
    assert_eq!(host.encoder().wear().total(), 0);
    host.expect("40 50 10", "40 50 00 10"); // a rejection adds nothing to the queue
    host.expect("41 42 03", "");
    host.expect("41 42 04", "");
}

#[test]
fn overlong_request_is_one_bad_frame() {
    let mut host = Host::with("");
    let request = format!("40 42 {}", "00 ".repeat(300));
    host.expect(&request, "40 50 0C 1C");
}

#[test]
fn queued_status_codes_flag_every_reply() {
    let mut host = Host::with("");
    for code in [0x1C, 0x1D, 0x1E, 0x01, 0x02] {
        host.encoder_mut().queue_code(StatusCode::new(code));
    }
    host.expect("40 42 02", "40 C2 00 0E 05 31 B8");
    host.expect("40 4C 01 0D", "40 D0 12 82");
    host.expect("40 50 10", "40 D0 1C 8C");
    host.expect("40 50 10", "40 D0 1D 8D");
    host.expect("40 50 10", "40 D0 1E 8E");
    host.expect("40 50 10", "40 50 01 11"); // the fifth code was lost
    host.expect("40 50 10", "40 50 00 10");
    host.expect("40 42 02", "40 42 00 0E 05 31 38");
}

#[test]
fn counter_overflow_raises_warning() {
    let mut host = Host::with("");
    host.encoder_mut().set_counter(0x00FF_FFFF);
    host.expect("40 46 06", "40 46 FF FF FF F9");
    host.expect("40 47 07", "40 C7 87");
    host.expect("40 46 06", "40 C6 00 00 00 86");
    host.expect("40 50 10", "40 50 08 18");
    host.expect("40 46 06", "40 46 00 00 00 06");
}

#[test]
fn overheating_warns_once_per_reset() {
    let mut host = Host::with("");
    host.encoder_mut().set_temperature(115);
    host.expect("40 50 10", "40 50 00 10");
    host.encoder_mut().set_temperature(116);
    host.expect("40 44 48 4C", "40 C4 48 00 74 B8");
    host.expect("40 50 10", "40 50 1E 0E");
    host.encoder_mut().set_temperature(117);
    host.expect("40 50 10", "40 50 00 10");
    host.expect("40 53 13", "");
    host.wait(ms(200.0));
    host.expect("40 50 10", "40 50 1E 0E");
}

#[test]
fn samples_shaft_at_reply_start() {
    // At 60 rpm, the shaft moves by 4096 steps per second, or 4.096 steps per millisecond.
    let mut host = Host::with("rpm=60&position=0");
    // After 3 characters, 44 bits of silence and 3.7 ms, the reply starts at 11.72 ms and step 48.004.
    host.expect("40 42 02", "40 42 00 00 00 30 32");
    let mut host = Host::with("rpm=60&position=0&pace=worst");
    host.expect("40 42 02", "40 42 00 00 00 49 4B"); // 18.02 ms: step 73.8
    let now = host.now;
    host.encoder_mut().set_rpm(now, 6001.0);
    host.expect("40 42 02", "40 50 1F 0F");
    host.encoder_mut().queue_code(StatusCode::new(0x1D));
    host.expect("40 42 02", "40 D0 1F 8F");
}

#[test]
fn address_change_is_immediate_and_persistent() {
    let mut host = Host::with("");
    host.expect("40 55 41 55 01", "40 55 41 54");
    host.expect("40 42 02", "");
    host.expect("41 42 03", "41 42 00 0E 05 31 39");
    host.expect("41 53 12", "");
    host.wait(ms(200.0));
    host.expect("41 42 03", "41 42 00 0E 05 31 39");
}

#[test]
fn requires_configured_access_codes() {
    let mut host = Host::with("codes=0:66");
    host.expect("40 4A 00 00 04 55 5B", "40 50 0F 1F");
    host.expect("40 4A 00 00 04 66 68", "40 4A 00 00 04 45 4D 44 37 75");
    host.expect("40 49 55 5C", "40 50 0F 1F");
}
