//! The drive's states and what leads from one to another (reference 3, reconstructed from the manual's 6.4 and 6.5, `D`).

use std::fmt;

use super::control_word::{ControlBit, ControlWord};

/// A state, as the status word tells it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum State {
    /// Nobody has asked for the drive.
    NotReady,
    /// The control has.
    Ready,
    /// It is on.
    Operational,
    /// It may move.
    Enabled,
    /// It moves.
    Moving,
    /// Something went wrong.
    Fault,
    /// A fault was acknowledged.
    Locked,
}

/// What leads from a state to another.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Trigger {
    /// A bit of the control word is set.
    Set(ControlBit),
    /// A bit of the control word is clear.
    Clear(ControlBit),
    /// A bit falls while another one is set, or clear.
    Falls(ControlBit, Option<(ControlBit, bool)>),
    /// A job or a run begins.
    Starts,
    /// The motion has ended.
    Ends,
    /// Something went wrong, or a connection was lost.
    Fails,
}

/// A row of the table.
#[derive(Clone, Copy, Debug)]
pub struct Transition {
    /// From any of these.
    pub from: &'static [State],
    /// By this.
    pub trigger: Trigger,
    /// To this.
    pub to: State,
    /// The word that does it, where a word alone does.
    pub word: Option<ControlWord>,
    /// The manual does not say it.
    pub assumed: bool,
}

use State::{Enabled, Fault, Locked, Moving, NotReady, Operational, Ready};
use Trigger::{Clear, Ends, Fails, Falls, Set, Starts};

const fn row(from: &'static [State], trigger: Trigger, to: State, word: Option<ControlWord>) -> Transition {
    Transition { from, trigger, to, word, assumed: false }
}

const fn assumed(from: &'static [State], trigger: Trigger, to: State, word: ControlWord) -> Transition {
    Transition { from, trigger, to, word: Some(word), assumed: true }
}

/// All of them. Of several that apply the first one counts.
pub const TRANSITIONS: [Transition; 14] = [
    row(&[NotReady], Set(ControlBit::Control), Ready, Some(ControlWord::READY)),
    row(&[Ready, Operational, Enabled, Moving], Clear(ControlBit::Control), NotReady, Some(ControlWord::OFF)),
    row(&[Ready], Set(ControlBit::On), Operational, Some(ControlWord::OPERATIONAL)),
    row(&[Operational], Clear(ControlBit::On), Ready, Some(ControlWord::READY)),
    row(&[Operational], Set(ControlBit::Enable), Enabled, Some(ControlWord::ENABLED)),
    assumed(&[Enabled, Moving], Clear(ControlBit::On), Ready, ControlWord::READY),
    assumed(&[Enabled, Moving], Clear(ControlBit::Enable), Operational, ControlWord::OPERATIONAL),
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

    /// What it is called.
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

    /// What may follow it.
    pub fn transitions(self) -> impl Iterator<Item = &'static Transition> {
        TRANSITIONS.iter().filter(move |row| row.from.contains(&self))
    }

    /// The state behind this one when the word `now` follows `before`: one step at most. Motion is not the word's alone.
    pub fn after(self, before: ControlWord, now: ControlWord) -> State {
        let applies = |trigger: Trigger| match trigger {
            Set(bit) => now.has(bit),
            Clear(bit) => !now.has(bit),
            Falls(bit, beside) => {
                let fits = beside.is_none_or(|(bit, set)| now.has(bit) == set);
                before.has(bit) && !now.has(bit) && fits
            }
            Starts | Ends | Fails => false,
        };
        self.transitions().find(|row| applies(row.trigger)).map_or(self, |row| row.to)
    }

    /// The state behind this one by something that is no word.
    pub fn by(self, trigger: Trigger) -> State {
        self.transitions().find(|row| row.trigger == trigger).map_or(self, |row| row.to)
    }

    /// The drive's own keys move it in this state.
    pub const fn obeys_keys(self) -> bool {
        matches!(self, NotReady | Ready | Fault | Locked)
    }
}

impl fmt::Display for State {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}
