//! Random sessions of thousands of steps with every kind of fault: the drive fails, ignores its limits, turns the wrong
//! way or is turned by hand, another master writes limits, and connections are cut.
//!
//! A word that commands motion may be sent only after a new action of the user, in its direction and within the
//! limits. A model that is independent of the dead-man control checks this ([`Model`]).

use encoder_studio::devices::hiperdrive::procedures::dead_man::Permit;
use encoder_studio::devices::hiperdrive::procedures::dead_man::{MotionLock, MotionRequest, SpeedTorque, TargetState};
use encoder_studio::devices::hiperdrive::protocol::{Direction, DriveNumber, ErrorCode, RunEnd, State};
use encoder_studio::devices::hiperdrive::sim::{DriveDefect, SpindleLoad};

use super::bench::Bench;
use super::model::Model;
use super::{FULL, TURN};

const SESSIONS: u64 = 100;
const STEPS: u64 = 5000;

fn wish(dice: &mut fastrand::Rng) -> MotionRequest {
    let effort = if dice.bool() { FULL } else { SpeedTorque::DEFAULT_JOG };
    let direction = if dice.bool() { Direction::Clockwise } else { Direction::Counterclockwise };
    match dice.u8(..14) {
        0 => MotionRequest::Rest,
        1 => MotionRequest::Lead(TargetState::ALL[dice.usize(..4)]),
        2 | 3 => MotionRequest::Acknowledge,
        4 | 5 => MotionRequest::Move { target: dice.i32(-3 * TURN..3 * TURN), effort },
        6 | 7 => MotionRequest::Step { by: dice.i32(-TURN..TURN), effort },
        8 => MotionRequest::Pause,
        9 => MotionRequest::Resume,
        10 | 11 => MotionRequest::Jog { direction, effort, outward: dice.u8(..4) == 0 },
        12 => MotionRequest::Run { direction, end: RunEnd::RangeEnd, effort },
        _ => MotionRequest::Stop,
    }
}

fn mishap(bench: &mut Bench, model: &mut Model, dice: &mut fastrand::Rng) {
    let now = bench.now;
    match dice.u8(..20) {
        0 | 1 => bench.fail([ErrorCode::OVER_CURRENT, ErrorCode::RS485][dice.usize(..2)]),
        2 => {
            let wall_above = Some(bench.position().into());
            bench.load(SpindleLoad { wall_above, ..SpindleLoad::default() });
        }
        3 => bench.load(SpindleLoad { percent: 60, ..SpindleLoad::default() }),
        4 | 5 => bench.load(SpindleLoad::default()),
        6 => bench.station.set_drive_select_switch(now, dice.u8(..3)),
        7 => bench.station.set_drive_select_switch(now, 0),
        8 => bench.reset(),
        9 => {
            bench.reconnect();
            model.end();
        }
        10 => {
            bench.permit.locks = vec![MotionLock::LimitsUnconfirmed];
            model.end();
        }
        11 | 12 => bench.permit.locks.clear(),
        13 => bench.late = dice.usize(..4),
        14 => bench.load(SpindleLoad { defect: Some(DriveDefect::RunsOn), ..SpindleLoad::default() }),
        15 => {
            let defect = Some([DriveDefect::Reversed, DriveDefect::SaysOutside][dice.usize(..2)]);
            bench.load(SpindleLoad { defect, ..SpindleLoad::default() });
        }
        16 => {
            let steps = f64::from(dice.i32(-TURN..TURN));
            bench.station.drive(DriveNumber::FIRST).unwrap().turn_by_hand(now, steps);
        }
        17 | 18 => {
            let limits = (dice.i32(-4 * TURN..-TURN / 2), dice.i32(TURN / 2..4 * TURN));
            bench.permit = Permit { locks: bench.permit.locks.clone(), ..Permit::for_range(limits.0, limits.1) };
            model.set_limits(limits);
        }
        _ => {}
    }
}

/// The test bench and the model check each control word. This test checks that, after the last motion request, the
/// drive stops within the time for stronger stop words and braking, and does not move again (issue 21.14).
#[test]
fn any_session_ends_at_standstill() {
    let mut moved = 0u64;
    for seed in 0..SESSIONS {
        let mut dice = fastrand::Rng::with_seed(seed);
        let mut bench = Bench::new();
        let limits = (-3 * TURN, 3 * TURN);
        bench.permit = Permit::for_range(limits.0, limits.1);
        let mut model = Model::new(limits);
        let mut unwanted = 0;
        let mut word = bench.man.last_setpoint().control;
        for step in 0..STEPS {
            if dice.u8(..30) == 0 {
                let wish = wish(&mut dice);
                let number = bench.act(wish);
                model.act(number, wish, bench.now);
            }
            if dice.u8(..150) == 0 {
                mishap(&mut bench, &mut model, &mut dice);
            }
            bench.cut_out = dice.u8(..20) == 0;
            bench.cut_back = dice.u8(..20) == 0;
            bench.absent = dice.u8(..200) == 0 || (bench.absent && dice.u8(..40) != 0);
            let stale = bench.intent.is_stale(bench.now) && bench.absent;
            if !bench.absent {
                model.refresh(bench.now);
            }
            let now = bench.now;
            let sent = bench.cycle();
            model.look(now, sent, bench.man.actual_values(), bench.man.last_end());
            let wanted = bench.intent.request.needs_motion() && !stale && bench.permit.locks.is_empty();
            assert!(wanted || sent.control.is_at_rest(), "{seed}/{step}: {:?} after {word:?}", sent.control);
            word = sent.control;
            unwanted = if wanted { 0 } else { unwanted + 1 };
            let moves = bench.actual().status.state() == State::Moving || bench.actual().speed != 0;
            moved += u64::from(moves);
            // Losses make this longer, because a stop word may need several tries.
            assert!(!moves || unwanted < 40, "{seed}/{step}: {unwanted} intervals unwanted, {:?}", bench.man.phase());
            if bench.man.has_exhausted_stop_levels() {
                bench.reconnect();
                model.end();
            }
        }
    }
    assert!(moved > SESSIONS * STEPS / 20, "hardly anything has moved: {moved}");
}
