//! The dead-man control with virtual drives: user actions and faults, each followed by the stop of the drive.

mod any;
mod bench;
mod ladder;
mod model;
mod watch;

use encoder_studio::devices::hiperdrive::procedures::dead_man::{
    ActionEnd, MotionKind, MotionLock, MotionRejection, MotionRequest, Permit, Phase, SpeedTorque, TargetState,
};
use encoder_studio::devices::hiperdrive::protocol::{Direction, ErrorCode, Percent, RunEnd};
use encoder_studio::devices::hiperdrive::sim::SpindleLoad;

use bench::Bench;

const FULL: SpeedTorque = SpeedTorque { speed: Percent::FULL, torque: Percent::FULL };
const TURN: i32 = 65_536;

fn jog(direction: Direction) -> MotionRequest {
    MotionRequest::Jog { direction, effort: SpeedTorque::DEFAULT_JOG, outward: false }
}

fn run_endless() -> MotionRequest {
    MotionRequest::Run { direction: Direction::Clockwise, end: RunEnd::Endless, effort: FULL }
}

fn to(target: i32) -> MotionRequest {
    MotionRequest::Move { target, effort: FULL }
}

/// Returns the control words in the order sent, without repetitions.
fn words(bench: &mut Bench) -> String {
    let words: Vec<String> = bench.take_words().iter().map(|word| format!("{word:04X}")).collect();
    words.join(" ")
}

/// A move sends the words 0000, 0400, 0401, 0409, 0439 and 0479, and the next move 0439. At rest, bits 4 and 5 are
/// clear (reference 3).
#[test]
fn published_words_move_to_target() {
    let mut bench = Bench::new();
    bench.run(50);
    assert_eq!(words(&mut bench), "0000");
    bench.act(to(163_840));
    assert_eq!(bench.until_over(), ActionEnd::Arrived);
    assert_eq!(words(&mut bench), "0000 0400 0401 0409 0439 0479 0449");
    assert_eq!((bench.position(), bench.man.phase()), (163_840, Phase::Idle));
    bench.run(100);
    bench.act(MotionRequest::Step { by: -TURN, effort: FULL });
    assert_eq!(bench.until_over(), ActionEnd::Arrived);
    assert_eq!(words(&mut bench), "0449 0479 0439 0409");
    assert_eq!(bench.position(), 163_840 - TURN);
    bench.act(MotionRequest::Lead(TargetState::Off));
    assert_eq!(bench.until_over(), ActionEnd::Done);
    assert_eq!((words(&mut bench).as_str(), bench.status()), ("0409 0000", 0x2A30));
}

/// A clockwise jog sends 1459 and 1419, and a counterclockwise one 1449 and 1409. Speed mode ends with 0400 (reference
/// 3).
#[test]
fn jog_runs_while_held() {
    let mut bench = Bench::new();
    bench.act(MotionRequest::Lead(TargetState::Enabled));
    assert_eq!(bench.until_over(), ActionEnd::Done);
    words(&mut bench);
    for (direction, sent, sign) in [
        (Direction::Clockwise, "0409 1419 1459 1419 0400", 1),
        (Direction::Counterclockwise, "0400 0401 0409 1409 1449 1409 0400", -1),
    ] {
        bench.act(jog(direction));
        bench.run(1000);
        let phase = bench.man.phase();
        assert!(
            matches!(phase, Phase::Moving(MotionKind::Run { direction: way, .. }) if way == direction),
            "{phase:?}"
        );
        // 10 % of 35 rpm, in tenths of a rpm.
        assert_eq!(bench.actual().speed, sign * 35);
        assert_eq!((bench.man.last_setpoint().speed.get(), bench.man.last_setpoint().torque.get()), (10, 25));
        bench.act(MotionRequest::Stop);
        bench.run(500);
        assert_eq!(words(&mut bench), sent);
        assert_eq!(
            (bench.man.phase(), bench.man.last_end().map(|ended| ended.1)),
            (Phase::Idle, Some(ActionEnd::Stopped))
        );
        let stood = bench.position();
        assert!(stood * i32::from(sign) > 0 || sign < 0, "{stood}");
        assert_eq!(bench.man.last_setpoint().target, stood, "the target is where it stands");
        bench.run(1000);
        assert_eq!((bench.position(), bench.status()), (stood, 0x2A31));
    }
}

/// The button is pressed and released in quick succession. A jog must not turn into a move.
#[test]
fn repeated_jogs_start_no_job() {
    let mut bench = Bench::new();
    for times in 1..60 {
        bench.act(jog(if times % 3 == 0 { Direction::Clockwise } else { Direction::Counterclockwise }));
        bench.run(times * 10);
        bench.act(MotionRequest::Stop);
        bench.run(600 / times);
    }
    bench.run(500);
    let stood = bench.position();
    bench.run(2000);
    assert_eq!((bench.position(), bench.man.phase()), (stood, Phase::Idle));
    bench.act(to(stood + 1000));
    assert_eq!(bench.until_over(), ActionEnd::Arrived);
    assert_eq!(bench.position(), stood + 1000);
}

#[test]
fn pauses_and_resumes_job() {
    let mut bench = Bench::new();
    let job = bench.act(to(3 * TURN));
    bench.run(1000);
    let pause = bench.act(MotionRequest::Pause);
    bench.run(300);
    assert_eq!(bench.man.phase(), Phase::Paused { target: 3 * TURN });
    assert_eq!((bench.status() & 0x2000, bench.man.action_number()), (0x2000, pause));
    assert!(job < pause && bench.man.last_end().is_none());
    let waited = bench.position();
    bench.run(1000);
    assert_eq!(bench.position(), waited);
    bench.act(MotionRequest::Resume);
    assert_eq!(bench.until_over(), ActionEnd::Arrived);
    assert_eq!(bench.position(), 3 * TURN);
    // At this time, there is nothing to pause or resume.
    bench.act(MotionRequest::Pause);
    assert_eq!(bench.until_over(), ActionEnd::Refused(MotionRejection::NothingToPause));
    bench.act(MotionRequest::Resume);
    assert_eq!(bench.until_over(), ActionEnd::Refused(MotionRejection::NothingToResume));
    // A move that waits to start is discarded if it is stopped.
    bench.act(to(0));
    bench.run(1000);
    bench.act(MotionRequest::Pause);
    bench.run(300);
    bench.act(MotionRequest::Stop);
    bench.run(300);
    bench.act(MotionRequest::Resume);
    assert_eq!(bench.until_over(), ActionEnd::Refused(MotionRejection::NothingToResume));
    // A pause ends a jog instead of pausing it.
    bench.act(jog(Direction::Clockwise));
    bench.run(500);
    bench.act(MotionRequest::Pause);
    bench.run(500);
    assert_eq!(bench.man.phase(), Phase::Idle);
}

/// A request rejected by the dead-man control never reaches the drive.
#[test]
fn rejects_invalid_requests() {
    let none = SpeedTorque { speed: Percent::NONE, ..FULL };
    let permit = |limits, locks: &[MotionLock]| Permit { limits, locks: locks.to_vec(), ..Permit::for_range(0, 0) };
    let free = || permit(Some((-TURN, TURN)), &[]);
    let outside = |target| MotionRejection::Outside { target, low: -TURN, high: TURN };
    for (label, wish, permit, refusal) in [
        ("not read", to(1), Permit::default(), MotionRejection::Locked(MotionLock::Unread)),
        ("limits not read", to(1), permit(None, &[]), MotionRejection::Locked(MotionLock::Unread)),
        (
            "no time-out",
            jog(Direction::Clockwise),
            permit(Some((0, 9)), &[MotionLock::NoTimeout]),
            MotionRejection::Locked(MotionLock::NoTimeout),
        ),
        (
            "limits",
            to(1),
            permit(Some((0, 9)), &[MotionLock::LimitsUnconfirmed]),
            MotionRejection::Locked(MotionLock::LimitsUnconfirmed),
        ),
        (
            "not requested",
            to(1),
            permit(Some((0, 9)), &[MotionLock::NotRequested]),
            MotionRejection::Locked(MotionLock::NotRequested),
        ),
        ("above", to(TURN + 1), free(), outside(TURN + 1)),
        ("below", to(i32::MIN), free(), outside(i32::MIN)),
        ("a step beyond", MotionRequest::Step { by: i32::MAX, effort: FULL }, free(), outside(i32::MAX)),
        ("no speed", MotionRequest::Move { target: 1, effort: none }, free(), MotionRejection::NoEffort),
        ("endless", run_endless(), free(), MotionRejection::Endless),
    ] {
        let mut bench = Bench::new();
        bench.permit = permit;
        bench.act(wish);
        assert_eq!(bench.until_over(), ActionEnd::Refused(refusal), "{label}");
        bench.run(500);
        assert_eq!((words(&mut bench).as_str(), bench.position()), ("0000", 0), "{label}");
    }
    let mut bench = Bench::new();
    bench.permit = Permit { endless: true, ..free() };
    bench.act(run_endless());
    bench.run(1000);
    assert_eq!(words(&mut bench), "0400 0401 0409 1439 1479");
}

/// Nothing moves until the user has acknowledged the fault, and the acknowledgement does not move anything either.
#[test]
fn acknowledges_fault_before_motion() {
    let mut bench = Bench::new();
    bench.act(to(5 * TURN));
    bench.run(1000);
    words(&mut bench);
    bench.fail(ErrorCode::OVER_CURRENT);
    assert_eq!(bench.until_over(), ActionEnd::Fault);
    bench.run(1000);
    assert_eq!(words(&mut bench), "0479 0469 0401");
    let stood = bench.position();
    bench.act(to(0));
    assert_eq!(bench.until_over(), ActionEnd::Refused(MotionRejection::Fault));
    bench.act(MotionRequest::Lead(TargetState::Enabled));
    assert_eq!(bench.until_over(), ActionEnd::Refused(MotionRejection::Fault));
    words(&mut bench);
    bench.act(MotionRequest::Acknowledge);
    assert_eq!(bench.until_over(), ActionEnd::Done);
    assert_eq!((words(&mut bench).as_str(), bench.status()), ("0401 0481 0401 0400", 0x2A31));
    bench.run(1000);
    assert_eq!(bench.position(), stood);
    bench.act(to(0));
    assert_eq!(bench.until_over(), ActionEnd::Arrived);
}

#[test]
fn blocked_drive_ends_motion() {
    let mut bench = Bench::new();
    bench.load(SpindleLoad { wall_above: Some(f64::from(TURN)), ..SpindleLoad::default() });
    bench.act(to(2 * TURN));
    assert_eq!(bench.until_over(), ActionEnd::Fault);
    assert_eq!(bench.position(), TURN);
}

/// The action ends with the run.
#[test]
fn run_stops_at_end_of_range() {
    let mut bench = Bench::new();
    bench.write(160, TURN.into());
    bench.act(MotionRequest::Run { direction: Direction::Clockwise, end: RunEnd::RangeEnd, effort: FULL });
    assert_eq!(bench.until_over(), ActionEnd::RangeEnd);
    bench.run(500);
    assert_eq!((bench.position(), bench.status(), bench.man.phase()), (TURN, 0x2A31, Phase::Idle));
    // The run is started again where no range is left.
    bench.act(MotionRequest::Run { direction: Direction::Clockwise, end: RunEnd::RangeEnd, effort: FULL });
    assert_eq!(bench.until_over(), ActionEnd::RangeEnd);
}

/// While switch S3 selects a drive, bus commands have no effect.
#[test]
fn reports_unresponsive_drive() {
    let mut bench = Bench::new();
    bench.station.set_drive_select_switch(bench.now, 1);
    bench.act(to(TURN));
    let ended = bench.until_over();
    assert!(matches!(ended, ActionEnd::NoAnswer(_)), "{ended:?}");
    bench.station.set_drive_select_switch(bench.now, 0);
    bench.run(3000);
    assert_eq!((bench.status(), bench.position()), (0x2A30, 0));
}

/// A drive that briefly loses its supply restarts while the earlier words are still being sent.
#[test]
fn restarted_drive_does_not_resume_job() {
    for after in [100, 110, 500, 1500] {
        let mut bench = Bench::new();
        bench.act(to(5 * TURN));
        bench.run(after);
        // 47 = −4 resets the drives, and the connection remains open.
        bench.write(47, -4);
        let ended = bench.until_over();
        assert!(matches!(ended, ActionEnd::Left(_) | ActionEnd::NoAnswer(_)), "{after} ms: {ended:?}");
        let stood = bench.position();
        bench.run(3000);
        assert_eq!(bench.position(), stood, "{after} ms");
        assert_eq!(bench.status() & 0x0004, 0, "it is not enabled");
    }
}
