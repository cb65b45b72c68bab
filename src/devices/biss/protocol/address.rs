//! Register addresses. 00h to 3Fh are in the selected bank, and 40h to 7Fh are direct registers. UBICOM numbers all
//! registers globally. See chapter 4 of the manual, and "Address global" in its appendix.

use std::fmt;
use std::str::FromStr;

/// The address of a register. Direct registers are sorted before those in banks.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct RegisterAddress(u16);

/// Error for a string that is not a register address.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("`{0}` is not a register: enter 0x40 to 0x7F for a direct register, or BANK:OFFSET such as 0x24:0x10")]
pub struct AddressError(String);

impl RegisterAddress {
    /// Number of registers in a bank, which is also the number of direct registers.
    pub const BANK_SIZE: u8 = 0x40;
    /// Register 40h, which all encoders have. It selects the bank that is visible at 00h to 3Fh.
    pub const BANK_SELECT: RegisterAddress = RegisterAddress(0x00);
    /// Register 41h, which all encoders have. It holds the number of the first bank of the electronic data sheet.
    pub const EDS_BANK: RegisterAddress = RegisterAddress(0x01);
    /// Registers 42h and 43h, which all encoders have. They hold the profile ID.
    pub const PROFILE: RegisterAddress = RegisterAddress(0x02);
    /// Registers 78h to 7Dh, which all encoders have. They hold the device ID, and are followed by the manufacturer ID.
    pub const DEVICE_ID: RegisterAddress = RegisterAddress(0x38);

    /// Creates the address of a direct register. Returns `None` outside 40h to 7Fh.
    pub const fn direct_register(address: u8) -> Option<Self> {
        if 0x40 <= address && address <= 0x7F { Some(RegisterAddress(address as u16 - 0x40)) } else { None }
    }

    /// Creates the address of a register in a bank. Returns `None` if the offset is above 3Fh.
    pub const fn in_bank(bank: u8, offset: u8) -> Option<Self> {
        if offset < Self::BANK_SIZE { Some(RegisterAddress(0x40 + 0x40 * bank as u16 + offset as u16)) } else { None }
    }

    /// Returns the address of the first register in a bank.
    pub const fn bank_start(bank: u8) -> Self {
        RegisterAddress(0x40 + 0x40 * bank as u16)
    }

    /// Converts a global number to an address. Returns `None` for numbers beyond bank FFh.
    pub const fn from_global(global: u16) -> Option<Self> {
        if global < 0x40 + 0x4000 { Some(RegisterAddress(global)) } else { None }
    }

    /// Returns the global number. Direct registers start at 0, bank 0 starts at 40h, and the other banks follow.
    pub const fn global_number(self) -> u16 {
        self.0
    }

    /// Returns the bank that must be selected for access, or `None` for a direct register.
    pub const fn bank(self) -> Option<u8> {
        if self.0 < 0x40 { None } else { Some(((self.0 - 0x40) / 0x40) as u8) }
    }

    /// Returns the seven-bit address in the control frame: 40h to 7Fh for a direct register, 00h to 3Fh for a register
    /// in a bank.
    pub const fn address(self) -> u8 {
        // The value is always below 40h.
        let offset = (self.0 % 0x40) as u8;
        if self.0 < 0x40 { 0x40 + offset } else { offset }
    }

    /// Returns the address `count` registers after this one, or `None` beyond the end of the bank.
    pub fn offset_by(self, count: u8) -> Option<Self> {
        let offset = u16::from(self.address() % Self::BANK_SIZE) + u16::from(count);
        (offset < u16::from(Self::BANK_SIZE)).then_some(RegisterAddress(self.0 + u16::from(count)))
    }
}

impl fmt::Display for RegisterAddress {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.bank() {
            None => write!(f, "0x{:02X}", self.address()),
            Some(bank) => write!(f, "0x{bank:02X}:0x{:02X}", self.address()),
        }
    }
}

impl FromStr for RegisterAddress {
    type Err = AddressError;

    /// Parses an address such as `0x66` or `0x24:0x10`. Numbers without `0x` are decimal.
    fn from_str(text: &str) -> Result<Self, AddressError> {
        let place = match text.split_once(':') {
            None => byte(text).and_then(Self::direct_register),
            Some((bank, offset)) => byte(bank).zip(byte(offset)).and_then(|(bank, offset)| Self::in_bank(bank, offset)),
        };
        place.ok_or_else(|| AddressError(text.to_owned()))
    }
}

fn byte(text: &str) -> Option<u8> {
    let text = text.trim();
    match text.strip_prefix("0x").or_else(|| text.strip_prefix("0X")) {
        // from_str_radix accepts a sign.
        Some(digits) => u8::from_str_radix(digits, 16).ok().filter(|_| digits.bytes().all(|c| c.is_ascii_hexdigit())),
        None => text.parse().ok().filter(|_| text.bytes().all(|c| c.is_ascii_digit())),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// Expected values from section 3 of the UBICOM reference.
    #[test]
    fn published_address_map_matches() {
        let cases = [
            ("0x40", 0x0000),
            ("0x7F", 0x003F),
            ("0x00:0x00", 0x0040),
            ("0x00:0x25", 0x0065),
            ("0x01:0x07", 0x0087),
            ("0x02:0x3F", 0x00FF),
            ("0x03:0x3F", 0x013F),
            ("0x04:0x00", 0x0140),
            ("0x23:0x3F", 0x093F),
            ("0x24:0x00", 0x0940),
            ("0x43:0x3F", 0x113F),
            // These registers are given by name in the same section.
            ("0x6B", 0x002B),
            ("0x6A", 0x002A),
            ("0x66", 0x0026),
            ("0x68", 0x0028),
            ("0x69", 0x0029),
            ("0x6E", 0x002E),
            ("0x74", 0x0034),
            ("0x44", 0x0004),
            ("0x42", 0x0002),
        ];
        for (text, global) in cases {
            let address: RegisterAddress = text.parse().unwrap();
            assert_eq!(address.global_number(), global, "{text}");
            assert_eq!(RegisterAddress::from_global(global), Some(address), "{text}");
            assert_eq!(address.to_string(), text);
        }
        let decimal = "36:16".parse::<RegisterAddress>().unwrap();
        assert_eq!((decimal.bank(), decimal.address()), (Some(0x24), 0x10));
        assert_eq!("102".parse::<RegisterAddress>().unwrap().address(), 0x66);
    }

    #[test]
    fn rejects_invalid_register_addresses() {
        for text in ["", "0x3F", "0x80", "0x00:0x40", "256:0", "1:", ":1", "0x+5:0", "+66", "-1", "0x24:0x10:0", "x"] {
            assert_eq!(text.parse::<RegisterAddress>(), Err(AddressError(text.to_owned())));
        }
        assert_eq!(RegisterAddress::from_global(0x403F), RegisterAddress::in_bank(0xFF, 0x3F));
        assert_eq!(Some(RegisterAddress::bank_start(0xFF)), RegisterAddress::in_bank(0xFF, 0));
        for (address, place) in [
            (0x40, RegisterAddress::BANK_SELECT),
            (0x41, RegisterAddress::EDS_BANK),
            (0x42, RegisterAddress::PROFILE),
            (0x78, RegisterAddress::DEVICE_ID),
        ] {
            assert_eq!(RegisterAddress::direct_register(address), Some(place));
        }
        assert_eq!(RegisterAddress::from_global(0x4040), None);
        let last = RegisterAddress::in_bank(2, 0x3F).unwrap();
        assert_eq!((last.offset_by(0), last.offset_by(1)), (Some(last), None));
        assert_eq!(
            RegisterAddress::direct_register(0x7E).and_then(|own| own.offset_by(1)),
            RegisterAddress::direct_register(0x7F)
        );
    }

    proptest! {
        #[test]
        fn address_numbers_round_trip(global in 0u16..0x4040) {
            let address = RegisterAddress::from_global(global).unwrap();
            prop_assert_eq!(address.global_number(), global);
            prop_assert_eq!(address.to_string().parse(), Ok(address));
            let again = match address.bank() {
                None => RegisterAddress::direct_register(address.address()),
                Some(bank) => RegisterAddress::in_bank(bank, address.address()),
            };
            prop_assert_eq!(again, Some(address));
        }

        #[test]
        fn arbitrary_text_never_panics(text in ".*") {
            let _ = text.parse::<RegisterAddress>();
        }
    }
}
