//! Frames, which consist of address, command byte, payload and XOR checksum (manual, "Das Übertragungsprotokoll").

/// Returns the XOR of all bytes, which is zero for a complete and valid frame.
pub fn checksum(bytes: &[u8]) -> u8 {
    bytes.iter().fold(0, |sum, byte| sum ^ byte)
}

/// A frame with a valid checksum. The command determines the meaning of the payload.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Frame<'a> {
    /// Address byte as received: 40h to 5Fh, or FFh in a broadcast.
    pub address: u8,
    /// Command byte as received, including the error bit.
    pub command: u8,
    /// Bytes between the command byte and the checksum.
    pub payload: &'a [u8],
}

/// Reason why bytes are not a frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum FrameError {
    /// The frame has fewer than the minimum of three bytes.
    #[error("too few bytes for a frame ({got})")]
    Short {
        /// Received length in bytes.
        got: usize,
    },
    /// The last byte is not the XOR of all other bytes.
    #[error("checksum {got:02X} instead of {expected:02X}")]
    Checksum {
        /// Checksum calculated over the received bytes.
        expected: u8,
        /// Received checksum.
        got: u8,
    },
}

impl<'a> Frame<'a> {
    /// Error bit in a reply's command byte.
    pub const ERROR_BIT: u8 = 0x80;

    /// Parses a slice that contains exactly one frame. On the line, silence marks the end of a frame.
    ///
    /// # Errors
    /// Returns [`FrameError::Short`] for fewer than three bytes, or [`FrameError::Checksum`] if the checksum does not
    /// match.
    pub fn parse(bytes: &'a [u8]) -> Result<Self, FrameError> {
        let [address, command, payload @ .., got] = bytes else {
            return Err(FrameError::Short { got: bytes.len() });
        };
        let expected = checksum(bytes) ^ got;
        if expected != *got {
            return Err(FrameError::Checksum { expected, got: *got });
        }
        Ok(Frame { address: *address, command: *command, payload })
    }

    /// Returns the frame as bytes, including the checksum.
    pub fn emit(&self) -> Vec<u8> {
        let mut bytes = Vec::with_capacity(self.payload.len() + 3);
        bytes.extend([self.address, self.command]);
        bytes.extend(self.payload);
        bytes.push(checksum(&bytes));
        bytes
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// Frames from the manual's "Beispiel zur Datenfelddefinition", each with a flag that is set if its printed
    /// checksum is correct.
    const MANUAL_EXAMPLE: [(&[u8], bool); 11] = [
        (&[0x40, 0x4E, 0x0E], true),
        (&[0x40, 0x4E, 0x08, 0x00, 0x06], true),
        (&[0x40, 0x4D, 0x00, 0xC9, 0x55, 0x91], true),
        (&[0x40, 0x4D, 0x00, 0xC9, 0xC4], true),
        (&[0x40, 0x4D, 0x01, 0xE0, 0x55, 0x69], false), // misprint: should be B9
        (&[0x40, 0x4D, 0x01, 0xE0, 0x55, 0xB9], true),
        (&[0x40, 0x4D, 0x01, 0xE0, 0xEC], true),
        (&[0x40, 0x4F, 0x02, 0x55, 0x66, 0x3E], true),
        (&[0x40, 0x4F, 0x02, 0x0D], true),
        (&[0x40, 0x4B, 0x01, 0x05, 0x02, 0x66, 0x08, 0x15, 0x76], true),
        (&[0x40, 0x4B, 0x01, 0x05, 0x02, 0x0D], true),
    ];

    #[test]
    fn parses_manual_example() {
        for (bytes, right) in MANUAL_EXAMPLE {
            match Frame::parse(bytes) {
                Ok(frame) => assert!(right && frame.emit() == bytes, "{bytes:02X?}"),
                Err(error) => {
                    assert!(!right);
                    assert_eq!(error, FrameError::Checksum { expected: 0xB9, got: 0x69 });
                }
            }
        }
    }

    #[test]
    fn rejects_corrupt_frames() {
        let frame = [0x40, 0x42, 0x00, 0x0E, 0x05, 0x31, 0x38];
        for cut in 0..frame.len() {
            assert!(Frame::parse(&frame[..cut]).is_err(), "cut at {cut}");
        }
        for bit in 0..frame.len() * 8 {
            let mut damaged = frame;
            damaged[bit / 8] ^= 1 << (bit % 8);
            assert!(Frame::parse(&damaged).is_err(), "bit {bit}");
        }
    }

    proptest! {
        #[test]
        fn emitted_frames_round_trip(address: u8, command: u8, payload in proptest::collection::vec(any::<u8>(), 0..140)) {
            let frame = Frame { address, command, payload: &payload };
            let bytes = frame.emit();
            prop_assert_eq!(Frame::parse(&bytes), Ok(frame));
        }
    }
}
