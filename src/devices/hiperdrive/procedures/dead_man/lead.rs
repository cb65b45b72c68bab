//! Leading a drive through its states: one control word after another, each until the drive has followed or a time
//! limit expires (reference 3, and the recipes in `devices/hiperdrive/protocol/recipe`).

use super::{Act, DeadMan, Ended, Mark, MotionKind, Refusal, SETTLE, STEP, Stage, TargetState};
use crate::devices::hiperdrive::protocol::{ActualValues, ControlBit, ControlWord, State, StatusBit, StatusWord};
use crate::units::Moment;

#[derive(Clone, Copy, Debug)]
pub(super) struct StateSequencer {
    goal: TargetState,
    acknowledges: bool,
    /// The control word being sent, and the mark at which sending began.
    word: Option<(ControlWord, Mark)>,
}

enum StateSequenceStep {
    By(ControlWord),
    There,
    Lost,
}

impl TargetState {
    pub(super) const fn from_word(word: ControlWord) -> TargetState {
        if !word.has(ControlBit::Control) {
            TargetState::Off
        } else if !word.has(ControlBit::On) {
            TargetState::Ready
        } else if !word.has(ControlBit::Enable) {
            TargetState::Operational
        } else {
            TargetState::Enabled
        }
    }

    pub(super) const fn word(self) -> ControlWord {
        match self {
            TargetState::Off => ControlWord::OFF,
            TargetState::Ready => ControlWord::READY,
            TargetState::Operational => ControlWord::OPERATIONAL,
            TargetState::Enabled => ControlWord::ENABLED,
        }
    }
}

impl StateSequencer {
    pub(super) const fn to(goal: TargetState) -> Self {
        StateSequencer { goal, acknowledges: false, word: None }
    }

    /// Creates a sequence that leads the drive out of a fault or the switch-on lock to the ready state.
    const fn out() -> Self {
        StateSequencer { goal: TargetState::Ready, acknowledges: true, word: None }
    }

    pub(super) const fn goal(&self) -> TargetState {
        self.goal
    }

    /// Returns whether the sequence only removes torque or keeps it off. It then needs no refresh.
    pub(super) fn only_removes_torque(&self, state: State) -> bool {
        self.goal <= TargetState::of(state) || self.goal == TargetState::Off
    }

    /// Returns the control word being sent, which is zero before the first step.
    pub(super) fn word(&self) -> ControlWord {
        self.word.map_or(ControlWord::OFF, |(word, _)| word)
    }

    fn next_step(&self, now: Mark, status: StatusWord, after_run: bool) -> StateSequenceStep {
        use ControlWord as W;
        let sends = |word: ControlWord| self.word.is_some_and(|(sent, _)| sent == word);
        // The drive has had enough time to process the word, so it will not miss the edge that follows.
        let seen = |word: ControlWord| {
            self.word.is_some_and(|(sent, since)| sent == word && now.has_elapsed_since(since, SETTLE))
        };
        let state = status.state();
        let word = match (state, self.goal) {
            (State::Fault | State::Locked, TargetState::Off) => return StateSequenceStep::There,
            (State::Fault, _) if !self.acknowledges => return StateSequenceStep::Lost,
            (State::Fault, _) if seen(W::ACKNOWLEDGE) || sends(W::OPERATIONAL) => W::OPERATIONAL,
            (State::Fault, _) => W::ACKNOWLEDGE,
            (State::Locked, _) if seen(W::OPERATIONAL) || sends(W::READY) => W::READY,
            (State::Locked, _) => W::OPERATIONAL,
            // Below operational the drive forgets the run.
            (_, goal) if after_run && goal > TargetState::Ready => W::READY,
            (_, goal) => match TargetState::of(state) {
                level if level > goal => goal.word(),
                level if level < goal => level.above().word(),
                // Nothing else starts before the drive is at rest.
                _ if state == State::Moving => W::ENABLED,
                _ if after_run && goal == TargetState::Ready && status.has(StatusBit::SetpointAcknowledged) => W::READY,
                _ => return StateSequenceStep::There,
            },
        };
        let patience = |(sent, since): (ControlWord, Mark)| sent == word && now.has_elapsed_since(since, STEP);
        if self.word.is_some_and(patience) { StateSequenceStep::Lost } else { StateSequenceStep::By(word) }
    }
}

impl DeadMan {
    /// Starts to lead the drive to the requested state.
    pub(super) fn lead(&mut self, now: Moment, actual: ActualValues, goal: TargetState) -> Result<(), Refusal> {
        if actual.status.has(StatusBit::Fault) && goal != TargetState::Off {
            return Err(Refusal::Fault);
        }
        self.stage = Stage::Lead(StateSequencer::to(goal));
        self.advance(now, actual);
        Ok(())
    }

    pub(super) fn acknowledge(&mut self, now: Moment, actual: ActualValues) -> Result<(), Refusal> {
        if matches!(actual.status.state(), State::Fault | State::Locked) {
            self.stage = Stage::Lead(StateSequencer::out());
            self.advance(now, actual);
        } else {
            self.end(Ended::Done);
        }
        Ok(())
    }

    pub(super) fn go_on(&mut self, now: Moment, actual: ActualValues, mut lead: StateSequencer) {
        let mark = self.mark(now);
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
                    Some(Act { motion: Some(motion), .. }) => self.arm(now, actual, motion.kind),
                    _ => self.end(Ended::Done),
                }
            }
            StateSequenceStep::Lost => {
                self.hold_state(actual.status.state());
                self.end(Ended::NoAnswer(actual.status.state()));
            }
        }
    }

    /// Enters the stage whose control word allows a motion to begin, without starting one.
    fn arm(&mut self, now: Moment, actual: ActualValues, kind: MotionKind) {
        let acknowledged = actual.status.has(StatusBit::SetpointAcknowledged);
        self.after_run |= matches!(kind, MotionKind::Run { .. });
        self.stage = Stage::Arm { since: self.mark(now), acknowledged };
    }

    /// Holds the present state or a lower one after a sequence was abandoned.
    pub(super) fn hold_state(&mut self, state: State) {
        let highest = if self.after_run { TargetState::Ready } else { TargetState::Enabled };
        self.level = match state {
            // Bit 0 stays set for the acknowledgement.
            State::Fault | State::Locked => TargetState::Operational,
            state => TargetState::of(state),
        }
        .min(highest)
        .min(TargetState::from_word(self.sent.control));
        self.stage = Stage::Rest { moves: None };
    }
}
