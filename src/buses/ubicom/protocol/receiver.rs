//! Frame reassembly from a byte stream. The byte 80h may also occur within a payload, so it starts a frame only between
//! frames: after a complete frame, a damaged frame or silence. The caller measures the silence with
//! [`BYTE_TIME_OUT`](super::BYTE_TIME_OUT). See reference 2.

use super::frame::{Frame, MAX_PAYLOAD, SYNC};

/// A buffer of received bytes that do not yet form a complete frame.
#[derive(Clone, Debug)]
pub struct Receiver {
    node: u8,
    bytes: Vec<u8>,
    skipped: u64,
}

/// What the first bytes in the buffer are.
enum FrameHead {
    /// More bytes are required.
    Partial,
    /// A complete frame of the given length.
    Frame(usize),
    /// The bytes do not start a frame.
    Other,
}

impl Receiver {
    /// Creates a receiver for frames of the encoder with the given address.
    pub const fn new(node: u8) -> Self {
        Receiver { node, bytes: Vec::new(), skipped: 0 }
    }

    /// Appends received bytes to the buffer.
    pub fn push(&mut self, bytes: &[u8]) {
        self.bytes.extend(bytes);
    }

    /// Returns the next complete frame, skipping any preceding bytes that do not belong to a frame.
    pub fn next_frame(&mut self) -> Option<Vec<u8>> {
        loop {
            match self.classify_head() {
                FrameHead::Partial => return None,
                FrameHead::Frame(length) => return Some(self.bytes.drain(..length).collect()),
                FrameHead::Other => self.skip_byte(),
            }
        }
    }

    /// Handles silence on the line, after which an incomplete frame will not be completed. Returns a frame if the
    /// remaining bytes contain one.
    pub fn handle_silence(&mut self) -> Option<Vec<u8>> {
        loop {
            if let Some(frame) = self.next_frame() {
                return Some(frame);
            }
            if self.bytes.is_empty() {
                return None;
            }
            self.skip_byte();
        }
    }

    /// Returns whether a frame has started and is incomplete.
    pub fn is_waiting(&self) -> bool {
        !self.bytes.is_empty()
    }

    /// Returns the total number of received bytes that did not belong to a frame.
    pub const fn skipped_count(&self) -> u64 {
        self.skipped
    }

    fn classify_head(&self) -> FrameHead {
        match self.bytes.as_slice() {
            [] | [SYNC] => FrameHead::Partial,
            [SYNC, node, ..] if *node != self.node => FrameHead::Other,
            [SYNC, _, _, low, high, ..] => {
                let payload = usize::from(u16::from_le_bytes([*low, *high]));
                match self.bytes.get(..payload + Frame::OVERHEAD) {
                    _ if payload > MAX_PAYLOAD => FrameHead::Other,
                    None => FrameHead::Partial,
                    Some(frame) if Frame::parse(frame).is_ok() => FrameHead::Frame(frame.len()),
                    Some(_) => FrameHead::Other,
                }
            }
            [SYNC, ..] => FrameHead::Partial,
            _ => FrameHead::Other,
        }
    }

    fn skip_byte(&mut self) {
        // Skips at least one byte, up to a possible start of a frame.
        let rest = self.bytes.get(1..).unwrap_or_default();
        let count = 1 + rest.iter().position(|byte| *byte == SYNC).unwrap_or(rest.len());
        self.bytes.drain(..count);
        self.skipped += count as u64;
    }
}

#[cfg(test)]
mod tests {
    use super::super::NODE;
    use super::*;
    use crate::bits::{hex, parse_hex};
    use proptest::prelude::*;

    const READ: &str = "80 01 01 02 00 26 00 55";
    const VALUE: &str = "80 01 01 01 00 4B 31";
    /// A frame whose payload contains the start sequence 80 01.
    const TRICKY: &str = "80 01 03 05 00 80 01 01 01 00 F3";

    fn frames(receiver: &mut Receiver, text: &str) -> Vec<String> {
        receiver.push(&parse_hex(text).unwrap());
        std::iter::from_fn(|| receiver.next_frame()).map(|frame| hex(&frame)).collect()
    }

    #[test]
    fn finds_frames_in_any_chunks() {
        let text = [READ, VALUE, TRICKY].join(" ");
        let bytes = parse_hex(&text).unwrap();
        for size in 1..=bytes.len() {
            let mut receiver = Receiver::new(NODE);
            let mut found = Vec::new();
            for portion in bytes.chunks(size) {
                found.extend(frames(&mut receiver, &hex(portion)));
            }
            assert_eq!(found, [READ, VALUE, TRICKY], "portions of {size}");
            assert!(!receiver.is_waiting() && receiver.skipped_count() == 0);
        }
    }

    #[test]
    fn finds_frame_after_damage() {
        let mut receiver = Receiver::new(NODE);
        assert_eq!(frames(&mut receiver, &format!("55 80 80 {VALUE}")), [VALUE], "noise before");
        assert_eq!(receiver.skipped_count(), 3);
        let damaged = VALUE.replace("4B", "4A");
        assert_eq!(frames(&mut receiver, &format!("{damaged} {READ}")), [READ], "a wrong checksum");
        assert_eq!(frames(&mut receiver, &format!("80 01 01 FF FF {READ}")), [READ], "an impossible length");
        assert_eq!(frames(&mut receiver, "80 02 01 01 00 4B 30"), [""; 0], "another node's");
        assert_eq!(frames(&mut receiver, READ), [READ]);
    }

    /// Silence ends a partial frame that would otherwise never be complete, such as LEN 3 with two bytes (reference 6).
    #[test]
    fn silence_ends_partial_frame() {
        let mut receiver = Receiver::new(NODE);
        assert_eq!(frames(&mut receiver, "80 01 01 03 00 26 00 54"), [""; 0]);
        assert!(receiver.is_waiting());
        assert_eq!(receiver.handle_silence(), None);
        assert!(!receiver.is_waiting());
        // Until then, a false start hides a complete frame.
        assert_eq!(frames(&mut receiver, &format!("80 01 01 3F 00 {VALUE} {READ}")), [""; 0]);
        assert_eq!(receiver.handle_silence().map(|frame| hex(&frame)).as_deref(), Some(VALUE));
        assert_eq!(receiver.handle_silence().map(|frame| hex(&frame)).as_deref(), Some(READ));
        assert_eq!(receiver.handle_silence(), None);
    }

    #[test]
    fn drops_partial_frame_after_timeout() {
        let bytes = parse_hex(TRICKY).unwrap();
        for cut in 1..bytes.len() {
            let mut receiver = Receiver::new(NODE);
            receiver.push(&bytes[..cut]);
            assert_eq!(receiver.next_frame(), None, "cut at {cut}");
            assert_eq!(receiver.handle_silence(), None, "cut at {cut}");
            assert_eq!(frames(&mut receiver, VALUE), [VALUE]);
        }
    }

    proptest! {
        #[test]
        fn finds_frame_after_noise(noise in proptest::collection::vec(any::<u8>(), 0..40)) {
            let mut receiver = Receiver::new(NODE);
            receiver.push(&noise);
            let mut found: Vec<Vec<u8>> = std::iter::from_fn(|| receiver.next_frame()).collect();
            found.extend(std::iter::from_fn(|| receiver.handle_silence()));
            receiver.push(&parse_hex(VALUE).unwrap());
            found.extend(std::iter::from_fn(|| receiver.next_frame()));
            prop_assert_eq!(found.last().map(|frame| hex(frame)), Some(VALUE.to_owned()));
            let bytes: usize = found.iter().map(Vec::len).sum();
            prop_assert_eq!(bytes as u64 + receiver.skipped_count(), noise.len() as u64 + 7);
        }
    }
}
