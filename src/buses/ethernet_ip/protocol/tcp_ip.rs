//! TCP/IP interface object (class F5h): the IP address of a device and its source (`P ODVA`).

use core::net::Ipv4Addr;

use super::fields::{FieldReader, PacketError, Structure, ascii, text};

/// Configuration control, attribute 3. The default 0 selects the stored address. Unknown bits are preserved.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub struct ConfigurationControl(u32);

/// Source of the IP address, bits 3 to 0 of [`ConfigurationControl`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum AddressSource {
    /// Address stored in the device, encoded as 0.
    Stored,
    /// BOOTP, encoded as 1.
    Bootp,
    /// DHCP, encoded as 2.
    Dhcp,
    /// A reserved value up to 15.
    Unknown(u8),
}

/// Interface configuration, attribute 5.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub struct InterfaceConfiguration {
    /// IP address, or 0.0.0.0 if none is set.
    pub address: Ipv4Addr,
    /// Network mask.
    pub mask: Ipv4Addr,
    /// Default gateway, or 0.0.0.0 if there is none.
    pub gateway: Ipv4Addr,
    /// Name servers. 0.0.0.0 means that there is none.
    pub name_servers: [Ipv4Addr; 2],
    /// Domain name of up to 48 ASCII characters.
    pub domain: String,
}

/// The reason why an interface configuration would make a device unreachable.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum AddressError {
    /// The address is 0.0.0.0.
    #[error("0.0.0.0 is not a valid device address: enter the address for the device")]
    None,
    /// The address is reserved.
    #[error("{0} is reserved (loopback, multicast or future use): enter a different address")]
    Reserved(Ipv4Addr),
    /// The mask does not consist of ones followed by zeros, or leaves too few addresses.
    #[error("{0} is not a valid subnet mask: enter a mask such as 255.255.255.0 (at most 255.255.255.252)")]
    Mask(Ipv4Addr),
    /// The address is the network address.
    #[error("{0} is the address of the network itself: enter the address of a host in this network")]
    Network(Ipv4Addr),
    /// The address is the broadcast address of its network.
    #[error("{0} is the broadcast address of the network: enter the address of a host in this network")]
    Broadcast(Ipv4Addr),
    /// The gateway is outside the network.
    #[error(
        "the gateway {gateway} is outside the network {network}/{prefix}: enter an address in this network, or 0.0.0.0"
    )]
    GatewayOutside {
        /// Gateway address outside the network.
        gateway: Ipv4Addr,
        /// Network of the device.
        network: Ipv4Addr,
        /// Prefix length of the network mask.
        prefix: u32,
    },
    /// The gateway is the device itself, or a network or broadcast address.
    #[error("{0} cannot be used as the gateway: enter the address of another device in the network, or 0.0.0.0")]
    Gateway(Ipv4Addr),
    /// The domain name is invalid. A valid name has up to 48 letters, digits, hyphens and dots.
    #[error("{0:?} is not a valid domain name: use at most 48 letters, digits, hyphens and dots")]
    Domain(String),
}

impl ConfigurationControl {
    /// Class code of the TCP/IP interface object.
    pub const CLASS: u16 = 0xF5;
    /// Attribute number of the configuration control.
    pub const ATTRIBUTE: u16 = 3;

    /// Parses the four bytes of the attribute.
    ///
    /// # Errors
    /// Returns a [`PacketError`] if the length is not four.
    pub fn parse(data: &[u8]) -> Result<Self, PacketError> {
        let mut fields = FieldReader::new(Structure::ConfigurationControl, data);
        let word = fields.u32()?;
        fields.finish(ConfigurationControl(word))
    }

    /// Returns the attribute as bytes.
    pub const fn emit(self) -> [u8; 4] {
        self.0.to_le_bytes()
    }

    /// Returns the source of the IP address.
    pub const fn source(self) -> AddressSource {
        match self.0 & 0x0F {
            0 => AddressSource::Stored,
            1 => AddressSource::Bootp,
            2 => AddressSource::Dhcp,
            other => AddressSource::Unknown(other as u8),
        }
    }

    /// Returns a copy with the given source of the IP address.
    pub const fn with_source(self, source: AddressSource) -> Self {
        let number = match source {
            AddressSource::Stored => 0,
            AddressSource::Bootp => 1,
            AddressSource::Dhcp => 2,
            AddressSource::Unknown(other) => other as u32 & 0x0F,
        };
        ConfigurationControl(self.0 & !0x0F | number)
    }
}

impl InterfaceConfiguration {
    /// Attribute number of the interface configuration.
    pub const ATTRIBUTE: u16 = 5;

    /// Parses the attribute. It consists of five little-endian addresses and a string with a two-byte length, padded to
    /// whole words.
    ///
    /// # Errors
    /// Returns a [`PacketError`] if the attribute is incomplete or too long.
    pub fn parse(data: &[u8]) -> Result<Self, PacketError> {
        let mut fields = FieldReader::new(Structure::InterfaceConfiguration, data);
        let mut address = || fields.u32().map(Ipv4Addr::from);
        let (own, mask, gateway) = (address()?, address()?, address()?);
        let name_servers = [address()?, address()?];
        let length = fields.u16()?;
        let domain = text(fields.bytes(length.into())?);
        if length % 2 == 1 && !fields.is_empty() {
            fields.u8()?;
        }
        fields.finish(InterfaceConfiguration { address: own, mask, gateway, name_servers, domain })
    }

    /// Checks that a device with this configuration would be reachable. The address must be valid in a network with
    /// this mask, and the gateway must be unset or in the same network.
    ///
    /// Returns an [`AddressError`] if an address, the mask or the domain name is not usable.
    pub fn check_reachable(&self) -> Result<(), AddressError> {
        let InterfaceConfiguration { address, mask, gateway, .. } = *self;
        check_device_address(address)?;
        let bits = u32::from(mask);
        let prefix = bits.leading_ones();
        if !(1..=30).contains(&prefix) || prefix + bits.trailing_zeros() != 32 {
            return Err(AddressError::Mask(mask));
        }
        let network = u32::from(address) & bits;
        let host = |own: Ipv4Addr| u32::from(own) & !bits;
        if host(address) == 0 {
            return Err(AddressError::Network(address));
        }
        if host(address) == !bits {
            return Err(AddressError::Broadcast(address));
        }
        if !gateway.is_unspecified() {
            if u32::from(gateway) & bits != network {
                return Err(AddressError::GatewayOutside { gateway, network: network.into(), prefix });
            }
            if gateway == address || host(gateway) == 0 || host(gateway) == !bits {
                return Err(AddressError::Gateway(gateway));
            }
        }
        self.name_servers.into_iter().filter(|own| !own.is_unspecified()).try_for_each(check_device_address)?;
        let is_name = |c: u8| c.is_ascii_alphanumeric() || matches!(c, b'-' | b'.');
        if self.domain.len() > LONGEST_DOMAIN || !self.domain.bytes().all(is_name) {
            return Err(AddressError::Domain(self.domain.clone()));
        }
        Ok(())
    }

    /// Returns the attribute as bytes.
    pub fn emit(&self) -> Vec<u8> {
        let [first, second] = self.name_servers;
        let addresses = [self.address, self.mask, self.gateway, first, second];
        let mut data: Vec<u8> = addresses.into_iter().flat_map(|address| u32::from(address).to_le_bytes()).collect();
        let domain: Vec<u8> = ascii(&self.domain).take(usize::from(u16::MAX)).collect();
        // The length is at most 65535.
        data.extend((domain.len() as u16).to_le_bytes());
        let odd = domain.len() % 2 == 1;
        data.extend(domain);
        data.extend(odd.then_some(0));
        data
    }
}

/// Maximum number of characters in a domain name.
const LONGEST_DOMAIN: usize = 48;

fn check_device_address(address: Ipv4Addr) -> Result<(), AddressError> {
    let [first, ..] = address.octets();
    match first {
        _ if address.is_unspecified() => Err(AddressError::None),
        // These are this network, the computer itself, multicast groups and reserved addresses.
        0 | 127 | 224.. => Err(AddressError::Reserved(address)),
        _ => Ok(()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn check(address: &str, mask: &str, gateway: &str) -> Result<(), AddressError> {
        let own = |text: &str| text.parse().unwrap();
        let configuration = InterfaceConfiguration {
            address: own(address),
            mask: own(mask),
            gateway: own(gateway),
            name_servers: [Ipv4Addr::UNSPECIFIED; 2],
            domain: String::new(),
        };
        configuration.check_reachable()
    }

    /// The first, last and broadcast addresses match Python's `ipaddress.ip_network("192.168.1.64/26")`: 64, 65 to 126,
    /// and 127.
    #[test]
    fn rejects_unusable_addresses() {
        let own = |text: &str| -> Ipv4Addr { text.parse().unwrap() };
        for (address, mask, gateway) in [
            ("192.168.1.50", "255.255.255.0", "0.0.0.0"),
            ("192.168.1.50", "255.255.255.0", "192.168.1.1"),
            ("192.168.1.65", "255.255.255.192", "192.168.1.126"),
            ("10.255.255.254", "255.0.0.0", "10.0.0.1"),
            ("10.0.0.1", "255.255.255.252", "10.0.0.2"),
            ("169.254.3.4", "255.255.0.0", "0.0.0.0"),
        ] {
            assert_eq!(check(address, mask, gateway), Ok(()), "{address} {mask} {gateway}");
        }
        assert_eq!(check("0.0.0.0", "255.255.255.0", "0.0.0.0"), Err(AddressError::None));
        for address in ["0.1.2.3", "127.0.0.1", "224.0.0.5", "239.192.1.1", "240.0.0.1", "255.255.255.255"] {
            let expected = Err(AddressError::Reserved(own(address)));
            assert_eq!(check(address, "255.255.255.0", "0.0.0.0"), expected, "{address}");
        }
        for mask in ["0.0.0.0", "255.255.0.255", "255.255.255.253", "255.255.255.254", "255.255.255.255", "0.255.255.0"]
        {
            assert_eq!(check("192.168.1.50", mask, "0.0.0.0"), Err(AddressError::Mask(own(mask))), "{mask}");
        }
        let mask = "255.255.255.192";
        assert_eq!(check("192.168.1.64", mask, "0.0.0.0"), Err(AddressError::Network(own("192.168.1.64"))));
        assert_eq!(check("192.168.1.127", mask, "0.0.0.0"), Err(AddressError::Broadcast(own("192.168.1.127"))));
        for gateway in ["192.168.1.63", "192.168.1.128", "10.0.0.1"] {
            let (network, gateway) = (own("192.168.1.64"), own(gateway));
            let expected = Err(AddressError::GatewayOutside { gateway, network, prefix: 26 });
            assert_eq!(check("192.168.1.65", mask, &gateway.to_string()), expected, "{gateway}");
        }
        for gateway in ["192.168.1.64", "192.168.1.65", "192.168.1.127"] {
            let expected = Err(AddressError::Gateway(own(gateway)));
            assert_eq!(check("192.168.1.65", mask, gateway), expected, "{gateway}");
        }
    }

    #[test]
    fn checks_name_servers_and_domain() {
        let good = InterfaceConfiguration {
            address: Ipv4Addr::new(192, 168, 1, 50),
            mask: Ipv4Addr::new(255, 255, 255, 0),
            gateway: Ipv4Addr::UNSPECIFIED,
            name_servers: [Ipv4Addr::new(9, 9, 9, 9), Ipv4Addr::UNSPECIFIED],
            domain: "line-2.plant".to_owned(),
        };
        assert_eq!(good.check_reachable(), Ok(()));
        let group = Ipv4Addr::new(224, 0, 0, 1);
        let servers = [Ipv4Addr::UNSPECIFIED, group];
        let asked = InterfaceConfiguration { name_servers: servers, ..good.clone() };
        assert_eq!(asked.check_reachable(), Err(AddressError::Reserved(group)));
        for domain in ["two words", "straße", &"a".repeat(49)] {
            let named = InterfaceConfiguration { domain: domain.to_owned(), ..good.clone() };
            assert_eq!(named.check_reachable(), Err(AddressError::Domain(domain.to_owned())));
        }
    }
}
