//! Frames as users write them: bits in clock order, or a number.

/// The reason why a string is not a frame.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum FrameTextError {
    /// The string is neither a sequence of bits nor a number.
    #[error("{0:?} is not a frame: enter bits in clock order (0b1010 or 1010), or 0x and hexadecimal digits")]
    Form(String),
    /// The number of bits differs from the number of clocks.
    #[error("{text} {} {bits} bits; the layout has {clocks} clocks", if *.is_number { "needs" } else { "has" })]
    Bits {
        /// String as entered by the user.
        text: String,
        /// Number of bits in the string. For a number, this is the number of bits that it needs.
        bits: u32,
        /// Number of clocks that the layout requires.
        clocks: u8,
        /// Whether the string is a number, rather than a sequence of bits.
        is_number: bool,
    },
}

/// Parses a frame with the given number of clocks. The text contains either bits in clock order (`0b1010…` or only 0
/// and 1), or a right-justified number (`0x…`). Blanks and underscores between bits are ignored.
///
/// # Errors
/// Returns a [`FrameTextError`] with the valid formats if the text is not a frame.
pub fn parse_frame(text: &str, clocks: u8) -> Result<u64, FrameTextError> {
    let text = text.trim();
    let form = || FrameTextError::Form(text.to_owned());
    let hex = text.strip_prefix("0x").or(text.strip_prefix("0X"));
    let binary = text.strip_prefix("0b").or(text.strip_prefix("0B")).unwrap_or(text);
    let digits: String =
        hex.unwrap_or(binary).chars().filter(|digit| *digit != '_' && !digit.is_whitespace()).collect();
    let radix = if hex.is_some() { 16 } else { 2 };
    if digits.is_empty() || !digits.chars().all(|digit| digit.is_digit(radix)) {
        return Err(form());
    }
    let is_number = hex.is_some();
    let too_long = |bits| FrameTextError::Bits { text: text.to_owned(), bits, clocks, is_number };
    let significant = digits.trim_start_matches('0');
    let frame = if significant.is_empty() { Ok(0) } else { u64::from_str_radix(significant, radix) };
    let count = u32::try_from(digits.len()).unwrap_or(u32::MAX);
    // A number that exceeds 64 bits is measured by its digits.
    let bits = match &frame {
        Ok(frame) if is_number => u64::BITS - frame.leading_zeros(),
        Err(_) if is_number => u32::try_from(significant.len()).unwrap_or(u32::MAX).saturating_mul(4),
        _ => count,
    };
    let own = u32::from(clocks);
    let fits = if is_number { bits <= own } else { bits == own };
    frame.ok().filter(|_| fits).ok_or_else(|| too_long(bits))
}

/// Returns the bits of a frame in clock order.
pub fn frame_bits(frame: u64, clocks: u8) -> String {
    (0..clocks.min(64)).rev().map(|behind| if frame >> behind & 1 == 1 { '1' } else { '0' }).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bits_and_numbers_parse() {
        // Frame of an AHS36 at position 2A5Bh (reference section 8).
        for text in ["101010010110110", "0b1010100_10110110", "1010 1001 0110 110", "0x54B6", "0X54b6", "0x000054B6"] {
            assert_eq!(parse_frame(text, 15), Ok(0x54B6), "{text}");
        }
        assert_eq!(frame_bits(0x54B6, 15), "101010010110110");
        assert_eq!(frame_bits(u64::MAX, 64).len(), 64);
        assert_eq!(parse_frame(&"1".repeat(64), 64), Ok(u64::MAX));
        assert_eq!(parse_frame("0xFFFFFFFFFFFFFFFF", 64), Ok(u64::MAX));
    }

    #[test]
    fn rejects_invalid_frames() {
        for text in ["", "0x", "0b", "12", "+1", "0x+1", "0xG", "frame", "-1"] {
            assert!(matches!(parse_frame(text, 15), Err(FrameTextError::Form(_))), "{text}");
        }
        let said = |text: &str| parse_frame(text, 15).unwrap_err().to_string();
        assert_eq!(said("1010"), "1010 has 4 bits; the layout has 15 clocks");
        assert_eq!(said("0x8000"), "0x8000 needs 16 bits; the layout has 15 clocks");
        assert!(said(&format!("0x1{}", "0".repeat(20))).contains("needs 84 bits"));
        assert!(said(&"1".repeat(70)).contains("has 70 bits"));
    }
}
