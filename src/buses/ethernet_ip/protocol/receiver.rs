//! Reassembly of frames from the chunks of a TCP byte stream.

use super::encapsulation::Frame;
use super::fields::PacketError;

/// A buffer of received bytes that do not yet form a complete frame.
#[derive(Clone, Debug, Default)]
pub struct Receiver {
    bytes: Vec<u8>,
    broken: Option<PacketError>,
    /// Bytes from the first invalid header onwards, kept until the caller takes them.
    rest: Vec<u8>,
}

impl Receiver {
    /// Appends received bytes to the buffer.
    pub fn push(&mut self, bytes: &[u8]) {
        if self.broken.is_none() {
            self.bytes.extend(bytes);
        }
    }

    /// Returns the next complete frame, or `None` if more bytes are needed.
    ///
    /// # Errors
    /// Returns a [`PacketError`] for an invalid frame. All later calls return the same error, because the start of the
    /// next frame is unknown. The connection must be closed.
    pub fn next_frame(&mut self) -> Result<Option<Frame>, PacketError> {
        if let Some(why) = self.broken {
            return Err(why);
        }
        self.take_frame().inspect_err(|why| {
            self.broken = Some(*why);
            self.rest = std::mem::take(&mut self.bytes);
        })
    }

    /// Takes the bytes that do not form a complete frame.
    pub fn take_unparsed_bytes(&mut self) -> Vec<u8> {
        std::mem::take(if self.rest.is_empty() { &mut self.bytes } else { &mut self.rest })
    }

    /// Returns the number of bytes that do not yet form a complete frame. If any remain when the connection ends, the
    /// last frame was truncated.
    pub const fn pending_len(&self) -> usize {
        self.bytes.len()
    }

    fn take_frame(&mut self) -> Result<Option<Frame>, PacketError> {
        let Some(whole) = Frame::total_length(&self.bytes)?.and_then(|length| self.bytes.get(..length)) else {
            return Ok(None);
        };
        let (frame, length) = (Frame::parse(whole)?, whole.len());
        self.bytes.drain(..length);
        Ok(Some(frame))
    }
}

#[cfg(test)]
mod tests {
    use super::super::{Command, EncapsulationStatus, PacketField, Structure};
    use super::*;
    use proptest::prelude::*;

    fn frame(context: u8, length: usize) -> Frame {
        Frame {
            command: Command::SEND_RR_DATA,
            session: 0x1234_5678,
            status: EncapsulationStatus::OK,
            context: [context; 8],
            options: 0,
            data: vec![context; length],
        }
    }

    #[test]
    fn finds_frames_in_any_chunks() {
        let sent = [frame(1, 0), frame(2, 16), frame(3, 600), frame(4, 1), frame(5, Frame::MAX_DATA)];
        let bytes: Vec<u8> = sent.iter().flat_map(Frame::emit).collect();
        for size in [1, 7, 23, 24, 25, 1460, bytes.len()] {
            let mut receiver = Receiver::default();
            let mut found = Vec::new();
            for portion in bytes.chunks(size) {
                receiver.push(portion);
                found.extend(std::iter::from_fn(|| receiver.next_frame().unwrap()));
            }
            assert_eq!(found, sent, "portions of {size}");
            assert_eq!(receiver.pending_len(), 0);
        }
    }

    #[test]
    fn wrong_length_breaks_connection_permanently() {
        let mut receiver = Receiver::default();
        let mut bytes = frame(1, 4).emit();
        // 65512 exceeds the maximum data length by one.
        bytes.splice(2..4, [0xE8, 0xFF]);
        receiver.push(&bytes);
        let broken = PacketError::Value { what: Structure::Encapsulation, field: PacketField::Length, got: 65512 };
        assert_eq!(receiver.next_frame(), Err(broken));
        receiver.push(&frame(2, 0).emit());
        assert_eq!((receiver.next_frame(), receiver.pending_len()), (Err(broken), 0));
    }

    proptest! {
        #[test]
        fn arbitrary_bytes_never_panic(portions: Vec<Vec<u8>>) {
            let mut receiver = Receiver::default();
            for portion in portions {
                receiver.push(&portion);
                while let Ok(Some(_)) = receiver.next_frame() {}
            }
        }
    }
}
