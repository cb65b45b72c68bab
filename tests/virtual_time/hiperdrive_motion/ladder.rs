//! Every event that ends a motion. The same call sends the stop word, and stronger ones follow while the drive still
//! moves.

use encoder_studio::devices::hiperdrive::procedures::dead_man::{
    ActionEnd, MotionLock, MotionRequest, Phase, StopLevel, TargetState,
};
use encoder_studio::devices::hiperdrive::protocol::{Direction, DriveNumber};
use proptest::prelude::*;

use super::bench::Bench;
use super::{TURN, jog, to};

/// An event that ends a motion.
type Cause = fn(&mut Bench);

const CAUSES: [(&str, Cause, ActionEnd); 7] = [
    (
        "stop",
        |bench| {
            bench.act(MotionRequest::Stop);
        },
        ActionEnd::Stopped,
    ),
    (
        "rest",
        |bench| {
            bench.act(MotionRequest::Rest);
        },
        ActionEnd::Stopped,
    ),
    (
        "another drive",
        |bench| {
            bench.act(MotionRequest::Move { target: 0, effort: super::FULL });
            bench.intent.drive = DriveNumber::new(2).unwrap();
        },
        ActionEnd::Replaced,
    ),
    (
        "led elsewhere",
        |bench| {
            bench.act(MotionRequest::Lead(TargetState::Off));
        },
        ActionEnd::Replaced,
    ),
    (
        "locked",
        |bench| bench.permit.locks.push(MotionLock::LimitsUnconfirmed),
        ActionEnd::Locked(MotionLock::LimitsUnconfirmed),
    ),
    ("an older act", |bench| bench.intent.number -= 1, ActionEnd::Stopped),
    ("the same act with another wish", |bench| bench.intent.request = to(9), ActionEnd::Replaced),
];

#[test]
fn stops_drive_alike_for_every_cause() {
    for wish in [to(9 * TURN), jog(Direction::Clockwise), jog(Direction::Counterclockwise)] {
        for (label, cause, ended) in CAUSES {
            // The event occurs at various times after the first word of the motion.
            for after in (10..150).step_by(10).chain([900]) {
                let mut bench = Bench::new();
                bench.act(wish);
                bench.run(after);
                cause(&mut bench);
                let sent = bench.cycle();
                assert!(sent.control.is_at_rest(), "{label} after {after} ms: {:?}", sent.control);
                let how = bench.man.last_end().map(|ended| ended.1);
                assert!(how == Some(ended) || after < 100, "{label} after {after} ms: {how:?}");
                bench.run(300);
                assert!(!bench.moves(), "{label} after {after} ms: {:?}", bench.actual());
            }
        }
    }
}

/// The request is not refreshed for 250 ms plus one interval. The drive stays stopped when refreshes resume.
#[test]
fn stale_intent_stops_drive() {
    for wish in [to(9 * TURN), jog(Direction::Clockwise)] {
        let mut bench = Bench::new();
        bench.act(wish);
        bench.run(1000);
        bench.absent = true;
        // The last refresh was one interval ago.
        bench.run(240);
        assert!(!bench.cycle().control.is_at_rest());
        assert!(bench.cycle().control.is_at_rest());
        assert_eq!(bench.man.last_end().map(|ended| ended.1), Some(ActionEnd::Stale));
        bench.run(200);
        assert!(!bench.moves());
        bench.absent = false;
        let stood = bench.position();
        bench.run(2000);
        assert_eq!(bench.position(), stood, "the same act begins again");
        // The same applies to an action whose refreshes stop before it could begin.
        bench.act(MotionRequest::Lead(TargetState::Off));
        bench.until_over();
        bench.act(wish);
        bench.absent = true;
        bench.now = bench.now + std::time::Duration::from_millis(300);
        bench.station.open(bench.now, std::time::Duration::from_secs(1));
        bench.run(100);
        bench.absent = false;
        bench.run(2000);
        assert_eq!(bench.position(), stood);
        assert_eq!(bench.man.last_end().map(|ended| ended.1), Some(ActionEnd::Stale));
    }
}

/// While the drive still reports motion, the next stronger stop word follows every 200 ms.
#[test]
fn escalates_stop_while_moving() {
    for (wish, stop) in [(to(9 * TURN), "0469"), (jog(Direction::Clockwise), "1419")] {
        let mut bench = Bench::new();
        bench.act(wish);
        bench.run(1000);
        super::words(&mut bench);
        bench.heard = Some(bench.actual());
        bench.act(MotionRequest::Stop);
        let mut rungs = Vec::new();
        for ms in (0..1000).step_by(10) {
            let sent = bench.cycle();
            assert!(sent.control.is_at_rest());
            if let Phase::Stopping(rung) = bench.man.phase()
                && rungs.last().is_none_or(|(last, _)| *last != rung)
            {
                rungs.push((rung, ms));
            }
        }
        assert_eq!(
            rungs,
            [(StopLevel::Mode, 0), (StopLevel::Operational, 200), (StopLevel::Off, 400), (StopLevel::Close, 600)]
        );
        assert!(bench.man.has_exhausted_stop_levels());
        let moved = if stop == "0469" { "0479" } else { "1459" };
        assert_eq!(super::words(&mut bench), format!("{moved} {stop} 0401 0000"));
    }
}

/// Without further reports, the drive is assumed to be moving.
#[test]
fn stops_drive_if_reports_cease() {
    let mut bench = Bench::new();
    bench.act(to(9 * TURN));
    bench.run(1000);
    bench.cut_back = true;
    bench.run(360);
    assert!(bench.man.last_setpoint().control.is_at_rest());
    assert_eq!(bench.man.last_end().map(|ended| ended.1), Some(ActionEnd::Deaf));
    bench.run(600);
    assert!(bench.man.has_exhausted_stop_levels() && !bench.moves());
}

/// A drive that turns when it should be at rest is disabled and then switched off.
#[test]
fn stops_uncommanded_motion() {
    let mut bench = Bench::new();
    bench.act(MotionRequest::Lead(TargetState::Enabled));
    bench.until_over();
    super::words(&mut bench);
    let mut moving = bench.actual();
    moving.status = encoder_studio::devices::hiperdrive::protocol::StatusWord::new(0x1A37);
    bench.heard = Some(moving);
    bench.run(150);
    assert!(!bench.man.is_idle());
    bench.run(700);
    assert_eq!(super::words(&mut bench), "0409 0401 0000");
    assert!(bench.man.has_exhausted_stop_levels());
}

/// Earlier requests have no effect on a new connection.
#[test]
fn new_connection_moves_nothing() {
    let mut bench = Bench::new();
    bench.act(to(9 * TURN));
    bench.run(1000);
    bench.reconnect();
    bench.run(300);
    let stood = bench.position();
    bench.run(3000);
    assert_eq!((bench.position(), super::words(&mut bench).ends_with("0000")), (stood, true));
    assert_eq!(bench.man.last_setpoint().target, stood);
    // The loss of the master is a fault that must be acknowledged.
    bench.act(MotionRequest::Acknowledge);
    assert_eq!(bench.until_over(), ActionEnd::Done);
    bench.act(to(0));
    assert_eq!(bench.until_over(), ActionEnd::Arrived);
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(48))]

    /// A late report must never turn a stop into a start.
    #[test]
    fn late_reports_start_no_motion(late in 0usize..6, before in 1u64..40, gap in 1u64..30, runs: bool) {
        let mut bench = Bench::new();
        bench.late = late;
        bench.act(if runs { jog(Direction::Counterclockwise) } else { to(9 * TURN) });
        bench.run(before * 10);
        bench.act(MotionRequest::Stop);
        bench.run(gap * 10);
        bench.act(to(9 * TURN));
        bench.run(before * 10);
        bench.act(MotionRequest::Stop);
        bench.run(600);
        let stood = bench.position();
        bench.run(2000);
        prop_assert_eq!(bench.position(), stood);
    }
}
