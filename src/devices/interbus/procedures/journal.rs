//! Facts that outlast a job: the mode to which an encoder was switched, until it is returned, and the store cycles that
//! this may have cost.

use crate::devices::interbus::protocol::StartupMode;

/// An encoder that was sent into other modes than the one in which it was found.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Excursion {
    /// The mode before.
    pub found: StartupMode,
    /// Every mode it was sent into since.
    pub sent: Vec<StartupMode>,
}

/// Records facts that outlast a job, by serial number. A failure to record does not stop a read.
pub trait Journal {
    /// Returns whether an encoder was not returned to operation.
    fn has_excursions(&self) -> bool;

    /// Returns the recorded excursion of an encoder that was not returned to its mode; `None` if there is none.
    fn excursion(&self, serial_number: &str) -> Option<Excursion>;

    /// Notes that the encoder is about to be sent into the last of these modes.
    fn leaves(&mut self, serial_number: &str, excursion: &Excursion);

    /// Records that the encoder is back in its previous mode.
    fn is_back(&mut self, serial_number: &str);

    /// Records that this many cam programs are about to be selected, each of which may be stored when it is left.
    fn intends(&mut self, serial_number: &str, stores: u64);

    /// Records how many may have been stored; nothing if none was intended and none can have been.
    fn may_have_stored(&mut self, serial_number: &str, stores: u64);
}
