//! Devices attached to the clocked buses and the serial line of the adapter. The adapter names none of them; each
//! parses its own settings of a `sim:` link.

use std::any::Any;

use crate::sim::{ByteDevice, ConfigError, Faults, Motor};
use crate::units::Moment;

/// Position and registers on BiSS. Its motor turns the shaft shared by all encoders at an adapter, and its supply is
/// theirs.
pub trait BissDevice: Any + Send {
    /// Returns another device like it.
    fn another(&self) -> Box<dyn BissDevice>;

    /// Returns the bits after the control bit of the frame taken at a moment, and their number; `None` while it does not
    /// acknowledge.
    fn frame(&mut self, at: Moment) -> Option<(u64, u8)>;

    /// Returns the position of its shaft in steps, and the steps per revolution; `None` without power.
    fn place(&mut self, at: Moment) -> Option<(u64, u64)>;

    fn motor(&self) -> Motor;

    /// Turns it at another speed from `now` on.
    fn set_rpm(&mut self, now: Moment, rpm: f64);

    fn set_faults(&mut self, faults: &Faults);

    fn disconnect(&mut self);

    /// Restores the supply of a device that has lost it.
    fn connect(&mut self, now: Moment);

    /// Returns whether it has power; it may still be starting.
    fn has_power(&self) -> bool;

    /// Returns whether its registers can be read at `now`.
    fn answers(&mut self, now: Moment) -> bool;

    /// Returns whether a control frame can have this address.
    fn has_address(&self, address: u8) -> bool;

    /// Reads a register at `now`; `None`: it refuses.
    fn read_register(&mut self, now: Moment, address: u8) -> Option<u8>;

    /// Writes a register at `now`; returns `false` if it refuses, with nothing changed.
    fn write_register(&mut self, now: Moment, address: u8, value: u8) -> bool;
}

/// Encoder whose words are clocked out.
pub trait SsiDevice: Send {
    /// Returns another device like it.
    fn another(&self) -> Box<dyn SsiDevice>;

    /// Returns the word taken at a moment and its number of bits, with its shaft at a position of so many per revolution.
    fn word(&mut self, at: Moment, place: (u64, u64)) -> (u64, u8);
}

/// The device at the end of the serial line.
pub trait SerialDevice: ByteDevice {
    /// Returns another device like it.
    fn another(&self) -> Box<dyn SerialDevice>;

    /// Sets the speed of the shaft from `now` on.
    fn turn(&mut self, now: Moment, rpm: f64);
}

impl Clone for Box<dyn BissDevice> {
    fn clone(&self) -> Self {
        (**self).another()
    }
}

impl Clone for Box<dyn SsiDevice> {
    fn clone(&self) -> Self {
        (**self).another()
    }
}

impl Clone for Box<dyn SerialDevice> {
    fn clone(&self) -> Self {
        (**self).another()
    }
}

/// A device that hangs on an adapter, by the connector.
pub enum Attached {
    Biss(Box<dyn BissDevice>),
    Ssi(Box<dyn SsiDevice>),
    Serial(Box<dyn SerialDevice>),
}

/// A kind of device that can hang on an adapter.
pub trait Attachable: Sync {
    /// Returns its own settings of a `sim:` link.
    fn keys(&self) -> &'static [&'static str];

    /// Returns the device with these settings, all of which are its own; `None` if they request none.
    ///
    /// # Errors
    /// A sentence that names the key and the allowed values.
    fn attached(&self, pairs: &[(String, String)]) -> Result<Option<Attached>, ConfigError>;
}
