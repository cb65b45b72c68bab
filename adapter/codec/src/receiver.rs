//! Assembles packets from received bytes. Damaged packets are dropped and counted (`protocol/bridge.md`, section 1).

use alloc::vec::Vec;

use super::packet::{Packet, PacketError};

/// Buffer for received bytes that do not form a complete packet yet.
#[derive(Clone, Debug, Default)]
pub struct Receiver {
    bytes: Vec<u8>,
    /// Index at which to continue searching for the next 00.
    search_index: usize,
    /// Whether the current packet is too long. If so, its bytes are dropped until the next 00.
    overlong: bool,
    dropped: u64,
    /// Most recent damaged packet, or `None` if it has already been taken.
    damaged_packet: Option<Vec<u8>>,
}

impl Receiver {
    /// Appends received bytes.
    pub fn push(&mut self, bytes: &[u8]) {
        self.bytes.extend(bytes);
    }

    /// Returns the next valid packet, or `None` if more bytes are needed.
    pub fn next_packet(&mut self) -> Option<Packet> {
        loop {
            let behind = self.bytes.get(self.search_index..).unwrap_or_default();
            let Some(end) = behind.iter().position(|byte| *byte == 0) else {
                self.search_index = self.bytes.len();
                self.overlong |= self.bytes.len() > Packet::MAX_STUFFED_LEN;
                if self.overlong {
                    (self.bytes, self.search_index) = (Vec::new(), 0);
                }
                return None;
            };
            let end = self.search_index + end;
            let parsed = match self.bytes.get(..end) {
                Some([]) if !self.overlong => None,
                Some(stuffed) if !self.overlong && end <= Packet::MAX_STUFFED_LEN => Some(Packet::parse(stuffed)),
                _ => Some(Err(PacketError::Length(end))),
            };
            let packet: Vec<u8> = self.bytes.drain(..=end).collect();
            (self.search_index, self.overlong) = (0, false);
            match parsed {
                Some(Ok(packet)) => return Some(packet),
                Some(Err(_)) => {
                    self.dropped += 1;
                    self.damaged_packet = Some(packet);
                }
                // Two adjacent 00 bytes enclose no packet.
                None => {}
            }
        }
    }

    /// Takes the bytes of the most recent damaged packet, or returns `None` if there are none.
    pub const fn take_damaged_bytes(&mut self) -> Option<Vec<u8>> {
        self.damaged_packet.take()
    }

    /// Returns the number of damaged packets so far.
    pub const fn dropped_count(&self) -> u64 {
        self.dropped
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use std::vec;

    fn packets(receiver: &mut Receiver, bytes: &[u8]) -> Vec<Packet> {
        receiver.push(bytes);
        std::iter::from_fn(|| receiver.next_packet()).collect()
    }

    fn packet(seq: u8, length: usize) -> Packet {
        Packet { seq, op: 0x93, body: vec![seq; length] }
    }

    #[test]
    fn finds_packets_in_any_chunks() {
        let sent = [packet(0, 0), packet(1, 20), packet(0, 300), packet(2, 512)];
        let mut bytes = vec![0, 0];
        sent.iter().for_each(|packet| bytes.extend(packet.emit()));
        for size in [1, 2, 3, 7, 64, 519, bytes.len()] {
            let mut receiver = Receiver::default();
            let found: Vec<Packet> = bytes.chunks(size).flat_map(|part| packets(&mut receiver, part)).collect();
            assert_eq!(found, sent, "portions of {size}");
            assert_eq!(receiver.dropped_count(), 0);
        }
    }

    #[test]
    fn drops_and_counts_damaged_packets() {
        let mut receiver = Receiver::default();
        let good = packet(1, 20).emit();
        let mut damaged = good.clone();
        damaged[5] ^= 2;
        assert_eq!(packets(&mut receiver, &[damaged, good.clone()].concat()), [packet(1, 20)]);
        assert_eq!(receiver.dropped_count(), 1);
        // The end of one packet and the beginning of the next are lost.
        let cut = [&good[..10], &good[4..], &good].concat();
        assert_eq!(packets(&mut receiver, &cut), [packet(1, 20)]);
        assert_eq!(receiver.dropped_count(), 2);
    }

    #[test]
    fn does_not_buffer_endless_noise() {
        let mut receiver = Receiver::default();
        for _ in 0..100 {
            assert_eq!(packets(&mut receiver, &[0x55; 100]), []);
            assert!(receiver.bytes.len() <= Packet::MAX_STUFFED_LEN + 100);
        }
        let good = packet(1, 20).emit();
        assert_eq!(packets(&mut receiver, &good), [], "the first 00 ends the noise");
        assert_eq!(receiver.dropped_count(), 1);
        assert_eq!(packets(&mut receiver, &good), [packet(1, 20)]);
    }

    proptest! {
        #[test]
        fn finds_packets_after_noise_and_zero(noise: Vec<u8>) {
            let mut receiver = Receiver::default();
            let bytes = [noise, vec![0], packet(3, 9).emit()].concat();
            let found = packets(&mut receiver, &bytes);
            prop_assert_eq!(found.last(), Some(&packet(3, 9)));
        }
    }
}
