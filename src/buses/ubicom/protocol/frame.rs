//! The frames of UBICOM (manual 5.1).

/// First byte of every frame.
pub const SYNC: u8 = 0x80;
/// Address of the encoder.
pub const NODE: u8 = 0x01;
/// Maximum accepted payload length in bytes. The limit is an assumption (`U`), because no message in the manual exceeds
/// five bytes.
pub const MAX_PAYLOAD: usize = 64;

/// A frame with a valid checksum. The meaning of the payload depends on the command.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Frame<'a> {
    /// Address of the encoder that sends or receives the frame.
    pub address: u8,
    /// Command byte, which the reply repeats.
    pub command: u8,
    /// Payload of at most [`MAX_PAYLOAD`] bytes.
    pub payload: &'a [u8],
}

/// The reason why bytes are not a frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum FrameError {
    /// The first byte is not 80h.
    #[error("the first byte of the frame is {0:02X} instead of 80")]
    Sync(u8),
    /// The length differs from the length in the header.
    #[error("{got} bytes instead of {expected} for the frame")]
    Length {
        /// Length of the complete frame in bytes, or of the shortest frame if the header is incomplete.
        expected: usize,
        /// Received length in bytes.
        got: usize,
    },
    /// The last byte is not the inverted sum of all preceding bytes.
    #[error("checksum {got:02X} instead of {expected:02X}")]
    Checksum {
        /// Checksum calculated over the received bytes.
        expected: u8,
        /// Received checksum.
        got: u8,
    },
}

impl<'a> Frame<'a> {
    /// Number of bytes in addition to the payload. Five precede the payload and one follows.
    pub const OVERHEAD: usize = 6;

    /// Parses a frame that occupies the whole slice. The length is taken from the header, although some examples in the
    /// manual differ.
    ///
    /// # Errors
    /// Returns a [`FrameError`] if the bytes are not a valid frame.
    pub fn parse(bytes: &'a [u8]) -> Result<Self, FrameError> {
        if let Some(first) = bytes.first().filter(|first| **first != SYNC) {
            return Err(FrameError::Sync(*first));
        }
        let [_, address, command, low, high, payload @ .., got] = bytes else {
            return Err(FrameError::Length { expected: Self::OVERHEAD, got: bytes.len() });
        };
        let length = usize::from(u16::from_le_bytes([*low, *high]));
        if payload.len() != length {
            return Err(FrameError::Length { expected: length + Self::OVERHEAD, got: bytes.len() });
        }
        let expected = checksum(bytes.split_last().map_or(&[], |(_, before)| before));
        if *got != expected {
            return Err(FrameError::Checksum { expected, got: *got });
        }
        Ok(Frame { address: *address, command: *command, payload })
    }

    /// Returns the encoded frame, including the checksum.
    pub fn emit(&self) -> Vec<u8> {
        // A payload has at most 64 bytes.
        let length = u16::try_from(self.payload.len()).unwrap_or(u16::MAX);
        let mut bytes = Vec::with_capacity(self.payload.len() + Self::OVERHEAD);
        bytes.extend([SYNC, self.address, self.command]);
        bytes.extend(length.to_le_bytes());
        bytes.extend(self.payload);
        bytes.push(checksum(&bytes));
        bytes
    }
}

fn checksum(bytes: &[u8]) -> u8 {
    !bytes.iter().fold(0, |sum: u8, byte| sum.wrapping_add(*byte))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bits::parse_hex;
    use proptest::prelude::*;

    /// All frames of reference 6, with their checksums.
    const FRAMES: [&str; 17] = [
        "80 01 01 02 00 00 00 7B",
        "80 01 01 02 00 26 00 55",
        "80 01 01 01 00 4B 31",
        "80 01 01 02 00 C5 00 B6",
        "80 01 01 01 00 1C 60",
        "80 01 01 02 00 05 01 75",
        "80 01 01 02 00 34 00 47",
        "80 01 02 03 00 2B 00 2A 24",
        "80 01 02 01 00 90 EB",
        "80 01 02 01 00 A0 DB",
        "80 01 02 03 00 2A 00 07 48",
        "80 01 02 03 00 83 00 80 76",
        "80 01 03 01 00 01 79",
        "80 01 03 05 00 00 80 69 24 00 69",
        "80 01 03 05 00 00 00 00 00 00 76",
        "80 01 03 05 00 FF FF FF FF 01 79",
        "80 01 03 05 00 00 00 02 00 00 74",
    ];

    #[test]
    fn published_frames_match() {
        for text in FRAMES {
            let bytes = parse_hex(text).unwrap();
            let frame = Frame::parse(&bytes).unwrap();
            assert_eq!(frame.emit(), bytes, "{text}");
            // The sum of all bytes is FFh (reference 2).
            assert_eq!(bytes.iter().fold(0u8, |sum, byte| sum.wrapping_add(*byte)), 0xFF, "{text}");
        }
    }

    #[test]
    fn rejects_truncated_and_damaged_frames() {
        for text in FRAMES {
            let bytes = parse_hex(text).unwrap();
            for cut in 0..bytes.len() {
                assert!(matches!(Frame::parse(&bytes[..cut]), Err(FrameError::Length { .. })), "{text} cut at {cut}");
            }
            for bit in 0..bytes.len() * 8 {
                let mut damaged = bytes.clone();
                damaged[bit / 8] ^= 1 << (bit % 8);
                assert!(Frame::parse(&damaged).is_err(), "{text} bit {bit}");
            }
            for (at, value) in (0..bytes.len()).flat_map(|at| (0..=255).map(move |value| (at, value))) {
                let mut damaged = bytes.clone();
                damaged[at] = value;
                assert!(damaged == bytes || Frame::parse(&damaged).is_err(), "{text} byte {at} = {value:02X}");
            }
        }
    }

    /// The length in the header is checked. The example printed in the manual (reference 5) is rejected, because it is
    /// one byte too short.
    #[test]
    fn checks_header_length() {
        let printed = [0x80, 0x01, 0x01, 0x02, 0x00, 0x00, 0x7B];
        assert_eq!(Frame::parse(&printed), Err(FrameError::Length { expected: 8, got: 7 }));
        let longer = [0x80, 0x01, 0x01, 0x03, 0x00, 0x00, 0x00, 0x7A];
        assert_eq!(Frame::parse(&longer), Err(FrameError::Length { expected: 9, got: 8 }));
        assert_eq!(Frame::parse(&[0x81, 0x01]), Err(FrameError::Sync(0x81)));
        let wrong = [0x80, 0x01, 0x01, 0x02, 0x00, 0x00, 0x00, 0x7A];
        assert_eq!(Frame::parse(&wrong), Err(FrameError::Checksum { expected: 0x7B, got: 0x7A }));
    }

    proptest! {
        #[test]
        fn emitted_frames_parse_back(address: u8, command: u8, payload in proptest::collection::vec(any::<u8>(), 0..=64)) {
            let frame = Frame { address, command, payload: &payload };
            let bytes = frame.emit();
            prop_assert_eq!(Frame::parse(&bytes), Ok(frame));
        }
    }
}
