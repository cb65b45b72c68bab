//! Property tests of the dead-man control with arbitrary reports, requests and times.

use std::time::Duration;

use proptest::prelude::*;

use super::{
    ActionEnd, DeadMan, LimitSide, LimitViolation, MotionIntent, MotionLock, MotionRejection, MotionRequest, Permit,
    Phase, STOP_LEVEL_TIMEOUT, SpeedTorque, TargetState,
};
use crate::devices::hiperdrive::protocol::{
    ActualValues, ControlBit, ControlWord, Direction, DriveNumber, Percent, RunEnd, Setpoint, StatusBit, StatusWord,
};
use crate::units::Moment;

const FULL: SpeedTorque = SpeedTorque { speed: Percent::FULL, torque: Percent::FULL };

/// Bits that are never sent: the reserved bits 1, 2, 11 and 13 to 15, and the jog bits.
const FORBIDDEN_BITS: u16 = 0b1110_1011_0000_0110;

/// Everything that happens in one interval.
#[derive(Clone, Debug)]
struct Tick {
    ms: u64,
    /// Received status word and position, or `None` if nothing was received.
    heard: Option<(u16, i32)>,
    /// A new action. The flag tells whether it is meant for this drive.
    act: Option<(bool, MotionRequest)>,
    /// Whether the action is refreshed.
    refreshed: bool,
    locked: bool,
    endless: bool,
    /// A request that replaces the current one but keeps its number.
    meddled: Option<MotionRequest>,
}

fn wish() -> impl Strategy<Value = MotionRequest> {
    let direction = prop_oneof![Just(Direction::Clockwise), Just(Direction::Counterclockwise)];
    let effort = prop_oneof![3 => Just(FULL), 1 => Just(SpeedTorque::NONE)];
    let end = prop_oneof![Just(RunEnd::RangeEnd), Just(RunEnd::Endless)];
    prop_oneof![
        Just(MotionRequest::Rest),
        Just(MotionRequest::Stop),
        Just(MotionRequest::Pause),
        Just(MotionRequest::Resume),
        Just(MotionRequest::Acknowledge),
        (0usize..4).prop_map(|goal| MotionRequest::Lead(TargetState::ALL[goal])),
        (any::<i32>(), effort.clone())
            .prop_map(|(target, effort)| MotionRequest::Move { target: target % 2000, effort }),
        (any::<i32>(), effort.clone()).prop_map(|(by, effort)| MotionRequest::Step { by: by % 500, effort }),
        (direction.clone(), effort.clone()).prop_map(|(direction, effort)| MotionRequest::Jog {
            direction,
            effort,
            outward: false
        }),
        (direction, end, effort).prop_map(|(direction, end, effort)| MotionRequest::Run { direction, end, effort }),
    ]
}

/// Generates status words, mostly realistic ones.
fn status() -> impl Strategy<Value = u16> {
    let said = [0x2A30, 0x2A31, 0x2A33, 0x2A37, 0x3A37, 0x1A37, 0x0A37, 0x3E37, 0x2E37, 0x2AB8, 0x2A70, 0, 0x0A30];
    prop_oneof![8 => prop::sample::select(said.to_vec()), 1 => any::<u16>()]
}

fn tick() -> impl Strategy<Value = Tick> {
    let heard = prop::option::weighted(0.9, (status(), -900i32..900));
    let act = prop::option::weighted(0.15, (prop::bool::weighted(0.9), wish()));
    let rare = || prop::bool::weighted(0.05);
    (1u64..60, heard, act, prop::bool::weighted(0.95), rare(), rare(), prop::option::weighted(0.03, wish())).prop_map(
        |(ms, heard, act, refreshed, locked, endless, meddled)| Tick {
            ms,
            heard,
            act,
            refreshed,
            locked,
            endless,
            meddled,
        },
    )
}

fn heard(said: Option<(u16, i32)>) -> Option<ActualValues> {
    said.map(|(status, position)| ActualValues { status: StatusWord::new(status), speed: 0, position })
}

/// A control word for standstill starts no motion, for any relevant status and previous control word.
#[test]
fn standstill_word_starts_no_motion() {
    let befores: Vec<ControlWord> =
        (0..=u16::MAX).step_by(0x40).filter_map(|word| ControlWord::parse(word | 0x0439).ok()).collect();
    let mut standing = 0;
    for word in (0..=u16::MAX).filter_map(|word| ControlWord::parse(word).ok()).filter(|word| word.is_at_rest()) {
        standing += 1;
        for acknowledged in [false, true] {
            let status = StatusWord::new(0x2A37).with_bit(StatusBit::SetpointAcknowledged, acknowledged);
            for before in [ControlWord::OFF, ControlWord::ENABLED].iter().chain(&befores) {
                assert_eq!(word.motion_start(*before, status), None, "{word:?} behind {before:?}");
            }
        }
    }
    // Ten bits may be set. Half of the words lack bit 3. With bit 3 and without jog bits, the standing words are three
    // quarters of those for positioning (bits 4 and 5) and half of those for speed mode (bit 6).
    assert_eq!(standing, 512 + 48 + 32);
}

/// After a run, the drive leaves the operational state before it is enabled again. If bit 12 were cleared while the
/// drive is enabled and bits 4 and 5 are set, a stale job would start (reference, section 3).
#[test]
fn leaving_speed_mode_passes_through_ready() {
    let mut man = DeadMan::new(DriveNumber::FIRST, 0);
    let permit = Permit::for_range(-1000, 1000);
    let jog = MotionRequest::Jog { direction: Direction::Clockwise, effort: SpeedTorque::DEFAULT_JOG, outward: false };
    let mut status = 0x2A37;
    let mut words = Vec::new();
    for at in 0..100u64 {
        let now = Moment::START + Duration::from_millis(at * 10);
        let wish = if at < 20 { jog } else { MotionRequest::Stop };
        let intent =
            MotionIntent { drive: DriveNumber::FIRST, request: wish, number: 1 + u64::from(at >= 20), refreshed: now };
        let word = man.next(now, heard(Some((status, 77))), &intent, &permit).control.to_u16();
        // The drive acknowledges a run with bit 12, and discards it only below the operational state.
        status = match word {
            0x1459 => 0x1A37,
            0x1419 if status & 0x1000 != 0 => 0x3A37,
            0x0400 => 0x2A31,
            0x0401 => 0x2A33 | status & 0x1000,
            _ => 0x2A37 | status & 0x1000,
        };
        words.push(word);
    }
    words.dedup();
    assert_eq!(words, [0x1419, 0x1459, 0x1419, 0x0400]);
    assert_eq!((man.last_setpoint().target, man.last_end()), (77, Some((1, ActionEnd::Stopped))));
}

/// While the thread was suspended between two calls, a stop may have been requested and then replaced by another
/// request.
#[test]
fn missed_stop_still_ends_job() {
    let permit = Permit::for_range(-1000, 1000);
    for (waits, next) in [(true, MotionRequest::Resume), (false, MotionRequest::Pause)] {
        let mut man = DeadMan::new(DriveNumber::FIRST, 0);
        let mut now = Moment::START;
        let mut look = |man: &mut DeadMan, number: u64, wish: MotionRequest, status: u16| {
            now = now + Duration::from_millis(10);
            let intent = MotionIntent { drive: DriveNumber::FIRST, request: wish, number, refreshed: now };
            man.next(now, heard(Some((status, 0))), &intent, &permit).control
        };
        let job = MotionRequest::Move { target: 500, effort: FULL };
        for status in [0x2A37, 0x2A37, 0x2A37, 0x1A37, 0x1A37] {
            look(&mut man, 1, job, status);
        }
        assert!(matches!(man.phase(), Phase::Moving(_)), "{:?}", man.phase());
        let mut number = 1;
        if waits {
            number = 2;
            look(&mut man, number, MotionRequest::Pause, 0x1A37);
            assert!(matches!(man.phase(), Phase::Paused { .. }));
        }
        // The skipped action was a stop.
        let word = look(&mut man, number + 2, next, 0x1A37);
        assert!(word.is_at_rest() && matches!(man.phase(), Phase::Stopping(_)), "{:?}", man.phase());
        assert_eq!(man.last_end(), Some((number, ActionEnd::Stopped)));
    }
}

/// A dead-man control with predefined reports from the drive. Each call takes 10 ms, and the request is always
/// refreshed.
struct DeadManBench {
    man: DeadMan,
    now: Moment,
    intent: MotionIntent,
    permit: Permit,
}

impl DeadManBench {
    fn new() -> Self {
        let intent = MotionIntent::idle(DriveNumber::FIRST, 0, Moment::START);
        let man = DeadMan::new(DriveNumber::FIRST, 0);
        DeadManBench { man, now: Moment::START, intent, permit: Permit::for_range(-1000, 1000) }
    }

    fn act(&mut self, wish: MotionRequest) {
        self.intent = MotionIntent { request: wish, number: self.intent.number + 1, ..self.intent };
    }

    /// Calls the dead-man control `times` times with the same report and returns the last setpoint.
    fn look(&mut self, times: u32, status: u16, position: i32) -> Setpoint {
        for _ in 0..times {
            self.now = self.now + Duration::from_millis(10);
            self.intent.refreshed = self.now;
            self.man.next(self.now, heard(Some((status, position))), &self.intent, &self.permit);
        }
        self.man.last_setpoint()
    }
}

const CLOCKWISE: MotionRequest = MotionRequest::Jog { direction: Direction::Clockwise, effort: FULL, outward: false };

/// If another master may have changed the limits while a drive is being enabled, the limits are read before the drive
/// moves. A running motion continues, and a paused one does not resume (issue 21.3).
#[test]
fn outdated_limits_prevent_motion_start() {
    let doubted = ActionEnd::Refused(MotionRejection::Locked(MotionLock::Outdated));
    for wish in [CLOCKWISE, MotionRequest::Move { target: 500, effort: FULL }] {
        let mut looks = DeadManBench::new();
        looks.look(3, 0x2A31, 0);
        looks.act(wish);
        looks.look(1, 0x2A31, 0);
        assert_eq!(looks.man.phase(), Phase::Leading(TargetState::Enabled));
        looks.permit.doubted = true;
        looks.look(1, 0x2A33, 0);
        assert_eq!(looks.man.last_end(), Some((1, doubted)), "{wish:?}");
        assert!(looks.look(100, 0x2A37, 0).control.is_at_rest());
    }
    let mut looks = DeadManBench::new();
    looks.act(MotionRequest::Move { target: 500, effort: FULL });
    looks.look(5, 0x2A37, 0);
    looks.look(5, 0x1A37, 100);
    looks.permit.doubted = true;
    looks.look(5, 0x1A37, 200);
    assert!(matches!(looks.man.phase(), Phase::Moving(_)), "{:?}", looks.man.last_end());
    looks.act(MotionRequest::Pause);
    looks.look(3, 0x3A37, 200);
    assert!(matches!(looks.man.phase(), Phase::Paused { .. }), "{:?}", looks.man.last_end());
    looks.act(MotionRequest::Resume);
    assert!(looks.look(1, 0x3A37, 200).control.is_at_rest());
    assert_eq!(looks.man.last_end(), Some((2, doubted)));
}

/// A job may end just before the user pauses or resumes it. The user is then told why it ended.
#[test]
fn late_pause_or_resume_reports_job_end() {
    for waits in [false, true] {
        let mut looks = DeadManBench::new();
        looks.act(MotionRequest::Move { target: 500, effort: FULL });
        looks.look(5, 0x2A37, 0);
        looks.look(5, 0x1A37, 100);
        let (mut number, mut status) = (1, 0x1A37);
        if waits {
            (number, status) = (2, 0x3A37);
            looks.act(MotionRequest::Pause);
            looks.look(3, status, 100);
        }
        // The job is not refreshed for 250 ms.
        let refreshed = looks.now;
        for _ in 0..26 {
            looks.now = looks.now + Duration::from_millis(10);
            looks.intent.refreshed = refreshed;
            looks.man.next(looks.now, heard(Some((status, 100))), &looks.intent, &looks.permit);
        }
        assert_eq!(looks.man.last_end(), Some((number, ActionEnd::Stale)));
        looks.act(if waits { MotionRequest::Resume } else { MotionRequest::Pause });
        assert!(looks.look(100, 0x2A37, 100).control.is_at_rest());
        assert_eq!(looks.man.last_end(), Some((number + 1, ActionEnd::Stale)));
    }
    // After a stop by the user, there is no job.
    let mut looks = DeadManBench::new();
    looks.act(MotionRequest::Move { target: 500, effort: FULL });
    looks.look(5, 0x2A37, 0);
    looks.act(MotionRequest::Stop);
    looks.look(100, 0x2A37, 0);
    looks.act(MotionRequest::Resume);
    looks.look(5, 0x2A37, 0);
    assert_eq!(looks.man.last_end(), Some((3, ActionEnd::Refused(MotionRejection::NothingToResume))));
}

/// Another master may change the limits, or the shaft may be pushed, just before a motion starts. A drive that is
/// outside its limits as a result must not move further out (issue 21.4).
#[test]
fn drive_outside_limits_does_not_start() {
    for (wish, direction) in [
        (CLOCKWISE, Direction::Clockwise),
        (
            MotionRequest::Jog { direction: Direction::Counterclockwise, effort: FULL, outward: false },
            Direction::Counterclockwise,
        ),
    ] {
        let position = if direction == Direction::Clockwise { 700 } else { -700 };
        let mut looks = DeadManBench::new();
        looks.look(3, 0x2A37, position);
        looks.act(wish);
        let mut count = 0;
        while !matches!(looks.man.phase(), Phase::Starting(_)) {
            looks.look(1, 0x2A37, position);
            count += 1;
            assert!(count < 100);
        }
        looks.permit = Permit::for_range(-100, 100);
        assert!(looks.look(1, 0x2A37, position).control.is_at_rest());
        let refused = ActionEnd::Refused(MotionRejection::Outward { position, low: -100, high: 100 });
        assert_eq!(looks.man.last_end(), Some((1, refused)));
    }
}

/// If both limits are within a degree of the position, status bit 15 does not tell which limit the drive has passed
/// (issue 21.4).
#[test]
fn bit_15_is_ambiguous_near_both_limits() {
    let at = |position| Permit::for_range(-150, 150).outside_limits(heard(Some((0xAA37, position))).unwrap());
    assert_eq!(
        (at(-20), at(0), at(20)),
        (Some(LimitViolation::Unclear), Some(LimitViolation::Unclear), Some(LimitViolation::Unclear))
    );
    assert_eq!(
        (at(-34), at(34)),
        (Some(LimitViolation::At(LimitSide::Below)), Some(LimitViolation::At(LimitSide::Above)))
    );
    assert_eq!(
        (at(-151), at(151)),
        (Some(LimitViolation::At(LimitSide::Below)), Some(LimitViolation::At(LimitSide::Above)))
    );
}

/// The first packets of a connection contain no valid position, because a hub first queries all its drives. A step
/// therefore waits until positions have arrived for 250 ms (issue 21.6b).
#[test]
fn step_waits_for_valid_positions() {
    let mut looks = DeadManBench::new();
    looks.permit = Permit::for_range(-100_000, 100_000);
    looks.act(MotionRequest::Step { by: 100, effort: FULL });
    looks.look(24, 0x2A37, 0);
    assert_eq!(looks.man.phase(), Phase::Idle);
    let sent = looks.look(20, 0x2A37, 50_000);
    assert_eq!((sent.target, looks.man.last_end()), (50_100, None));
    assert!(matches!(looks.man.phase(), Phase::Starting(_)));
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(600))]

    #[test]
    fn dead_man_invariants_hold(ticks in prop::collection::vec(tick(), 1..120)) {
        let mut man = DeadMan::new(DriveNumber::FIRST, 5);
        let mut now = Moment::START;
        let mut intent = MotionIntent::idle(DriveNumber::FIRST, 5, now);
        let mut before = Setpoint::default();
        // Number of the latest action that must have ended according to the test.
        let mut over = 5;
        let mut unmet = Duration::ZERO;
        for Tick { ms, heard: said, act, refreshed, locked, endless, meddled } in ticks {
            let step = Duration::from_millis(ms);
            now = now + step;
            if let Some((own, wish)) = act {
                let other = DriveNumber::new(2).unwrap();
                // A pause or resume continues the job. Any other action and a missed refresh end the previous one.
                let carries = matches!(wish, MotionRequest::Pause | MotionRequest::Resume) && own && !intent.is_stale(now);
                over = if carries { over } else { intent.number };
                let drive = if own { DriveNumber::FIRST } else { other };
                intent = MotionIntent { drive, request: wish, number: intent.number + 1, refreshed: now };
            }
            if let (Some(wish), None) = (meddled, act) {
                // An accepted action ends if its request changes. A waiting action may change.
                let taken = man.action_number() == intent.number && wish != intent.request;
                over = if taken { intent.number } else { over };
                intent.request = wish;
            }
            if intent.is_stale(now) {
                over = intent.number;
            }
            if refreshed {
                intent.refreshed = now;
            }
            let locks = if locked { vec![MotionLock::NotRequested] } else { Vec::new() };
            let permit = Permit { locks, endless, ..Permit::for_range(-1000, 1000) };
            let sent = man.next(now, heard(said), &intent, &permit);
            let word = sent.control;
            prop_assert_eq!(word.to_u16() & FORBIDDEN_BITS, 0);
            let own = intent.drive == DriveNumber::FIRST;
            let wanted = own && intent.request.needs_motion() && !intent.is_stale(now) && !locked;
            let faulty = said.is_some_and(|(status, _)| status & 8 != 0);
            if !word.is_at_rest() {
                prop_assert!(wanted && intent.number > over, "{:?} for {:?}, over: {}", word, intent, over);
                prop_assert!(!faulty && sent.speed.get() > 0 && sent.torque.get() > 0);
                prop_assert!(!word.is_set(ControlBit::SpeedMode) || !word.is_set(ControlBit::NoPause) || endless);
                let job = !word.is_set(ControlBit::SpeedMode);
                prop_assert!(!job || (-1000..=1000).contains(&sent.target), "{:?}", sent);
            }
            if let Some((ended, _)) = man.last_end() {
                over = over.max(ended);
            }
            // Speed mode is never left by clearing bit 12 alone.
            let leaves = before.control.is_set(ControlBit::SpeedMode) && !word.is_set(ControlBit::SpeedMode);
            prop_assert!(!leaves || !word.is_set(ControlBit::Enable), "{:?} behind {:?}", word, before.control);
            // If a drive does not stop, all levels of the stop sequence are used.
            unmet = if matches!(man.phase(), Phase::Stopping(_)) { unmet + step } else { Duration::ZERO };
            prop_assert!(unmet < STOP_LEVEL_TIMEOUT * 3 + Duration::from_millis(240) || man.has_exhausted_stop_levels());
            before = sent;
        }
    }
}
