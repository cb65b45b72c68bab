//! Reads the IP address and its source: address switches and TCP/IP object (reference, section 1).

use super::error::RequestedItem;
use super::identify::device_parameter;
use super::{Error, Master};
use crate::buses::ethernet_ip::protocol::{ConfigurationControl, InterfaceConfiguration, PacketError};
use crate::devices::hiperdrive::profile::NetworkSettings;
use crate::devices::hiperdrive::protocol::AddressSwitch;

/// IP address and its source. Values that the device does not report are `None`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Network {
    /// Positions of S1 and S2 at power-up, parameter 12.
    pub switch: i64,
    /// Attribute 3 of the TCP/IP object: source of the address when the switches are at 0.
    pub control: Option<ConfigurationControl>,
    /// Attribute 5 of the TCP/IP object, which contains the address, mask, gateway, name servers and domain.
    pub interface: Option<InterfaceConfiguration>,
    pub mac: Option<[u8; 6]>,
}

/// Class and attribute that hold the MAC address.
const MAC: (u16, u16) = (0xF6, 3);

impl Network {
    /// Returns the setting of the address switches, or `None` if the value is not a valid setting.
    pub fn address_switch(&self) -> Option<AddressSwitch> {
        AddressSwitch::parse(u8::try_from(self.switch).ok()?)
    }
}

/// Reads the switches and the TCP/IP object.
///
/// # Errors
/// Returns an error if the exchange fails.
pub fn network(master: &mut Master<'_>) -> Result<Network, Error> {
    let switch = master.read_number(device_parameter(12)?)?;
    let control =
        optional_if_rejected(read_attribute(master, ConfigurationControl::ATTRIBUTE, ConfigurationControl::parse))?;
    let interface =
        optional_if_rejected(read_attribute(master, InterfaceConfiguration::ATTRIBUTE, InterfaceConfiguration::parse))?;
    let (class, number) = MAC;
    let mac = optional_if_rejected(master.read_attribute(RequestedItem::Mac, class, number))?
        .and_then(|data| data.try_into().ok());
    Ok(Network { switch, control, interface, mac })
}

/// Reads the network settings that a plan can change.
///
/// # Errors
/// Returns [`Error::Refused`] if the device has no such settings, or another error if the exchange fails.
pub fn settings(master: &mut Master<'_>) -> Result<NetworkSettings, Error> {
    let (control, interface) = (ConfigurationControl::ATTRIBUTE, InterfaceConfiguration::ATTRIBUTE);
    let control = read_attribute(master, control, ConfigurationControl::parse)?;
    let interface = read_attribute(master, interface, InterfaceConfiguration::parse)?;
    Ok(NetworkSettings { source: control.source(), interface })
}

fn read_attribute<T>(
    master: &mut Master<'_>,
    attribute: u16,
    parse: impl FnOnce(&[u8]) -> Result<T, PacketError>,
) -> Result<T, Error> {
    let requested = RequestedItem::Network { attribute };
    let data = master.read_attribute(requested, ConfigurationControl::CLASS, attribute)?;
    parse(&data).map_err(|cause| Error::Damaged { requested, tries: 1, cause: cause.into() })
}

/// Returns the value, or `None` if the device rejected the request.
fn optional_if_rejected<T>(ended: Result<T, Error>) -> Result<Option<T>, Error> {
    match ended {
        Ok(value) => Ok(Some(value)),
        Err(Error::Refused { .. }) => Ok(None),
        Err(error) => Err(error),
    }
}
