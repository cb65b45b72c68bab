//! Address switches S1 and S2, which are read at power-up (reference, section 1). Switch S3 selects the drive that the
//! RS485 LED stands for.

use core::net::Ipv4Addr;

/// Source of the IP address, selected by the two address switches.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum AddressSwitch {
    /// Position 0: the source in the TCP/IP object (class F5h, attribute 3), which is *stored*, BOOTP or DHCP. It is
    /// set to DHCP at the factory.
    Object,
    /// Positions 1 to 96: address 192.168.1.n, mask 255.255.255.0, no gateway.
    Fixed(Ipv4Addr),
    /// Position 97: the stored address. If the switches are turned to this position during operation, the device also
    /// stores its current address.
    Stored,
    /// Position 98: BOOTP.
    Bootp,
    /// Position 99: DHCP.
    Dhcp,
}

impl AddressSwitch {
    /// Converts the two-digit position of the address switches. Returns `None` if `number` is above 99.
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

    /// Returns the two digits of the switch position.
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
