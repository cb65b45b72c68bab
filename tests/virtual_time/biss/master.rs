//! Registers and position over the configuration pin: echo, byte order, noise, silence, rejected requests, and writes
//! whose reply is lost.

use std::time::Duration;

use encoder_studio::bits::ByteOrder;
use encoder_studio::devices::biss::procedures::{Echo, Error, ReplyDamage};
use encoder_studio::link::{CancelToken, Clock, Direction};

use super::support::{Pin, at};

/// Temperature 75 is 25 °C. The position is 1234h turns and 18000h steps (UBICOM reference 6).
#[test]
fn reads_with_published_frames() {
    let mut pin = Pin::new("temperature=25");
    assert_eq!(pin.master().read(at("0x66")), Ok(75));
    let reading = pin.master().position().unwrap();
    assert_eq!(
        (reading.turns, reading.steps, reading.position_word().to_string(), reading.frame),
        (0x1234, 0x18000, "024698000".to_owned(), None)
    );
    assert_eq!((reading.position(), reading.degrees_in_turn()), (0x2469_8000, 270.0));
    assert_eq!((reading.error, reading.warning, reading.crc_errors), (None, None, 0));
    assert_eq!(pin.master().read_consecutive(at("0x7E"), 2), Ok(b"Fr".to_vec()));
    let sent = ["80 01 01 02 00 01 00 7A", "80 01 01 02 00 26 00 55", "80 01 03 01 00 01 79"];
    assert_eq!(pin.shown(Direction::Sent)[..3], sent);
    let received = ["80 01 01 01 00 02 7A", "80 01 01 01 00 4B 31", "80 01 03 05 00 00 80 69 24 00 69"];
    assert_eq!(pin.shown(Direction::Received)[..3], received);
    assert_eq!(pin.station.line.damaged, 0);
}

/// The shaft turns half a revolution per second. A position is sampled when the encoder begins to answer, one
/// millisecond after the seven bytes of the request.
#[test]
fn position_has_time_of_first_bit() {
    let mut pin = Pin::new("rpm=30&position=0");
    let reading = pin.master().position().unwrap();
    let seconds = reading.at.since_start().as_secs_f64();
    assert!((seconds - (0.001 + 7.0 * 10.0 / 115_200.0)).abs() < 1e-7, "{seconds}");
    assert!((f64::from(reading.steps) - seconds * 65_536.0).abs() < 1.0, "{reading:?}");
}

#[test]
fn probes_byte_order_once() {
    for (word, order) in [("low-first", ByteOrder::LowFirst), ("high-first", ByteOrder::HighFirst)] {
        for given in [None, Some(order)] {
            let mut pin = Pin::new(&format!("order={word}&temperature=30"));
            pin.station.order = given;
            assert_eq!(pin.master().read(at("0x66")), Ok(80), "{word}");
            // Register 05h of bank 02h, the minimum time-out, contains 1Ch.
            assert_eq!(pin.master().read(at("0x02:0x05")), Ok(0x1C), "{word}");
            assert_eq!(pin.station.order, Some(order));
            assert_eq!(pin.tap().sent.len(), if given.is_none() { 3 } else { 2 });
        }
    }
}

#[test]
fn removes_echo_with_any_setting() {
    for (echoes, told) in [("on", Echo::On), ("off", Echo::Off)] {
        for setting in [Echo::Unknown, told] {
            let mut pin = Pin::new(&format!("echo={echoes}"));
            pin.station.line.echo = setting;
            assert_eq!(pin.master().read_consecutive(at("0x02:0x00"), 4), Ok(vec![0x01, 0x02, 0x04, 0x43]));
            assert_eq!(pin.master().write(at("0x40"), 5), Ok(()));
            assert_eq!(pin.device().encoder().bank(), 5);
            assert_eq!((pin.station.line.echo, pin.station.line.damaged), (told, 0), "{setting:?}");
        }
    }
    // A reply without the echo that should precede it belongs to another request.
    let mut pin = Pin::new("echo=off");
    pin.station.line.echo = Echo::On;
    let error = pin.master().read(at("0x66")).unwrap_err();
    assert!(matches!(error, Error::Damaged { cause: ReplyDamage::Echo, tries: 5, .. }), "{error}");
}

#[test]
fn reports_silence_after_five_tries() {
    let mut pin = Pin::new("fault=silent-after:0");
    pin.station.order = Some(ByteOrder::LowFirst);
    let error = pin.master().read(at("0x66")).unwrap_err();
    assert_eq!(error.to_string(), "no reply while reading register 0x66 (attempts: 5)");
    assert!(error.is_lost());
    assert!(pin.now() < Duration::from_secs(10), "{:?}", pin.now());
    let mut echoing = Pin::new("fault=silent-after:0&echo=on");
    echoing.station.order = Some(ByteOrder::LowFirst);
    let error = echoing.master().position().unwrap_err();
    assert!(matches!(error, Error::NoReply { echo_heard: true, .. }), "{error}");
}

/// An encoder does not answer a request for a missing register, but answers other requests. The kit encoder has no bank
/// 44h.
#[test]
fn distinguishes_missing_register_from_missing_encoder() {
    let mut pin = Pin::new("");
    let error = pin.master().read(at("0x44:0x00")).unwrap_err();
    assert_eq!(error.to_string(), "the encoder has no register 0x44:0x00");
    assert!(!error.is_lost());
    let beyond = pin.master().read_consecutive(at("0xFF:0x3F"), 2).unwrap_err();
    assert_eq!(beyond, Error::OutOfRange { start: at("0xFF:0x3F"), count: 2 });
    assert_eq!(pin.master().read_consecutive(at("0xFF:0x3F"), 0), Ok(vec![]));
    assert!(matches!(pin.master().read_consecutive(at("0x40"), usize::MAX), Err(Error::OutOfRange { .. })));
}

#[test]
fn rejected_write_is_not_retried() {
    let mut pin = Pin::new("");
    let error = pin.master().write(at("0x6A"), 7).unwrap_err();
    assert_eq!(error, Error::Refused { address: at("0x6A"), value: 7, reads: None });
    assert_eq!(pin.tap().sent.len(), 2, "the probe, and once");
    assert_eq!(pin.master().write(at("0x6B"), 0x2A), Ok(()));
    assert_eq!(pin.master().write(at("0x6A"), 7), Ok(()));
    assert_eq!(pin.master().read(at("0x6A")), Ok(7));
}

/// The request or its reply is lost. A stored value is read back, and written again only if necessary.
#[test]
fn write_with_lost_reply_is_read_back() {
    for request_lost in [false, true] {
        let mut pin = Pin::new("");
        pin.station.order = Some(ByteOrder::LowFirst);
        pin.tap().swallow_request = request_lost.then_some(0);
        pin.tap().swallow_reply = (!request_lost).then_some(0);
        assert_eq!(pin.master().write(at("0x6B"), 0x2A), Ok(()));
        assert_eq!(pin.master().read(at("0x6B")), Ok(0x2A));
        let writes = pin.tap().sent.iter().filter(|frame| frame[2] == 0x02).count();
        assert_eq!(writes, if request_lost { 2 } else { 1 });
    }
}

/// The command starts a Wiegand test. The encoder cannot report whether it received the command, so it must not be
/// repeated.
#[test]
fn command_with_lost_reply_is_not_retried() {
    for request_lost in [false, true] {
        let mut pin = Pin::new("rpm=1000");
        pin.master().write(at("0x6B"), 0x2A).unwrap();
        pin.master().write(at("0x6A"), 0x02).unwrap();
        let next = pin.tap().sent.len();
        pin.tap().swallow_request = request_lost.then_some(next);
        pin.tap().swallow_reply = (!request_lost).then_some(next);
        let error = pin.master().write(at("0x00:0x06"), 0x01).unwrap_err();
        assert!(matches!(error, Error::Unclear { value: 0x01, .. }), "{error}");
        assert_eq!(pin.tap().sent.len(), next + 1);
    }
}

/// If the connection is lost during a write, the result is unknown.
#[test]
fn write_is_unclear_after_wire_loss() {
    let mut pin = Pin::new("");
    pin.station.order = Some(ByteOrder::LowFirst);
    pin.tap().lost_from = Some(0);
    let error = pin.master().write(at("0x6B"), 0x2A).unwrap_err();
    assert!(matches!(&error, Error::Unclear { cause, .. } if matches!(**cause, Error::Link(_))), "{error}");
    assert!(error.is_lost());
}

#[test]
fn write_is_unclear_without_readback() {
    let mut pin = Pin::new("");
    pin.station.order = Some(ByteOrder::LowFirst);
    pin.tap().mute_from = Some(0);
    let error = pin.master().write(at("0x6B"), 0x2A).unwrap_err();
    assert!(matches!(&error, Error::Unclear { cause, .. } if matches!(**cause, Error::NoReply { .. })), "{error}");
    assert!(error.is_lost());
    assert!(pin.now() < Duration::from_secs(10), "{:?}", pin.now());
}

#[test]
fn cancels_between_exchanges_outside_shield() {
    let mut pin = Pin::new("");
    pin.cancel = CancelToken::after_transactions(3);
    assert_eq!(pin.master().read_consecutive(at("0x02:0x00"), 64), Err(Error::Cancelled));
    assert_eq!(pin.tap().sent.len(), 3);
    let mut master = pin.master();
    assert_eq!(master.wait(Duration::from_secs(1)), Err(Error::Cancelled));
    assert_eq!(master.run_uncancellable(|master| master.read(at("0x41"))), Ok(0x02));
    assert_eq!(master.read(at("0x41")), Err(Error::Cancelled), "the shield ends");
}

/// The encoder is silent for five seconds during calibration. A normal request returns an error, and one with a longer
/// time limit returns the status.
#[test]
fn longer_reply_timeout_tolerates_silence() {
    let mut pin = Pin::new("rpm=-500&calibration=7");
    for (place, value) in [("0x6B", 0x2A), ("0x6A", 0x01), ("0x00:0x00", 0x01)] {
        pin.master().write(at(place), value).unwrap();
    }
    let started = pin.now();
    assert!(matches!(pin.master().read(at("0x00:0x01")), Err(Error::NoReply { .. })));
    let status = pin.master().with_reply_timeout(Duration::from_secs(10), |master| master.read(at("0x00:0x01")));
    assert_eq!(status, Ok(0x02));
    let silent = pin.now() - started;
    assert!((7.0..7.5).contains(&silent.as_secs_f64()), "{silent:?}");
    let mut dead = Pin::new("fault=silent-after:1");
    dead.master().read(at("0x41")).unwrap_err();
    let from = dead.now();
    dead.master().with_reply_timeout(Duration::from_secs(10), |master| master.read(at("0x41"))).unwrap_err();
    assert!((9.0..10.5).contains(&(dead.now() - from).as_secs_f64()), "patience has an end");
}

/// Two damaged frames with matching checksums would give a wrong value. Because values are confirmed, none is wrong in
/// these runs.
#[test]
fn noisy_line_yields_no_wrong_values() {
    let (mut right, mut failed) = (0, 0);
    for noise in ["drop:0.02", "flip:0.02", "garbage:0.02", "drop:0.01,flip:0.01,garbage:0.01"] {
        for seed in 0..12 {
            let mut pin = Pin::new(&format!("seed={seed}&fault={noise}&temperature=25"));
            for _ in 0..20 {
                for (place, truth) in [("0x66", 75), ("0x02:0x0F", 0xF4), ("0x03:0x0C", 17), ("0x7E", b'F')] {
                    match pin.master().read(at(place)) {
                        Ok(value) => {
                            assert_eq!(value, truth, "{noise}, seed {seed}, {place}");
                            right += 1;
                        }
                        Err(Error::Damaged { .. } | Error::NoReply { .. }) => failed += 1,
                        Err(other) => panic!("{noise}, seed {seed}: {other}"),
                    }
                }
            }
        }
    }
    println!("{right} right, {failed} errors");
    assert!(right > 3700, "{right} of 3840");
}

#[test]
fn noisy_writes_report_actual_result() {
    for noise in ["drop:0.03", "flip:0.03", "garbage:0.03"] {
        for seed in 0..20 {
            let mut pin = Pin::new(&format!("seed={seed}&fault={noise}"));
            for value in 1..20 {
                let before = pin.device().encoder().bank();
                match pin.master().write(at("0x40"), value) {
                    Ok(()) => assert_eq!(pin.device().encoder().bank(), value, "{noise}, seed {seed}"),
                    Err(Error::Unclear { .. }) => {}
                    Err(error) => assert_eq!(pin.device().encoder().bank(), before, "{noise}, seed {seed}: {error}"),
                }
            }
        }
    }
}

/// Noise that looks like the start of a frame hides the following bytes until that frame ends. Both sides end it after
/// 20 ms of silence.
#[test]
fn reads_replies_again_after_garbage() {
    let mut pin = Pin::new("temperature=25");
    pin.tap().foreign.extend([0x80, 0x01, 0x01, 0x3F, 0x00]);
    assert_eq!(pin.master().read(at("0x66")), Ok(75));
    pin.link_send(&[0x80, 0x01, 0x01, 0x02]);
    let from = pin.clock.now();
    assert_eq!(pin.master().read(at("0x66")), Ok(75));
    assert!(pin.clock.now().duration_since(from) < Duration::from_secs(1));
}

/// Damaged replies are counted, and the trace contains their bytes (issue 22.11).
#[test]
fn counts_and_reports_corrupt_replies() {
    let mut pin = Pin::new("");
    // Over the pin, the temperature is 0026h (UBICOM reference 6).
    pin.tap().broken_to = Some(vec![0x80, 1, 1, 2, 0, 0x26]);
    let error = pin.master().read(at("0x66")).unwrap_err();
    assert!(matches!(error, Error::Damaged { .. }), "{error}");
    let quality = pin.station.line.quality.clone();
    assert_eq!((quality.damaged, quality.retries), (5, 4));
    // The byte order of numbers was requested before these replies.
    let shown = pin.shown(Direction::Received);
    assert!(shown.len() == 6 && shown.iter().all(|own| !own.contains('*')), "{shown:?}");
}
