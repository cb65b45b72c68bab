//! The kinds of devices that this program knows: the one file that names them all.

use crate::devices::biss::profile::BissProfile;
use crate::devices::biss::views::BissView;
use crate::devices::hiperdrive::profile::HiperdriveProfile;
use crate::devices::hiperdrive::views::HiperdriveView;
use crate::devices::hiperface::profile::HiperfaceProfile;
use crate::devices::hiperface::views::HiperfaceView;
use crate::devices::interbus::profile::InterbusProfile;
use crate::devices::interbus::views::InterbusView;
use crate::devices::ssi::profile::SsiProfile;
use crate::devices::ssi::views::SsiView;
use crate::profile::{Formats, Profile};
use crate::signals::views::SignalsView;
use crate::ui::TabViews;

/// The formats of their profiles.
pub const FORMATS: Formats = Formats::new(&[
    HiperfaceProfile::FORMAT,
    BissProfile::FORMAT,
    SsiProfile::FORMAT,
    InterbusProfile::FORMAT,
    HiperdriveProfile::FORMAT,
]);

/// The tabs of the window, in the order of the navigation.
pub const TABS: TabViews =
    TabViews::new(&[&HiperfaceView, &BissView, &SsiView, &InterbusView, &HiperdriveView], &[&SignalsView]);

#[cfg(test)]
mod tests;
