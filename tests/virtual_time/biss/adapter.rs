//! Registers and position over an adapter: banks, checksums, a stuck line, and an adapter that does not answer.

use std::time::Duration;

use encoder_studio::buses::bridge::procedures::AdapterError;
use encoder_studio::buses::bridge::protocol::Operation;
use encoder_studio::devices::biss::procedures::{Error, Supply};
use encoder_studio::devices::biss::protocol::{Crc, Layout};
use encoder_studio::devices::biss::sim::Encoder;
use encoder_studio::units::Moment;

use super::support::{Bus, at};

/// At 1234h turns and 18000h steps, the frame is 024698000CF (BiSS reference 2).
#[test]
fn reads_registers_and_position() {
    let mut bus = Bus::new("temperature=25");
    assert_eq!(bus.master().read(at("0x66")), Ok(75));
    assert_eq!(bus.master().read_consecutive(at("0x7E"), 2), Ok(b"Fr".to_vec()));
    let reading = bus.master().position().unwrap();
    assert_eq!(
        (reading.turns, reading.steps, reading.position_word().to_string()),
        (0x1234, 0x18000, "024698000".to_owned())
    );
    assert_eq!(reading.frame.map(|frame| frame.to_string()).as_deref(), Some("024698000CF"));
    assert_eq!((reading.error, reading.warning, reading.crc_errors), (Some(false), Some(false), 0));
    assert_eq!((bus.count(Operation::Hello), bus.count(Operation::BissConfig)), (1, 1));
    let hello = bus.station.adapter.identity().unwrap();
    assert_eq!((hello.name.as_str(), hello.max_clock_hz), ("virtual adapter", 10_000_000));
    assert_eq!(bus.station.to_string(), "BiSS at 1000000 Hz");
}

/// The clock is divided from 60 MHz: 60/9 MHz is the highest available clock below the requested one.
#[test]
fn clock_rounds_down_to_divider() {
    let mut bus = Bus::new("");
    bus.station.clock_hz = 7_000_000;
    bus.master().position().unwrap();
    assert_eq!(bus.station.actual_clock_hz, Some(6_666_666));
}

#[test]
fn position_has_error_and_warning() {
    let mut bus = Bus::new("errors=0x10&temperature=130");
    let reading = bus.master().position().unwrap();
    assert_eq!((reading.error, reading.warning, reading.is_valid()), (Some(true), Some(true), false));
}

/// The shaft turns half a revolution, or 65536 steps, per second.
#[test]
fn position_has_sampling_time() {
    let mut bus = Bus::new("rpm=30&position=0");
    for _ in 0..20 {
        let reading = bus.master().position().unwrap();
        let expected = reading.at.since_start().as_secs_f64() * 65_536.0;
        // The frame and its transmission take 0.4 ms, during which the shaft turns by 26 steps.
        assert!((f64::from(reading.steps) - expected).abs() < 20.0, "{reading:?}, not {expected}");
    }
}

#[test]
fn reselects_bank_only_after_possible_change() {
    let mut bus = Bus::new("");
    let mut master = bus.master();
    assert_eq!(
        master.read_consecutive(at("0x02:0x00"), 64).map(|bytes| bytes[63]),
        Ok(0xF4),
        "the sum of the data sheet"
    );
    assert_eq!(master.read(at("0x03:0x3F")), Ok(0x31));
    assert_eq!(bus.count(Operation::BissRegisterWrite), 2);
    let mut master = bus.master();
    assert_eq!(master.read(at("0x03:0x0A")), Ok(16), "another job: who knows what happened in between");
    master.wait(Duration::from_secs(1)).unwrap();
    assert_eq!(master.read(at("0x03:0x0A")), Ok(16), "long enough for a restart");
    assert_eq!(bus.count(Operation::BissRegisterWrite), 4);
    let mut master = bus.master();
    master.write(at("0x40"), 0x02).unwrap();
    assert_eq!(master.read(at("0x02:0x05")), Ok(0x1C), "selected by hand");
    assert_eq!(bus.count(Operation::BissRegisterWrite), 5);
}

/// A short loss of power resets the selected bank to 0.
#[test]
fn silence_reveals_restart() {
    let mut bus = Bus::new("");
    assert_eq!(bus.master().read(at("0x03:0x0A")), Ok(16));
    let (now, device) = (Moment::from_elapsed(bus.now()), bus.device.clone());
    let mut master = bus.master();
    assert_eq!(master.read(at("0x03:0x0A")), Ok(16));
    device.lock().unwrap().device_mut::<Encoder>().unwrap().power_cycle(now);
    let error = master.read(at("0x03:0x0A")).unwrap_err();
    assert!(matches!(error, Error::NoAcknowledge { .. }), "{error}");
    assert_eq!(master.with_reply_timeout(Duration::from_secs(2), |master| master.read(at("0x03:0x0A"))), Ok(16));
}

#[test]
fn verifies_writes_by_readback() {
    let mut bus = Bus::new("");
    let error = bus.master().write(at("0x6A"), 7).unwrap_err();
    assert_eq!(error, Error::Refused { address: at("0x6A"), value: 7, reads: Some(0) });
    for (place, value) in [("0x6B", 0x2A), ("0x6A", 0x07), ("0x01:0x00", 0x02), ("0x01:0x02", 0x99)] {
        assert_eq!(bus.master().write(at(place), value), Ok(()), "{place}");
    }
    assert_eq!(bus.master().read(at("0x01:0x02")), Ok(0x99));
    let error = bus.master().write(at("0x44:0x00"), 1).unwrap_err();
    assert!(matches!(error, Error::Unclear { value: 1, .. }), "nothing is known of that register: {error}");
}

#[test]
fn lost_reply_makes_command_unclear() {
    let mut bus = Bus::new("rpm=1000");
    for (place, value) in [("0x6B", 0x2A), ("0x6A", 0x02)] {
        let next = bus.tap().sent.len();
        bus.tap().swallow_reply = Some(if next == 0 { 2 } else { next });
        assert_eq!(bus.master().write(at(place), value), Ok(()));
    }
    assert_eq!(bus.count(Operation::BissRegisterWrite), 2);
    let next = bus.tap().sent.len();
    // The first request selects the bank, and the second is the command.
    bus.tap().swallow_reply = Some(next + 1);
    let error = bus.master().write(at("0x00:0x06"), 0x01).unwrap_err();
    assert!(matches!(error, Error::Unclear { value: 0x01, .. }), "{error}");
    assert_eq!(bus.count(Operation::BissRegisterWrite), 4);
}

#[test]
fn distinguishes_missing_register_from_missing_encoder() {
    let mut bus = Bus::new("");
    assert_eq!(bus.master().read(at("0x44:0x00")), Err(Error::NoSuchRegister { address: at("0x44:0x00") }));
}

#[test]
fn line_faults_have_distinct_errors() {
    let cases = [
        ("line=open", "no encoder acknowledges on the bus (attempts: 5)"),
        ("line=low", "the data line stays low (attempts: 5)"),
        ("line=high", "the data line stays high (attempts: 5)"),
    ];
    for (query, sentence) in cases {
        let mut bus = Bus::new(query);
        let position = bus.master().position().unwrap_err();
        let register = bus.master().read(at("0x66")).unwrap_err();
        assert_eq!((position.to_string().as_str(), register.to_string().as_str()), (sentence, sentence));
        assert!(position.is_lost() && register.is_lost());
        assert!(bus.now() < Duration::from_secs(10));
    }
}

#[test]
fn counts_and_retries_corrupt_frames() {
    let mut bus = Bus::new("noise=0.15&seed=3");
    let (mut right, mut wrong) = (0, 0);
    for _ in 0..200 {
        // A CRC of six bits detects every single inverted bit, and only one is inverted.
        let reading = bus.master().position().unwrap_or_else(|error| panic!("{error}"));
        assert_eq!(reading.position(), 0x2469_8000);
        right += 1;
        wrong += reading.crc_errors;
    }
    let share = f64::from(wrong) / f64::from(wrong + right);
    assert!((0.1..0.2).contains(&share), "{share}");
}

#[test]
fn reports_wrong_widths() {
    let narrow = Layout::new(12, 13, true, true, Crc::new(Crc::POSITION, 0, true).ok()).unwrap();
    let mut bus = Bus::new("rpm=60");
    bus.station.layout = Some(narrow);
    let error = bus.master().position().unwrap_err();
    assert_eq!(
        error.to_string(),
        "21 frames in a row have a wrong CRC: frames of the encoder do not have 27+6 bits",
        "five tries, and sixteen more"
    );
    bus.station.layout = None;
    assert!(bus.master().position().is_ok());
    let mut broken = Bus::new("noise=1");
    assert!(matches!(broken.master().position(), Err(Error::WrongWidths { .. })));
}

#[test]
fn version_error_names_both_versions() {
    let mut bus = Bus::new("version=2");
    let error = bus.master().read(at("0x66")).unwrap_err();
    assert_eq!(error.to_string(), "the adapter uses version 2 of the bridge protocol, but this program uses version 1");
    assert_eq!(bus.tap().sent.len(), 1);
}

#[test]
fn silent_adapter_is_asked_twice() {
    let mut bus = Bus::new("fault=silent-after:0");
    let error = bus.master().position().unwrap_err();
    assert_eq!(error, Error::Adapter(AdapterError::Silent));
    assert_eq!(error.to_string(), "the adapter does not answer");
    assert_eq!(bus.tap().sent.len(), 2);
    // Two tries of 200 ms each, plus the margin.
    assert_eq!(bus.now(), Duration::from_millis(2 * 220));
    assert!(bus.tap().sent.iter().all(|bytes| bytes[0] == 0), "an empty packet goes before each");
}

#[test]
fn switches_supply_on_if_requested() {
    let mut bus = Bus::new("supply=switched");
    let error = bus.master().position().unwrap_err();
    assert_eq!(error, Error::NoAcknowledge { tries: 5, supply_off: true });
    let mut bus = Bus::new("supply=switched");
    bus.station.supply = Some(Supply { millivolt: 5_000, measured: None });
    assert_eq!(bus.master().read(at("0x41")), Ok(0x02));
    // The encoder needs 0.3 W (manual, chapter 2).
    assert_eq!(bus.station.supply, Some(Supply { millivolt: 5_000, measured: Some((5_000, 60)) }));
    let mut external = Bus::new("");
    external.station.supply = Some(Supply { millivolt: 5_000, measured: None });
    let error = external.master().read(at("0x41")).unwrap_err();
    assert_eq!(error.to_string(), "the adapter virtual adapter cannot supply an encoder");
}

/// The noise is between host and adapter, where packets have a 16-bit CRC, not between adapter and encoder.
#[test]
fn noisy_adapter_wire_yields_no_wrong_values() {
    let (mut right, mut failed) = (0, 0);
    for noise in ["drop:0.01", "flip:0.01", "garbage:0.01"] {
        for seed in 0..10 {
            let mut bus = Bus::new(&format!("seed={seed}&fault={noise}&temperature=25"));
            for _ in 0..10 {
                for (place, truth) in [("0x66", 75), ("0x02:0x0F", 0xF4), ("0x03:0x0C", 17)] {
                    match bus.master().read(at(place)) {
                        Ok(value) => {
                            assert_eq!(value, truth, "{noise}, seed {seed}, {place}");
                            right += 1;
                        }
                        Err(Error::Adapter(AdapterError::Silent) | Error::NoReply { .. }) => failed += 1,
                        Err(other) => panic!("{noise}, seed {seed}: {other}"),
                    }
                }
            }
        }
    }
    println!("{right} right, {failed} errors");
    assert!(right > 600, "{right} of 900");
}
