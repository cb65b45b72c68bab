//! Buffer for bytes to the host. Samples are added and requests are accepted only while there is enough room, so a host
//! that does not read cannot exhaust the memory.

use alloc::collections::VecDeque;

/// Bytes for the host, in sending order.
#[derive(Clone, Debug)]
pub struct Outbox {
    bytes: VecDeque<u8>,
    /// Time in microseconds since which the host has fetched nothing.
    progress_us: u64,
}

/// Number of waiting bytes above which no samples are added.
const SAMPLE_LIMIT_BYTES: usize = 24 * 1024;
/// Additional space in bytes for the replies to all requests in a USB packet.
const REPLIES: usize = 8 * 1024;
/// Time in microseconds after which a host that fetches nothing is considered lost.
const HOST_TIMEOUT_US: u64 = 2_000_000;

impl Default for Outbox {
    /// Allocates all memory at once, because a small heap has no room for reallocation.
    fn default() -> Self {
        Outbox { bytes: VecDeque::with_capacity(SAMPLE_LIMIT_BYTES + REPLIES), progress_us: 0 }
    }
}

impl Outbox {
    /// Returns unsent bytes, starting with the next one. More bytes may follow after these are consumed.
    pub fn pending(&self) -> &[u8] {
        self.bytes.as_slices().0
    }

    /// Removes the first `count` pending bytes after they have been sent. `now_us` is the current time in microseconds.
    pub fn consume(&mut self, count: usize, now_us: u64) {
        if count > 0 {
            self.progress_us = now_us;
            self.bytes.drain(..count.min(self.bytes.len()));
        }
    }

    pub(crate) fn push(&mut self, bytes: &[u8], now_us: u64) {
        if self.bytes.is_empty() {
            self.progress_us = now_us;
        }
        self.bytes.extend(bytes);
    }

    pub(crate) fn clear(&mut self) {
        self.bytes.clear();
    }

    pub(crate) fn has_room(&self) -> bool {
        self.bytes.len() < SAMPLE_LIMIT_BYTES
    }

    /// Returns whether the host has fetched nothing for too long.
    pub(crate) fn is_stuck(&self, now_us: u64) -> bool {
        !self.bytes.is_empty() && now_us.saturating_sub(self.progress_us) > HOST_TIMEOUT_US
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sends_bytes_in_order() {
        let mut outbox = Outbox::default();
        outbox.push(&[1, 2, 3], 0);
        outbox.consume(2, 5);
        outbox.push(&[4], 6);
        assert_eq!(outbox.pending(), [3, 4]);
        outbox.push(&[9; SAMPLE_LIMIT_BYTES], 7);
        assert!(!outbox.has_room());
        outbox.consume(2, 8);
        outbox.consume(SAMPLE_LIMIT_BYTES, 9);
        assert!(outbox.pending().is_empty() && outbox.has_room());
        // The bytes wrap around to the beginning of the memory.
        for round in 0..10 {
            outbox.push(&[round; SAMPLE_LIMIT_BYTES / 4 * 3], 10);
            let mut count = 0;
            while !outbox.pending().is_empty() {
                assert!(outbox.pending().iter().all(|byte| *byte == round));
                let length = outbox.pending().len().min(1000);
                outbox.consume(length, 11);
                count += length;
            }
            assert_eq!(count, SAMPLE_LIMIT_BYTES / 4 * 3);
        }
        assert!(outbox.bytes.capacity() < SAMPLE_LIMIT_BYTES + REPLIES + 64, "the memory is not moved");
    }

    #[test]
    fn host_is_stuck_after_two_seconds() {
        let mut outbox = Outbox::default();
        assert!(!outbox.is_stuck(u64::MAX));
        outbox.push(&[1, 2, 3], 1_000_000);
        assert!(!outbox.is_stuck(3_000_000));
        assert!(outbox.is_stuck(3_000_001));
        outbox.consume(1, 3_000_001);
        assert!(!outbox.is_stuck(5_000_001));
        outbox.push(&[4], 5_000_000);
        assert!(outbox.is_stuck(5_000_002), "more bytes are no progress");
    }
}
