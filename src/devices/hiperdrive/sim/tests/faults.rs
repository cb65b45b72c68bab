//! Tests of how faults appear and how they are cleared (reference, sections 3, 4 and 7).

use super::*;
use crate::devices::hiperdrive::protocol::{ACKNOWLEDGE, State, UNLOCK};

/// Returns whether an operational drive reports a fault. Its status word is then 2AB8, apart from bits 10 and 12.
fn is_fault(bench: &mut Bench) -> bool {
    bench.actual(FIRST).status.to_u16() & 0x2AFF == 0x2AB8
}

/// Clears a fault with the control words from the reference. Each step must be complete before the next word is sent.
fn acknowledge(bench: &mut Bench) {
    for step in ACKNOWLEDGE {
        bench.word(step.word.to_u16());
        let status = bench.actual(FIRST).status;
        assert!(step.is_done(status), "{:04X}: {:04X}", step.word.to_u16(), status.to_u16());
    }
}

#[test]
fn blocked_drive_faults_and_recovers() {
    for (target, wall, code) in [
        (655_360, SpindleLoad { wall_above: Some(30_000.0), ..SpindleLoad::default() }, ErrorCode::BLOCK_FORWARD),
        (-655_360, SpindleLoad { wall_below: Some(-30_000.0), ..SpindleLoad::default() }, ErrorCode::BLOCK_REVERSE),
    ] {
        let mut bench = Bench::single();
        bench.load(wall);
        bench.start(target);
        bench.run(2000);
        assert!(is_fault(&mut bench), "{:04X}", bench.actual(FIRST).status.to_u16());
        assert_eq!((bench.error(), bench.position().abs()), (code, 30_000));
        assert_eq!(bench.read(197), Value::Number(1));
        acknowledge(&mut bench);
        assert_eq!(bench.read(197), Value::Number(0));
        assert_eq!(bench.error(), code, "the buffer keeps it");
        // The job was discarded. A new job away from the obstacle runs.
        bench.out[FIRST].target = 0;
        bench.words(&[0x0439, 0x0479]);
        bench.run(2000);
        assert_eq!(bench.position(), 0);
    }
}

/// A torque of 26 % is rounded up to 50 %, which is too low for a load of 60 %.
#[test]
fn insufficient_torque_causes_following_error() {
    let mut bench = Bench::single();
    bench.load(SpindleLoad { percent: 60, ..SpindleLoad::default() });
    bench.out[FIRST].torque = 26;
    bench.start(65_536);
    bench.run(1000);
    assert!(is_fault(&mut bench));
    assert_eq!((bench.error(), bench.position()), (ErrorCode::FOLLOWING_ERROR, 0));
    acknowledge(&mut bench);
    bench.out[FIRST].torque = 51;
    bench.words(&[0x0439, 0x0479]);
    bench.run(3000);
    assert_eq!(bench.position(), 65_536);
}

/// At an ambient temperature of 50 °C and with 40 K of self-heating at full torque, the drive exceeds 80 °C after 60 s
/// · ln 4 = 83 s of motion.
#[test]
fn hot_drive_faults() {
    let hot = SpindleLoad { ambient: 50.0, ..SpindleLoad::default() };
    let mut bench =
        Bench::new(StationConfig { drives: vec![Some((Variant::new(13), hot))], ..StationConfig::default() });
    assert_eq!(bench.read(119), Value::Number(50));
    bench.enable();
    bench.words(&[0x1419, 0x1459]);
    bench.run(80_000);
    assert_eq!(bench.actual(FIRST).status.state(), State::Moving);
    bench.run(5000);
    assert!(is_fault(&mut bench));
    assert_eq!(bench.error(), ErrorCode::OVER_TEMPERATURE);
}

/// A target beyond the limits causes a fault, whose error becomes the newest one (reference, section 9).
#[test]
fn target_beyond_limits_faults() {
    let mut bench = Bench::single();
    bench.enable();
    // A target of 512 turns, where the limit is 511.
    bench.out[FIRST].target = 33_554_432;
    bench.words(&[0x0439, 0x0479]);
    assert!(is_fault(&mut bench));
    assert_eq!((bench.error(), bench.position()), (ErrorCode::INVALID_TARGET, 0));
    let now = bench.now;
    bench.drive().inject_error(now, ErrorCode::OVER_CURRENT);
    assert_eq!(bench.error(), ErrorCode::OVER_CURRENT);
    assert_eq!(bench.read(109), Value::Number(0x8503));
    assert_eq!((bench.read(110), bench.read(197)), (Value::Number(0), Value::Number(2)));
    assert_ne!(bench.actual(FIRST).status.to_u16() & 0x4000, 0, "over-current has a separate bit");
    acknowledge(&mut bench);
    assert_eq!(bench.actual(FIRST).status.to_u16() & 0x4080, 0);
    (0..20).for_each(|_| bench.drive().inject_error(now, ErrorCode::SINCOS));
    assert_eq!(bench.read(115), Value::Number(0x8502));
}

/// Below the operational state, an error causes only a warning, which 197 = 0 clears.
#[test]
fn switched_off_drive_warns() {
    let mut bench = Bench::single();
    let now = bench.now;
    bench.drive().inject_error(now, ErrorCode::RS485);
    assert_eq!(bench.actual(FIRST).status.to_u16(), 0x2AB0);
    assert_eq!(bench.write(197, 0), Ok(()));
    assert_eq!(bench.actual(FIRST).status.to_u16(), 0x2A30);
}

/// If bit 0 was cleared before the acknowledgement, releasing the lock takes another falling edge (reference, section
/// 3).
#[test]
fn lock_release_needs_edge() {
    let mut bench = Bench::single();
    bench.enable();
    let now = bench.now;
    bench.drive().inject_error(now, ErrorCode::CONTROL_LOOP);
    assert_eq!(bench.words(&[0x0480, 0x0400]), 0x2A70);
    assert_eq!(bench.word(0x0400), 0x2A70);
    assert_eq!(bench.words(&UNLOCK.map(|step| step.word.to_u16())), 0x2A31);
}

/// The master is considered lost after 40 ms without a packet. Braking takes 100 ms, no matter how often the state is
/// read (reference, sections 3 and 7).
#[test]
fn lost_master_stops_all_drives() {
    for looks in [&[][..], &[10, 39, 40, 41, 200]] {
        let mut bench = Bench::single();
        bench.start(655_360);
        bench.run(500);
        let at = |ms| Duration::from_millis(ms);
        // The last packet arrived 10 ms ago.
        let last = bench.now - at(10);
        for ms in looks {
            assert_eq!(bench.station.is_open(last + at(*ms)), *ms < 40, "{ms} ms");
        }
        let braked = bench.station.image(last + at(140)).drives[FIRST];
        let later = bench.station.image(last + at(5000)).drives[FIRST];
        assert_eq!((braked.speed, later.position), (0, braked.position));
        assert_eq!(later.status.state(), State::Fault);
        bench.now = last + at(5000);
        assert_eq!(bench.error(), ErrorCode::CONNECTION_TIMEOUT);
        // Data received without a connection are dropped. After the next connection, an acknowledgement is required.
        bench.run(500);
        assert!(!bench.station.is_open(bench.now));
        bench.station.open(bench.now, at(40));
        bench.out[FIRST].control = 0x0439;
        bench.run(500);
        assert_eq!(bench.position(), later.position);
        acknowledge(&mut bench);
    }
}

/// An idle master stops the drive but is not considered lost. A master that closes the connection is.
#[test]
fn idle_master_stops_drive_without_fault() {
    let mut bench = Bench::single();
    bench.start(655_360);
    bench.run(500);
    for _ in 0..20 {
        let image = OutputImage { drives: bench.out.clone(), pkw: None };
        bench.station.handle_process_data(bench.now, &image, false);
        bench.now = bench.now + Duration::from_millis(10);
    }
    assert_eq!(bench.actual(FIRST).status.to_u16(), 0x2A30);
    assert!(bench.station.is_open(bench.now));
    bench.enable();
    bench.station.close(bench.now);
    assert_eq!(bench.actual(FIRST).status.state(), State::Fault);
    assert!(!bench.station.is_open(bench.now));
}
