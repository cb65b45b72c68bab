//! What the command line does with a kind of device, one function a command. What a kind does not have is refused as
//! wrong usage.

use super::args::{Common, Decode, DeviceKind, Do, Find, Position, Read, Restore, Save, Simulate, Status, Write};
use super::output::Output;
use super::simulate::Simulated;
use super::{Failure, Result};
use crate::app::Text;
use crate::devices::biss::commands as biss;
use crate::devices::hiperdrive::commands as hiperdrive;
use crate::devices::hiperface::commands as hiperface;
use crate::devices::interbus::commands as interbus;
use crate::devices::ssi::commands as ssi;
use crate::profile::{Body, Comparison, ProfileError};

/// A kind of device on the command line: the commands by their names.
pub(crate) struct Kind {
    /// As it is written on the command line and in profiles.
    pub(crate) name: &'static str,
    pub(crate) find: fn(&Common, &Output, &Find) -> Result,
    pub(crate) identify: fn(&Common, &Output) -> Result,
    pub(crate) status: fn(&Common, &Output, &Status) -> Result,
    pub(crate) position: fn(&Common, &Output, &Position) -> Result,
    pub(crate) read: fn(&Common, &Output, &Read) -> Result,
    pub(crate) save: fn(&Common, &Output, &Save) -> Result,
    pub(crate) write: fn(&Common, &Output, &Write) -> Result,
    pub(crate) act: fn(&Common, &Output, &Do) -> Result,
    pub(crate) decode: fn(&Output, &Decode) -> Result,
    pub(crate) restore: fn(&Common, &Output, &Restore, Body) -> Result,
    /// The virtual device that is to be served.
    pub(crate) simulated: fn(&Output, &Simulate) -> Result<Box<dyn Simulated>>,
    /// The device as it is, for a comparison: all of it, or at least what a profile says something about.
    pub(crate) present: fn(&Common, &Output, Option<&Body>) -> Result<Body>,
    /// What differs between two profiles, or that one of them is of another kind.
    pub(crate) compare: fn(&Body, &Body) -> std::result::Result<Comparison, ProfileError>,
    /// What is to be known of a profile, whatever is done with it.
    pub(crate) remark: fn(&Body) -> Option<Text>,
    /// That two profiles are not of the same device.
    pub(crate) other_device: fn(&Body, &Body) -> Option<String>,
}

/// A command that a kind of device does not have.
pub(crate) fn lacking(command: &str, kind: &str) -> Result {
    Err(Failure::Usage(format!("{command} is not for {kind} devices")))
}

pub(super) fn of(device: DeviceKind) -> &'static Kind {
    match device {
        DeviceKind::Hiperface => &hiperface::COMMANDS,
        DeviceKind::Biss => &biss::COMMANDS,
        DeviceKind::Ssi => &ssi::COMMANDS,
        DeviceKind::Interbus => &interbus::COMMANDS,
        DeviceKind::Hiperdrive => &hiperdrive::COMMANDS,
    }
}

/// The kind of device that a profile is of.
///
/// # Errors
/// It has no commands.
pub(super) fn of_profile(body: &Body) -> Result<&'static Kind> {
    let all = [&hiperface::COMMANDS, &biss::COMMANDS, &ssi::COMMANDS, &interbus::COMMANDS, &hiperdrive::COMMANDS];
    let of_kind = all.into_iter().find(|kind| kind.name == body.kind());
    of_kind.ok_or_else(|| Failure::Failed(vec![format!("There are no commands for {} devices.", body.kind())]))
}
