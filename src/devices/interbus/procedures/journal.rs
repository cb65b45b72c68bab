//! What of a job outlasts it: where an encoder was sent, until it is led back, and what that may have stored.

use crate::devices::interbus::protocol::StartupMode;

/// An encoder that was sent into other modes than the one in which it was found.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Excursion {
    /// What it did before.
    pub found: StartupMode,
    /// Every mode it was sent into since.
    pub sent: Vec<StartupMode>,
}

/// Where a job notes what outlasts it, by serial number. What cannot be noted stops no reading.
pub trait Journal {
    /// Some encoder was not led back.
    fn has_excursions(&self) -> bool;

    /// Where this one is that was not led back; `None` where nothing is noted of it.
    fn excursion(&self, serial_number: &str) -> Option<Excursion>;

    /// It is about to be sent into the last of these modes.
    fn leaves(&mut self, serial_number: &str, excursion: &Excursion);

    /// It does again what it did before.
    fn is_back(&mut self, serial_number: &str);

    /// So many cam programs are about to be selected, each of which it may store when it leaves it.
    fn intends(&mut self, serial_number: &str, stores: u64);

    /// So many it may have stored; nothing where none was intended and none can have been.
    fn may_have_stored(&mut self, serial_number: &str, stores: u64);
}
