//! Sequences of control words that bring a drive to a state (reference, section 3). They are derived (`D`).

use super::control_word::ControlWord;
use super::status_word::{StatusBit, StatusWord};

/// A control word and the status that the drive must report before the next word is sent.
#[derive(Clone, Copy, Debug)]
pub struct Step {
    /// Word to send.
    pub word: ControlWord,
    /// Status bits and the values they must have.
    pub until: &'static [(StatusBit, bool)],
}

const fn recipe_step(word: ControlWord, until: &'static [(StatusBit, bool)]) -> Step {
    Step { word, until }
}

const READY: Step = recipe_step(ControlWord::READY, &[(StatusBit::Ready, true), (StatusBit::SwitchOnLock, false)]);
const OPERATIONAL: Step = recipe_step(ControlWord::OPERATIONAL, &[(StatusBit::Operational, true)]);
const ENABLED: Step = recipe_step(ControlWord::ENABLED, &[(StatusBit::OperationEnabled, true)]);

/// Steps from off to enabled. [`ControlWord::without_job_start`] must follow.
pub const ENABLE: [Step; 4] = [recipe_step(ControlWord::OFF, &[]), READY, OPERATIONAL, ENABLED];

/// Steps from a fault to enabled. [`ControlWord::without_job_start`] must follow. Bit 0 stays set during the
/// acknowledgement, so that its falling edge can still release the switch-on lock.
pub const ACKNOWLEDGE: [Step; 5] = [
    recipe_step(ControlWord::ACKNOWLEDGE, &[]),
    recipe_step(ControlWord::OPERATIONAL, &[(StatusBit::Fault, false), (StatusBit::SwitchOnLock, true)]),
    READY,
    OPERATIONAL,
    ENABLED,
];

/// Steps out of the switch-on lock if bit 0 is already clear. It is set first, because only its falling edge releases
/// the lock.
pub const UNLOCK: [Step; 2] = [recipe_step(ControlWord::OPERATIONAL, &[]), READY];

impl Step {
    /// Returns whether the drive has completed this step.
    pub fn is_done(&self, status: StatusWord) -> bool {
        self.until.iter().all(|(bit, set)| status.is_set(*bit) == *set)
    }
}
