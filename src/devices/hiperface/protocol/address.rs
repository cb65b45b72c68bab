//! Address byte of a frame (manual, "ADDRESS-Format").

use std::fmt;

/// Broadcast address, to which every encoder on the line replies with its own address. It may be used only if a single
/// encoder is connected or the command has no reply.
pub const BROADCAST: u8 = 0xFF;

/// Address byte of an encoder, 40h to 5Fh: device number 0 to 31 plus 40h.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct DeviceAddress(u8);

impl DeviceAddress {
    /// Factory setting, 40h.
    pub const FACTORY: DeviceAddress = DeviceAddress(0x40);

    /// Lowest address, 40h.
    pub const FIRST: DeviceAddress = DeviceAddress(0x40);

    /// Highest address, 5Fh.
    pub const LAST: DeviceAddress = DeviceAddress(0x5F);

    /// Creates an address from a byte 40h to 5Fh, or returns `None` for any other byte.
    pub const fn new(byte: u8) -> Option<Self> {
        if byte & 0xE0 == 0x40 { Some(DeviceAddress(byte)) } else { None }
    }

    /// Returns all 32 addresses in ascending order, starting with 40h.
    pub fn all() -> impl Iterator<Item = DeviceAddress> {
        (Self::FIRST.0..=Self::LAST.0).map(DeviceAddress)
    }

    /// Returns the address byte.
    pub const fn byte(self) -> u8 {
        self.0
    }
}

impl fmt::Display for DeviceAddress {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{:02X}h", self.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn device_addresses_are_40h_to_5fh() {
        let valid: Vec<u8> = (0..=0xFF).filter(|byte| DeviceAddress::new(*byte).is_some()).collect();
        assert_eq!(valid, (0x40..=0x5F).collect::<Vec<u8>>());
        assert!(DeviceAddress::all().map(DeviceAddress::byte).eq(0x40..=0x5F));
    }
}
