//! The kinds of devices that this program knows: the one file that names them all.

use crate::buses::ethernet_ip::commands::EthernetIpDecoder;
use crate::cli::Commands;
use crate::devices::biss::commands::BissCommands;
use crate::devices::biss::profile::BissProfile;
use crate::devices::biss::views::BissView;
use crate::devices::hiperdrive::commands::HiperdriveCommands;
use crate::devices::hiperdrive::profile::HiperdriveProfile;
use crate::devices::hiperdrive::views::HiperdriveView;
use crate::devices::hiperface::commands::HiperfaceCommands;
use crate::devices::hiperface::profile::HiperfaceProfile;
use crate::devices::hiperface::views::HiperfaceView;
use crate::devices::interbus::commands::InterbusCommands;
use crate::devices::interbus::profile::InterbusProfile;
use crate::devices::interbus::views::InterbusView;
use crate::devices::ssi::commands::SsiCommands;
use crate::devices::ssi::profile::SsiProfile;
use crate::devices::ssi::views::SsiView;
use crate::profile::{Formats, Profile};
use crate::signals::commands::AnalyseCommand;
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

/// Their commands, and the protocols and commands beside them.
pub const COMMANDS: Commands = Commands::new(
    &[&HiperfaceCommands, &BissCommands, &SsiCommands, &InterbusCommands, &HiperdriveCommands],
    &[&EthernetIpDecoder],
    &[&AnalyseCommand],
);

#[cfg(test)]
mod tests;
