//! The order in which a gateway splits a process data word into two 16-bit registers (reference 1, `U`).

use crate::expected::Quantity;
use crate::parameter::{Keywords, WholeNumbers};

/// Valid unit identifiers of a gateway.
pub const UNIT: WholeNumbers<u8> = WholeNumbers(Quantity::Unit, 0..=255);
/// Valid addresses of the first input register of an IN word.
pub const INPUT: WholeNumbers<u16> = WholeNumbers(Quantity::InputRegister, 0..=LAST);
/// Valid addresses of the first holding register of an OUT word.
pub const OUTPUT: WholeNumbers<u16> = WholeNumbers(Quantity::HoldingRegister, 0..=LAST);
/// Last register address that is followed by another one.
const LAST: u16 = u16::MAX - 1;

/// Word order, named after the half of the word in the first register.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum WordOrder {
    /// Bits 31..16 come first, which is the usual order in INTERBUS (`U`: not documented).
    #[default]
    HighFirst,
    /// Bits 15..0 come first.
    LowFirst,
}

impl WordOrder {
    /// Word-order keywords in a link URL.
    pub const KEYWORDS: Keywords<WordOrder> =
        Keywords(&[("high-first", WordOrder::HighFirst), ("low-first", WordOrder::LowFirst)]);

    /// Splits a word into its two registers.
    pub const fn registers(self, word: u32) -> [u16; 2] {
        let (high, low) = ((word >> 16) as u16, word as u16);
        match self {
            WordOrder::HighFirst => [high, low],
            WordOrder::LowFirst => [low, high],
        }
    }

    /// Combines two registers into a word.
    pub const fn combine(self, [first, second]: [u16; 2]) -> u32 {
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
            assert_eq!(order.combine(registers), 0xC200_00FF);
        }
    }
}
