//! Tests of the table in docs/motion.md, which specifies how a motion ends for each phase and event (issue 21, *What
//! must hold*).

use std::time::Duration;

use super::{DeadMan, MotionIntent, MotionLock, MotionRequest, Permit, Phase, SpeedTorque, TargetState};
use crate::devices::hiperdrive::protocol::{ActualValues, Direction, DriveNumber, StatusWord};
use crate::units::Moment;

const DOCUMENT: &str = include_str!("../../../../../docs/motion.md");

struct TestBench {
    man: DeadMan,
    now: Moment,
    intent: MotionIntent,
    permit: Permit,
    status: u16,
    position: i32,
    refreshes: bool,
    is_connected: bool,
}

/// Status words: ready; enabled and at rest; enabled and moving; at rest with a job or a run acknowledged.
const READY: u16 = 0x2A31;
const ENABLED: u16 = 0x2A37;
const MOVING: u16 = 0x1A37;
const STANDSTILL: u16 = 0x3A37;

impl TestBench {
    fn new(status: u16) -> Self {
        TestBench {
            man: DeadMan::new(DriveNumber::FIRST, 0),
            now: Moment::START,
            intent: MotionIntent::idle(DriveNumber::FIRST, 0, Moment::START),
            permit: Permit::for_range(-10_000, 10_000),
            status,
            position: 0,
            refreshes: true,
            is_connected: true,
        }
    }

    fn request(&mut self, wish: MotionRequest) {
        self.intent =
            MotionIntent { request: wish, number: self.intent.number + 1, refreshed: self.now, ..self.intent };
    }

    fn run_cycle(&mut self) {
        self.now = self.now + Duration::from_millis(10);
        if self.refreshes {
            self.intent.refreshed = self.now;
        }
        let actual = ActualValues { status: StatusWord::new(self.status), speed: 0, position: self.position };
        self.man.next(self.now, self.is_connected.then_some(actual), &self.intent, &self.permit);
    }

    fn run_cycles(&mut self, count: u32) {
        (0..count).for_each(|_| self.run_cycle());
    }

    /// Creates a test set-up and brings its dead-man control to a phase named in the table.
    fn new_in_phase(name: &str) -> Self {
        let job = MotionRequest::Move { target: 5000, effort: SpeedTorque::DEFAULT_JOG };
        let jog =
            MotionRequest::Jog { direction: Direction::Clockwise, effort: SpeedTorque::DEFAULT_JOG, outward: false };
        let is_below = matches!(name, "at rest" | "leading" | "up to a motion");
        let mut bench = TestBench::new(if is_below { READY } else { ENABLED });
        bench.run_cycles(3);
        match name {
            "at rest" => {}
            "leading" => bench.request(MotionRequest::Lead(TargetState::Enabled)),
            "up to a motion" | "moving (run)" | "stopping" => bench.request(jog),
            _ => bench.request(job),
        }
        // Arming and starting take two reports each.
        bench.run_cycles(5);
        if !is_below && name != "starting" {
            bench.status = MOVING;
            bench.run_cycles(20);
        }
        match name {
            "paused" => {
                bench.request(MotionRequest::Pause);
                bench.status = STANDSTILL;
                bench.run_cycles(3);
            }
            "stopping" => {
                bench.request(MotionRequest::Stop);
                bench.run_cycles(2);
            }
            _ => {}
        }
        let phase = bench.man.phase();
        let is_so = match name {
            "at rest" => phase == Phase::Idle,
            "leading" | "up to a motion" => matches!(phase, Phase::Leading(_)),
            "starting" => matches!(phase, Phase::Starting(_)),
            "moving (job)" | "moving (run)" => matches!(phase, Phase::Moving(_)),
            "paused" => matches!(phase, Phase::Paused { .. }),
            "stopping" => matches!(phase, Phase::Stopping(_)),
            other => panic!("{other} is no phase"),
        };
        assert!(is_so, "{name}: {phase:?}");
        bench
    }

    fn play_event(&mut self, event: &str) {
        let paused = matches!(self.man.phase(), Phase::Paused { .. });
        match event.split(['(', ',']).next().unwrap_or_default().trim() {
            "released" => self.request(MotionRequest::Stop),
            "not refreshed for 250 ms" => {
                self.refreshes = false;
                // The motion must not end before the first packet after 250 ms.
                self.run_cycles(25);
                let moves = self.man.last_end().is_none() || matches!(self.man.phase(), Phase::Stopping(_));
                assert!(moves, "not before");
            }
            "another action" => self.request(MotionRequest::Lead(TargetState::Operational)),
            "no status from the drive" => {
                self.is_connected = false;
                self.man.handle_contact_loss(self.now);
                // A mere change of state tolerates a longer silence.
                let leads = matches!(self.man.phase(), Phase::Leading(_));
                self.run_cycles(if leads { 36 } else { 0 });
            }
            "the connection is lost or closed" => self.man.connection_lost(self.now),
            "fault" => self.status = 0x2AB8,
            "a lock" => self.permit.locks.push(MotionLock::NoAnswer),
            "parameters must be read again" => self.permit.doubted = true,
            "operation no longer enabled" => self.status = 0x2A33,
            "beyond a limit" => {
                self.position = 10_400;
                self.status |= 0x8000;
            }
            "moves in the wrong direction by more than 1°" => self.position = -400,
            "moves further by more than 1°" => {
                self.run_cycles(60);
                self.position = 400;
            }
            "standstill" => {
                self.status = if self.status & 0x1000 == 0 { ENABLED } else { STANDSTILL };
                // A drive has one second to start. At standstill, the motion ends after half a second.
                self.run_cycles(if paused { 0 } else { 110 });
            }
            other => panic!("{other} is no event"),
        }
    }
}

/// Returns the rows of the table, including its header, as trimmed cells.
fn table_rows() -> Vec<Vec<&'static str>> {
    let lines = DOCUMENT.lines().skip_while(|line| !line.starts_with('|')).take_while(|line| line.starts_with('|'));
    let cells = |line: &'static str| line.trim_matches('|').split('|').map(str::trim).collect::<Vec<_>>();
    lines.filter(|line| !line.starts_with("|---")).map(cells).collect()
}

#[test]
fn motions_end_as_documented() {
    let rows = table_rows();
    let (head, events) = rows.split_first().unwrap();
    assert_eq!((head.len(), events.len()), (9, 13), "all phases and all events");
    for row in events {
        for (phase, expected) in head.iter().zip(row).skip(1) {
            let mut bench = TestBench::new_in_phase(phase);
            let before = bench.man.last_end();
            bench.play_event(row[0]);
            bench.run_cycle();
            let ended = bench.man.last_end().filter(|_| bench.man.last_end() != before);
            let name = ended.map_or("–".to_owned(), |(_, how)| {
                format!("{how:?}").split([' ', '(', '{']).next().unwrap_or_default().to_owned()
            });
            assert_eq!(&name, expected, "{} while {phase}", row[0]);
            // However the action has ended, the control word must be a standing word.
            assert!(ended.is_none() || bench.man.last_setpoint().control.is_at_rest(), "{} while {phase}", row[0]);
        }
    }
}
