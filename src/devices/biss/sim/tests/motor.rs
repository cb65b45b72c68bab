//! Tests of the procedures that need a turning motor: durations, results and failures (sections 5.1 and 5.2 of the
//! reference).

use super::*;

#[test]
fn calibration_takes_two_runs() {
    let mut host = Host::with("rpm=-500&cycles=5");
    host.enter(0x01);
    host.put("0x00:0x00", 0x01);
    assert!(!host.answers(), "it may not respond while it runs");
    assert_eq!(host.encoder.position_at(host.now).map(|reading| reading.error), Some(true));
    host.wait(4.999);
    host.expect("0x00:0x01", 0x01);
    host.wait(0.001);
    assert!(host.answers());
    host.expect("0x00:0x01", 0x02);
    assert_eq!(host.encoder.flash().write_cycles(), 5);
    host.turn(500.0);
    host.put("0x00:0x00", 0x02);
    host.wait(5.0);
    host.expect("0x00:0x01", 0x22);
    assert!(host.encoder.flash().is_calibrated());
    assert_eq!(host.encoder.flash().write_cycles(), 6, "saved by itself");
    host.put("0x6A", 0x00);
    host.expect("0x00:0x01", 0x00);
}

#[test]
fn calibration_fails_with_matching_status() {
    let cases = [
        ("rpm=500", 0x30),
        ("rpm=-500&temperature=24", 0x31),
        ("rpm=-500&temperature=41", 0x31),
        ("rpm=-299", 0x32),
        ("rpm=-701", 0x32),
        ("rpm=0", 0x32),
        ("rpm=-500&waver=2.5", 0x33),
        ("rpm=-500&filter=dynamic", 0x33),
        ("rpm=-300&temperature=25", 0x02),
        ("rpm=-700&temperature=40&waver=2", 0x02),
    ];
    for (query, status) in cases {
        let mut host = Host::with(query);
        host.enter(0x01);
        host.put("0x00:0x00", 0x01);
        host.expect("0x00:0x01", 0x01);
        host.wait(5.0);
        host.expect("0x00:0x01", status);
        assert!(host.encoder.flash().is_calibrated(), "{query}: the first run loses nothing");
    }
}

#[test]
fn failed_second_run_loses_table() {
    let after_first_run = || {
        let mut host = Host::with("rpm=-500&cycles=0&calibration-silent=off");
        host.enter(0x01);
        host.put("0x00:0x00", 0x01);
        host.wait(5.0);
        host
    };
    // The motor still turns in the direction of the first run.
    let mut host = after_first_run();
    host.put("0x00:0x00", 0x02);
    assert!(host.answers(), "this one answers while it runs");
    host.wait(1.0);
    host.expect("0x00:0x01", 0x30);
    assert!(!host.encoder.flash().is_calibrated());
    // The table is also lost if the mode is left, the speed changes or power is lost.
    for end in [0, 1, 2] {
        let mut host = after_first_run();
        host.turn(500.0);
        host.put("0x00:0x00", 0x02);
        host.wait(2.0);
        match end {
            0 => host.put("0x6A", 0x00),
            1 => host.turn(510.0),
            _ => host.encoder.power_cycle(host.now),
        }
        assert!(!host.encoder.flash().is_calibrated(), "{end}");
        assert_eq!(host.encoder.flash().write_cycles(), 0);
    }
    // If the mode is left during the first run, the table remains.
    let mut host = Host::with("rpm=-500");
    host.enter(0x01);
    host.put("0x00:0x00", 0x01);
    host.put("0x6A", 0x00);
    assert!(host.encoder.flash().is_calibrated());
}

#[test]
fn second_run_requires_completed_first_run() {
    let mut host = Host::with("rpm=500");
    host.enter(0x01);
    assert!(!host.write("0x00:0x00", 0x02));
    assert!(!host.write("0x00:0x00", 0x07), "no command");
    host.turn(-500.0);
    host.put("0x00:0x00", 0x01);
    assert!(!host.write("0x00:0x00", 0x01), "it runs already");
}

/// According to section 5.1 of the reference, 515 revolutions take 61.8 s at 500 rpm and 15.45 s at 2000 rpm.
#[test]
fn wiegand_test_takes_515_revolutions_each_way() {
    for (rpm, seconds) in [(500.0, 61.8), (2000.0, 15.45)] {
        let mut host = Host::with("pulses=6.3,5.8&cycles=0");
        host.enter(0x02);
        host.turn(rpm);
        host.put("0x00:0x06", 0x01);
        host.wait(seconds - 0.01);
        host.expect("0x00:0x07", 0x01);
        host.wait(0.02);
        host.expect("0x00:0x07", 0x03);
        host.turn(-rpm);
        host.put("0x00:0x06", 0x02);
        host.wait(seconds - 0.01);
        host.expect("0x00:0x07", 0x04);
        host.wait(0.02);
        host.expect("0x00:0x07", 0x06);
        let result = ["0x00:0x09", "0x00:0x0A", "0x00:0x0B", "0x00:0x0C"].map(|register| host.read(register));
        assert_eq!(result, [63, 58, 63, 58]);
        host.put("0x00:0x06", 0x05);
        host.expect("0x00:0x11", 0); // the saved result can be read only after a restart
        host.put("0x00:0x06", 0x03);
        host.expect("0x00:0x07", 0x00);
        host.put("0x6A", 0x00);
        assert_eq!(host.encoder.flash().write_cycles(), 1);
        host.encoder.power_cycle(host.now);
        host.wait(0.5);
        let saved = ["0x00:0x11", "0x00:0x12", "0x00:0x13", "0x00:0x14"].map(|register| host.read(register));
        assert_eq!(saved, [63, 58, 63, 58]);
        host.expect("0x00:0x09", 0);
    }
}

#[test]
fn paused_motor_only_takes_longer() {
    let mut host = Host::with("rpm=1000");
    host.enter(0x02);
    host.put("0x00:0x06", 0x01);
    host.wait(15.0); // 250 revolutions
    host.turn(0.0);
    host.wait(1000.0);
    host.expect("0x00:0x07", 0x01);
    host.turn(1000.0);
    host.wait(15.8);
    host.expect("0x00:0x07", 0x01);
    host.wait(0.2); // slightly more than 265
    host.expect("0x00:0x07", 0x03);
}

#[test]
fn wiegand_test_fails_with_matching_status() {
    // The motor has not been reversed for the second run.
    let mut host = Host::with("rpm=1000&calibration-silent=off");
    host.enter(0x02);
    assert!(!host.write("0x00:0x06", 0x02), "the first run comes first");
    assert!(!host.write("0x00:0x06", 0x05), "nothing to save");
    host.put("0x00:0x06", 0x01);
    host.wait(31.0);
    host.put("0x00:0x06", 0x02);
    host.wait(0.1);
    host.expect("0x00:0x07", 0x30);
    host.put("0x00:0x06", 0x03);
    host.expect("0x00:0x07", 0x00);
    // The sensor generates no pulses.
    let mut host = Host::with("rpm=1000&pulses=0,0");
    host.enter(0x02);
    host.put("0x00:0x06", 0x01);
    host.wait(31.0);
    host.expect("0x00:0x07", 0x07);
    host.expect("0x00:0x08", 0x01);
}

#[test]
fn motor_handle_turns_shaft() {
    let mut host = Host::with("rpm=60&position=0");
    let motor = host.encoder.motor();
    host.wait(1.0);
    assert_eq!(host.position(), Some((1, 0)));
    // The shaft follows the motor from the next request on.
    motor.set_rpm(-120.0);
    assert_eq!(host.position(), Some((1, 0)));
    host.wait(0.25);
    assert_eq!(host.position(), Some((0, 0x10000)));
    host.turn(6.0);
    assert_eq!(motor.rpm(), 6.0, "there is one speed, whoever sets it");
    for (set, turned) in [(20_000.0, 12_000.0), (f64::NEG_INFINITY, -12_000.0), (f64::NAN, -12_000.0)] {
        motor.set_rpm(set);
        assert_eq!(motor.rpm(), turned);
    }
    // A copy of the encoder has its own motor.
    let copy = host.encoder.clone();
    copy.motor().set_rpm(1.0);
    assert_eq!(motor.rpm(), -12_000.0);
}

#[test]
fn motor_reverses_when_procedure_waits() {
    let mut host = Host::with("rpm=-500&motor=reverse&cycles=0");
    host.enter(0x01);
    host.put("0x00:0x00", 0x01);
    host.wait(4.9);
    host.expect("0x00:0x01", 0x01);
    assert_eq!(host.encoder.motor().rpm(), -500.0);
    host.wait(0.1);
    host.expect("0x00:0x01", 0x02);
    assert_eq!(host.encoder.motor().rpm(), 500.0);
    host.put("0x00:0x00", 0x02);
    host.wait(5.0);
    host.expect("0x00:0x01", 0x22);
    assert_eq!(host.encoder.motor().rpm(), 500.0, "no request is pending");
    host.put("0x6A", 0x00);
    // After the calibration, the motor turns in the direction that the Wiegand test requires first. The test takes 61.8
    // s in each direction.
    host.enter(0x02);
    host.put("0x00:0x06", 0x01);
    host.wait(62.0);
    host.expect("0x00:0x07", 0x03);
    assert_eq!(host.encoder.motor().rpm(), -500.0);
    host.put("0x00:0x06", 0x02);
    host.wait(62.0);
    host.expect("0x00:0x07", 0x06);
    // A motor without automatic reversal keeps its direction.
    let mut host = Host::with("rpm=-500");
    host.enter(0x01);
    host.put("0x00:0x00", 0x01);
    host.wait(5.0);
    host.expect("0x00:0x01", 0x02);
    assert_eq!(host.encoder.motor().rpm(), -500.0);
}
