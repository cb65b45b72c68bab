//! Conversion of a table to UTF-8 in pieces. Windows programs export UTF-16 as "Unicode text".

use std::borrow::Cow;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Encoding {
    /// UTF-8 or a single-byte encoding.
    Bytes,
    /// UTF-16, little-endian.
    Utf16Le,
    /// UTF-16, big-endian.
    Utf16Be,
}

/// Decoder that converts a table to UTF-8 in pieces and drops the byte order mark.
#[derive(Debug)]
pub(super) struct Utf8Decoder {
    encoding: Encoding,
    /// Number of remaining bytes of the byte order mark.
    mark: usize,
    /// First byte of a code unit that is split across two pieces.
    half: Option<u8>,
    /// First code unit of a surrogate pair that is split across two pieces.
    high: Option<u16>,
}

pub fn decode_head(head: &[u8]) -> Cow<'_, [u8]> {
    Utf8Decoder::detect(head).decode(head)
}

impl Utf8Decoder {
    /// Detects the encoding from the beginning of a table. UTF-16 without a byte order mark is recognised by the zero
    /// bytes in the first two characters.
    pub(super) fn detect(head: &[u8]) -> Self {
        let (encoding, mark) = match head {
            [0xEF, 0xBB, 0xBF, ..] => (Encoding::Bytes, 3),
            [0xFF, 0xFE, ..] => (Encoding::Utf16Le, 2),
            [0xFE, 0xFF, ..] => (Encoding::Utf16Be, 2),
            [1..=255, 0, 1..=255, 0, ..] => (Encoding::Utf16Le, 0),
            [0, 1..=255, 0, 1..=255, ..] => (Encoding::Utf16Be, 0),
            _ => (Encoding::Bytes, 0),
        };
        Utf8Decoder { encoding, mark, half: None, high: None }
    }

    pub(super) fn decode<'b>(&mut self, bytes: &'b [u8]) -> Cow<'b, [u8]> {
        let skipped = self.mark.min(bytes.len());
        self.mark -= skipped;
        let bytes = bytes.get(skipped..).unwrap_or_default();
        match self.encoding {
            Encoding::Bytes => Cow::Borrowed(bytes),
            Encoding::Utf16Le => Cow::Owned(self.decode_units(bytes, u16::from_le_bytes)),
            Encoding::Utf16Be => Cow::Owned(self.decode_units(bytes, u16::from_be_bytes)),
        }
    }

    fn decode_units(&mut self, bytes: &[u8], unit: fn([u8; 2]) -> u16) -> Vec<u8> {
        let mut text = String::with_capacity(bytes.len() / 2 + 1);
        for &byte in bytes {
            match self.half.take() {
                None => self.half = Some(byte),
                Some(first) => self.push_unit(unit([first, byte]), &mut text),
            }
        }
        text.into_bytes()
    }

    fn push_unit(&mut self, unit: u16, text: &mut String) {
        if self.high.is_none() && (0xD800..0xDC00).contains(&unit) {
            self.high = Some(unit);
            return;
        }
        let units = self.high.take().into_iter().chain([unit]);
        text.extend(char::decode_utf16(units).map(|own| own.unwrap_or(char::REPLACEMENT_CHARACTER)));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn decoded(bytes: &[u8], pieces: usize) -> Vec<u8> {
        let mut decoder = Utf8Decoder::detect(bytes);
        let mut out = Vec::new();
        for piece in bytes.chunks(pieces) {
            out.extend_from_slice(&decoder.decode(piece));
        }
        out
    }

    #[test]
    fn decodes_utf_16_in_any_chunks() {
        let text = "Zeit (µs);sin;cos 𝛼\n0;1;2\n";
        let le: Vec<u8> = text.encode_utf16().flat_map(u16::to_le_bytes).collect();
        let be: Vec<u8> = text.encode_utf16().flat_map(u16::to_be_bytes).collect();
        let ways = [
            ("UTF-8", text.as_bytes().to_vec()),
            ("UTF-8 with mark", [b"\xEF\xBB\xBF", text.as_bytes()].concat()),
            ("LE", le.clone()),
            ("LE with mark", [vec![0xFF, 0xFE], le].concat()),
            ("BE", be.clone()),
            ("BE with mark", [vec![0xFE, 0xFF], be].concat()),
        ];
        for (label, bytes) in ways {
            for pieces in [1, 2, 3, 100] {
                assert_eq!(decoded(&bytes, pieces), text.as_bytes(), "{label} in pieces of {pieces}");
            }
        }
        assert_eq!(decoded(b"\xFF\xFE\x00\xD8a\x00b\x00", 1), "\u{FFFD}ab".as_bytes(), "half of a pair");
        assert_eq!(decoded(b"", 1), b"");
    }
}
