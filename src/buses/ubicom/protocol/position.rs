//! The position word: five bytes, least significant first. The frame layout of the encoder defines its bits.

/// A position word as received. Unused bits are preserved.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PositionWord(u64);

impl PositionWord {
    /// Length of a position word in bytes.
    pub const BYTES: usize = 5;

    /// Creates a position word, or returns `None` if the value exceeds 40 bits.
    pub const fn new(word: u64) -> Option<Self> {
        if word >> 40 == 0 { Some(PositionWord(word)) } else { None }
    }

    /// Parses a position word, least significant byte first.
    pub const fn parse(bytes: [u8; Self::BYTES]) -> Self {
        let [b0, b1, b2, b3, b4] = bytes;
        PositionWord(u64::from_le_bytes([b0, b1, b2, b3, b4, 0, 0, 0]))
    }

    /// Returns the encoded word, least significant byte first.
    pub const fn emit(self) -> [u8; Self::BYTES] {
        let [b0, b1, b2, b3, b4, ..] = self.0.to_le_bytes();
        [b0, b1, b2, b3, b4]
    }

    /// Returns the word as a number of 40 bits.
    pub const fn to_u64(self) -> u64 {
        self.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn rejects_position_over_forty_bits() {
        assert_eq!(PositionWord::new(1 << 40), None);
        assert_eq!(PositionWord::new((1 << 40) - 1).map(PositionWord::emit), Some([0xFF; 5]));
    }

    proptest! {
        #[test]
        fn position_words_round_trip(bytes: [u8; 5]) {
            let word = PositionWord::parse(bytes);
            prop_assert_eq!(word.emit(), bytes);
            prop_assert_eq!(PositionWord::new(word.to_u64()), Some(word));
        }
    }
}
