//! Sequences of control words that bring a drive to a requested state. Each word is sent until the drive obeys it or a
//! time limit expires. See section 3 of the reference and `devices/hiperdrive/protocol/recipe`.

use super::{
    ActionEnd, DeadMan, MAX_REPORT_DELAY, MotionKind, MotionRejection, ReportTimestamp, STEP, Stage, TargetState,
    UserAction,
};
use crate::devices::hiperdrive::protocol::{ActualValues, ControlBit, ControlWord, State, StatusBit, StatusWord};
use crate::units::Moment;

#[derive(Clone, Copy, Debug)]
pub(super) struct StateSequencer {
    goal: TargetState,
    acknowledges: bool,
    /// Control word that is being sent, and when it was first sent.
    word: Option<(ControlWord, ReportTimestamp)>,
}

enum StateSequenceStep {
    By(ControlWord),
    There,
    Lost,
}

impl TargetState {
    pub(super) const fn from_word(word: ControlWord) -> TargetState {
        if !word.is_set(ControlBit::Control) {
            TargetState::Off
        } else if !word.is_set(ControlBit::On) {
            TargetState::Ready
        } else if !word.is_set(ControlBit::Enable) {
            TargetState::Operational
        } else {
            TargetState::Enabled
        }
    }

    pub(super) const fn control_word(self) -> ControlWord {
        match self {
            TargetState::Off => ControlWord::OFF,
            TargetState::Ready => ControlWord::READY,
            TargetState::Operational => ControlWord::OPERATIONAL,
            TargetState::Enabled => ControlWord::ENABLED,
        }
    }
}

impl StateSequencer {
    pub(super) const fn new(goal: TargetState) -> Self {
        StateSequencer { goal, acknowledges: false, word: None }
    }

    /// Creates a sequence that brings the drive out of a fault or the switch-on lock to the ready state.
    const fn fault_exit() -> Self {
        StateSequencer { goal: TargetState::Ready, acknowledges: true, word: None }
    }

    pub(super) const fn goal(&self) -> TargetState {
        self.goal
    }

    /// Returns whether the sequence only removes torque or keeps it off, which needs no refresh.
    pub(super) fn is_torque_removal(&self, state: State) -> bool {
        self.goal <= TargetState::from_state(state) || self.goal == TargetState::Off
    }

    /// Returns the control word that is being sent, or zero before the first step.
    pub(super) fn control_word(&self) -> ControlWord {
        self.word.map_or(ControlWord::OFF, |(word, _)| word)
    }

    fn next_step(&self, now: ReportTimestamp, status: StatusWord, after_run: bool) -> StateSequenceStep {
        use ControlWord as W;
        let sends = |word: ControlWord| self.word.is_some_and(|(sent, _)| sent == word);
        // The drive has had enough time to process the word, so it will not miss the edge that follows.
        let seen = |word: ControlWord| {
            self.word.is_some_and(|(sent, since)| sent == word && now.has_elapsed_since(since, MAX_REPORT_DELAY))
        };
        let state = status.state();
        let word = match (state, self.goal) {
            (State::Fault | State::Locked, TargetState::Off) => return StateSequenceStep::There,
            (State::Fault, _) if !self.acknowledges => return StateSequenceStep::Lost,
            (State::Fault, _) if seen(W::ACKNOWLEDGE) || sends(W::OPERATIONAL) => W::OPERATIONAL,
            (State::Fault, _) => W::ACKNOWLEDGE,
            (State::Locked, _) if seen(W::OPERATIONAL) || sends(W::READY) => W::READY,
            (State::Locked, _) => W::OPERATIONAL,
            // Below the operational state, the drive forgets the run.
            (_, goal) if after_run && goal > TargetState::Ready => W::READY,
            (_, goal) => match TargetState::from_state(state) {
                level if level > goal => goal.control_word(),
                level if level < goal => level.next_level().control_word(),
                // Nothing else starts before the drive is at rest.
                _ if state == State::Moving => W::ENABLED,
                _ if after_run && goal == TargetState::Ready && status.is_set(StatusBit::SetpointAcknowledged) => {
                    W::READY
                }
                _ => return StateSequenceStep::There,
            },
        };
        let patience =
            |(sent, since): (ControlWord, ReportTimestamp)| sent == word && now.has_elapsed_since(since, STEP);
        if self.word.is_some_and(patience) { StateSequenceStep::Lost } else { StateSequenceStep::By(word) }
    }
}

impl DeadMan {
    /// Begins to bring the drive to the requested state.
    pub(super) fn begin_transition(
        &mut self,
        now: Moment,
        actual: ActualValues,
        goal: TargetState,
    ) -> Result<(), MotionRejection> {
        if actual.status.is_set(StatusBit::Fault) && goal != TargetState::Off {
            return Err(MotionRejection::Fault);
        }
        self.stage = Stage::Lead(StateSequencer::new(goal));
        self.advance_stage(now, actual);
        Ok(())
    }

    pub(super) fn acknowledge(&mut self, now: Moment, actual: ActualValues) -> Result<(), MotionRejection> {
        if matches!(actual.status.state(), State::Fault | State::Locked) {
            self.stage = Stage::Lead(StateSequencer::fault_exit());
            self.advance_stage(now, actual);
        } else {
            self.end_action(ActionEnd::Done);
        }
        Ok(())
    }

    pub(super) fn continue_transition(&mut self, now: Moment, actual: ActualValues, mut lead: StateSequencer) {
        let mark = self.current_mark(now);
        match lead.next_step(mark, actual.status, self.after_run) {
            StateSequenceStep::By(word) => {
                if lead.word.is_none_or(|(sent, _)| sent != word) {
                    lead.word = Some((word, mark));
                }
                self.stage = Stage::Lead(lead);
            }
            StateSequenceStep::There => {
                self.level = lead.goal;
                self.stage = Stage::Rest { moves: None };
                match self.act {
                    Some(UserAction { motion: Some(motion), .. }) => self.prepare_motion(now, actual, motion.kind),
                    _ => self.end_action(ActionEnd::Done),
                }
            }
            StateSequenceStep::Lost => {
                self.hold_state(actual.status.state());
                self.end_action(ActionEnd::NoAnswer(actual.status.state()));
            }
        }
    }

    /// Enters the stage in which a motion may begin, without starting one.
    fn prepare_motion(&mut self, now: Moment, actual: ActualValues, kind: MotionKind) {
        let acknowledged = actual.status.is_set(StatusBit::SetpointAcknowledged);
        self.after_run |= matches!(kind, MotionKind::Run { .. });
        self.stage = Stage::Arm { since: self.current_mark(now), acknowledged };
    }

    /// Holds the current state, or a lower one, when a sequence has been abandoned.
    pub(super) fn hold_state(&mut self, state: State) {
        let highest = if self.after_run { TargetState::Ready } else { TargetState::Enabled };
        self.level = match state {
            // Bit 0 stays set for the acknowledgement.
            State::Fault | State::Locked => TargetState::Operational,
            state => TargetState::from_state(state),
        }
        .min(highest)
        .min(TargetState::from_word(self.sent.control));
        self.stage = Stage::Rest { moves: None };
    }
}
