//! BiSS checksums of up to 32 bits, computed in the order of transmission without reflection. The polynomial for
//! position data depends on the encoder. The control frame always uses the same 4-bit polynomial. See manual 3.1.1 and
//! iC-Haus AN3.

use std::fmt;

/// A checksum algorithm. The polynomial determines the width of the checksum.
#[derive(Clone, PartialEq, Eq)]
pub struct Crc {
    polynomial: u64,
    start: u32,
    inverted: bool,
    /// Remainder for each byte value, left-aligned in a 32-bit register.
    table: [u32; 256],
}

/// Reason why checksum parameters are invalid.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum CrcError {
    /// The degree of the polynomial is 0 or above 32.
    #[error("the CRC polynomial {0:#X} must have 2 to 33 bits, including its highest and lowest terms")]
    Degree(u64),
    /// The lowest term of the polynomial is missing, so the checksum would not detect every single-bit error.
    #[error("the CRC polynomial {0:#X} must have the constant term 1")]
    LowestTerm(u64),
    /// The start value is wider than the checksum.
    #[error("the CRC start value {start:#X} does not fit into {width} bits")]
    Start {
        /// Value of the CRC register before the first bit.
        start: u32,
        /// Width of the checksum in bits.
        width: u8,
    },
}

impl Crc {
    /// Polynomial x⁶ + x + 1 for position data, unless an encoder specifies another. The checksum is sent inverted.
    pub const POSITION: u64 = 0x43;
    /// Polynomial x⁴ + x + 1 for the control frame. The checksum is sent inverted.
    pub const CONTROL: u64 = 0x13;

    /// Creates a checksum algorithm. The polynomial includes its highest and lowest terms. For example, 43h is x⁶ + x +
    /// 1. `start` is the value of the CRC register before the first bit.
    ///
    /// # Errors
    /// Returns a [`CrcError`] if the parameters do not describe a checksum of 1 to 32 bits.
    pub fn new(polynomial: u64, start: u32, inverted: bool) -> Result<Self, CrcError> {
        let degree = polynomial.checked_ilog2().unwrap_or(0);
        if !(1..=32).contains(&degree) {
            return Err(CrcError::Degree(polynomial));
        }
        if polynomial & 1 == 0 {
            return Err(CrcError::LowestTerm(polynomial));
        }
        let crc = Crc { polynomial, start, inverted, table: crc_table(polynomial, degree) };
        if start & !crc.mask() != 0 {
            return Err(CrcError::Start { start, width: crc.width() });
        }
        Ok(crc)
    }

    /// Creates a checksum algorithm from the polynomial in an electronic data sheet, which omits the lowest term. For
    /// example, 21h stands for 43h. Returns `None` for 0, which stands for no checksum.
    ///
    /// # Errors
    /// Returns an error from [`new`](Self::new) if the parameters are invalid.
    pub fn from_data_sheet(polynomial: u32, start: u32) -> Result<Option<Self>, CrcError> {
        match polynomial {
            0 => Ok(None),
            _ => Self::new(u64::from(polynomial) << 1 | 1, start, true).map(Some),
        }
    }

    /// Returns the polynomial, including its highest and lowest terms.
    pub const fn polynomial(&self) -> u64 {
        self.polynomial
    }

    /// Returns the value of the CRC register before the first bit.
    pub const fn start(&self) -> u32 {
        self.start
    }

    /// Returns whether the checksum is sent inverted.
    pub const fn is_inverted(&self) -> bool {
        self.inverted
    }

    /// Returns the width of the checksum, 1 to 32 bits.
    pub const fn width(&self) -> u8 {
        self.polynomial.ilog2() as u8 // at most 32
    }

    /// Returns the checksum of the lowest `bits` bits of `data`, processed from the highest to the lowest. The result
    /// is inverted if the checksum is sent inverted. At most 64 bits are used.
    pub fn compute(&self, data: u64, bits: u8) -> u32 {
        let unused = 32 - u32::from(self.width());
        let mut register = self.start << unused;
        let mut left = u32::from(bits.min(64));
        while left > 0 {
            // The bits of an incomplete byte are processed first, so that only complete bytes remain.
            let now = if left.is_multiple_of(8) { 8 } else { left % 8 };
            left -= now;
            let group = (data >> left) as u32 & ((1 << now) - 1);
            let index = (register >> (32 - now)) ^ group;
            register = (register << now) ^ self.entry(index);
        }
        let sum = register >> unused;
        if self.inverted { sum ^ self.mask() } else { sum }
    }

    fn entry(&self, index: u32) -> u32 {
        self.table.get((index & 0xFF) as usize).copied().unwrap_or(0)
    }

    fn mask(&self) -> u32 {
        u32::MAX >> (32 - u32::from(self.width()))
    }
}

impl fmt::Debug for Crc {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Crc")
            .field("polynomial", &format_args!("{:#X}", self.polynomial))
            .field("start", &self.start)
            .field("inverted", &self.inverted)
            .finish()
    }
}

/// Returns the control frame checksum (x⁴ + x + 1, inverted) of the lowest `bits` bits of `data`.
pub(super) fn crc4(data: u16, bits: u8) -> u8 {
    let sum = (0..bits.min(16)).rev().fold(0u8, |sum, at| {
        let feedback = sum >> 3 ^ (data >> at & 1) as u8;
        sum << 1 & 0xF ^ if feedback == 1 { 3 } else { 0 }
    });
    sum ^ 0xF
}

fn crc_table(polynomial: u64, degree: u32) -> [u32; 256] {
    // The polynomial without its highest term, left-aligned in 32 bits.
    let low_terms = ((polynomial ^ 1 << degree) << (32 - degree)) as u32;
    let mut table = [0; 256];
    for (index, entry) in (0u32..).zip(&mut table) {
        *entry = (0..8).fold(index << 24, |register, _| match register >> 31 {
            0 => register << 1,
            _ => register << 1 ^ low_terms,
        });
    }
    table
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// Calculates the remainder by long division, independently of the tested code.
    fn remainder_by_division(polynomial: u64, start: u32, data: u64, bits: u8) -> u32 {
        let degree = 63 - polynomial.leading_zeros();
        let mut rest = u128::from(data) & ((1u128 << bits) - 1);
        rest <<= degree;
        // A start value is equivalent to a change of the first data bits.
        rest ^= u128::from(start) << bits;
        for at in (degree..u32::from(bits) + degree).rev() {
            if rest >> at & 1 == 1 {
                rest ^= u128::from(polynomial) << (at - degree);
            }
        }
        rest as u32
    }

    /// CRC4 values of request headers from section 3 of the reference, calculated over CTS = 1, ID = 0 and the address.
    #[test]
    fn published_headers_match() {
        let table = [
            (0x00, 0x6),
            (0x05, 0x9),
            (0x40, 0x1),
            (0x42, 0x7),
            (0x66, 0x1),
            (0x68, 0x0),
            (0x69, 0x3),
            (0x6A, 0x6),
            (0x6B, 0x5),
            (0x6E, 0xA),
            (0x7E, 0xF),
            (0x7F, 0xC),
        ];
        for (address, sum) in table {
            assert_eq!(crc4(0x400 | address, 11), sum, "{address:02X}");
        }
        // Commands with CTS = 0, ID 0, CMD 01 and 00 (last line of section 3 of the reference).
        assert_eq!(crc4(0b001, 11), 0xC);
        assert_eq!(crc4(0b000, 11), 0xF);
    }

    #[test]
    fn control_header_crc_is_remainder() {
        let crc = Crc::new(Crc::CONTROL, 0, true).unwrap();
        for header in 0..1 << 11 {
            let sum = remainder_by_division(0x13, 0, header.into(), 11) as u8 ^ 0xF;
            assert_eq!(crc4(header, 11), sum, "{header:03X}");
            assert_eq!(crc.compute(header.into(), 11), u32::from(sum), "{header:03X}");
        }
    }

    /// CRC4 values of data bytes from section 3 of the reference.
    #[test]
    fn published_data_bytes_match() {
        let table = "00→F 01→C 02→9 03→A 04→3 05→0 07→6 10→A 1C→D 21→6 29→D 2A→8 30→0 46→2 4B→6 61→1 72→1 80→1 FF→B";
        for entry in table.split(' ') {
            let (data, sum) = entry.split_once('→').unwrap();
            let data = u16::from_str_radix(data, 16).unwrap();
            assert_eq!(crc4(data, 8), u8::from_str_radix(sum, 16).unwrap(), "{entry}");
        }
    }

    /// Check values for the string 123456789 from the catalogue of parametrised CRC algorithms (reveng), for several
    /// widths without reflection.
    #[test]
    fn other_polynomials_match_published_check_values() {
        let cases = [
            ("CRC-8/SMBUS", 0x107, 0, 0x00, 0xF4),
            ("CRC-8/AUTOSAR", 0x12F, 0xFF, 0xFF, 0xDF),
            ("CRC-16/IBM-3740", 0x1_1021, 0xFFFF, 0x0000, 0x29B1),
            ("CRC-16/GENIBUS", 0x1_1021, 0xFFFF, 0xFFFF, 0xD64E),
            ("CRC-32/BZIP2", 0x1_04C1_1DB7, 0xFFFF_FFFF, 0xFFFF_FFFF, 0xFC89_1918),
            ("CRC-32/MPEG-2", 0x1_04C1_1DB7, 0xFFFF_FFFF, 0x0000_0000, 0x0376_E6E7),
        ];
        for (name, polynomial, start, xor, check) in cases {
            let crc = Crc::new(polynomial, start, xor != 0).unwrap();
            // Nine bytes do not fit into 64 bits, so the first one goes into the start value.
            let first = remainder_by_division(polynomial, start, u64::from(b'1'), 8);
            let rest = Crc::new(polynomial, first, xor != 0).unwrap();
            assert_eq!(rest.compute(u64::from_be_bytes(*b"23456789"), 64), check, "{name}");
            let plain = crc.compute(u64::from(b'1'), 8) ^ xor;
            assert_eq!(plain, first, "{name}");
        }
    }

    #[test]
    fn rejects_invalid_crc_parameters() {
        assert_eq!(Crc::new(0, 0, true), Err(CrcError::Degree(0)));
        assert_eq!(Crc::new(1, 0, true), Err(CrcError::Degree(1)));
        assert_eq!(Crc::new(1 << 33 | 1, 0, true), Err(CrcError::Degree(1 << 33 | 1)));
        assert_eq!(Crc::new(0x42, 0, true), Err(CrcError::LowestTerm(0x42)));
        assert_eq!(Crc::new(0x43, 0x40, true), Err(CrcError::Start { start: 0x40, width: 6 }));
        assert_eq!(Crc::from_data_sheet(0x21, 0), Crc::new(0x43, 0, true).map(Some));
        assert_eq!(Crc::from_data_sheet(0, 0), Ok(None));
        assert_eq!(Crc::new(0x1_04C1_1DB7, u32::MAX, false).unwrap().width(), 32);
        assert_eq!(Crc::new(3, 1, false).unwrap().width(), 1);
    }

    proptest! {
        #[test]
        fn crc_is_polynomial_remainder(
            degree in 1u32..=32, terms: u32, start: u32, inverted: bool, data: u64, bits in 0u8..=64,
        ) {
            let low = u64::from(terms) & ((1 << degree) - 1);
            let polynomial = 1 << degree | low | 1;
            let mask = u32::MAX >> (32 - degree);
            let crc = Crc::new(polynomial, start & mask, inverted).unwrap();
            let sum = remainder_by_division(polynomial, start & mask, data, bits);
            prop_assert_eq!(crc.compute(data, bits), if inverted { sum ^ mask } else { sum });
        }
    }
}
