//! Facts that outlast a job: the mode to which an encoder was switched, until it is returned, and the store cycles that
//! this may have cost.

use crate::devices::interbus::protocol::StartupMode;

/// A departure of an encoder from the mode in which it was found.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Excursion {
    /// The mode before.
    pub found: StartupMode,
    /// Every mode to which the encoder has been switched since.
    pub sent: Vec<StartupMode>,
}

/// Records facts that outlast a job, by serial number. A failure to record does not stop a read.
pub trait Journal {
    /// Returns whether an encoder was not returned to operation.
    fn has_excursions(&self) -> bool;

    /// Returns the recorded excursion of an encoder that was not returned to its mode, or `None` if there is no record.
    fn excursion(&self, serial_number: &str) -> Option<Excursion>;

    /// Records that the encoder is about to be switched to the last mode of the excursion.
    fn leaves(&mut self, serial_number: &str, excursion: &Excursion);

    /// Records that the encoder is back in its previous mode.
    fn is_back(&mut self, serial_number: &str);

    /// Records that the given number of cam programs is about to be selected; leaving a program may store it.
    fn intends(&mut self, serial_number: &str, stores: u64);

    /// Records how many programs may have been stored. Does nothing if no store was intended and none can have
    /// happened.
    fn may_have_stored(&mut self, serial_number: &str, stores: u64);
}
