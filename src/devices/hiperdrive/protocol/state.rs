//! States of a drive and the transitions between them (reference, section 3), as derived from sections 6.4 and 6.5 of
//! the manual (`D`).

use std::fmt;

use super::control_word::{ControlBit, ControlWord};

/// State of a drive according to its status word.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum State {
    /// Control of the drive has not been requested.
    NotReady,
    /// Control has been requested.
    Ready,
    /// The drive is switched on.
    Operational,
    /// The drive may move.
    Enabled,
    /// The drive is moving.
    Moving,
    /// A fault has occurred.
    Fault,
    /// A fault has been acknowledged, but the switch-on lock is active.
    Locked,
}

/// An event that causes a transition.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Trigger {
    /// A bit of the control word is set.
    Set(ControlBit),
    /// A bit of the control word is clear.
    Clear(ControlBit),
    /// A bit of the control word changes from set to clear, while the other bit, if given, has the given value.
    Falls(ControlBit, Option<(ControlBit, bool)>),
    /// A job or a run starts.
    Starts,
    /// The motion has ended.
    Ends,
    /// A fault has occurred, or the connection was lost.
    Fails,
}

/// Row of the transition table.
#[derive(Clone, Copy, Debug)]
pub struct Transition {
    /// States in which the transition applies.
    pub from: &'static [State],
    /// Event that causes it.
    pub trigger: Trigger,
    /// Resulting state.
    pub to: State,
    /// Control word that causes the transition, or `None` if no single word does.
    pub word: Option<ControlWord>,
    /// Whether the transition is an assumption, because the manual does not define it.
    pub assumed: bool,
}

use State::{Enabled, Fault, Locked, Moving, NotReady, Operational, Ready};
use Trigger::{Clear, Ends, Fails, Falls, Set, Starts};

const fn row(from: &'static [State], trigger: Trigger, to: State, word: Option<ControlWord>) -> Transition {
    Transition { from, trigger, to, word, assumed: false }
}

const fn assumed_transition(from: &'static [State], trigger: Trigger, to: State, word: ControlWord) -> Transition {
    Transition { from, trigger, to, word: Some(word), assumed: true }
}

/// All transitions of the state machine. The first one that applies takes effect.
pub const TRANSITIONS: [Transition; 14] = [
    row(&[NotReady], Set(ControlBit::Control), Ready, Some(ControlWord::READY)),
    row(&[Ready, Operational, Enabled, Moving], Clear(ControlBit::Control), NotReady, Some(ControlWord::OFF)),
    row(&[Ready], Set(ControlBit::On), Operational, Some(ControlWord::OPERATIONAL)),
    row(&[Operational], Clear(ControlBit::On), Ready, Some(ControlWord::READY)),
    row(&[Operational], Set(ControlBit::Enable), Enabled, Some(ControlWord::ENABLED)),
    assumed_transition(&[Enabled, Moving], Clear(ControlBit::On), Ready, ControlWord::READY),
    assumed_transition(&[Enabled, Moving], Clear(ControlBit::Enable), Operational, ControlWord::OPERATIONAL),
    row(&[Enabled], Starts, Moving, None),
    row(&[Moving], Starts, Moving, None),
    row(&[Moving], Ends, Enabled, None),
    row(&[Operational, Enabled, Moving], Fails, Fault, None),
    row(&[Fault], Falls(ControlBit::Acknowledge, None), Locked, Some(ControlWord::OPERATIONAL)),
    row(&[Locked], Falls(ControlBit::On, Some((ControlBit::Control, true))), Ready, Some(ControlWord::READY)),
    row(&[Locked], Falls(ControlBit::On, Some((ControlBit::Control, false))), NotReady, Some(ControlWord::OFF)),
];

impl State {
    /// All states.
    pub const ALL: [State; 7] = [NotReady, Ready, Operational, Enabled, Moving, Fault, Locked];

    /// Returns the name.
    pub const fn name(self) -> &'static str {
        match self {
            NotReady => "not ready",
            Ready => "ready",
            Operational => "operational",
            Enabled => "enabled",
            Moving => "moving",
            Fault => "fault",
            Locked => "switch-on lock",
        }
    }

    /// Returns the transitions from this state.
    pub fn transitions(self) -> impl Iterator<Item = &'static Transition> {
        TRANSITIONS.iter().filter(move |row| row.from.contains(&self))
    }

    /// Returns the state after the control word has changed from `before` to `now`. At most one transition takes place.
    /// No control word alone leads to the moving state.
    pub fn after_control_word(self, before: ControlWord, now: ControlWord) -> State {
        let applies = |trigger: Trigger| match trigger {
            Set(bit) => now.is_set(bit),
            Clear(bit) => !now.is_set(bit),
            Falls(bit, beside) => {
                let fits = beside.is_none_or(|(bit, set)| now.is_set(bit) == set);
                before.is_set(bit) && !now.is_set(bit) && fits
            }
            Starts | Ends | Fails => false,
        };
        self.transitions().find(|row| applies(row.trigger)).map_or(self, |row| row.to)
    }

    /// Returns the state after an event that is not a control word.
    pub fn after_event(self, trigger: Trigger) -> State {
        self.transitions().find(|row| row.trigger == trigger).map_or(self, |row| row.to)
    }

    /// Returns whether the keys on the drive can move it in this state.
    pub const fn allows_key_operation(self) -> bool {
        matches!(self, NotReady | Ready | Fault | Locked)
    }
}

impl fmt::Display for State {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}
