//! What the command line does with a kind of device, one function a command. What a kind does not have is refused as
//! wrong usage.

use super::args::{Common, DeviceKind, Do, Find, Position, Restore, Save, Simulate, Write};
use super::biss::Biss;
use super::hiperface::Hiperface;
use super::output::Output;
use super::simulate::Simulated;
use super::{Failure, Result};
use crate::profile::{Body, Comparison, ProfileError};

/// A kind of device on the command line.
pub(super) trait Kind {
    /// As it is written on the command line and in profiles.
    fn name(&self) -> &'static str;

    fn find(&self, _common: &Common, _output: &Output, _find: &Find) -> Result {
        self.lacks("find")
    }

    fn identify(&self, _common: &Common, _output: &Output) -> Result {
        self.lacks("identify")
    }

    fn status(&self, _common: &Common, _output: &Output) -> Result {
        self.lacks("status")
    }

    fn position(&self, _common: &Common, _output: &Output, _position: &Position) -> Result {
        self.lacks("position")
    }

    fn read(&self, _common: &Common, _output: &Output, _item: &str) -> Result {
        self.lacks("read")
    }

    fn save(&self, _common: &Common, _output: &Output, _save: &Save) -> Result {
        self.lacks("save")
    }

    fn write(&self, _common: &Common, _output: &Output, _write: &Write) -> Result {
        self.lacks("write")
    }

    fn act(&self, _common: &Common, _output: &Output, _act: &Do) -> Result {
        self.lacks("do")
    }

    fn decode(&self, output: &Output, words: &[String]) -> Result;

    /// The device as it is, for a comparison.
    fn present(&self, _common: &Common, _output: &Output) -> Result<Body> {
        Err(lacks(self.name(), "comparing with --link"))
    }

    /// What differs between two profiles.
    ///
    /// # Errors
    /// When one of them is of another kind.
    fn compare(&self, left: &Body, right: &Body) -> std::result::Result<Comparison, ProfileError>;

    /// That two profiles are not of the same device.
    fn other_device(&self, profile: &Body, device: &Body) -> Option<String>;

    fn restore(&self, _common: &Common, _output: &Output, _restore: &Restore, _profile: Body) -> Result {
        self.lacks("restore")
    }

    /// The virtual device that is to be served.
    fn simulated(&self, arguments: &Simulate) -> Result<Box<dyn Simulated>>;

    fn lacks(&self, command: &str) -> Result {
        Err(lacks(self.name(), command))
    }
}

fn lacks(kind: &str, command: &str) -> Failure {
    Failure::Usage(format!("{command} is not for {kind} devices"))
}

pub(super) fn of(device: DeviceKind) -> &'static dyn Kind {
    match device {
        DeviceKind::Hiperface => &Hiperface,
        DeviceKind::Biss => &Biss,
    }
}

/// The kind of device that a profile is of.
pub(super) fn of_profile(body: &Body) -> &'static dyn Kind {
    match body {
        Body::Hiperface(_) => &Hiperface,
        Body::Biss(_) => &Biss,
    }
}
