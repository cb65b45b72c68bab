//! Address switches S1 and S2, read when the device is switched on (reference, section 1). S3 selects the drive to
//! which the RS485 LED refers.

use core::net::Ipv4Addr;

/// Source of the IP address, selected by the two address switches.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum AddressSwitch {
    /// Switch position 0: the source in the TCP/IP object (class F5h, attribute 3). It is stored, BOOTP or DHCP. The
    /// factory setting is DHCP.
    Object,
    /// Switch positions 1 to 96: address 192.168.1.n with the mask 255.255.255.0 and no gateway.
    Fixed(Ipv4Addr),
    /// Switch position 97: the stored address. If the switches are turned to 97 during operation, the device also
    /// stores its current address.
    Stored,
    /// Switch position 98: BOOTP.
    Bootp,
    /// Switch position 99: DHCP.
    Dhcp,
}

impl AddressSwitch {
    /// Converts the two-digit position of the address switches, or returns `None` if `number` is greater than 99.
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
