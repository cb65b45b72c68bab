//! The TCP/IP interface object (class F5h): where a device has its address from, and what it is (`P ODVA`).

use core::net::Ipv4Addr;

use super::fields::{Fields, PacketError, ascii, text};

/// Attribute 3. Bits that are not known are kept.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct ConfigurationControl(u32);

/// Its bits 3 to 0.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum AddressSource {
    /// 0: what is stored in the device.
    Stored,
    /// 1: BOOTP.
    Bootp,
    /// 2: DHCP.
    Dhcp,
    /// Another number up to 15.
    Unknown(u8),
}

/// Attribute 5.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct InterfaceConfiguration {
    /// Its address; 0.0.0.0 for none.
    pub address: Ipv4Addr,
    /// Of its network.
    pub mask: Ipv4Addr,
    /// To other networks; 0.0.0.0 for none.
    pub gateway: Ipv4Addr,
    /// Name servers; 0.0.0.0 for none.
    pub name_servers: [Ipv4Addr; 2],
    /// ASCII, up to 48 characters.
    pub domain: String,
}

impl ConfigurationControl {
    /// The class of the object.
    pub const CLASS: u16 = 0xF5;
    /// The attribute.
    pub const ATTRIBUTE: u16 = 3;

    /// As it came: four bytes.
    ///
    /// # Errors
    /// [`PacketError`] where there are fewer or more.
    pub fn parse(data: &[u8]) -> Result<Self, PacketError> {
        let mut fields = Fields::new("the configuration control", data);
        let word = fields.u32()?;
        fields.end(ConfigurationControl(word))
    }

    /// As it is sent.
    pub const fn emit(self) -> [u8; 4] {
        self.0.to_le_bytes()
    }

    /// Where the address comes from.
    pub const fn source(self) -> AddressSource {
        match self.0 & 0x0F {
            0 => AddressSource::Stored,
            1 => AddressSource::Bootp,
            2 => AddressSource::Dhcp,
            other => AddressSource::Unknown(other as u8),
        }
    }

    /// The same with another source.
    pub const fn with(self, source: AddressSource) -> Self {
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
    /// The attribute.
    pub const ATTRIBUTE: u16 = 5;

    /// Reads the attribute: five addresses as numbers, their low byte first, and a text with its length in two bytes, filled
    /// to whole words.
    ///
    /// # Errors
    /// [`PacketError`] where it is cut off or too long.
    pub fn parse(data: &[u8]) -> Result<Self, PacketError> {
        let mut fields = Fields::new("the interface configuration", data);
        let mut address = || fields.u32().map(Ipv4Addr::from);
        let (own, mask, gateway) = (address()?, address()?, address()?);
        let name_servers = [address()?, address()?];
        let length = fields.u16()?;
        let domain = text(fields.bytes(length.into())?);
        if length % 2 == 1 && !fields.is_empty() {
            fields.u8()?;
        }
        fields.end(InterfaceConfiguration { address: own, mask, gateway, name_servers, domain })
    }

    /// Its bytes.
    pub fn emit(&self) -> Vec<u8> {
        let [first, second] = self.name_servers;
        let addresses = [self.address, self.mask, self.gateway, first, second];
        let mut data: Vec<u8> = addresses.into_iter().flat_map(|address| u32::from(address).to_le_bytes()).collect();
        let domain: Vec<u8> = ascii(&self.domain).take(usize::from(u16::MAX)).collect();
        // At most 65535.
        data.extend((domain.len() as u16).to_le_bytes());
        let odd = domain.len() % 2 == 1;
        data.extend(domain);
        data.extend(odd.then_some(0));
        data
    }
}
