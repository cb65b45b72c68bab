//! What is recorded beyond a job: the original mode of an encoder, and the EEPROM write cycles that switching the mode
//! may have caused.

use crate::devices::interbus::protocol::StartupMode;

/// A temporary switch of an encoder away from its original mode.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ModeSwitch {
    /// The mode before the switch.
    pub found: StartupMode,
    /// All modes to which the encoder has been switched so far.
    pub sent: Vec<StartupMode>,
}

/// Persistent record of mode switches and EEPROM write cycles, by serial number. Reading continues even if a record
/// cannot be saved.
pub trait Journal {
    /// Returns whether any encoder has not been returned to its mode.
    fn has_modes_to_restore(&self) -> bool;

    /// Returns the recorded mode switch if the encoder was never returned from it.
    fn recorded_mode_switch(&self, serial_number: &str) -> Option<ModeSwitch>;

    /// Records that the encoder is about to enter the last mode in `excursion`.
    fn save_mode_switch(&mut self, serial_number: &str, excursion: &ModeSwitch);

    /// Records that the encoder is back in its original mode.
    fn record_mode_restored(&mut self, serial_number: &str);

    /// Records how many cam programs are about to be selected. The encoder may store each of them when it leaves it.
    fn record_planned_stores(&mut self, serial_number: &str, stores: u64);

    /// Records how many cam programs the encoder may have stored. Does nothing if no store was planned or possible.
    fn record_possible_stores(&mut self, serial_number: &str, stores: u64);
}
