//! What the command line does with a kind of device, one function a command. What a kind does not have is refused as
//! wrong usage.

use super::args::{Common, DeviceKind, Do, Find, Position, Save, Simulate, Write};
use super::biss::Biss;
use super::hiperface::Hiperface;
use super::output::Output;
use super::simulate::Simulated;
use super::{Failure, Result};

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

    /// The virtual device that is to be served.
    fn simulated(&self, arguments: &Simulate) -> Result<Box<dyn Simulated>>;

    fn lacks(&self, command: &str) -> Result {
        Err(Failure::Usage(format!("{command} is not for {} devices", self.name())))
    }
}

pub(super) fn of(device: DeviceKind) -> &'static dyn Kind {
    match device {
        DeviceKind::Hiperface => &Hiperface,
        DeviceKind::Biss => &Biss,
    }
}
