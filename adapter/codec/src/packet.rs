//! Packets, which consist of a sequence number, an operation, a body and a checksum (`protocol/bridge.md`, section 1).

use alloc::vec::Vec;

use super::cobs::{self, CobsError};

/// Maximum length of a body in bytes.
pub const MAX_BODY: usize = 512;

/// A packet with a valid checksum.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Packet {
    /// Sequence number. The host chooses it, and the reply repeats it. Unsolicited packets have their own numbers.
    pub seq: u8,
    /// Operation code. Bit 7 is set in replies.
    pub op: u8,
    /// Body of at most [`MAX_BODY`] bytes.
    pub body: Vec<u8>,
}

/// The reason why bytes are not a valid packet.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum PacketError {
    /// The byte stuffing is invalid.
    #[error(transparent)]
    Cobs(#[from] CobsError),
    /// The packet has this length in bytes, which is less than four or greater than the maximum.
    #[error("{0} bytes is not a valid packet length")]
    Length(usize),
    /// The checksum does not match.
    #[error("CRC {got:04X} instead of {expected:04X}")]
    Crc {
        /// Checksum of the received bytes.
        expected: u16,
        /// Checksum in the packet.
        got: u16,
    },
}

impl Packet {
    /// Number of bytes in a packet in addition to its body.
    const OVERHEAD: usize = 4;
    /// Maximum length of a stuffed packet in bytes.
    pub(super) const MAX_STUFFED_LEN: usize = MAX_BODY + Self::OVERHEAD + (MAX_BODY + Self::OVERHEAD) / 254 + 1;

    /// Parses the bytes between two 00 bytes.
    ///
    /// # Errors
    /// Returns a [`PacketError`] if the bytes are not a valid packet.
    pub fn parse(stuffed: &[u8]) -> Result<Self, PacketError> {
        let mut bytes = cobs::decode(stuffed)?;
        let length = bytes.len();
        if !(Self::OVERHEAD..=MAX_BODY + Self::OVERHEAD).contains(&length) {
            return Err(PacketError::Length(length));
        }
        let Some((content, [low, high])) = bytes.split_last_chunk::<2>() else {
            return Err(PacketError::Length(length));
        };
        let (expected, got) = (crc16(content), u16::from_le_bytes([*low, *high]));
        if expected != got {
            return Err(PacketError::Crc { expected, got });
        }
        let [seq, op, ..] = content else { return Err(PacketError::Length(length)) };
        let (seq, op) = (*seq, *op);
        bytes.truncate(length - 2);
        bytes.drain(..2);
        Ok(Packet { seq, op, body: bytes })
    }

    /// Returns the packet with byte stuffing, followed by 00.
    pub fn emit(&self) -> Vec<u8> {
        let mut bytes = Vec::with_capacity(self.body.len() + Self::OVERHEAD);
        bytes.extend([self.seq, self.op]);
        bytes.extend(&self.body);
        bytes.extend(crc16(&bytes).to_le_bytes());
        let mut stuffed = cobs::encode(&bytes);
        stuffed.push(0);
        stuffed
    }
}

/// Calculates the CRC-16/IBM-3740 checksum: polynomial x¹⁶ + x¹² + x⁵ + 1, initial value FFFFh, most significant bit
/// first.
pub fn crc16(bytes: &[u8]) -> u16 {
    bytes.iter().fold(0xFFFF, |crc: u16, byte| {
        let [high, _] = crc.to_be_bytes();
        crc << 8 ^ TABLE.get(usize::from(high ^ byte)).copied().unwrap_or(0)
    })
}

/// CRC remainder for each possible value of the register's upper eight bits.
const TABLE: [u16; 256] = crc_table();

#[expect(clippy::indexing_slicing, reason = "iterators cannot run while compiling; the index is that of the loop")]
const fn crc_table() -> [u16; 256] {
    let mut table = [0; 256];
    let mut index = 0;
    while index < 256 {
        let mut register = (index as u16) << 8;
        let mut bit = 0;
        while bit < 8 {
            register = if register & 0x8000 == 0 { register << 1 } else { register << 1 ^ 0x1021 };
            bit += 1;
        }
        table[index] = register;
        index += 1;
    }
    table
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use std::vec;

    /// The CRC matches the check value in the catalogue of parametrised CRC algorithms.
    #[test]
    fn published_check_value_matches() {
        assert_eq!(crc16(b"123456789"), 0x29B1);
        assert_eq!(crc16(b""), 0xFFFF);
    }

    #[test]
    fn rejects_invalid_packets() {
        assert_eq!(Packet::parse(&[]), Err(PacketError::Length(0)));
        assert_eq!(Packet::parse(&cobs::encode(&[0xFF, 0xFF])), Err(PacketError::Length(2)));
        let long = Packet { seq: 0, op: 1, body: vec![7; MAX_BODY + 1] }.emit();
        assert_eq!(Packet::parse(&long[..long.len() - 1]), Err(PacketError::Length(517)));
        assert_eq!(Packet::parse(&[9, 1]), Err(PacketError::Cobs(CobsError::Short(7))));
    }

    proptest! {
        #[test]
        fn emitted_packets_parse_back(seq: u8, op: u8, body in proptest::collection::vec(any::<u8>(), 0..=MAX_BODY)) {
            let packet = Packet { seq, op, body };
            let bytes = packet.emit();
            prop_assert!(bytes.len() <= Packet::MAX_STUFFED_LEN + 1);
            prop_assert_eq!(Packet::parse(&bytes[..bytes.len() - 1]), Ok(packet));
        }

        #[test]
        fn arbitrary_bytes_never_panic(bytes: Vec<u8>) {
            let _ = Packet::parse(&bytes);
        }
    }
}
