//! A virtual encoder on the serial line of a virtual adapter.

use super::{Bus, Config};
use crate::buses::bridge::sim::{AttachableKind, AttachedDevice, SerialDevice};
use crate::parameter::{Keywords, ParameterGroup};
use crate::parameters;
use crate::sim::ConfigError;
use crate::units::Moment;

parameters! {
    struct Settings: ConfigError {
        is_there: bool = false, "uart" => Keywords(&[("none", false), ("hiperface", true)]);
    }
}

/// A virtual encoder with factory settings that a link can attach to a virtual adapter's serial line.
#[derive(Clone, Copy, Debug)]
pub struct AttachableEncoder;

impl AttachableKind for AttachableEncoder {
    fn setting_names(&self) -> &'static [&'static str] {
        Settings::KEYS
    }

    fn attach_device(&self, pairs: &[(String, String)]) -> Result<Option<AttachedDevice>, ConfigError> {
        let is_there = Settings::read(pairs)?.is_there;
        Ok(is_there.then(|| AttachedDevice::Serial(Box::new(Bus::new(&Config::default())))))
    }
}

impl SerialDevice for Bus {
    fn clone_device(&self) -> Box<dyn SerialDevice> {
        Box::new(self.clone())
    }

    fn turn_shaft(&mut self, now: Moment, rpm: f64) {
        if let Some(encoder) = self.encoder_mut(0) {
            encoder.set_rpm(now, rpm);
        }
    }
}
