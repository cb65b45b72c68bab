//! Bytes as hexadecimal text: upper case, grouped by bytes, the way every manual prints frames; with what is secret
//! masked.

use std::fmt;
use std::str::FromStr;

/// Upper-case hex with a blank between bytes: `40 42 02`.
pub fn hex(bytes: &[u8]) -> String {
    let words: Vec<String> = bytes.iter().map(|byte| format!("{byte:02X}")).collect();
    words.join(" ")
}

/// Upper-case hex without separators, as JSON carries bytes: `404202`.
pub fn hex_compact(bytes: &[u8]) -> String {
    bytes.iter().map(|byte| format!("{byte:02X}")).collect()
}

/// Bytes that may be shown: what is secret is not in them. Its text has `**` for a masked byte.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct MaskedBytes(Vec<Option<u8>>);

impl MaskedBytes {
    /// Bytes without a secret.
    pub fn clear(bytes: &[u8]) -> Self {
        MaskedBytes(bytes.iter().copied().map(Some).collect())
    }

    /// Bytes of which nothing but the number may be shown.
    pub fn hidden(count: usize) -> Self {
        MaskedBytes(vec![None; count])
    }

    /// The bytes, without those at the positions in `secret`.
    pub fn masked(bytes: &[u8], secret: &[usize]) -> Self {
        let show = |(at, byte): (usize, &u8)| (!secret.contains(&at)).then_some(*byte);
        MaskedBytes(bytes.iter().enumerate().map(show).collect())
    }

    /// Number of bytes, masked ones included.
    pub fn len(&self) -> usize {
        self.0.len()
    }

    /// No byte at all.
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// The bytes; `None` where a masked one leaves a hole.
    pub fn to_bytes(&self) -> Option<Vec<u8>> {
        self.0.iter().copied().collect()
    }

    /// The first `count` bytes and the rest.
    pub fn split_at(&self, count: usize) -> (MaskedBytes, MaskedBytes) {
        let (head, tail) = self.0.split_at(count.min(self.0.len()));
        (MaskedBytes(head.to_vec()), MaskedBytes(tail.to_vec()))
    }

    /// These bytes followed by `more`.
    pub fn extend(&mut self, more: MaskedBytes) {
        self.0.extend(more.0);
    }

    /// Of the same length, and equal wherever this one is not masked.
    pub fn matches(&self, bytes: &[u8]) -> bool {
        self.0.len() == bytes.len() && self.0.iter().zip(bytes).all(|(own, byte)| own.is_none_or(|own| own == *byte))
    }
}

impl fmt::Display for MaskedBytes {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (at, byte) in self.0.iter().enumerate() {
            let gap = if at == 0 { "" } else { " " };
            match byte {
                Some(byte) => write!(f, "{gap}{byte:02X}")?,
                None => write!(f, "{gap}**")?,
            }
        }
        Ok(())
    }
}

impl FromStr for MaskedBytes {
    type Err = HexError;

    fn from_str(text: &str) -> Result<Self, HexError> {
        let mut bytes = Vec::new();
        for word in text.split_whitespace() {
            match word {
                "**" => bytes.push(None),
                _ => bytes.extend(parse_hex(word)?.into_iter().map(Some)),
            }
        }
        Ok(MaskedBytes(bytes))
    }
}

/// Why a text is not hex bytes.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum HexError {
    /// A character that is neither a hex digit nor a separator.
    #[error("{0:?} is not a hexadecimal digit")]
    Digit(char),
    /// A group with an odd number of digits.
    #[error("{0:?} has an odd number of hexadecimal digits")]
    Odd(String),
}

/// Reads hex bytes: groups of two digits each, separated by blanks, commas, colons or dashes or by nothing, with or
/// without `0x` or a final `h`. An empty text is no bytes.
pub fn parse_hex(text: &str) -> Result<Vec<u8>, HexError> {
    let mut bytes = Vec::new();
    for group in text.split(|c: char| c.is_whitespace() || matches!(c, ',' | ':' | '-')).filter(|g| !g.is_empty()) {
        parse_group(group, &mut bytes)?;
    }
    Ok(bytes)
}

fn parse_group(group: &str, bytes: &mut Vec<u8>) -> Result<(), HexError> {
    let bare = group.strip_prefix("0x").or_else(|| group.strip_prefix("0X")).unwrap_or(group);
    let bare = bare.strip_suffix(['h', 'H']).unwrap_or(bare);
    let digits: Vec<u8> = bare
        .chars()
        .map(|c| c.to_digit(16).and_then(|d| u8::try_from(d).ok()).ok_or(HexError::Digit(c)))
        .collect::<Result<_, _>>()?;
    let (pairs, rest) = digits.as_chunks::<2>();
    if !rest.is_empty() || digits.is_empty() {
        // One digit on its own is a byte only where it stands alone: "0x5" is 05.
        return match (pairs, rest) {
            ([], [digit]) => {
                bytes.push(*digit);
                Ok(())
            }
            _ => Err(HexError::Odd(group.to_owned())),
        };
    }
    bytes.extend(pairs.iter().map(|[high, low]| high << 4 | low));
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn hex_is_read_in_every_usual_form() {
        for text in ["40 4E 0E", "404e0e", "0x40,0x4E,0x0E", "40h 4Eh 0Eh", "40:4E:0E", " 40-4E-E "] {
            assert_eq!(parse_hex(text).unwrap(), [0x40, 0x4E, 0x0E], "{text}");
        }
        assert_eq!(parse_hex("").unwrap(), [0u8; 0]);
    }

    #[test]
    fn what_is_no_hex_is_refused() {
        assert_eq!(parse_hex("4G"), Err(HexError::Digit('G')));
        assert_eq!(parse_hex("404"), Err(HexError::Odd("404".into())));
        assert_eq!(parse_hex("0x"), Err(HexError::Odd("0x".into())));
    }

    #[test]
    fn masked_bytes_match_anything_in_their_place() {
        let masked = MaskedBytes::masked(&[0x40, 0x4F, 0x02, 0x55, 0x66, 0x3E], &[3, 4, 5]);
        assert_eq!(masked.to_string(), "40 4F 02 ** ** **");
        assert_eq!("40 4f 02 ** ** **".parse(), Ok(masked.clone()));
        assert!(masked.matches(&[0x40, 0x4F, 0x02, 1, 2, 3]));
        assert!(!masked.matches(&[0x40, 0x4F, 0x03, 1, 2, 3]));
        assert!(!masked.matches(&[0x40, 0x4F, 0x02, 1, 2]));
        assert_eq!(masked.to_bytes(), None);
        assert_eq!(MaskedBytes::clear(&[1, 2]).to_bytes(), Some(vec![1, 2]));
    }

    proptest! {
        #[test]
        fn what_is_written_is_read(bytes in proptest::collection::vec(any::<u8>(), 0..64)) {
            prop_assert_eq!(parse_hex(&hex(&bytes)).unwrap(), bytes.clone());
            prop_assert_eq!(parse_hex(&hex_compact(&bytes)).unwrap(), bytes);
        }

        #[test]
        fn no_text_panics(text in ".*") {
            let _ = parse_hex(&text);
        }
    }
}
