//! The HIPERDRIVE tab.

use super::unit::Unit;
use crate::app::studio::Studio;
use crate::app::tab::Tab;

impl Studio {
    /// The device or profile that the HIPERDRIVE tab shows.
    pub fn hiperdrive(&self) -> Option<&Unit> {
        self.device(self.shown.of(Tab::Hiperdrive)?)?.get()
    }
}
