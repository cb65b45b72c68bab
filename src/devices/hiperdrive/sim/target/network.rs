//! TCP/IP object (class F5h) and Ethernet link object (class F6h) as specified by ODVA (`P`).
//!
//! Assumptions (`U`: not documented): Attribute 5 can be set only while attribute 3 selects stored addresses, and takes
//! effect immediately. The virtual device remains reachable at its old address.

use std::net::Ipv4Addr;

use super::objects::status_of;
use crate::buses::ethernet_ip::protocol::{
    AddressSource, ConfigurationControl, EPath, GeneralStatus, InterfaceConfiguration,
};
use crate::devices::hiperdrive::protocol::AddressSwitch;

/// Address source and addresses of the virtual device.
#[derive(Debug)]
pub(super) struct Network {
    switch: u8,
    control: ConfigurationControl,
    present: InterfaceConfiguration,
    stored: InterfaceConfiguration,
    mac: [u8; 6],
}

const NONE: InterfaceConfiguration = InterfaceConfiguration {
    address: Ipv4Addr::UNSPECIFIED,
    mask: Ipv4Addr::UNSPECIFIED,
    gateway: Ipv4Addr::UNSPECIFIED,
    name_servers: [Ipv4Addr::UNSPECIFIED; 2],
    domain: String::new(),
};
const NETWORK: Ipv4Addr = Ipv4Addr::new(255, 255, 255, 0);
/// Address that a virtual DHCP or BOOTP server assigns.
const ASSIGNED_ADDRESS: Ipv4Addr = Ipv4Addr::new(192, 168, 1, 200);
/// Value of attribute 1 of the TCP/IP object: an address has been obtained. The next constant is the value of attribute
/// 2: BOOTP and DHCP are supported, and the attributes can be set.
const CONFIGURED: u32 = 1;
const CAPABILITY: u32 = 0x15;
const ETHERNET_LINK: u16 = 0xF6;
const MEGABITS: u32 = 100;
/// Value of attribute 2 of the Ethernet link object: the link is active and full duplex.
const LINK_UP: u32 = 0x03;

impl Network {
    pub(super) fn new(switch: u8, serial_number: u16) -> Self {
        let [high, low] = serial_number.to_be_bytes();
        let mac = [0x02, 0x00, 0x00, 0x00, high, low];
        let mut network = Network { switch, control: dhcp_control(), present: NONE, stored: NONE, mac };
        network.power_up();
        network
    }

    pub(super) fn power_up(&mut self) {
        let source = match AddressSwitch::parse(self.switch) {
            Some(AddressSwitch::Fixed(address)) => {
                self.present = InterfaceConfiguration { address, mask: NETWORK, ..NONE };
                return;
            }
            Some(AddressSwitch::Stored) => AddressSource::Stored,
            Some(AddressSwitch::Bootp) => AddressSource::Bootp,
            Some(AddressSwitch::Dhcp) => AddressSource::Dhcp,
            Some(AddressSwitch::Object) | None => self.control.source(),
        };
        let stored = source == AddressSource::Stored && self.stored.address != Ipv4Addr::UNSPECIFIED;
        self.present = if stored {
            self.stored.clone()
        } else {
            InterfaceConfiguration { address: ASSIGNED_ADDRESS, mask: NETWORK, ..NONE }
        };
    }

    /// Restores the factory settings. The device keeps its current address until the next power cycle.
    pub(super) fn restore_factory(&mut self) {
        (self.control, self.stored) = (dhcp_control(), NONE);
    }

    pub(super) fn interface(&self, attribute: u16) -> Option<Vec<u8>> {
        let bytes = match attribute {
            1 => CONFIGURED.to_le_bytes().to_vec(),
            2 => CAPABILITY.to_le_bytes().to_vec(),
            ConfigurationControl::ATTRIBUTE => self.control.emit().to_vec(),
            4 => {
                let path = EPath::to_instance(ETHERNET_LINK, 1).emit();
                // The length of the path is given in words.
                [&(path.len() as u16 / 2).to_le_bytes()[..], &path].concat()
            }
            InterfaceConfiguration::ATTRIBUTE => self.present.emit(),
            // The host name is empty.
            6 => vec![0, 0],
            _ => return None,
        };
        Some(bytes)
    }

    pub(super) fn interface_attributes(&self) -> Vec<u8> {
        (1..=6).filter_map(|attribute| self.interface(attribute)).flatten().collect()
    }

    pub(super) fn set_attribute(&mut self, attribute: u16, data: &[u8]) -> Result<Vec<u8>, GeneralStatus> {
        match attribute {
            ConfigurationControl::ATTRIBUTE => {
                let control = ConfigurationControl::parse(data).map_err(status_of)?;
                if matches!(control.source(), AddressSource::Unknown(_)) {
                    return Err(GeneralStatus::INVALID_VALUE);
                }
                // On a change from another source to stored, the present address is stored (reference, section 1).
                if control.source() == AddressSource::Stored && self.control.source() != AddressSource::Stored {
                    self.stored = self.present.clone();
                }
                self.control = control;
            }
            InterfaceConfiguration::ATTRIBUTE => {
                let configuration = InterfaceConfiguration::parse(data).map_err(status_of)?;
                if self.control.source() != AddressSource::Stored {
                    return Err(GeneralStatus::STATE);
                }
                (self.present, self.stored) = (configuration.clone(), configuration);
            }
            1 | 2 | 4 | 6 => return Err(GeneralStatus::NOT_SETTABLE),
            _ => return Err(GeneralStatus::NO_ATTRIBUTE),
        }
        Ok(Vec::new())
    }

    pub(super) fn link_attribute(&self, attribute: u16) -> Option<Vec<u8>> {
        match attribute {
            1 => Some(MEGABITS.to_le_bytes().to_vec()),
            2 => Some(LINK_UP.to_le_bytes().to_vec()),
            3 => Some(self.mac.to_vec()),
            _ => None,
        }
    }

    pub(super) fn link_attributes(&self) -> Vec<u8> {
        (1..=3).filter_map(|attribute| self.link_attribute(attribute)).flatten().collect()
    }
}

fn dhcp_control() -> ConfigurationControl {
    ConfigurationControl::default().with_source(AddressSource::Dhcp)
}
