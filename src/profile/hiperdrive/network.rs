//! How a device gets its IP address: its TCP/IP object, CIP class F5h (reference 1). It counts where the address switch is at
//! 0, its addresses also where it is at 97.

use core::net::Ipv4Addr;
use std::fmt;

use super::NetworkError;

/// What the object says.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub struct NetworkSettings {
    /// Attribute 3.
    pub source: AddressSource,
    /// Attribute 5.
    pub interface: Interface,
}

/// Where the address comes from: the lowest four bits of attribute 3.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum AddressSource {
    /// 0: as stored. Setting it stores the address that the device has at that time.
    Stored,
    /// 1.
    Bootp,
    /// 2: from the factory.
    Dhcp,
    /// Another number, 3 to 15: kept, and never set.
    Other(u8),
}

/// Addresses of an interface; 0.0.0.0 where there is none.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub struct Interface {
    /// Its own.
    pub address: Ipv4Addr,
    /// Of its network.
    pub mask: Ipv4Addr,
    /// Out of its network.
    pub gateway: Ipv4Addr,
    /// The first and the second one.
    pub name_servers: [Ipv4Addr; 2],
    /// The domain's name, at most 48 characters.
    pub domain: String,
}

impl AddressSource {
    /// By attribute 3; what stands above its lowest four bits does not count.
    pub const fn of_control(control: u32) -> Self {
        match control & 0xF {
            0 => AddressSource::Stored,
            1 => AddressSource::Bootp,
            2 => AddressSource::Dhcp,
            // Four bits.
            other => AddressSource::Other(other as u8),
        }
    }

    /// The lowest four bits of attribute 3.
    pub const fn code(self) -> u8 {
        match self {
            AddressSource::Stored => 0,
            AddressSource::Bootp => 1,
            AddressSource::Dhcp => 2,
            AddressSource::Other(code) => code,
        }
    }
}

impl fmt::Display for AddressSource {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            AddressSource::Stored => f.write_str("stored"),
            AddressSource::Bootp => f.write_str("BOOTP"),
            AddressSource::Dhcp => f.write_str("DHCP"),
            AddressSource::Other(code) => write!(f, "method {code}"),
        }
    }
}

impl Interface {
    /// Without any address.
    pub const NONE: Interface = Interface {
        address: Ipv4Addr::UNSPECIFIED,
        mask: Ipv4Addr::UNSPECIFIED,
        gateway: Ipv4Addr::UNSPECIFIED,
        name_servers: [Ipv4Addr::UNSPECIFIED; 2],
        domain: String::new(),
    };

    /// The longest name of a domain (CIP volume 2).
    pub const LONGEST_DOMAIN: usize = 48;

    /// That a device can be reached at these addresses.
    ///
    /// # Errors
    /// [`NetworkError`] with what is wrong.
    pub fn check(&self) -> Result<(), NetworkError> {
        let (address, mask, gateway) = (self.address.to_bits(), self.mask.to_bits(), self.gateway.to_bits());
        let is_mask = mask != 0 && mask.count_ones() == mask.leading_ones();
        let host = address & !mask;
        match self.address {
            _ if !is_mask || mask.count_ones() > 30 => Err(NetworkError::Mask(self.mask)),
            own if own.is_unspecified() || own.is_loopback() || own.is_multicast() || own.octets()[0] >= 240 => {
                Err(NetworkError::Address(own))
            }
            own if host == 0 || host == !mask => Err(NetworkError::NoHost { address: own, mask: self.mask }),
            _ if gateway == 0 => Ok(()),
            own if gateway == address || (gateway ^ address) & mask != 0 => {
                Err(NetworkError::Gateway { gateway: self.gateway, address: own, mask: self.mask })
            }
            _ if self.domain.len() > Interface::LONGEST_DOMAIN || !self.domain.is_ascii() => Err(NetworkError::Domain),
            _ => Ok(()),
        }
    }
}
