//! Devices on the clocked buses and the serial line of the adapter. The adapter does not depend on any specific device.
//! Each device parses its own settings in a `sim:` link.

use std::any::Any;

use crate::sim::{ByteDevice, ConfigError, Motor, SimulatedFaults};
use crate::units::Moment;

/// A BiSS device with a position and registers. Its motor turns the shaft that all encoders of an adapter share, and
/// its supply determines whether they have power.
pub trait BissDevice: Any + Send {
    /// Creates a copy of the device with separate state.
    fn clone_device(&self) -> Box<dyn BissDevice>;

    /// Returns the bits after the control bit of the frame that is latched at `at`, and their number. The result is
    /// `None` while the device does not acknowledge.
    fn frame_at(&mut self, at: Moment) -> Option<(u64, u8)>;

    /// Returns the shaft position in steps and the number of steps per revolution, or `None` if the power is off.
    fn shaft_position(&mut self, at: Moment) -> Option<(u64, u64)>;

    fn motor(&self) -> Motor;

    fn set_rpm(&mut self, now: Moment, rpm: f64);

    fn set_faults(&mut self, faults: &SimulatedFaults);

    fn disconnect(&mut self);

    /// Switches the device back on after [`disconnect`](Self::disconnect).
    fn connect(&mut self, now: Moment);

    /// Returns whether the power is on. The device may still be starting.
    fn has_power(&self) -> bool;

    /// Returns whether the registers can be read at `now`.
    fn can_access_registers(&mut self, now: Moment) -> bool;

    /// Returns whether the device has a register with this address.
    fn has_address(&self, address: u8) -> bool;

    /// Reads a register at `now`, or returns `None` if the device rejects the request.
    fn read_register(&mut self, now: Moment, address: u8) -> Option<u8>;

    /// Writes a register at `now`. Returns `false` if the device rejects the request.
    fn write_register(&mut self, now: Moment, address: u8, value: u8) -> bool;
}

/// An encoder whose position word is clocked out.
pub trait SsiDevice: Send {
    /// Creates another device with the same settings.
    fn clone_device(&self) -> Box<dyn SsiDevice>;

    /// Returns the word that is latched at `at`, and its number of bits. `place` contains the shaft position in steps
    /// and the number of steps per revolution.
    fn word_at(&mut self, at: Moment, place: (u64, u64)) -> (u64, u8);
}

/// The device on the serial line.
pub trait SerialDevice: ByteDevice {
    /// Creates another device with the same settings.
    fn clone_device(&self) -> Box<dyn SerialDevice>;

    fn turn_shaft(&mut self, now: Moment, rpm: f64);
}

impl Clone for Box<dyn BissDevice> {
    fn clone(&self) -> Self {
        (**self).clone_device()
    }
}

impl Clone for Box<dyn SsiDevice> {
    fn clone(&self) -> Self {
        (**self).clone_device()
    }
}

impl Clone for Box<dyn SerialDevice> {
    fn clone(&self) -> Self {
        (**self).clone_device()
    }
}

/// A device that is attached to one connector of an adapter.
pub enum AttachedDevice {
    Biss(Box<dyn BissDevice>),
    Ssi(Box<dyn SsiDevice>),
    Serial(Box<dyn SerialDevice>),
}

/// A kind of device that can be attached to an adapter.
pub trait AttachableKind: Sync {
    /// Returns the names of the device's settings in a `sim:` link.
    fn setting_names(&self) -> &'static [&'static str];

    /// Creates the device from its settings. Returns `None` if the settings do not select a device.
    ///
    /// # Errors
    /// Returns an error with the key and the allowed values if a setting is invalid.
    fn attach_device(&self, pairs: &[(String, String)]) -> Result<Option<AttachedDevice>, ConfigError>;
}
