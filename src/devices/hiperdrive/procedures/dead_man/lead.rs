//! Leading a drive through its states: one control word after another, each until the drive has followed or a time
//! limit expires (reference 3, and the recipes in `devices/hiperdrive/protocol/recipe`).

use super::{Act, DeadMan, Ended, Goal, Mark, MotionKind, Refusal, SETTLE, STEP, Stage};
use crate::devices::hiperdrive::protocol::{Actual, ControlBit, ControlWord, State, StatusBit, StatusWord};
use crate::units::Moment;

#[derive(Clone, Copy, Debug)]
pub(super) struct Lead {
    goal: Goal,
    acknowledges: bool,
    /// The control word being sent, and the mark at which sending began.
    word: Option<(ControlWord, Mark)>,
}

enum GoalSequenceStep {
    By(ControlWord),
    There,
    Lost,
}

impl Goal {
    pub(super) const fn of_word(word: ControlWord) -> Goal {
        if !word.has(ControlBit::Control) {
            Goal::Off
        } else if !word.has(ControlBit::On) {
            Goal::Ready
        } else if !word.has(ControlBit::Enable) {
            Goal::Operational
        } else {
            Goal::Enabled
        }
    }

    pub(super) const fn word(self) -> ControlWord {
        match self {
            Goal::Off => ControlWord::OFF,
            Goal::Ready => ControlWord::READY,
            Goal::Operational => ControlWord::OPERATIONAL,
            Goal::Enabled => ControlWord::ENABLED,
        }
    }
}

impl Lead {
    pub(super) const fn to(goal: Goal) -> Self {
        Lead { goal, acknowledges: false, word: None }
    }

    /// Creates a lead out of a fault or the switch-on lock, to the ready state.
    const fn out() -> Self {
        Lead { goal: Goal::Ready, acknowledges: true, word: None }
    }

    pub(super) const fn goal(&self) -> Goal {
        self.goal
    }

    /// Returns whether the lead only removes torque or keeps it off, so that no refresh is required.
    pub(super) fn only_downwards(&self, state: State) -> bool {
        self.goal <= Goal::of(state) || self.goal == Goal::Off
    }

    /// Returns the control word being sent, which is zero before the first step.
    pub(super) fn word(&self) -> ControlWord {
        self.word.map_or(ControlWord::OFF, |(word, _)| word)
    }

    fn next_step(&self, now: Mark, status: StatusWord, after_run: bool) -> GoalSequenceStep {
        use ControlWord as W;
        let sends = |word: ControlWord| self.word.is_some_and(|(sent, _)| sent == word);
        // The drive has received a word for long enough to have processed it: the edge that follows must not be missed.
        let seen =
            |word: ControlWord| self.word.is_some_and(|(sent, since)| sent == word && now.is_past(since, SETTLE));
        let state = status.state();
        let word = match (state, self.goal) {
            (State::Fault | State::Locked, Goal::Off) => return GoalSequenceStep::There,
            (State::Fault, _) if !self.acknowledges => return GoalSequenceStep::Lost,
            (State::Fault, _) if seen(W::ACKNOWLEDGE) || sends(W::OPERATIONAL) => W::OPERATIONAL,
            (State::Fault, _) => W::ACKNOWLEDGE,
            (State::Locked, _) if seen(W::OPERATIONAL) || sends(W::READY) => W::READY,
            (State::Locked, _) => W::OPERATIONAL,
            // Below operational the drive forgets the run.
            (_, goal) if after_run && goal > Goal::Ready => W::READY,
            (_, goal) => match Goal::of(state) {
                level if level > goal => goal.word(),
                level if level < goal => level.above().word(),
                // Nothing else starts before it stands still.
                _ if state == State::Moving => W::ENABLED,
                _ if after_run && goal == Goal::Ready && status.has(StatusBit::SetpointAcknowledged) => W::READY,
                _ => return GoalSequenceStep::There,
            },
        };
        let patience = |(sent, since): (ControlWord, Mark)| sent == word && now.is_past(since, STEP);
        if self.word.is_some_and(patience) { GoalSequenceStep::Lost } else { GoalSequenceStep::By(word) }
    }
}

impl DeadMan {
    /// Starts to lead the drive to the requested state.
    pub(super) fn lead(&mut self, now: Moment, actual: Actual, goal: Goal) -> Result<(), Refusal> {
        if actual.status.has(StatusBit::Fault) && goal != Goal::Off {
            return Err(Refusal::Fault);
        }
        self.stage = Stage::Lead(Lead::to(goal));
        self.advance(now, actual);
        Ok(())
    }

    pub(super) fn acknowledge(&mut self, now: Moment, actual: Actual) -> Result<(), Refusal> {
        if matches!(actual.status.state(), State::Fault | State::Locked) {
            self.stage = Stage::Lead(Lead::out());
            self.advance(now, actual);
        } else {
            self.end(Ended::Done);
        }
        Ok(())
    }

    pub(super) fn go_on(&mut self, now: Moment, actual: Actual, mut lead: Lead) {
        let mark = self.mark(now);
        match lead.next_step(mark, actual.status, self.after_run) {
            GoalSequenceStep::By(word) => {
                if lead.word.is_none_or(|(sent, _)| sent != word) {
                    lead.word = Some((word, mark));
                }
                self.stage = Stage::Lead(lead);
            }
            GoalSequenceStep::There => {
                self.level = lead.goal;
                self.stage = Stage::Rest { moves: None };
                match self.act {
                    Some(Act { motion: Some(motion), .. }) => self.arm(now, actual, motion.kind),
                    _ => self.end(Ended::Done),
                }
            }
            GoalSequenceStep::Lost => {
                self.hold_state(actual.status.state());
                self.end(Ended::NoAnswer(actual.status.state()));
            }
        }
    }

    /// Enters the stage whose control word allows a motion to begin, without starting one.
    fn arm(&mut self, now: Moment, actual: Actual, kind: MotionKind) {
        let acknowledged = actual.status.has(StatusBit::SetpointAcknowledged);
        self.after_run |= matches!(kind, MotionKind::Run { .. });
        self.stage = Stage::Arm { since: self.mark(now), acknowledged };
    }

    /// Holds the present state or a lower one after the lead has been abandoned.
    pub(super) fn hold_state(&mut self, state: State) {
        let highest = if self.after_run { Goal::Ready } else { Goal::Enabled };
        self.level = match state {
            // Bit 0 stays set for the acknowledgement.
            State::Fault | State::Locked => Goal::Operational,
            state => Goal::of(state),
        }
        .min(highest)
        .min(Goal::of_word(self.sent.control));
        self.stage = Stage::Rest { moves: None };
    }
}
