//! Address switches S1 and S2, read when the device is switched on (reference 1). S3 selects the drive to which the
//! RS485 LED refers.

use core::net::Ipv4Addr;

/// Source of the IP address that the two switches select.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum AddressSwitch {
    /// 0: from the TCP/IP object (class F5h, attribute 3): stored, BOOTP or, as the factory setting, DHCP.
    Object,
    /// 1 to 96: 192.168.1.n with the mask 255.255.255.0 and no gateway.
    Fixed(Ipv4Addr),
    /// 97: the stored address. Turned to 97 at runtime, the device also stores its present address.
    Stored,
    /// 98: BOOTP.
    Bootp,
    /// 99: DHCP.
    Dhcp,
}

impl AddressSwitch {
    /// Parses the two digits, or returns `None` above 99.
    pub const fn parse(number: u8) -> Option<Self> {
        let source = match number {
            0 => AddressSwitch::Object,
            1..=96 => AddressSwitch::Fixed(Ipv4Addr::new(192, 168, 1, number)),
            97 => AddressSwitch::Stored,
            98 => AddressSwitch::Bootp,
            99 => AddressSwitch::Dhcp,
            _ => return None,
        };
        Some(source)
    }

    /// Returns the two digits.
    pub const fn number(self) -> u8 {
        match self {
            AddressSwitch::Object => 0,
            AddressSwitch::Fixed(address) => {
                let [_, _, _, last] = address.octets();
                last
            }
            AddressSwitch::Stored => 97,
            AddressSwitch::Bootp => 98,
            AddressSwitch::Dhcp => 99,
        }
    }
}
