//! The UBICOM position word, which holds the singleturn position in the lower bits and the multiturn position above it
//! (manual 5.2). It has no error and warning bits.

use super::single_cycle::{Layout, PositionData};
use crate::buses::ubicom::protocol::PositionWord;

impl Layout {
    /// Returns the position word for a reading. Multiturn bits that exceed the width in the frame are dropped.
    pub fn position_word(&self, reading: &PositionData) -> PositionWord {
        let [b0, b1, b2, b3, b4, ..] = self.position_to_steps(reading).to_le_bytes();
        PositionWord::parse([b0, b1, b2, b3, b4])
    }

    /// Splits a position word into multiturn and singleturn, without error and warning. Returns `None` if a bit above
    /// them is set.
    pub fn decode_position(&self, word: PositionWord) -> Option<PositionData> {
        let split = |value: u64, bits: u8| (value & ((1 << bits) - 1), value >> bits);
        let (singleturn, above) = split(word.to_u64(), self.singleturn_bits());
        let (multiturn, rest) = split(above, self.multiturn_bits());
        // Fields are at most 32 bits wide.
        let fields = PositionData {
            multiturn: u32::try_from(multiturn).ok()?,
            singleturn: u32::try_from(singleturn).ok()?,
            ..PositionData::default()
        };
        (rest == 0).then_some(fields)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// Expected values from section 6 of the UBICOM reference.
    #[test]
    fn published_positions_match() {
        let layout = Layout::default();
        for (bytes, multiturn, singleturn) in [
            ([0x00, 0x80, 0x69, 0x24, 0x00], 0x1234, 0x18000),
            ([0x00, 0x00, 0x00, 0x00, 0x00], 0x0000, 0x00000),
            ([0xFF, 0xFF, 0xFF, 0xFF, 0x01], 0xFFFF, 0x1FFFF),
            ([0x00, 0x00, 0x02, 0x00, 0x00], 0x0001, 0x00000),
        ] {
            let reading = PositionData { multiturn, singleturn, error: false, warning: false };
            let word = PositionWord::parse(bytes);
            assert_eq!(layout.decode_position(word), Some(reading), "{bytes:02X?}");
            assert_eq!(layout.position_word(&reading), word);
        }
    }

    #[test]
    fn rejects_word_wider_than_position() {
        let word = PositionWord::parse([0, 0, 0, 0, 2]);
        assert_eq!(Layout::default().decode_position(word), None);
        let wide = Layout::new(32, 17, true, true, None).unwrap();
        assert_eq!(wide.decode_position(word).map(|reading| reading.multiturn), Some(0x1_0000));
    }

    proptest! {
        #[test]
        fn arbitrary_words_never_panic(bytes: [u8; 5]) {
            let _ = Layout::default().decode_position(PositionWord::parse(bytes));
        }
    }
}
