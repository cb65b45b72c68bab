//! Devices attached to the adapter: on its clocked buses and its serial line. The adapter does not know which ones
//! exist; each reads its own settings of a `sim:` link.

use std::any::Any;

use crate::sim::{ByteDevice, ConfigError, Faults, Motor};
use crate::units::Moment;

/// A position and registers on BiSS. Its motor turns the shaft that all encoders at an adapter share, and its supply is
/// theirs.
pub trait BissDevice: Any + Send {
    /// Returns another device like it.
    fn another(&self) -> Box<dyn BissDevice>;

    /// The bits behind the control bit of the frame taken at a moment, and how many; `None` while it does not acknowledge.
    fn frame(&mut self, at: Moment) -> Option<(u64, u8)>;

    /// Returns the position of its shaft in steps, and the steps per revolution; `None` without power.
    fn place(&mut self, at: Moment) -> Option<(u64, u64)>;

    /// Returns the motor of the shaft.
    fn motor(&self) -> Motor;

    /// Turns it at another speed from `now` on.
    fn set_rpm(&mut self, now: Moment, rpm: f64);

    /// Replaces the faults.
    fn set_faults(&mut self, faults: &Faults);

    /// Removes the supply.
    fn disconnect(&mut self);

    /// Gives the supply back to a device that has lost it.
    fn connect(&mut self, now: Moment);

    /// Returns whether it has power; it may still be starting.
    fn has_power(&self) -> bool;

    /// Returns whether its registers can be read at `now`.
    fn answers(&mut self, now: Moment) -> bool;

    /// A control frame can have this address.
    fn has_address(&self, address: u8) -> bool;

    /// A register's value at `now`; `None`: it refuses.
    fn read_register(&mut self, now: Moment, address: u8) -> Option<u8>;

    /// Writes a register at `now`; `false`: it refuses, and nothing has changed.
    fn write_register(&mut self, now: Moment, address: u8, value: u8) -> bool;
}

/// An encoder whose words are clocked out of it.
pub trait SsiDevice: Send {
    /// Returns another device like it.
    fn another(&self) -> Box<dyn SsiDevice>;

    /// The word taken at a moment and how many bits it has, with its shaft at a place of so many a revolution.
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
    /// On BiSS.
    Biss(Box<dyn BissDevice>),
    /// On SSI.
    Ssi(Box<dyn SsiDevice>),
    /// At the serial line.
    Serial(Box<dyn SerialDevice>),
}

/// A kind of device that can hang on an adapter.
pub trait Attachable: Sync {
    /// The settings of a `sim:` link that are its own.
    fn keys(&self) -> &'static [&'static str];

    /// The device as these settings say, all of which are its own; `None` where they say that there is none.
    ///
    /// # Errors
    /// With a sentence that names the key and what is allowed.
    fn attached(&self, pairs: &[(String, String)]) -> Result<Option<Attached>, ConfigError>;
}
