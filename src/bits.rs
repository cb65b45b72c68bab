//! Hexadecimal notation for bytes: upper case, separated by spaces as in the manuals, with secrets masked. Bytes can
//! also be interpreted as numbers or text.

use std::fmt;
use std::str::FromStr;

pub fn hex(bytes: &[u8]) -> String {
    let words: Vec<String> = bytes.iter().map(|byte| format!("{byte:02X}")).collect();
    words.join(" ")
}

/// Returns the bytes as upper-case hex without separators, as used in JSON: `404202`.
pub fn hex_compact(bytes: &[u8]) -> String {
    bytes.iter().map(|byte| format!("{byte:02X}")).collect()
}

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, serde::Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum ByteOrder {
    #[default]
    HighFirst,
    LowFirst,
}

/// A number of a given width in bits, displayed with as many upper-case hexadecimal digits as the width requires.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Word {
    /// The bits, right-justified.
    pub value: u64,
    pub bits: u8,
}

impl fmt::Display for Word {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{:0digits$X}", self.value, digits = usize::from(self.bits.div_ceil(4)))
    }
}

/// A byte sequence in which secret bytes may be masked. A masked byte displays as `**`.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct MaskedBytes(Vec<Option<u8>>);

impl MaskedBytes {
    /// Creates bytes without any mask.
    pub fn unmasked(bytes: &[u8]) -> Self {
        MaskedBytes(bytes.iter().copied().map(Some).collect())
    }

    pub fn fully_masked(count: usize) -> Self {
        MaskedBytes(vec![None; count])
    }

    /// Creates a sequence in which the bytes at the positions in `secret` are masked.
    pub fn with_masked(bytes: &[u8], secret: &[usize]) -> Self {
        let show = |(at, byte): (usize, &u8)| (!secret.contains(&at)).then_some(*byte);
        MaskedBytes(bytes.iter().enumerate().map(show).collect())
    }

    pub fn len(&self) -> usize {
        self.0.len()
    }

    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// Returns the bytes, or `None` if any of them is masked.
    pub fn to_bytes(&self) -> Option<Vec<u8>> {
        self.0.iter().copied().collect()
    }

    pub fn with_placeholder(&self, stand_in: u8) -> Vec<u8> {
        self.0.iter().map(|byte| byte.unwrap_or(stand_in)).collect()
    }

    pub fn split_at(&self, count: usize) -> (MaskedBytes, MaskedBytes) {
        let (head, tail) = self.0.split_at(count.min(self.0.len()));
        (MaskedBytes(head.to_vec()), MaskedBytes(tail.to_vec()))
    }

    pub fn append(&mut self, more: MaskedBytes) {
        self.0.extend(more.0);
    }

    /// Returns whether `bytes` has the same length and matches all bytes that are not masked.
    pub fn matches_visible(&self, bytes: &[u8]) -> bool {
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

/// The reason why a string is not a list of hexadecimal bytes.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum HexError {
    /// The character is neither a hex digit nor a separator.
    #[error("{0:?} is not a hexadecimal digit")]
    Digit(char),
    #[error("{0:?} has an odd number of hexadecimal digits")]
    Odd(String),
}

/// Parses hex bytes in groups of two digits each. Blanks, commas, colons or dashes may separate the groups, and a group
/// may begin with `0x` or end with `h`. An empty string yields no bytes.
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
        // A single digit is a byte only if it is the whole text. For example, "0x5" is 05.
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

#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum DataType {
    U8,
    /// A signed byte in two's complement.
    I8,
    /// Two bytes, unsigned.
    U16,
    I16,
    /// Four bytes, unsigned.
    U32,
    /// Four bytes, two's complement.
    I32,
    F32,
    /// The bits of one byte, most significant first.
    Binary,
    /// All bytes as ASCII.
    Text,
}

impl DataType {
    pub const ALL: [DataType; 9] = [
        DataType::U8,
        DataType::I8,
        DataType::U16,
        DataType::I16,
        DataType::U32,
        DataType::I32,
        DataType::F32,
        DataType::Binary,
        DataType::Text,
    ];

    /// Returns whether the value depends on the byte order.
    pub const fn has_byte_order(self) -> bool {
        !matches!(self, DataType::U8 | DataType::I8 | DataType::Binary | DataType::Text)
    }
}

/// The start of a byte sequence, interpreted as one kind of value. `little` and `big` are equal if the byte order does
/// not matter.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct InterpretedRow {
    pub kind: DataType,
    /// Little-endian value, or `None` if there are too few bytes.
    pub little: Option<String>,
    /// Big-endian value, or `None` if there are too few bytes.
    pub big: Option<String>,
}

/// Interprets the start of `bytes` as each kind of value, in the order of [`DataType::ALL`].
pub fn interpret(bytes: &[u8]) -> Vec<InterpretedRow> {
    let row = |kind| InterpretedRow {
        kind,
        little: format_as_type(kind, bytes, false),
        big: format_as_type(kind, bytes, true),
    };
    DataType::ALL.into_iter().map(row).collect()
}

fn format_as_type(kind: DataType, bytes: &[u8], big: bool) -> Option<String> {
    let (one, two, four) = (bytes.first().copied(), bytes.first_chunk::<2>(), bytes.first_chunk::<4>());
    let word = two.map(|word| if big { u16::from_be_bytes(*word) } else { u16::from_le_bytes(*word) });
    let long = four.map(|long| if big { u32::from_be_bytes(*long) } else { u32::from_le_bytes(*long) });
    match kind {
        DataType::U8 => one.map(|byte| byte.to_string()),
        DataType::I8 => one.map(|byte| byte.cast_signed().to_string()),
        DataType::U16 => word.map(|word| word.to_string()),
        DataType::I16 => word.map(|word| word.cast_signed().to_string()),
        DataType::U32 => long.map(|long| long.to_string()),
        DataType::I32 => long.map(|long| long.cast_signed().to_string()),
        DataType::F32 => long.map(|long| format_float(f32::from_bits(long))),
        DataType::Binary => one.map(format_binary),
        DataType::Text => one.map(|_| bytes.iter().map(|byte| ascii(*byte).unwrap_or(UNPRINTABLE)).collect()),
    }
}

/// Replacement for a byte that is not a printable character.
pub const UNPRINTABLE: char = '·';

/// Returns the ASCII character of a byte, or `None` if the byte is not printable.
pub fn ascii(byte: u8) -> Option<char> {
    (0x20..0x7F).contains(&byte).then_some(char::from(byte))
}

pub fn format_binary(byte: u8) -> String {
    format!("{:04b} {:04b}", byte >> 4, byte & 0xF)
}

/// Returns the shortest representation that parses back to the same number. A long number is written with an exponent.
fn format_float(value: f32) -> String {
    let plain = value == 0.0 || !value.is_finite() || (1e-4..1e7).contains(&value.abs());
    if plain { value.to_string() } else { format!("{value:e}") }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn parses_common_hex_notations() {
        for text in ["40 4E 0E", "404e0e", "0x40,0x4E,0x0E", "40h 4Eh 0Eh", "40:4E:0E", " 40-4E-E "] {
            assert_eq!(parse_hex(text).unwrap(), [0x40, 0x4E, 0x0E], "{text}");
        }
        assert_eq!(parse_hex("").unwrap(), [0u8; 0]);
    }

    #[test]
    fn rejects_invalid_hex() {
        assert_eq!(parse_hex("4G"), Err(HexError::Digit('G')));
        assert_eq!(parse_hex("404"), Err(HexError::Odd("404".into())));
        assert_eq!(parse_hex("0x"), Err(HexError::Odd("0x".into())));
    }

    #[test]
    fn masked_bytes_match_any_value() {
        let masked = MaskedBytes::with_masked(&[0x40, 0x4F, 0x02, 0x55, 0x66, 0x3E], &[3, 4, 5]);
        assert_eq!(masked.to_string(), "40 4F 02 ** ** **");
        assert_eq!("40 4f 02 ** ** **".parse(), Ok(masked.clone()));
        assert!(masked.matches_visible(&[0x40, 0x4F, 0x02, 1, 2, 3]));
        assert!(!masked.matches_visible(&[0x40, 0x4F, 0x03, 1, 2, 3]));
        assert!(!masked.matches_visible(&[0x40, 0x4F, 0x02, 1, 2]));
        assert_eq!(masked.to_bytes(), None);
        assert_eq!(MaskedBytes::unmasked(&[1, 2]).to_bytes(), Some(vec![1, 2]));
    }

    #[test]
    fn decoded_values_match_python() {
        type Rows = [(&'static str, &'static str); 9];
        // The expected values come from struct.unpack in Python with "<" and ">" and b, B, h, H, i, I, f.
        let table: [(&[u8], Rows); 4] = [
            (
                &[0xDB, 0x0F, 0x49, 0x40],
                [
                    ("219", "219"),
                    ("-37", "-37"),
                    ("4059", "56079"),
                    ("4059", "-9457"),
                    ("1078530011", "3675212096"),
                    ("1078530011", "-619755200"),
                    ("3.1415927", "-4.033146e16"),
                    ("1101 1011", "1101 1011"),
                    ("··I@", "··I@"),
                ],
            ),
            (
                &[0x42, 0xF6, 0xE9, 0x79],
                [
                    ("66", "66"),
                    ("66", "66"),
                    ("63042", "17142"),
                    ("-2494", "17142"),
                    ("2045376066", "1123477881"),
                    ("2045376066", "1123477881"),
                    ("1.5184998e35", "123.456"),
                    ("0100 0010", "0100 0010"),
                    ("B··y", "B··y"),
                ],
            ),
            (
                &[0x80, 0x00],
                [
                    ("128", "128"),
                    ("-128", "-128"),
                    ("128", "32768"),
                    ("128", "-32768"),
                    ("", ""),
                    ("", ""),
                    ("", ""),
                    ("1000 0000", "1000 0000"),
                    ("··", "··"),
                ],
            ),
            (&[], [("", ""); 9]),
        ];
        for (bytes, rows) in table {
            for (row, (little, big)) in interpret(bytes).into_iter().zip(rows) {
                let shown = (row.little.unwrap_or_default(), row.big.unwrap_or_default());
                assert_eq!(shown, (little.to_owned(), big.to_owned()), "{} as {:?}", hex(bytes), row.kind);
            }
        }
    }

    #[test]
    fn names_special_floats() {
        let big = |bytes: [u8; 4]| interpret(&bytes)[6].big.clone().unwrap();
        assert_eq!(big([0x7F, 0x80, 0, 0]), "inf");
        assert_eq!(big([0x7F, 0xC0, 0, 0]), "NaN");
        assert_eq!(big([0x80, 0, 0, 0]), "-0");
        assert_eq!(big([0, 0, 0, 1]), "1e-45");
    }

    proptest! {
        #[test]
        fn emitted_hex_parses_back(bytes in proptest::collection::vec(any::<u8>(), 0..64)) {
            prop_assert_eq!(parse_hex(&hex(&bytes)).unwrap(), bytes.clone());
            prop_assert_eq!(parse_hex(&hex_compact(&bytes)).unwrap(), bytes);
        }

        #[test]
        fn arbitrary_text_never_panics(text in ".*") {
            let _ = parse_hex(&text);
        }
    }
}
