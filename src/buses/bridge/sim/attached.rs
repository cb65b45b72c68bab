//! Devices attached to the clocked buses and the serial line of the adapter. The adapter names none of them; each
//! parses its own settings of a `sim:` link.

use std::any::Any;

use crate::sim::{ByteDevice, ConfigError, Motor, SimulatedFaults};
use crate::units::Moment;

/// A BiSS device with a position and registers. Its motor turns the shaft shared by all encoders of an adapter, and the
/// device determines their supply.
pub trait BissDevice: Any + Send {
    /// Creates another device with the same settings.
    fn duplicate(&self) -> Box<dyn BissDevice>;

    /// Returns the bits that follow the control bit of the frame latched at `at`, and their number, or `None` while the
    /// device does not acknowledge.
    fn frame(&mut self, at: Moment) -> Option<(u64, u8)>;

    /// Returns the shaft position in steps and the number of steps per revolution, or `None` without power.
    fn place(&mut self, at: Moment) -> Option<(u64, u64)>;

    fn motor(&self) -> Motor;

    fn set_rpm(&mut self, now: Moment, rpm: f64);

    fn set_faults(&mut self, faults: &SimulatedFaults);

    fn disconnect(&mut self);

    /// Restores power to a device that has lost it.
    fn connect(&mut self, now: Moment);

    /// Returns whether the device has power; it may still be starting up.
    fn has_power(&self) -> bool;

    /// Returns whether the registers are readable at `now`.
    fn answers(&mut self, now: Moment) -> bool;

    /// Returns whether a control frame can use this address.
    fn has_address(&self, address: u8) -> bool;

    /// Reads a register at `now`, or returns `None` if the device refuses.
    fn read_register(&mut self, now: Moment, address: u8) -> Option<u8>;

    /// Writes a register at `now`; returns `false` without changes if the device refuses.
    fn write_register(&mut self, now: Moment, address: u8, value: u8) -> bool;
}

/// An encoder that is read by clocking out its position word.
pub trait SsiDevice: Send {
    /// Creates another device with the same settings.
    fn duplicate(&self) -> Box<dyn SsiDevice>;

    /// Returns the word latched at `at` and its number of bits, for a shaft position in steps and the number of steps
    /// per revolution.
    fn word(&mut self, at: Moment, place: (u64, u64)) -> (u64, u8);
}

/// The device at the end of the serial line.
pub trait SerialDevice: ByteDevice {
    /// Creates another device with the same settings.
    fn duplicate(&self) -> Box<dyn SerialDevice>;

    fn turn(&mut self, now: Moment, rpm: f64);
}

impl Clone for Box<dyn BissDevice> {
    fn clone(&self) -> Self {
        (**self).duplicate()
    }
}

impl Clone for Box<dyn SsiDevice> {
    fn clone(&self) -> Self {
        (**self).duplicate()
    }
}

impl Clone for Box<dyn SerialDevice> {
    fn clone(&self) -> Self {
        (**self).duplicate()
    }
}

/// A device attached to an adapter, grouped by connector.
pub enum AttachedDevice {
    Biss(Box<dyn BissDevice>),
    Ssi(Box<dyn SsiDevice>),
    Serial(Box<dyn SerialDevice>),
}

/// A kind of device that can be attached to an adapter.
pub trait AttachableKind: Sync {
    /// Returns the keys of the device's settings in a `sim:` link.
    fn keys(&self) -> &'static [&'static str];

    /// Creates the device from its settings, or returns `None` if they do not request a device.
    ///
    /// # Errors
    /// Names the key and the allowed values.
    fn attach_device(&self, pairs: &[(String, String)]) -> Result<Option<AttachedDevice>, ConfigError>;
}
