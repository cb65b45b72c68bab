//! Facts that outlast a job: the mode to which an encoder was switched, until it is returned, and the store cycles that
//! this may have cost.

use crate::devices::interbus::protocol::StartupMode;

/// A temporary switch of an encoder away from its original mode.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ModeSwitch {
    /// The mode before.
    pub found: StartupMode,
    /// Every mode to which the encoder has been switched so far.
    pub sent: Vec<StartupMode>,
}

/// Persistent record of mode switches and stores, by serial number. A failure to record does not stop a read.
pub trait Journal {
    /// Returns whether any encoder has not been returned to its mode.
    fn has_excursions(&self) -> bool;

    /// Returns the recorded excursion of an encoder that was not returned to its mode, or `None` if there is no record.
    fn recorded_excursion(&self, serial_number: &str) -> Option<ModeSwitch>;

    /// Records, before the switch, that the encoder will enter the last mode listed in the excursion.
    fn record_excursion(&mut self, serial_number: &str, excursion: &ModeSwitch);

    /// Records that the encoder is back in its previous mode.
    fn record_return(&mut self, serial_number: &str);

    /// Records, in advance, the number of cam programs to be selected, since leaving a program may store it.
    fn record_intent(&mut self, serial_number: &str, stores: u64);

    /// Records how many cam programs the encoder may have stored. Does nothing if no store was announced and none can
    /// have happened.
    fn record_possible_stores(&mut self, serial_number: &str, stores: u64);
}
