//! The settings byte of the serial interface, which is read with 52h and set with 57h and 67h (manual, figure 42). The
//! positions of bits 7 and 6 are inferred from their order in the figure.

use std::fmt;

use crate::units::{Baud, CharacterFormat, Parity};

/// Baud rates, indexed by their three-bit code. Code 111 is reserved.
pub const BAUDS: [Baud; 7] = [baud(600), baud(1200), baud(2400), baud(4800), baud(9600), baud(19200), baud(38400)];

const fn baud(bits_per_second: u32) -> Baud {
    match Baud::new(bits_per_second) {
        Some(baud) => baud,
        None => Baud::B9600,
    }
}

/// RS485 settings byte.
///
/// | bit | 7 | 6 | 5..4 | 3 | 2..0 |
/// |---|---|---|---|---|---|
/// | | 1 standard, 0 bus | time-out 1: 44/baud, 0: 11/baud | parity 00 none, 10 even, 11 odd | 0 | speed |
#[derive(Clone, Copy, PartialEq, Eq, Hash)]
pub struct LineSettings(u8);

impl LineSettings {
    /// Factory settings E4h: standard, 44/baud, even, 9600.
    pub const FACTORY: LineSettings = LineSettings(0xE4);

    const STANDARD: u8 = 0x80;
    const LONG_TIMEOUT: u8 = 0x40;

    /// Creates settings from the byte. Reserved values are preserved.
    pub const fn from_byte(byte: u8) -> Self {
        LineSettings(byte)
    }

    /// Returns the settings byte.
    pub const fn byte(self) -> u8 {
        self.0
    }

    /// Returns the settings with another character format, or `None` if the byte cannot express the baud rate.
    pub fn with_format(self, format: CharacterFormat) -> Option<Self> {
        let speed = u8::try_from(BAUDS.iter().position(|baud| *baud == format.baud)?).ok()?;
        let parity = match format.parity {
            Parity::None => 0b00,
            Parity::Even => 0b10,
            Parity::Odd => 0b11,
        };
        Some(LineSettings(self.0 & 0xC8 | parity << 4 | speed))
    }

    /// Returns the settings with a time-out of 44/baud if `long` is set, and of 11/baud otherwise.
    #[must_use]
    pub const fn with_long_timeout(self, long: bool) -> Self {
        LineSettings(if long { self.0 | Self::LONG_TIMEOUT } else { self.0 & !Self::LONG_TIMEOUT })
    }

    /// Returns the settings for a bus with several encoders if `bus` is set, and for a single encoder otherwise.
    #[must_use]
    pub const fn with_bus(self, bus: bool) -> Self {
        LineSettings(if bus { self.0 & !Self::STANDARD } else { self.0 | Self::STANDARD })
    }

    /// Returns the baud rate, or `None` for the reserved code 111.
    pub fn baud(self) -> Option<Baud> {
        BAUDS.get(usize::from(self.0 & 7)).copied()
    }

    /// Returns the parity, or `None` for the reserved code 01.
    pub const fn parity(self) -> Option<Parity> {
        match self.0 >> 4 & 3 {
            0b00 => Some(Parity::None),
            0b10 => Some(Parity::Even),
            0b11 => Some(Parity::Odd),
            _ => None,
        }
    }

    /// Returns the character format, or `None` if the code for the baud rate or the parity is reserved.
    pub fn character_format(self) -> Option<CharacterFormat> {
        Some(CharacterFormat { baud: self.baud()?, parity: self.parity()? })
    }

    /// Returns whether the time-out is 44/baud rather than 11/baud (bit 6).
    pub const fn has_long_timeout(self) -> bool {
        self.0 & Self::LONG_TIMEOUT != 0
    }

    /// Returns whether the encoder is configured for a bus, that is, whether bit 7 is 0.
    pub const fn is_bus(self) -> bool {
        self.0 & Self::STANDARD == 0
    }

    /// Returns whether the byte contains no reserved values and may be sent to an encoder.
    pub fn is_valid(self) -> bool {
        self.character_format().is_some() && self.0 & 0x08 == 0
    }
}

impl fmt::Debug for LineSettings {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{:02X}h ({self})", self.0)
    }
}

impl fmt::Display for LineSettings {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.character_format() {
            Some(format) => write!(f, "{format}")?,
            None => write!(f, "reserved format")?,
        }
        let timeout = if self.has_long_timeout() { 44 } else { 11 };
        let wiring = if self.is_bus() { "bus" } else { "standard" };
        write!(f, ", time-out {timeout} bits, {wiring}")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn settings_bytes_match_reference() {
        // byte, baud, parity, long time-out, bus
        let cases = [
            (0xE4, 9600, Parity::Even, true, false),
            (0xE5, 19200, Parity::Even, true, false),
            (0xE6, 38400, Parity::Even, true, false),
            (0xC4, 9600, Parity::None, true, false),
            (0xF4, 9600, Parity::Odd, true, false),
            (0xA4, 9600, Parity::Even, false, false),
            (0x64, 9600, Parity::Even, true, true),
            (0x85, 19200, Parity::None, false, false),
        ];
        for (byte, baud, parity, long_timeout, bus) in cases {
            let settings = LineSettings::from_byte(byte);
            let format = CharacterFormat { baud: Baud::new(baud).unwrap(), parity };
            assert_eq!(settings.character_format(), Some(format), "{byte:02X}");
            assert_eq!(settings.has_long_timeout(), long_timeout, "{byte:02X}");
            assert_eq!(settings.is_bus(), bus, "{byte:02X}");
            assert_eq!(settings.with_format(format), Some(settings), "{byte:02X}");
            assert!(settings.is_valid());
        }
    }

    #[test]
    fn keeps_but_never_sends_reserved_values() {
        for byte in [0xE7, 0xD4, 0xEC] {
            let settings = LineSettings::from_byte(byte);
            assert_eq!(settings.byte(), byte);
            assert!(!settings.is_valid(), "{byte:02X}");
        }
    }
}
