//! Frames as received from the PIO state machines: words of 32 bits with the first bit highest, followed by a last word
//! with the remaining bits right-justified. If the length is a multiple of 32, the last word is empty.

/// Maximum number of words in a frame.
pub const MAX_WORDS: usize = 3;

/// The words of a received frame.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct FrameWords(pub [u32; MAX_WORDS]);

impl FrameWords {
    /// Returns the number of words in a frame of `bits` bits.
    pub const fn count(bits: u8) -> u8 {
        bits / 32 + 1
    }

    /// Joins the words of a frame of `bits` bits. The result is right-justified.
    pub fn join(self, bits: u8) -> u128 {
        let last = usize::from(bits / 32);
        self.0.iter().take(last + 1).enumerate().fold(0, |frame, (at, word)| {
            let width = if at < last { 32 } else { u32::from(bits % 32) };
            let mask = (1_u128 << width) - 1;
            frame << width | u128::from(*word) & mask
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn joins_words_in_clock_order() {
        let cases: [(u8, [u32; 3], u128); 7] = [
            (1, [1, 0, 0], 1),
            (25, [0x0B4_B234, 7, 7], 0x0B4_B234),
            (31, [0x7FFF_FFFF, 0, 0], 0x7FFF_FFFF),
            (32, [0xA5A5_5A5A, 0xFFFF_FFFF, 0], 0xA5A5_5A5A),
            (33, [0xFFFF_FFFF, 0, 0], 0x1_FFFF_FFFE),
            (64, [0x8123_4567, 0x89AB_CDEF, 9], 0x8123_4567_89AB_CDEF),
            (68, [0x8123_4567, 0x89AB_CDEF, 5], 0x8_1234_5678_9ABC_DEF5),
        ];
        for (bits, words, frame) in cases {
            assert_eq!(FrameWords(words).join(bits), frame, "{bits} bits");
        }
        assert_eq!([1, 31, 32, 63, 64, 68].map(FrameWords::count), [1, 1, 2, 2, 3, 3]);
    }
}
