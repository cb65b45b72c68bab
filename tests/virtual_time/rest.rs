//! Sine and cosine at standstill: they are read together with the position, and only while the shaft does not move.

use encoder_studio::devices::hiperface::jobs::{HiperfaceJob, HiperfaceOutput, JobError};
use encoder_studio::devices::hiperface::procedures::{Error, RestPosition, Signals};
use encoder_studio::devices::hiperface::protocol::{Command, StatusCode};
use encoder_studio::link::Clock;

use crate::support::Desk;

fn rest(desk: &mut Desk) -> Result<RestPosition, JobError> {
    match desk.run(HiperfaceJob::Rest)? {
        HiperfaceOutput::Rest(rest) => Ok(rest),
        other => panic!("{other:?}"),
    }
}

/// At three quarters of a period, the counts are 409 and 511. On the scale, 511.5 is 0 V and 1023 is 5 V.
#[test]
fn reads_channels_between_positions() {
    let mut desk = Desk::new("position=3224");
    let RestPosition { raw, valid, signals } = rest(&mut desk).unwrap();
    assert_eq!((raw, valid), (3224, true));
    let Signals { sine_v, cosine_v } = signals.unwrap();
    assert!((sine_v + 0.500_978).abs() < 1e-6 && (cosine_v + 0.002_444).abs() < 1e-6, "{sine_v} {cosine_v}");
    let tap = desk.tap();
    assert_eq!((tap.count(Command::ReadPosition), tap.count(Command::ReadAnalogue)), (4, 8));
    assert_eq!(tap.count(Command::SetPosition) + tap.count(Command::StoreData), 0);
}

#[test]
fn rejects_moving_shaft_and_missing_position() {
    for rpm in ["60", "-0.5"] {
        let error = rest(&mut Desk::new(&format!("rpm={rpm}"))).unwrap_err();
        assert!(matches!(error, JobError::Device(Error::Moving { .. })), "{error:?}");
    }
    let error = rest(&mut Desk::new("rpm=9000")).unwrap_err();
    assert!(matches!(&error, JobError::Device(error) if error.is_rejection(StatusCode::TOO_FAST)), "{error:?}");
}

/// The shaft turns so slowly that it appears to be at rest for 0.2 s, but not for the whole reading.
#[test]
fn detects_creeping_shaft_at_end() {
    let mut desk = Desk::new("position=100");
    let now = desk.clock.now();
    // At 6.7 steps of 1/4096 turn per second, the shaft moves by one step while it is watched, and by two more until
    // the end.
    desk.bus().encoder_mut(0).unwrap().set_rpm(now, 6.7 * 60.0 / 4096.0);
    let error = rest(&mut desk).unwrap_err();
    assert!(matches!(error, JobError::Device(Error::Moving { .. })), "{error:?}");
    assert_eq!(desk.tap().count(Command::ReadAnalogue), 8, "it stood still at first");
}
