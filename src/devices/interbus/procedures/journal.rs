//! State that outlives a job: the original mode of an encoder, and the store cycles that a switch of the mode may have
//! used.

use crate::devices::interbus::protocol::StartupMode;

/// A temporary switch of an encoder away from its original mode.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ModeSwitch {
    /// The mode before the switch.
    pub found: StartupMode,
    /// All modes to which the encoder has been switched so far.
    pub sent: Vec<StartupMode>,
}

/// Persistent record of mode switches and stores by serial number. Reading continues if a record cannot be saved.
pub trait Journal {
    /// Returns whether there is an encoder that was not returned to its mode.
    fn has_modes_to_restore(&self) -> bool;

    /// Returns the mode switch from which an encoder was not returned, or `None` if there is no record.
    fn recorded_mode_switch(&self, serial_number: &str) -> Option<ModeSwitch>;

    /// Records that the encoder is about to enter the last mode in `excursion`.
    fn save_mode_switch(&mut self, serial_number: &str, excursion: &ModeSwitch);

    /// Records that the encoder is back in the mode before the switch.
    fn record_mode_restored(&mut self, serial_number: &str);

    /// Records how many cam programs are about to be selected, since leaving a program may store it.
    fn record_planned_stores(&mut self, serial_number: &str, stores: u64);

    /// Records how many cam programs the encoder may have stored. It has no effect if no store was announced and none
    /// can have happened.
    fn record_possible_stores(&mut self, serial_number: &str, stores: u64);
}
