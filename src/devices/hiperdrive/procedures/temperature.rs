//! Temperatures of the device (parameter 11) and of a drive (parameter 119), which are polled together with the
//! position.

use super::identify::{device_parameter, drive_parameter};
use super::{DriveReading, Error, Master};
use crate::devices::hiperdrive::protocol::{DriveNumber, ParameterNumber};
use crate::units::Moment;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Temperature {
    /// Temperature of the device, parameter 11.
    Device,
    /// Temperature of a drive, parameter 119.
    Drive(DriveNumber),
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TemperatureReading {
    pub at: Moment,
    pub what: Temperature,
    /// Temperature in degrees Celsius, or `None` if the device does not provide it.
    pub celsius: Option<i64>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PolledSample {
    Position(DriveReading),
    Temperature(TemperatureReading),
}

impl Temperature {
    /// Returns the number of the temperature parameter.
    ///
    /// # Errors
    /// Returns [`Error::NoNumber`] if the parameter does not exist.
    pub fn parameter(self) -> Result<ParameterNumber, Error> {
        match self {
            Temperature::Device => device_parameter(11),
            Temperature::Drive(drive) => drive_parameter(119, drive),
        }
    }
}

/// Reads a temperature with an explicit message, which does not delay the cyclic connection. If the device rejects the
/// request, the temperature is unavailable.
///
/// # Errors
/// Returns an error if the exchange fails.
pub fn temperature(master: &mut Master<'_>, what: Temperature) -> Result<TemperatureReading, Error> {
    let celsius = match master.read_number(what.parameter()?) {
        Ok(celsius) => Some(celsius),
        Err(error) if error.is_unavailable() => None,
        Err(error) => return Err(error),
    };
    Ok(TemperatureReading { at: master.now(), what, celsius })
}
