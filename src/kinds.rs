//! The kinds of devices that this program knows: the one file that names them all.

use crate::devices::biss::profile::BissProfile;
use crate::devices::hiperdrive::profile::HiperdriveProfile;
use crate::devices::hiperface::profile::HiperfaceProfile;
use crate::devices::interbus::profile::InterbusProfile;
use crate::devices::ssi::profile::SsiProfile;
use crate::profile::{Formats, Profile};

/// The formats of their profiles.
pub const FORMATS: Formats = Formats::new(&[
    HiperfaceProfile::FORMAT,
    BissProfile::FORMAT,
    SsiProfile::FORMAT,
    InterbusProfile::FORMAT,
    HiperdriveProfile::FORMAT,
]);

#[cfg(test)]
mod tests;
