//! A word of the process data in the two 16-bit registers of a gateway (reference 1, `U`).

use crate::expected::Quantity;
use crate::parameter::{Whole, Words};

/// The unit that a gateway is asked for.
pub const UNIT: Whole<u8> = Whole(Quantity::Unit, 0..=255);
/// The first of the two input registers of an IN word.
pub const INPUT: Whole<u16> = Whole(Quantity::InputRegister, 0..=LAST);
/// The first of the two holding registers of an OUT word.
pub const OUTPUT: Whole<u16> = Whole(Quantity::HoldingRegister, 0..=LAST);
/// The last register that is followed by another.
const LAST: u16 = u16::MAX - 1;

/// The half of a word that is in the first of its two registers.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum WordOrder {
    /// Bits 31..16 (`U`: the usual order of INTERBUS).
    #[default]
    HighFirst,
    /// Bits 15..0.
    LowFirst,
}

impl WordOrder {
    /// Spelling in links.
    pub const WORDS: Words<WordOrder> =
        Words(&[("high-first", WordOrder::HighFirst), ("low-first", WordOrder::LowFirst)]);

    /// Returns the registers of a word.
    pub const fn registers(self, word: u32) -> [u16; 2] {
        let (high, low) = ((word >> 16) as u16, word as u16);
        match self {
            WordOrder::HighFirst => [high, low],
            WordOrder::LowFirst => [low, high],
        }
    }

    /// Returns the word of two registers.
    pub const fn word(self, [first, second]: [u16; 2]) -> u32 {
        let (high, low) = match self {
            WordOrder::HighFirst => (first, second),
            WordOrder::LowFirst => (second, first),
        };
        (high as u32) << 16 | low as u32
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_convert_in_either_register_order() {
        for (order, registers) in [(WordOrder::HighFirst, [0xC200, 0x00FF]), (WordOrder::LowFirst, [0x00FF, 0xC200])] {
            assert_eq!(order.registers(0xC200_00FF), registers);
            assert_eq!(order.word(registers), 0xC200_00FF);
        }
    }
}
