//! The position word: five bytes, the lowest first; singleturn below, multiturn above it (manual 5.2). There is no error
//! and no warning bit in it.

use crate::protocol::biss::{Layout, Reading};

/// A position word as it came; bits that no position has are kept.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PositionWord(u64);

impl PositionWord {
    /// Bytes on the line.
    pub const BYTES: usize = 5;

    /// Forty bits; `None` above.
    pub const fn new(word: u64) -> Option<Self> {
        if word >> 40 == 0 { Some(PositionWord(word)) } else { None }
    }

    /// From the line, the lowest byte first.
    pub const fn parse(bytes: [u8; Self::BYTES]) -> Self {
        let [b0, b1, b2, b3, b4] = bytes;
        PositionWord(u64::from_le_bytes([b0, b1, b2, b3, b4, 0, 0, 0]))
    }

    /// For the line, the lowest byte first.
    pub const fn emit(self) -> [u8; Self::BYTES] {
        let [b0, b1, b2, b3, b4, ..] = self.0.to_le_bytes();
        [b0, b1, b2, b3, b4]
    }

    /// The word of a position. Bits of the multiturn for which there is no place are left out.
    pub fn of(reading: &Reading, layout: &Layout) -> Self {
        PositionWord(layout.steps(reading) & 0xFF_FFFF_FFFF)
    }

    /// All forty bits.
    pub const fn word(self) -> u64 {
        self.0
    }

    /// The position, with the widths of the frame; `None` where bits above them are set. Error and warning are not told.
    pub fn reading(self, layout: &Layout) -> Option<Reading> {
        let split = |value: u64, bits: u8| (value & ((1 << bits) - 1), value >> bits);
        let (singleturn, above) = split(self.0, layout.singleturn_bits());
        let (multiturn, rest) = split(above, layout.multiturn_bits());
        // Fields have at most 32 bits.
        let fields = Reading {
            multiturn: u32::try_from(multiturn).ok()?,
            singleturn: u32::try_from(singleturn).ok()?,
            ..Reading::default()
        };
        (rest == 0).then_some(fields)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// Reference 6.
    #[test]
    fn the_published_positions() {
        let layout = Layout::default();
        for (bytes, multiturn, singleturn) in [
            ([0x00, 0x80, 0x69, 0x24, 0x00], 0x1234, 0x18000),
            ([0x00, 0x00, 0x00, 0x00, 0x00], 0x0000, 0x00000),
            ([0xFF, 0xFF, 0xFF, 0xFF, 0x01], 0xFFFF, 0x1FFFF),
            ([0x00, 0x00, 0x02, 0x00, 0x00], 0x0001, 0x00000),
        ] {
            let reading = Reading { multiturn, singleturn, error: false, warning: false };
            let word = PositionWord::parse(bytes);
            assert_eq!(word.reading(&layout), Some(reading), "{bytes:02X?}");
            assert_eq!(PositionWord::of(&reading, &layout), word);
            assert_eq!(word.emit(), bytes);
        }
    }

    #[test]
    fn a_word_too_wide_for_the_encoder_is_no_position() {
        let word = PositionWord::parse([0, 0, 0, 0, 2]);
        assert_eq!(word.reading(&Layout::default()), None);
        let wide = Layout::new(32, 17, true, true, None).unwrap();
        assert_eq!(word.reading(&wide).map(|reading| reading.multiturn), Some(0x1_0000));
        assert_eq!(PositionWord::new(1 << 40), None);
    }

    proptest! {
        #[test]
        fn five_bytes_are_kept(bytes: [u8; 5]) {
            let word = PositionWord::parse(bytes);
            prop_assert_eq!(word.emit(), bytes);
            prop_assert_eq!(PositionWord::new(word.word()), Some(word));
            let _ = word.reading(&Layout::default());
        }
    }
}
