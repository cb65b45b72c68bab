//! Words that lead a drive somewhere, one after the other (reference 3, `D`).

use super::control_word::ControlWord;
use super::status_word::{StatusBit, StatusWord};

/// A word, and what the drive has to say before the next one.
#[derive(Clone, Copy, Debug)]
pub struct Step {
    /// What is sent.
    pub word: ControlWord,
    /// Bits with what they have to be.
    pub until: &'static [(StatusBit, bool)],
}

const fn step(word: ControlWord, until: &'static [(StatusBit, bool)]) -> Step {
    Step { word, until }
}

const READY: Step = step(ControlWord::READY, &[(StatusBit::Ready, true), (StatusBit::SwitchOnLock, false)]);
const OPERATIONAL: Step = step(ControlWord::OPERATIONAL, &[(StatusBit::Operational, true)]);
const ENABLED: Step = step(ControlWord::ENABLED, &[(StatusBit::OperationEnabled, true)]);

/// From nothing to enabled. [`ControlWord::holding`] follows.
pub const ENABLE: [Step; 4] = [step(ControlWord::OFF, &[]), READY, OPERATIONAL, ENABLED];

/// From a fault to enabled. Bit 0 stays set over the acknowledgement, so that its falling edge is left for the lock.
/// [`ControlWord::holding`] follows.
pub const ACKNOWLEDGE: [Step; 5] = [
    step(ControlWord::ACKNOWLEDGE, &[]),
    step(ControlWord::OPERATIONAL, &[(StatusBit::Fault, false), (StatusBit::SwitchOnLock, true)]),
    READY,
    OPERATIONAL,
    ENABLED,
];

/// Out of the lock where bit 0 has fallen before: there has to be something to fall.
pub const UNLOCK: [Step; 2] = [step(ControlWord::OPERATIONAL, &[]), READY];

impl Step {
    /// The drive is where this step leads.
    pub fn is_done(&self, status: StatusWord) -> bool {
        self.until.iter().all(|(bit, set)| status.has(*bit) == *set)
    }
}
