//! INTERBUS encoders among the devices of the studio.

use super::encoder::Encoder;
use crate::app::studio::Studio;
use crate::app::tab::Tab;

impl Studio {
    /// The encoder or profile that the INTERBUS tab shows.
    pub fn interbus(&self) -> Option<&Encoder> {
        self.device(self.shown.of(Tab::Interbus)?)?.get()
    }
}
