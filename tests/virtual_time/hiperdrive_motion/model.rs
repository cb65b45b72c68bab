//! A record of the user's requests that is independent of the dead-man control. Every word that commands motion must
//! match an action in it.

use std::time::Duration;

use encoder_studio::devices::hiperdrive::procedures::dead_man::{ActionEnd, MotionRequest};
use encoder_studio::devices::hiperdrive::protocol::{ActualValues, Direction, RunEnd, Setpoint, StatusBit};
use encoder_studio::units::Moment;

/// The user's actions, recorded without the dead-man control (issue 21.14).
pub(super) struct Model {
    live: Option<Live>,
    limits: (i32, i32),
}

/// An action that may currently move the drive.
struct Live {
    number: u64,
    wish: MotionRequest,
    said: Moment,
    /// Target of a move, set when the first word commands it.
    target: Option<i32>,
    /// Whether the drive has been within its limits since the action.
    was_inside: bool,
}

/// The motion that a word commands, according to its bits in reference 3: bit 3 enables, bit 12 selects speed mode.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Commands {
    Nothing,
    /// Bits 12 and 6 are set. Bit 4 selects clockwise, and bit 5 an endless run.
    Run {
        clockwise: bool,
        endless: bool,
    },
    /// Bits 4 and 5 are set, and bit 6 is not yet acknowledged or a move is in progress.
    Job,
}

const ENABLED: u16 = 0x0409;
/// Time for which an action stays valid without a refresh.
const FRESH: Duration = Duration::from_millis(250);
/// Steps per degree, rounded up.
const DEGREE: i64 = 183;

fn commands(word: u16, acknowledged: bool, job: bool) -> Commands {
    let has = |bit: u16| word & (1 << bit) != 0;
    if word & ENABLED != ENABLED {
        Commands::Nothing
    } else if has(12) {
        if has(6) { Commands::Run { clockwise: has(4), endless: has(5) } } else { Commands::Nothing }
    } else if has(4) && has(5) && (job || has(6) != acknowledged) {
        Commands::Job
    } else {
        Commands::Nothing
    }
}

impl Model {
    pub(super) fn new(limits: (i32, i32)) -> Self {
        Model { live: None, limits }
    }

    /// Records a user action.
    pub(super) fn act(&mut self, number: u64, wish: MotionRequest, now: Moment) {
        let is_job = |live: &Live| matches!(live.wish, MotionRequest::Move { .. } | MotionRequest::Step { .. });
        match wish {
            // These requests continue a move but do not begin one.
            MotionRequest::Pause | MotionRequest::Resume => {
                self.live = self.live.take().filter(is_job).map(|live| Live { number, said: now, ..live });
            }
            MotionRequest::Move { .. }
            | MotionRequest::Step { .. }
            | MotionRequest::Jog { .. }
            | MotionRequest::Run { .. } => {
                self.live = Some(Live { number, wish, said: now, target: None, was_inside: false });
            }
            _ => self.live = None,
        }
    }

    /// Records a refresh of the action.
    pub(super) fn refresh(&mut self, now: Moment) {
        if let Some(live) = &mut self.live {
            live.said = now;
        }
    }

    /// Discards all earlier requests.
    pub(super) fn end(&mut self) {
        self.live = None;
    }

    pub(super) fn set_limits(&mut self, limits: (i32, i32)) {
        self.limits = limits;
    }

    /// Returns the distance beyond the limits: positive above the upper one, negative below the lower one.
    fn outside(&self, position: i32) -> i64 {
        let (low, high) = self.limits;
        let (position, low, high) = (i64::from(position), i64::from(low), i64::from(high));
        if position > high { position - high } else { (position - low).min(0) }
    }

    /// Checks a set-point against the record. `heard` is the last report before it was sent.
    pub(super) fn look(&mut self, now: Moment, sent: Setpoint, heard: ActualValues, ended: Option<(u64, ActionEnd)>) {
        let out = self.outside(heard.position);
        let live = self.live.take().filter(|live| {
            now.duration_since(live.said) <= FRESH
                && !heard.status.is_set(StatusBit::Fault)
                && ended.is_none_or(|(number, _)| number < live.number)
        });
        let word = sent.control.to_u16();
        let job = live.as_ref().is_some_and(|live| live.target.is_some());
        let commands = commands(word, heard.status.is_set(StatusBit::SetpointAcknowledged), job);
        self.live = live;
        if commands == Commands::Nothing {
            return;
        }
        let Some(live) = &mut self.live else { panic!("{word:04X} without a fresh act") };
        live.was_inside |= out == 0;
        assert!(
            !(live.was_inside && out.abs() > 0) || is_arriving(commands, live, heard),
            "{word:04X} at {out} outside"
        );
        match (commands, live.wish) {
            (
                Commands::Run { clockwise, endless },
                MotionRequest::Jog { direction, .. } | MotionRequest::Run { direction, .. },
            ) => {
                assert_eq!(clockwise, direction == Direction::Clockwise, "{word:04X} for {:?}", live.wish);
                let may_run_on = matches!(live.wish, MotionRequest::Run { end: RunEnd::Endless, .. });
                assert!(!endless || may_run_on, "{word:04X} for {:?}", live.wish);
                let outward = if clockwise { out > 0 } else { out < 0 };
                let freed = matches!(live.wish, MotionRequest::Jog { outward: true, .. });
                assert!(!outward || freed, "{word:04X} at {out} outside, for {:?}", live.wish);
                if freed {
                    assert!(sent.speed.get() <= 10 && sent.torque.get() <= 25, "{sent:?}");
                }
            }
            (Commands::Job, MotionRequest::Move { target, .. }) => assert_eq!(sent.target, target),
            (Commands::Job, MotionRequest::Step { .. }) => assert!(live.target.is_none_or(|own| own == sent.target)),
            (_, wish) => panic!("{word:04X} for {wish:?}"),
        }
        if commands == Commands::Job {
            assert_eq!(self.outside(sent.target), 0, "a target outside the limits");
            if let Some(live) = &mut self.live {
                live.target = Some(sent.target);
            }
        }
    }
}

/// Returns whether a move is within one degree of its target and the target lies within the limits.
fn is_arriving(commands: Commands, live: &Live, heard: ActualValues) -> bool {
    let near = |target: i32| (i64::from(heard.position) - i64::from(target)).abs() <= DEGREE;
    commands == Commands::Job && live.target.is_some_and(near)
}

#[test]
fn words_match_reference() {
    let run = |clockwise, endless| Commands::Run { clockwise, endless };
    for (word, acknowledged, job, expected) in [
        (0x0439, false, false, Commands::Nothing),
        (0x0479, false, false, Commands::Job),
        (0x0479, true, true, Commands::Job),
        (0x0439, true, false, Commands::Job),
        (0x0469, true, true, Commands::Nothing),
        (0x0409, true, true, Commands::Nothing),
        (0x1419, false, false, Commands::Nothing),
        (0x1459, false, false, run(true, false)),
        (0x1449, false, false, run(false, false)),
        (0x1479, true, false, run(true, true)),
        (0x0401, true, true, Commands::Nothing),
        (0x0400, false, false, Commands::Nothing),
    ] {
        assert_eq!(commands(word, acknowledged, job), expected, "{word:04X}");
    }
}
