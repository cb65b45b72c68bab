//! Drives that ignore their limits or turn the wrong way, as the dead-man control detects from their positions (issues
//! 21.4 and 21.5).
//!
//! A turn has 65536 steps, and a degree 182.04. At 35 rpm, a drive makes 38.2 steps per millisecond, or 382 in an
//! interval of 10 ms.

use encoder_studio::devices::hiperdrive::procedures::dead_man::{
    ActionEnd, MotionRejection, MotionRequest, Permit, Phase, SpeedTorque,
};
use encoder_studio::devices::hiperdrive::protocol::{Direction, RunEnd, StatusBit};
use encoder_studio::devices::hiperdrive::sim::{DriveDefect, SpindleLoad};

use super::bench::Bench;
use super::{FULL, TURN, to};

const DEGREE: i32 = 183;
/// Steps per interval at full speed: 35 rpm · 65536 steps / 60 s / 100 intervals per second, rounded up.
const FULL_SPEED_STEPS_PER_INTERVAL: i32 = 383;
const LIMITS: (i32, i32) = (-TURN, TURN);

fn jog(direction: Direction, effort: SpeedTorque, outward: bool) -> MotionRequest {
    MotionRequest::Jog { direction, effort, outward }
}

fn run(direction: Direction, end: RunEnd) -> MotionRequest {
    MotionRequest::Run { direction, end, effort: FULL }
}

/// Returns a drive with the given defect and limits of ±1 turn.
fn bench(defect: Option<DriveDefect>) -> Bench {
    let mut bench = Bench::new();
    bench.write(158, LIMITS.0.into());
    bench.write(160, LIMITS.1.into());
    bench.permit = Permit::for_range(LIMITS.0, LIMITS.1);
    bench.load(SpindleLoad { defect, ..SpindleLoad::default() });
    bench
}

/// Returns a drive at rest outside its limits. `beyond` is the number of steps above the upper limit, or below the
/// lower one if negative.
fn bench_outside_limits(beyond: i32, defect: Option<DriveDefect>) -> Bench {
    let mut bench = bench(None);
    bench.act(to(if beyond > 0 { TURN } else { -TURN }));
    assert_eq!(bench.until_over(), ActionEnd::Arrived);
    bench.run(100);
    // The values of the limits change, as they do when another master writes them.
    let (low, high) = if beyond > 0 { (-TURN, TURN - beyond) } else { (-TURN - beyond, TURN) };
    bench.permit = Permit::for_range(low, high);
    bench.load(SpindleLoad { defect, ..SpindleLoad::default() });
    bench
}

/// Runs until the control word commands no motion. Returns the number of intervals since the first report of a position
/// beyond `limit`, and the position at the end.
fn intervals_past_limit(bench: &mut Bench, limit: i32) -> (u32, i32) {
    let mut past = None;
    for _ in 0..6000 {
        let position = bench.position();
        let sent = bench.cycle();
        let is_past = if limit > 0 { position > limit } else { position < limit };
        if is_past {
            past = Some(past.map_or(0, |count: u32| count + 1));
        }
        if let (Some(past), true) = (past, sent.control.is_at_rest()) {
            return (past, position);
        }
    }
    panic!("it is never stopped: {:?}", bench.man.phase());
}

/// The report shows a position beyond a limit. The next packet commands no motion, even though the drive continues
/// (issue 21.4).
#[test]
fn next_packet_stops_drive_overrunning_limits() {
    for effort in [SpeedTorque::DEFAULT_JOG, FULL] {
        for (direction, limit) in [(Direction::Clockwise, TURN), (Direction::Counterclockwise, -TURN)] {
            for wish in [jog(direction, effort, false), MotionRequest::Run { direction, end: RunEnd::RangeEnd, effort }]
            {
                let mut bench = bench(Some(DriveDefect::RunsOn));
                bench.act(wish);
                let (intervals, position) = intervals_past_limit(&mut bench, limit);
                assert_eq!(intervals, 0, "{wish:?}");
                let beyond = (position - limit).abs();
                assert!(beyond <= FULL_SPEED_STEPS_PER_INTERVAL, "{wish:?}: {beyond} steps beyond");
                let (_, ended) = bench.man.last_end().unwrap();
                let expected = if beyond <= DEGREE { ActionEnd::RangeEnd } else { ActionEnd::Beyond { position } };
                assert_eq!(ended, expected, "{wish:?}");
                assert!(bench.actual().status.is_set(StatusBit::PositionLimit));
                bench.run(500);
                assert!(!bench.moves(), "{wish:?}");
            }
        }
    }
}

/// Status bit 15 also ends a run, even if the position is within the limits known to the program (issue 21.4).
#[test]
fn bit_15_ends_run() {
    let mut bench = bench(Some(DriveDefect::RunsOn));
    bench.permit = Permit::for_range(-9 * TURN, 9 * TURN);
    bench.act(jog(Direction::Clockwise, FULL, false));
    let (intervals, position) = intervals_past_limit(&mut bench, TURN);
    assert_eq!((intervals, bench.man.last_end().unwrap().1), (0, ActionEnd::Beyond { position }));
}

/// A run that ignores the limits is not checked against them (issue 21.4, case *endless run*).
#[test]
fn endless_run_is_not_monitored() {
    let mut bench = bench(None);
    bench.permit.endless = true;
    bench.act(run(Direction::Clockwise, RunEnd::Endless));
    bench.run(5000);
    assert!(bench.position() > 2 * TURN && matches!(bench.man.phase(), Phase::Moving(_)), "{:?}", bench.man.last_end());
}

/// The next packet stops the motion (issue 21.4, case *unread limits*).
#[test]
fn unknown_limits_end_run() {
    let mut bench = bench(None);
    bench.act(jog(Direction::Clockwise, FULL, false));
    bench.run(1000);
    bench.permit = Permit::default();
    assert!(bench.cycle().control.is_at_rest());
    assert!(matches!(bench.man.last_end(), Some((_, ActionEnd::Locked(_)))), "{:?}", bench.man.last_end());
}

/// A request to move further outward is rejected before anything is sent (issue 21.4, case *already outside*).
#[test]
fn allows_only_inward_motion_from_outside() {
    for (beyond, inward, outward) in [
        (5000, Direction::Counterclockwise, Direction::Clockwise),
        (-5000, Direction::Clockwise, Direction::Counterclockwise),
    ] {
        for wish in [jog(outward, FULL, false), run(outward, RunEnd::RangeEnd)] {
            let mut bench = bench_outside_limits(beyond, None);
            let (low, high) = bench.permit.limits.unwrap();
            bench.act(wish);
            let position = bench.position();
            assert_eq!(
                bench.until_over(),
                ActionEnd::Refused(MotionRejection::Outward { position, low, high }),
                "{wish:?}"
            );
            bench.run(300);
            assert_eq!(bench.position(), position, "{wish:?}");
        }
        for wish in [jog(inward, FULL, false), run(inward, RunEnd::RangeEnd)] {
            let mut bench = bench_outside_limits(beyond, None);
            bench.act(wish);
            bench.run(1500);
            assert!(matches!(bench.man.phase(), Phase::Moving(_)), "{wish:?}: {:?}", bench.man.last_end());
            let (low, high) = bench.permit.limits.unwrap();
            assert!((low..=high).contains(&bench.position()), "{wish:?}: it is back in");
        }
        // A move to a target within the limits is also inward motion.
        let mut bench = bench_outside_limits(beyond, None);
        bench.act(to(0));
        assert_eq!(bench.until_over(), ActionEnd::Arrived);
    }
}

/// Status bit 15 reports a drive as outside its limits although its position is well inside, so the way back is
/// unknown. Nothing moves unless the user permits it for one press of the button (issue 21.4).
#[test]
fn bit_15_alone_blocks_motion_without_permission() {
    let ways = [Direction::Clockwise, Direction::Counterclockwise];
    let jogs = ways.map(|way| jog(way, FULL, false));
    let runs = ways.map(|way| run(way, RunEnd::RangeEnd));
    for wish in jogs.into_iter().chain(runs).chain([to(0), to(TURN / 2), MotionRequest::Step { by: 100, effort: FULL }])
    {
        let mut bench = bench(Some(DriveDefect::SaysOutside));
        bench.act(wish);
        let (low, high) = LIMITS;
        let expected = ActionEnd::Refused(MotionRejection::Unclear { position: 0, low, high });
        assert_eq!(bench.until_over(), expected, "{wish:?}");
        bench.run(300);
        assert_eq!((bench.position(), bench.moves()), (0, false), "{wish:?}");
    }
    for way in ways {
        let mut bench = bench(Some(DriveDefect::SaysOutside));
        bench.act(jog(way, FULL, true));
        bench.run(1500);
        assert!(bench.position().abs() > 1000 && matches!(bench.man.phase(), Phase::Moving(_)), "{way:?}");
        assert_eq!((bench.man.last_setpoint().speed.get(), bench.man.last_setpoint().torque.get()), (10, 25));
        // A drive whose position is beyond the limits is stopped like any other.
        bench.permit = Permit::for_range(-bench.position().abs(), bench.position().abs());
        bench.run(30);
        assert!(matches!(bench.man.last_end(), Some((_, ActionEnd::Beyond { .. }))), "{:?}", bench.man.last_end());
    }
    // Within one degree of a limit, the direction is clear.
    for (limits, free) in [((-TURN, 182), Direction::Counterclockwise), ((-182, TURN), Direction::Clockwise)] {
        for way in ways {
            let mut bench = bench(Some(DriveDefect::SaysOutside));
            bench.permit = Permit::for_range(limits.0, limits.1);
            bench.act(jog(way, SpeedTorque::DEFAULT_JOG, false));
            bench.run(1000);
            assert_eq!(matches!(bench.man.phase(), Phase::Moving(_)), way == free, "{limits:?} {way:?}");
        }
    }
}

/// Permitted outward motion is slow and weak, whatever is requested, and ends with that press (issue 21.4).
#[test]
fn permits_outward_motion_for_one_press() {
    let mut bench = bench_outside_limits(5000, None);
    // The drive's own limit is further outside than the permitted one.
    bench.write(160, (2 * TURN).into());
    let stood = bench.position();
    bench.act(jog(Direction::Clockwise, FULL, true));
    bench.run(1500);
    assert!(bench.position() > stood + 1000 && matches!(bench.man.phase(), Phase::Moving(_)));
    assert_eq!((bench.man.last_setpoint().speed.get(), bench.man.last_setpoint().torque.get()), (10, 25));
    bench.act(MotionRequest::Stop);
    bench.run(500);
    bench.act(jog(Direction::Clockwise, FULL, false));
    assert!(matches!(bench.until_over(), ActionEnd::Refused(MotionRejection::Outward { .. })));
    // The permission is not needed here: from inside, the limits apply.
    let mut bench = super::watch::bench(Some(DriveDefect::RunsOn));
    bench.act(jog(Direction::Clockwise, FULL, true));
    assert_eq!(intervals_past_limit(&mut bench, TURN).0, 0);
}

/// The drive counts in the opposite direction, so it moves outward. It is stopped within a degree (issue 21.4).
#[test]
fn stops_reversed_drive_moving_outward() {
    let mut bench = bench_outside_limits(5000, Some(DriveDefect::Reversed));
    bench.write(160, (2 * TURN).into());
    let stood = bench.position();
    bench.act(jog(Direction::Counterclockwise, SpeedTorque::DEFAULT_JOG, false));
    let ActionEnd::WrongWay { position } = bench.until_over() else { panic!("{:?}", bench.man.last_end()) };
    assert!(
        position > stood + DEGREE && position <= stood + DEGREE + FULL_SPEED_STEPS_PER_INTERVAL / 10 + 1,
        "{position}"
    );
    // With permission, the other direction moves the drive inward.
    bench.run(500);
    bench.act(jog(Direction::Clockwise, SpeedTorque::DEFAULT_JOG, true));
    bench.run(1500);
    assert!(bench.position() < stood);
}

/// The drive passes a limit while it brakes. The stop continues and keeps its reason (issue 21.4, case *overrun while
/// braking*).
#[test]
fn braking_overrun_keeps_stop_reason() {
    let mut bench = bench(Some(DriveDefect::RunsOn));
    bench.act(jog(Direction::Clockwise, FULL, false));
    // At 35 rpm, it brakes within 0.1 s and moves on by 1911 steps.
    while bench.position() < TURN - 1000 {
        bench.cycle();
    }
    let act = bench.act(MotionRequest::Stop) - 1;
    assert!(bench.cycle().control.is_at_rest());
    bench.run(500);
    assert!(bench.position() > TURN, "{}", bench.position());
    assert_eq!(bench.man.last_end(), Some((act, ActionEnd::Stopped)));
    assert!(!bench.moves());
}

/// The drive is stopped at the first report that shows more than one degree in the wrong direction (issue 21.5).
#[test]
fn stops_move_in_wrong_direction() {
    for target in [TURN / 2, -TURN / 2] {
        let mut bench = bench(Some(DriveDefect::Reversed));
        bench.act(to(target));
        let (intervals, _) = intervals_past_limit(&mut bench, -target.signum() * DEGREE);
        assert_eq!(intervals, 0, "{target}");
        assert!(matches!(bench.man.last_end(), Some((_, ActionEnd::WrongWay { .. }))), "{:?}", bench.man.last_end());
        assert!(bench.position().abs() <= DEGREE + 2 * FULL_SPEED_STEPS_PER_INTERVAL, "{}", bench.position());
    }
}

/// The drive is stopped at the first report that shows more than one degree in the wrong direction (issue 21.5).
#[test]
fn stops_jog_in_wrong_direction() {
    for (direction, sign) in [(Direction::Clockwise, 1), (Direction::Counterclockwise, -1)] {
        for wish in [jog(direction, FULL, false), run(direction, RunEnd::RangeEnd)] {
            let mut bench = bench(Some(DriveDefect::Reversed));
            bench.act(wish);
            let (intervals, position) = intervals_past_limit(&mut bench, -sign * DEGREE);
            assert_eq!((intervals, bench.man.last_end().unwrap().1), (0, ActionEnd::WrongWay { position }), "{wish:?}");
        }
    }
}

/// The drive is stopped at its target, or beyond the limit if the target is a limit (issue 21.5).
#[test]
fn stops_move_passing_target() {
    for target in [TURN / 2, TURN, -TURN] {
        let mut bench = bench(Some(DriveDefect::RunsOn));
        bench.act(to(target));
        // The drive's accuracy is 2.5°, so it may pass its target by three whole degrees, but a limit only by one.
        let degrees = if target.abs() == TURN { 1 } else { 3 };
        let (intervals, position) = intervals_past_limit(&mut bench, target + target.signum() * degrees * DEGREE);
        assert_eq!(intervals, 0, "{target}: stopped at {position}");
        let beyond = ActionEnd::Beyond { position };
        let wrong_way = ActionEnd::WrongWay { position };
        let how = bench.man.last_end().unwrap().1;
        assert!(how == beyond || how == wrong_way, "{target}: {how:?}");
        bench.run(500);
        assert!(!bench.moves());
    }
}

/// A drive without a defect is never stopped, even at its limits or with late reports.
#[test]
fn healthy_drive_reaches_every_target() {
    let mut dice = fastrand::Rng::with_seed(21);
    let mut bench = bench(None);
    for _ in 0..60 {
        bench.late = dice.usize(..4);
        let target = [LIMITS.0, LIMITS.1, 0, dice.i32(LIMITS.0..=LIMITS.1)][dice.usize(..4)];
        bench.act(to(target));
        assert_eq!(bench.until_over(), ActionEnd::Arrived, "{target}");
        assert_eq!(bench.position(), target);
        if dice.bool() {
            let direction = if dice.bool() { Direction::Clockwise } else { Direction::Counterclockwise };
            bench.act(jog(direction, FULL, false));
            bench.run(dice.u64(..8000));
            bench.act(MotionRequest::Stop);
            bench.run(500);
            let how = bench.man.last_end().unwrap().1;
            assert!(matches!(how, ActionEnd::Stopped | ActionEnd::RangeEnd), "{how:?}");
        }
    }
}
