//! The tabs of the window.

use crate::devices::biss::jobs as biss;
use crate::devices::biss::state::BissForm;
use crate::devices::hiperdrive::jobs as hiperdrive;
use crate::devices::hiperdrive::state::HiperdriveForm;
use crate::devices::hiperface::jobs as hiperface;
use crate::devices::interbus::jobs as interbus;
use crate::devices::interbus::state::InterbusForm;
use crate::devices::ssi::jobs as ssi;
use crate::devices::ssi::state::SsiForm;
use crate::link::LinkUrl;
use crate::worker::OpenError;

/// A tab of the window: a kind of device.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, serde::Serialize, serde::Deserialize)]
pub enum Tab {
    /// HIPERFACE motor-feedback encoders.
    #[default]
    Hiperface,
    /// BiSS C encoders.
    Biss,
    /// SSI encoders and their frames.
    Ssi,
    /// INTERBUS encoders and their cams.
    Interbus,
    /// HIPERDRIVE drives.
    Hiperdrive,
    /// Captures of sine and cosine, whatever encoder they are from.
    Signals,
}

impl Tab {
    /// The tabs that show devices.
    pub const DEVICES: [Tab; 5] = [Tab::Hiperface, Tab::Biss, Tab::Ssi, Tab::Interbus, Tab::Hiperdrive];

    /// The name of its bus, the same in every language; `None` for a tab that shows no device.
    pub fn bus(self) -> Option<&'static str> {
        match self {
            Tab::Hiperface => Some("HIPERFACE"),
            Tab::Biss => Some("BiSS"),
            Tab::Ssi => Some("SSI"),
            Tab::Interbus => Some("INTERBUS"),
            Tab::Hiperdrive => Some("HIPERDRIVE"),
            Tab::Signals => None,
        }
    }
}

impl Tab {
    /// Whether a link can lead to a device of its kind, as far as that can be told without opening it.
    pub(super) fn check(self, url: &LinkUrl) -> Result<(), OpenError> {
        match self {
            Tab::Biss => biss::check(url),
            Tab::Ssi => ssi::check(url),
            Tab::Interbus => interbus::check(url),
            Tab::Hiperdrive => hiperdrive::check(url),
            Tab::Hiperface | Tab::Signals => hiperface::check(url),
        }
    }

    /// The virtual device of its kind.
    pub(super) fn virtual_link(self) -> LinkUrl {
        match self {
            Tab::Biss => BissForm::usual(),
            Tab::Ssi => SsiForm::usual(),
            Tab::Interbus => InterbusForm::usual(),
            Tab::Hiperdrive => HiperdriveForm::usual(),
            Tab::Hiperface | Tab::Signals => LinkUrl::sim(),
        }
    }
}
