//! Position codes: binary, Gray, Gray excess and BCD. See SICK SSI description 2.4 and reference section 2.

use serde::Deserialize;

/// A code in which positions are transmitted.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Code {
    /// Binary code.
    Binary,
    /// Gray: one bit changes between adjacent positions.
    Gray,
    /// Gray excess: the middle part of a complete Gray code. A single bit changes even where positions wrap, for any
    /// even number of steps.
    GrayExcess,
    /// BCD, with four bits per decimal digit.
    Bcd,
}

/// The reason why a code cannot represent a range of positions.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum CodeError {
    /// The number of steps is odd. Gray excess omits equally many words before and after the positions, so the number
    /// must be even.
    #[error(
        "Gray excess requires an even number of steps, because with {0} steps two bits would change at the end of the \
         range"
    )]
    Odd(u128),
    /// The code word of the last position would exceed 64 bits.
    #[error("{0} decimal digits need more than 64 bits in BCD")]
    Digits(u32),
}

/// Converts a binary number to Gray: `b ^ (b >> 1)`.
pub const fn to_gray(word: u64) -> u64 {
    word ^ word >> 1
}

/// Converts a Gray code word to binary.
pub const fn gray_to_binary(word: u64) -> u64 {
    let word = word ^ word >> 1;
    let word = word ^ word >> 2;
    let word = word ^ word >> 4;
    let word = word ^ word >> 8;
    let word = word ^ word >> 16;
    word ^ word >> 32
}

/// Code for positions from 0 up to a maximum.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PositionCode {
    code: Code,
    last: u64,
    bits: u8,
    /// Number whose Gray code represents position 0 in Gray excess.
    offset: u64,
}

impl PositionCode {
    pub(super) const BIT: PositionCode = PositionCode { code: Code::Binary, last: 1, bits: 1, offset: 0 };

    /// Creates the code for the positions 0 to `last`.
    ///
    /// # Errors
    /// Returns a [`CodeError`] if the code cannot represent this number of positions.
    pub fn new(code: Code, last: u64) -> Result<Self, CodeError> {
        let binary_bits = bit_width(last);
        let (bits, offset) = match code {
            Code::Binary | Code::Gray => (binary_bits, 0),
            Code::GrayExcess if last.is_multiple_of(2) => return Err(CodeError::Odd(u128::from(last) + 1)),
            Code::GrayExcess => (binary_bits, (low_bits_mask(binary_bits) - last) / 2),
            Code::Bcd => {
                let digits = last.checked_ilog10().map_or(1, |log| log + 1);
                let bits = u8::try_from(4 * digits).ok().filter(|bits| *bits <= 64);
                (bits.ok_or(CodeError::Digits(digits))?, 0)
            }
        };
        Ok(PositionCode { code, last, bits, offset })
    }

    /// Returns the kind of code.
    pub const fn code(&self) -> Code {
        self.code
    }

    /// Returns the width of a code word, 1 to 64 bits.
    pub const fn bits(&self) -> u8 {
        self.bits
    }

    /// Returns the highest position that the code can represent.
    pub const fn last_position(&self) -> u64 {
        self.last
    }

    /// Returns the number whose Gray code represents position 0 in Gray excess. It is 0 for the other codes.
    pub const fn offset(&self) -> u64 {
        self.offset
    }

    /// Returns the code word of a position, or `None` if the position is out of range.
    pub fn encode(&self, position: u64) -> Option<u64> {
        if position > self.last {
            return None;
        }
        Some(match self.code {
            Code::Binary => position,
            Code::Gray => to_gray(position),
            Code::GrayExcess => to_gray(position + self.offset),
            Code::Bcd => decimal_to_bcd(position),
        })
    }

    /// Returns the position of a code word, or `None` if the word is invalid.
    #[inline]
    pub fn decode(&self, word: u64) -> Option<u64> {
        let position = match self.code {
            Code::Binary => word,
            Code::Gray => gray_to_binary(word),
            Code::GrayExcess => gray_to_binary(word).checked_sub(self.offset)?,
            Code::Bcd => bcd_to_decimal(word)?,
        };
        (position <= self.last).then_some(position)
    }
}

/// Returns the number of bits needed to represent `number`, at least one.
pub(super) const fn bit_width(number: u64) -> u8 {
    let bits = 64 - number.leading_zeros();
    if bits == 0 { 1 } else { bits as u8 }
}

/// Returns a mask in which the lowest `bits` bits are 1, from 0 to 64 bits.
pub(super) const fn low_bits_mask(bits: u8) -> u64 {
    if bits >= 64 { u64::MAX } else { (1 << bits) - 1 }
}

fn decimal_to_bcd(mut number: u64) -> u64 {
    let mut word = 0;
    let mut place = 0;
    while number > 0 && place < 64 {
        word |= (number % 10) << place;
        number /= 10;
        place += 4;
    }
    word
}

fn bcd_to_decimal(word: u64) -> Option<u64> {
    let mut number = 0_u64;
    for place in (0..64).step_by(4).rev() {
        let digit = word >> place & 0xF;
        if digit > 9 {
            return None;
        }
        number = number.checked_mul(10)?.checked_add(digit)?;
    }
    Some(number)
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    /// The code words are from reference section 8, "Gray".
    #[test]
    fn gray_words_match_reference() {
        let pairs = [
            (1000, 0x21C),
            (8191, 0x1000),
            (12345, 0x2825),
            (0xAB_CDEF, 0xFE_2B18),
            (0x155_5555, 0x1FF_FFFF),
            (0xFF_FFFF, 0x80_0000),
        ];
        for (number, word) in pairs {
            assert_eq!((to_gray(number), gray_to_binary(word)), (word, number), "{number}");
        }
        assert_eq!(gray_to_binary(0xFF_FFFE), 0xAA_AAAB);
    }

    /// The code words are from the column "Graycode", 0 to 15, in section 2.4 of the manual.
    #[test]
    fn gray_words_match_manual() {
        let table = [0, 1, 3, 2, 6, 7, 5, 4, 12, 13, 15, 14, 10, 11, 9, 8];
        for (number, word) in table.into_iter().enumerate() {
            assert_eq!(to_gray(number as u64), word);
        }
    }

    /// The table is from reference section 2, with the columns N, n, code(0), code(1), code(N/2) and code(N−1).
    #[test]
    fn gray_excess_matches_reference() {
        let table = [
            (10, 4, 0x2, 0x6, 0xC, 0xA),
            (100, 7, 0x09, 0x08, 0x60, 0x49),
            (360, 9, 0x06A, 0x06B, 0x180, 0x16A),
            (720, 10, 0x0D4, 0x0D5, 0x300, 0x2D4),
            (1000, 10, 0x00A, 0x00B, 0x300, 0x20A),
            (3600, 12, 0x084, 0x085, 0xC00, 0x884),
            (5000, 13, 0x0522, 0x0523, 0x1800, 0x1522),
        ];
        for (steps, bits, first, second, middle, last) in table {
            let coding = PositionCode::new(Code::GrayExcess, steps - 1).unwrap();
            assert_eq!(coding.bits(), bits, "{steps}");
            for (position, word) in [(0, first), (1, second), (steps / 2, middle), (steps - 1, last)] {
                assert_eq!(coding.encode(position), Some(word), "{position} of {steps}");
                assert_eq!(coding.decode(word), Some(position), "{position} of {steps}");
            }
            assert_eq!((first ^ last).count_ones(), 1, "{steps}: over the end of the range");
        }
    }

    /// The invalid words are from reference section 8.
    #[test]
    fn rejects_words_outside_gray_excess() {
        let coding = PositionCode::new(Code::GrayExcess, 9).unwrap();
        for word in [0x0, 0x1, 0x3, 0x8, 0x9, 0xB] {
            assert_eq!(coding.decode(word), None, "{word:X}");
        }
        assert_eq!(coding.decode(0xF), Some(7));
        assert_eq!(PositionCode::new(Code::GrayExcess, 8), Err(CodeError::Odd(9)));
    }

    #[test]
    fn bcd_digits_encode_and_decode() {
        let coding = PositionCode::new(Code::Bcd, 3599).unwrap();
        assert_eq!(coding.bits(), 16);
        assert_eq!(coding.encode(3599), Some(0x3599));
        assert_eq!(coding.decode(0x0A00), None);
        assert_eq!(coding.decode(0x3600), None);
        assert_eq!(PositionCode::new(Code::Bcd, u64::MAX), Err(CodeError::Digits(20)));
    }

    proptest! {
        #[test]
        fn adjacent_words_differ_in_one_bit(last in 1..u64::MAX, at in any::<u64>()) {
            let last = last | 1;
            let coding = PositionCode::new(Code::GrayExcess, last).unwrap();
            let at = at % last;
            let (here, next) = (coding.encode(at).unwrap(), coding.encode(at + 1).unwrap());
            prop_assert_eq!((here ^ next).count_ones(), 1);
            prop_assert_eq!(coding.decode(here), Some(at));
        }
    }
}
