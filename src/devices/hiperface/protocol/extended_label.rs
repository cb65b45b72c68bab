//! The extended type label in data field FFh (manual, "Inhalt des Datenfeldes FFh").

use super::type_label::text;
use super::{Geometry, checksum};

/// Extended label of an encoder with type code FFh.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ExtendedLabel {
    /// Whether the stored checksum equals the XOR of all other bytes. The algorithm is not public (`U`), so a mismatch
    /// only causes a warning.
    pub checksum_fits: bool,
    /// Flags in byte 01h. Bit 0 means linear, and bit 1 means bipolar counting. The byte is displayed unchanged,
    /// because another public source inverts the meaning of bit 1.
    pub flags: u8,
    /// Geometry of the encoder, or `None` if one of its numbers is zero or too large.
    pub geometry: Option<Geometry>,
    /// Designation of 18 characters, padded with blanks.
    pub designation: String,
    /// Valid limits, ordered by number.
    pub parameters: Vec<LabelParameter>,
}

/// Limit on the extended label. Only the encoder's data sheet defines the meaning of each limit number (`U`). If
/// command 44h can read the quantity, its first limit word is its analogue channel.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct LabelParameter {
    /// Number of the limit: 0 to 14 in the first set, 15 to 29 in the second, 30 to 44 in the third.
    pub number: u8,
    /// Value in two's complement.
    pub value: i16,
}

/// Part of the extended label.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LabelPart {
    /// Checksum (byte 00h).
    Checksum,
    /// Flags (byte 01h).
    Flags,
    /// Periods per revolution, or period length in nanometres (bytes 02h to 05h).
    Resolution(u32),
    /// Number of revolutions, or coded range in signal periods (bytes 06h to 09h).
    Range(u32),
    /// Designation (bytes 0Ah to 1Bh).
    Designation,
    /// Selector word of a set. Bits 0 to 14 mark the valid limits, and bit 15 means that another set follows.
    Selector(u16),
    /// Limit, which is valid only if its bit in the selector word is set.
    Limit {
        /// Number of the limit.
        number: u8,
        /// Value in two's complement.
        value: i16,
        /// Whether the bit in the selector word is set.
        valid: bool,
    },
}

/// Reason why a data field does not contain an extended label.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum LabelError {
    /// The content is too short for the description in bytes 00h to 1Bh.
    #[error("{got} bytes are too few for an extended type label of at least {}", ExtendedLabel::MIN_BYTES)]
    Short {
        /// Length of the content in bytes.
        got: usize,
    },
}

impl ExtendedLabel {
    /// Minimum length of a label in bytes: the description in bytes 00h to 1Bh, without limits.
    pub const MIN_BYTES: usize = 0x1C;
    /// Bit 0 of the flags, set for a linear encoder.
    pub const LINEAR: u8 = 0x01;
    /// Bit 1 of the flags, set for bipolar counting.
    pub const BIPOLAR: u8 = 0x02;
    /// Length of a set in bytes: a selector word and fifteen limit words.
    const SET_BYTES: usize = 32;

    /// Parses the content of field FFh. Limits beyond the end of the field are omitted.
    ///
    /// # Errors
    /// Returns [`LabelError::Short`] if the description is incomplete.
    pub fn parse(bytes: &[u8]) -> Result<Self, LabelError> {
        let (description, sets) =
            bytes.split_first_chunk::<{ Self::MIN_BYTES }>().ok_or(LabelError::Short { got: bytes.len() })?;
        let [_checksum, flags, a3, a2, a1, a0, b3, b2, b1, b0, designation @ ..] = description;
        let first = u32::from_be_bytes([*a3, *a2, *a1, *a0]);
        let second = u32::from_be_bytes([*b3, *b2, *b1, *b0]);
        Ok(ExtendedLabel {
            checksum_fits: checksum(bytes) == 0,
            flags: *flags,
            geometry: Self::build_geometry(flags & Self::LINEAR != 0, first, second),
            designation: text(designation),
            parameters: Self::parameters(sets),
        })
    }

    /// Returns the analogue channels that have a limit, each with its maximum reading. Only the data sheet defines
    /// which parameters form a pair of channel and limit (`U`). Therefore, any two parameters with consecutive numbers
    /// are assumed to be a pair, which is used only for a remark and only if the channel replies.
    pub fn limits(&self) -> Vec<(u8, i16)> {
        let mut limits = Vec::new();
        let mut rest = self.parameters.as_slice();
        while let [first, others @ ..] = rest {
            rest = others;
            let [second, others @ ..] = others else { break };
            if second.number == first.number + 1 {
                limits.extend(u8::try_from(first.value).ok().map(|channel| (channel, second.value)));
                rest = others;
            }
        }
        limits
    }

    /// Returns the parts of the label, each with its address, length in bytes, and meaning.
    ///
    /// # Errors
    /// Returns [`LabelError::Short`] if the description is incomplete.
    pub fn parse_parts(bytes: &[u8]) -> Result<Vec<(usize, usize, LabelPart)>, LabelError> {
        let (description, mut sets) =
            bytes.split_first_chunk::<{ Self::MIN_BYTES }>().ok_or(LabelError::Short { got: bytes.len() })?;
        let [_, _, a3, a2, a1, a0, b3, b2, b1, b0, ..] = description;
        let mut parts = vec![
            (0x00, 1, LabelPart::Checksum),
            (0x01, 1, LabelPart::Flags),
            (0x02, 4, LabelPart::Resolution(u32::from_be_bytes([*a3, *a2, *a1, *a0]))),
            (0x06, 4, LabelPart::Range(u32::from_be_bytes([*b3, *b2, *b1, *b0]))),
            (0x0A, 18, LabelPart::Designation),
        ];
        let mut address = Self::MIN_BYTES;
        for set in 0..3u8 {
            let Some(([high, low], limits)) = sets.split_first_chunk::<2>() else { break };
            let selector = u16::from_be_bytes([*high, *low]);
            parts.push((address, 2, LabelPart::Selector(selector)));
            let (words, _) = limits.as_chunks::<2>();
            for (slot, word) in (0..15u8).zip(words) {
                let valid = selector & 1 << slot != 0;
                let limit = LabelPart::Limit { number: set * 15 + slot, value: i16::from_be_bytes(*word), valid };
                parts.push((address + 2 + 2 * usize::from(slot), 2, limit));
            }
            match sets.get(Self::SET_BYTES..) {
                Some(rest) if selector & 0x8000 != 0 => sets = rest,
                _ => break,
            }
            address += Self::SET_BYTES;
        }
        Ok(parts)
    }

    fn build_geometry(linear: bool, first: u32, second: u32) -> Option<Geometry> {
        if first == 0 || second == 0 {
            return None;
        }
        let geometry = if linear {
            Geometry::Linear { period_nm: first, periods: second }
        } else {
            Geometry::Rotary { periods: first, turns: second }
        };
        // The position word has 32 bits.
        geometry.position_count().filter(|range| *range <= 1 << 32).map(|_| geometry)
    }

    fn parameters(mut sets: &[u8]) -> Vec<LabelParameter> {
        let mut parameters = Vec::new();
        for set in 0..3u8 {
            let Some(([high, low], limits)) = sets.split_first_chunk::<2>() else { break };
            let selector = u16::from_be_bytes([*high, *low]);
            let (words, _) = limits.as_chunks::<2>();
            for (slot, word) in (0..15u8).zip(words) {
                if selector & 1 << slot != 0 {
                    parameters.push(LabelParameter { number: set * 15 + slot, value: i16::from_be_bytes(*word) });
                }
            }
            let another_follows = selector & 0x8000 != 0;
            match sets.get(Self::SET_BYTES..) {
                Some(rest) if another_follows => sets = rest,
                _ => break,
            }
        }
        parameters
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Returns a synthetic label of 64 bytes with an XOR checksum.
    fn label() -> Vec<u8> {
        let mut bytes = crate::bits::parse_hex(
            "53 00 00 00 00 10 00 00 10 00 53 45 4C 33 37 2D 48 46 42 30 2D 4B 30 32 20 20 20 20 00 03 00 48 00 73",
        )
        .unwrap();
        bytes.resize(64, 0);
        bytes
    }

    #[test]
    fn parses_reference_label() {
        let label = ExtendedLabel::parse(&label()).unwrap();
        assert!(label.checksum_fits);
        assert_eq!(label.geometry, Some(Geometry::Rotary { periods: 16, turns: 4096 }));
        assert_eq!(label.designation, "SEL37-HFB0-K02");
        let parameters: Vec<(u8, i16)> = label.parameters.iter().map(|p| (p.number, p.value)).collect();
        assert_eq!(parameters, [(0, 0x48), (1, 115)]);
        assert_eq!(label.limits(), [(0x48, 115)]);
    }

    #[test]
    fn gap_does_not_shift_pairs() {
        let parameter = |number, value| LabelParameter { number, value };
        let mut label = ExtendedLabel::parse(&label()).unwrap();
        label.parameters = vec![parameter(0, 7), parameter(2, 0x48), parameter(3, 115), parameter(9, 1)];
        assert_eq!(label.limits(), [(0x48, 115)]);
        label.parameters = vec![parameter(0, -1), parameter(1, 5)];
        assert_eq!(label.limits(), []);
    }

    #[test]
    fn parses_linear_label_with_second_set() {
        let mut bytes = vec![0; 128];
        bytes[1] = 0x01;
        bytes[2..6].copy_from_slice(&1_000_000u32.to_be_bytes());
        bytes[6..10].copy_from_slice(&5_000u32.to_be_bytes());
        bytes[0x1C..0x1E].copy_from_slice(&[0xC0, 0x00]); // parameter 14, and another selector word follows
        bytes[0x1E + 28..0x1E + 30].copy_from_slice(&(-40i16).to_be_bytes());
        bytes[0x3C..0x3E].copy_from_slice(&[0x00, 0x01]);
        bytes[0x3E..0x40].copy_from_slice(&[0x12, 0x34]);
        let label = ExtendedLabel::parse(&bytes).unwrap();
        assert_eq!(label.geometry, Some(Geometry::Linear { period_nm: 1_000_000, periods: 5_000 }));
        let parameters: Vec<(u8, i16)> = label.parameters.iter().map(|p| (p.number, p.value)).collect();
        assert_eq!(parameters, [(14, -40), (15, 0x1234)]);
        assert!(!label.checksum_fits, "it warns and still reads");
    }

    #[test]
    fn rejects_labels_below_minimum_size() {
        let whole = label();
        for cut in 0..whole.len() {
            assert_eq!(ExtendedLabel::parse(&whole[..cut]).is_ok(), cut >= ExtendedLabel::MIN_BYTES, "{cut}");
        }
    }

    #[test]
    fn impossible_numbers_yield_no_geometry() {
        let mut bytes = label();
        bytes[2..6].copy_from_slice(&u32::MAX.to_be_bytes());
        assert_eq!(ExtendedLabel::parse(&bytes).unwrap().geometry, None);
        bytes[6..10].copy_from_slice(&u32::MAX.to_be_bytes()); // the product needs 69 bits
        assert_eq!(ExtendedLabel::parse(&bytes).unwrap().geometry, None);
        bytes[2..6].copy_from_slice(&[0; 4]);
        assert_eq!(ExtendedLabel::parse(&bytes).unwrap().geometry, None);
    }

    #[test]
    fn label_addresses_match_manual() {
        let parts = ExtendedLabel::parse_parts(&label()).unwrap();
        assert_eq!(
            parts[..5].iter().map(|(at, count, _)| (*at, *count)).collect::<Vec<_>>(),
            [(0, 1), (1, 1), (2, 4), (6, 4), (10, 18)]
        );
        assert_eq!(parts[2].2, LabelPart::Resolution(16));
        assert_eq!(parts[3].2, LabelPart::Range(4096));
        assert_eq!(parts[5], (0x1C, 2, LabelPart::Selector(3)));
        assert_eq!(parts[6], (0x1E, 2, LabelPart::Limit { number: 0, value: 0x48, valid: true }));
        assert_eq!(parts[7], (0x20, 2, LabelPart::Limit { number: 1, value: 0x73, valid: true }));
        assert_eq!(parts[8], (0x22, 2, LabelPart::Limit { number: 2, value: 0, valid: false }));
        assert_eq!(parts.len(), 6 + 15, "one set: 28 + 2 + 30 bytes");
        assert_eq!(ExtendedLabel::parse_parts(&[0; 27]), Err(LabelError::Short { got: 27 }));
    }
}
