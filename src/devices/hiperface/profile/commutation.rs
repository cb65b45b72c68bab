//! Commutation offset in a data field, in the format of this program. The manual does not define a format. The sixteen
//! bytes fill a block of the EEPROM, and a backup recognises them as a mounting value. See SICK 8010701, commutation,
//! and section 5 of the project's sine/cosine reference.

use super::HiperfaceProfile;
use crate::analysis::commutation::ElectricalAngle;

/// Commutation data of a motor as stored in the encoder.
///
/// | bytes | content |
/// |---|---|
/// | 0…2 | `CO1` |
/// | 3 | flags; bit 0: confirmed by a second vector |
/// | 4…7 | offset in units of 2⁻³² electrical turns, big-endian |
/// | 8 | pole pairs |
/// | 9 | direction: 0 with the electrical angle, 1 against it |
/// | 10…13 | 0 |
/// | 14…15 | CRC of bytes 0…13: polynomial 1021h, initial value FFFFh, big-endian |
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct CommutationRecord {
    /// Electrical offset: electrical angle = pole pairs × shaft angle − offset.
    pub offset: ElectricalAngle,
    /// Number of pole pairs of the motor.
    pub pole_pairs: u8,
    /// Whether the position decreases as the electrical angle increases.
    pub reversed: bool,
    /// Whether a second vector has confirmed the pole pairs and the phase order.
    pub confirmed: bool,
}

/// Error for bytes that begin like a commutation record but are not a valid one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct CommutationRecordError;

impl CommutationRecord {
    /// Length of a record in bytes.
    pub const BYTES: usize = HiperfaceProfile::COMMUTATION_BYTES;

    /// Returns the record as bytes.
    pub fn emit(&self) -> [u8; Self::BYTES] {
        let [o3, o2, o1, o0] = self.offset.bits().to_be_bytes();
        let flags = u8::from(self.confirmed);
        let body = [b'C', b'O', b'1', flags, o3, o2, o1, o0, self.pole_pairs, u8::from(self.reversed), 0, 0, 0, 0];
        let mut bytes = [0; Self::BYTES];
        for (place, byte) in bytes.iter_mut().zip(body.into_iter().chain(crc(&body).to_be_bytes())) {
            *place = byte;
        }
        bytes
    }

    /// Parses the record at the start of `bytes`, or returns `None` if there is no record.
    pub fn parse(bytes: &[u8]) -> Option<Result<Self, CommutationRecordError>> {
        if !bytes.starts_with(HiperfaceProfile::COMMUTATION_MAGIC) {
            return None;
        }
        Some(Self::from_valid_bytes(bytes).ok_or(CommutationRecordError))
    }

    fn from_valid_bytes(bytes: &[u8]) -> Option<Self> {
        let (body, check) = bytes.get(..Self::BYTES)?.split_at(Self::BYTES - 2);
        let &[_, _, _, flags, o3, o2, o1, o0, pole_pairs, direction, ..] = body else { return None };
        let sound = check == crc(body).to_be_bytes() && direction <= 1 && pole_pairs > 0;
        let offset = ElectricalAngle::from_bits(u32::from_be_bytes([o3, o2, o1, o0]));
        sound.then_some(CommutationRecord { offset, pole_pairs, reversed: direction == 1, confirmed: flags & 1 == 1 })
    }
}

/// Returns the CRC-16 with polynomial 1021h and initial value FFFFh, calculated bit by bit.
fn crc(bytes: &[u8]) -> u16 {
    bytes.iter().fold(0xFFFF, |crc, byte| {
        let start = crc ^ u16::from(*byte) << 8;
        (0..8).fold(start, |crc: u16, _| if crc & 0x8000 == 0 { crc << 1 } else { crc << 1 ^ 0x1021 })
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Record with four pole pairs and the offset from section 5 of the project's sine/cosine reference. The CRC was
    /// calculated with Python's `binascii.crc_hqx(body, 0xFFFF)`.
    const RECORD: [u8; 16] =
        [0x43, 0x4F, 0x31, 0x01, 0x53, 0x05, 0x1E, 0xB8, 0x04, 0x00, 0x00, 0x00, 0x00, 0x00, 0xF2, 0x6A];

    fn record() -> CommutationRecord {
        let offset = ElectricalAngle::from_bits(0x5305_1EB8);
        CommutationRecord { offset, pole_pairs: 4, reversed: false, confirmed: true }
    }

    #[test]
    fn round_trips_as_sixteen_bytes() {
        assert_eq!(record().emit(), RECORD);
        assert_eq!(CommutationRecord::parse(&RECORD), Some(Ok(record())));
        let longer = [&RECORD[..], &[0xFF; 3]].concat();
        assert_eq!(CommutationRecord::parse(&longer), Some(Ok(record())));
        let reversed = CommutationRecord { reversed: true, confirmed: false, ..record() };
        assert_eq!(CommutationRecord::parse(&reversed.emit()), Some(Ok(reversed)));
    }

    #[test]
    fn detects_flipped_bits_and_truncation() {
        for bit in 0..RECORD.len() * 8 {
            let mut bytes = RECORD;
            bytes[bit / 8] ^= 1 << (bit % 8);
            let expected = if bit < 24 { None } else { Some(Err(CommutationRecordError)) };
            assert_eq!(CommutationRecord::parse(&bytes), expected, "bit {bit}");
        }
        for length in 0..RECORD.len() {
            let expected = if length < 3 { None } else { Some(Err(CommutationRecordError)) };
            assert_eq!(CommutationRecord::parse(&RECORD[..length]), expected, "{length} bytes");
        }
    }

    #[test]
    fn crc_matches_standard_check_value() {
        // This is the published check value of CRC-16/CCITT-FALSE for the digits 1 to 9.
        assert_eq!(crc(b"123456789"), 0x29B1);
    }
}
