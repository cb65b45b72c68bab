//! A kit encoder on the bus of a virtual adapter.

use super::{Config, Encoder};
use crate::buses::bridge::sim::{AttachableKind, AttachedDevice, BissDevice};
use crate::sim::{ConfigError, Motor, SimulatedFaults};
use crate::units::Moment;

/// A kit encoder on the bus of an adapter, created from a [`Config`].
#[derive(Clone, Copy, Debug)]
pub struct AttachableEncoder;

impl AttachableKind for AttachableEncoder {
    fn setting_names(&self) -> &'static [&'static str] {
        Config::KEYS
    }

    fn attach_device(&self, pairs: &[(String, String)]) -> Result<Option<AttachedDevice>, ConfigError> {
        Ok(Some(AttachedDevice::Biss(Box::new(Encoder::new(&Config::from_pairs(pairs)?)))))
    }
}

impl BissDevice for Encoder {
    fn clone_device(&self) -> Box<dyn BissDevice> {
        Box::new(self.clone())
    }

    fn frame_at(&mut self, at: Moment) -> Option<(u64, u8)> {
        let reading = self.position_at(at)?;
        Some((self.layout().emit(&reading), self.layout().bits()))
    }

    fn shaft_position(&mut self, at: Moment) -> Option<(u64, u64)> {
        self.position_at(at).map(|_| self.shaft_position(at))
    }

    fn motor(&self) -> Motor {
        Encoder::motor(self)
    }

    fn set_rpm(&mut self, now: Moment, rpm: f64) {
        Encoder::set_rpm(self, now, rpm);
    }

    fn set_faults(&mut self, faults: &SimulatedFaults) {
        Encoder::set_faults(self, faults);
    }

    fn disconnect(&mut self) {
        Encoder::disconnect(self);
    }

    fn connect(&mut self, now: Moment) {
        Encoder::connect(self, now);
    }

    fn has_power(&self) -> bool {
        Encoder::has_power(self)
    }

    fn can_access_registers(&mut self, now: Moment) -> bool {
        Encoder::can_access_registers(self, now)
    }

    fn has_address(&self, address: u8) -> bool {
        self.address(address).is_some()
    }

    fn read_register(&mut self, now: Moment, address: u8) -> Option<u8> {
        let place = self.address(address)?;
        self.read(now, place)
    }

    fn write_register(&mut self, now: Moment, address: u8, value: u8) -> bool {
        self.address(address).is_some_and(|place| self.write(now, place, value))
    }
}
