//! Stages of the dead-man control and the control words sent in them: at rest, changing state, armed, started, moving,
//! paused, stopping.

use std::time::Duration;

use super::state_sequence::StateSequencer;
use super::{
    ActionEnd, DeadMan, MAX_REPORT_DELAY, MISSED_TARGET_TIME, Motion, MotionKind, START, STOP_LEVEL_TIMEOUT,
    SpeedTorque, StopLevel, TargetState,
};
use crate::devices::hiperdrive::protocol::{ActualValues, ControlBit, ControlWord, Setpoint, State, StatusBit};
use crate::units::Moment;

#[derive(Clone, Copy, Debug)]
pub(super) enum Stage {
    Rest {
        /// Time at which the drive was first seen moving, although it should be at rest.
        moves: Option<Moment>,
    },
    Lead(StateSequencer),
    /// The drive has received the setpoints of a motion, with the control word that comes before its start.
    Arm {
        since: ReportTimestamp,
        /// Status bit 12 as last reported.
        acknowledged: bool,
    },
    Start {
        since: ReportTimestamp,
        acknowledged: bool,
    },
    Go {
        since: ReportTimestamp,
        acknowledged: bool,
        /// Time at which the drive was first seen at rest, if it is at rest.
        standing_since: Option<ReportTimestamp>,
    },
    Paused {
        since: ReportTimestamp,
        acknowledged: bool,
    },
    Stop {
        level: StopLevel,
        since: Moment,
        begun: ReportTimestamp,
        word: ControlWord,
    },
}

/// A point in time, with the number of reports received so far.
#[derive(Clone, Copy, Debug)]
pub(super) struct ReportTimestamp {
    pub(super) at: Moment,
    pub(super) report: u64,
}

/// Number of reports to wait for after a mark. The last one is certain to describe a time after the mark.
const REPORTS: u64 = 2;

impl ReportTimestamp {
    /// Returns whether at least `time` has passed and [`REPORTS`] reports have arrived since `earlier`.
    pub(super) fn has_elapsed_since(self, earlier: ReportTimestamp, time: Duration) -> bool {
        self.at.duration_since(earlier.at) >= time && self.report >= earlier.report + REPORTS
    }
}

impl Stage {
    pub(super) const fn is_moving(&self) -> bool {
        matches!(self, Stage::Arm { .. } | Stage::Start { .. } | Stage::Go { .. })
    }

    pub(super) const fn has_motion(&self) -> bool {
        self.is_moving() || matches!(self, Stage::Paused { .. })
    }
}

impl StopLevel {
    const fn next(self) -> StopLevel {
        match self {
            StopLevel::Mode => StopLevel::Operational,
            StopLevel::Operational => StopLevel::Off,
            StopLevel::Off | StopLevel::Close => StopLevel::Close,
        }
    }
}

impl DeadMan {
    pub(super) fn advance_stage(&mut self, now: Moment, actual: ActualValues) {
        let mark = self.current_mark(now);
        let has = |bit| actual.status.is_set(bit);
        let toggled = |acknowledged| has(StatusBit::SetpointAcknowledged) != acknowledged;
        match self.stage {
            Stage::Rest { moves } => self.supervise_at_rest(now, actual, moves),
            Stage::Lead(lead) => self.continue_transition(now, actual, lead),
            Stage::Arm { since, acknowledged } => {
                if self.is_speed_mode() || !toggled(acknowledged) {
                    // The drive has received the control word.
                    if mark.has_elapsed_since(since, Duration::ZERO) {
                        self.stage = Stage::Start { since: mark, acknowledged };
                    }
                } else {
                    self.stop(now, ActionEnd::NotStarted);
                }
            }
            Stage::Start { since, acknowledged } => {
                let moves = actual.status.state() == State::Moving;
                let begun = if self.is_speed_mode() {
                    moves || (has(StatusBit::SetpointAcknowledged) && !acknowledged)
                } else {
                    toggled(acknowledged)
                };
                if begun {
                    self.stage = Stage::Go { since: mark, acknowledged, standing_since: None };
                } else if now.duration_since(since.at) >= START {
                    let at_end = self.act.and_then(|act| act.watch).is_some_and(|watch| watch.at_end);
                    self.stop(now, if at_end { ActionEnd::RangeEnd } else { ActionEnd::NotStarted });
                }
            }
            Stage::Go { since, acknowledged, standing_since: stands } => {
                let stands = has(StatusBit::Standstill).then(|| stands.unwrap_or(mark));
                self.stage = Stage::Go { since, acknowledged, standing_since: stands };
                if let Some(stands) = stands {
                    self.check_motion_end(mark, actual, stands);
                }
            }
            Stage::Paused { .. } => {}
            Stage::Stop { .. } => self.escalate_stop(mark, actual),
        }
    }

    fn check_motion_end(&mut self, mark: ReportTimestamp, actual: ActualValues, stands: ReportTimestamp) {
        let Stage::Go { since, .. } = self.stage else { return };
        // A report from before the start may still show a standstill, or show a previous target as reached.
        let late = mark.has_elapsed_since(since, MAX_REPORT_DELAY);
        if self.is_speed_mode() {
            if late && mark.has_elapsed_since(stands, MAX_REPORT_DELAY) {
                self.stop(mark.at, ActionEnd::RangeEnd);
            }
        } else if actual.status.is_set(StatusBit::TargetReached) {
            if late {
                self.end_action(ActionEnd::Arrived);
                self.hold_state(actual.status.state());
            }
        } else if mark.has_elapsed_since(stands, MISSED_TARGET_TIME) {
            self.stop(mark.at, ActionEnd::Short);
        }
    }

    /// Returns whether the motion is a run in speed mode.
    pub(super) fn is_speed_mode(&self) -> bool {
        self.act.and_then(|act| act.motion).is_some_and(|motion| matches!(motion.kind, MotionKind::Run { .. }))
    }

    pub(super) fn stop(&mut self, now: Moment, how: ActionEnd) {
        let moved = self.stage.has_motion();
        self.end_action(how);
        if moved {
            let (begun, word) = (self.current_mark(now), self.sent.control.with_stop());
            self.stage = Stage::Stop { level: StopLevel::Mode, since: now, begun, word };
        }
    }

    /// Escalates the stop until the drive is at rest, then holds its state. After a run, the held state is *ready*, and
    /// the next motion enables the drive again.
    fn escalate_stop(&mut self, mark: ReportTimestamp, actual: ActualValues) {
        let Stage::Stop { level, since, begun, word } = self.stage else { return };
        if level == StopLevel::Close {
            return;
        }
        if mark.has_elapsed_since(begun, MAX_REPORT_DELAY) && actual.status.is_set(StatusBit::Standstill) {
            // The held state is never above the state of the word sent last.
            self.hold_state(actual.status.state());
        } else if mark.at.duration_since(since) >= STOP_LEVEL_TIMEOUT {
            let level = level.next();
            self.stage = Stage::Stop { level, since: mark.at, begun, word };
        }
    }

    /// Supervises a drive at rest. If the drive falls to a lower state, the lower state is held. If the drive moves, it
    /// is stopped.
    fn supervise_at_rest(&mut self, now: Moment, actual: ActualValues, moves: Option<Moment>) {
        match actual.status.state() {
            State::Fault | State::Locked => self.level = self.level.min(TargetState::Operational),
            state => self.level = self.level.min(TargetState::from_state(state)),
        }
        let moves = (actual.status.state() == State::Moving).then(|| moves.unwrap_or(now));
        self.stage = Stage::Rest { moves };
        if moves.is_some_and(|since| now.duration_since(since) >= STOP_LEVEL_TIMEOUT) {
            let level = match self.level {
                TargetState::Enabled => StopLevel::Operational,
                TargetState::Operational | TargetState::Ready => StopLevel::Off,
                TargetState::Off => StopLevel::Close,
            };
            let (begun, word) = (self.current_mark(now), self.rest_control_word());
            self.stage = Stage::Stop { level, since: now, begun, word };
        }
    }

    /// Returns the control word for a drive at rest. For an enabled drive, this is a stop with bit 6 unchanged.
    fn rest_control_word(&self) -> ControlWord {
        let sent = self.sent.control;
        let enabled = TargetState::from_word(sent) == TargetState::Enabled;
        match self.level {
            TargetState::Enabled if enabled && !sent.is_set(ControlBit::SpeedMode) => sent.with_stop().with_pause(),
            level => level.control_word(),
        }
    }

    pub(super) fn next_setpoint(&self, actual: ActualValues) -> Setpoint {
        let motion = self.act.and_then(|act| act.motion);
        let control = match (&self.stage, motion) {
            (Stage::Rest { .. }, _) => self.rest_control_word(),
            (Stage::Lead(lead), _) => lead.control_word(),
            (Stage::Stop { level: StopLevel::Mode, word, .. }, _) => *word,
            (Stage::Stop { level: StopLevel::Operational, .. }, _) => ControlWord::OPERATIONAL,
            (Stage::Stop { level: StopLevel::Off | StopLevel::Close, .. }, _) => ControlWord::OFF,
            (stage, Some(Motion { kind, .. })) => moving_word(stage, kind, actual),
            // Without an action there is no motion in these stages.
            (_, None) => ControlWord::READY,
        };
        let target = match (&self.stage, motion.and_then(|motion| motion.kind.target())) {
            (Stage::Stop { .. }, _) => self.sent.target,
            (stage, Some(target)) if stage.has_motion() => target,
            _ => actual.position,
        };
        let SpeedTorque { speed, torque } =
            if matches!(self.stage, Stage::Stop { .. }) || TargetState::from_word(control) == TargetState::Enabled {
                self.effort
            } else {
                SpeedTorque::NONE
            };
        Setpoint { control, speed, torque, target }
    }
}

fn moving_word(stage: &Stage, kind: MotionKind, actual: ActualValues) -> ControlWord {
    let toggled = |acknowledged: &bool, toggle: bool| {
        let status = actual.status.with_bit(StatusBit::SetpointAcknowledged, acknowledged != &toggle);
        ControlWord::without_job_start(status)
    };
    match (stage, kind) {
        (Stage::Arm { .. }, MotionKind::Run { direction, end }) => ControlWord::speed_mode(direction, end),
        (_, MotionKind::Run { direction, end }) => ControlWord::speed_mode_running(direction, end),
        (Stage::Arm { acknowledged, .. }, MotionKind::Job { .. }) => toggled(acknowledged, false),
        (Stage::Start { acknowledged, .. } | Stage::Go { acknowledged, .. }, MotionKind::Job { .. }) => {
            toggled(acknowledged, true)
        }
        (Stage::Paused { acknowledged, .. }, MotionKind::Job { .. }) => toggled(acknowledged, true).with_pause(),
        _ => ControlWord::READY,
    }
}
