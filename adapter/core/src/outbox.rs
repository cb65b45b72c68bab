//! Bytes that wait for the host. Samples are only added while there is room, and requests are only taken while their
//! replies have room, so that a host that does not read cannot exhaust the memory.

use alloc::vec::Vec;

/// Bytes for the host in the order in which they are sent.
#[derive(Clone, Debug, Default)]
pub struct Outbox {
    bytes: Vec<u8>,
    sent: usize,
    /// Time of the last progress in microseconds.
    progress_us: u64,
}

/// Number of bytes above which nothing is added.
const ROOM: usize = 2048;
/// Time in microseconds without progress after which the host counts as lost.
const LOST_US: u64 = 2_000_000;

impl Outbox {
    /// Returns the bytes that have not been sent yet.
    pub fn pending(&self) -> &[u8] {
        self.bytes.get(self.sent..).unwrap_or_default()
    }

    /// Removes the first `count` pending bytes, which were sent at a time in microseconds.
    pub fn consume(&mut self, count: usize, now_us: u64) {
        if count == 0 {
            return;
        }
        self.progress_us = now_us;
        self.sent = (self.sent + count).min(self.bytes.len());
        if self.sent == self.bytes.len() {
            self.clear();
        }
    }

    pub(crate) fn push(&mut self, bytes: &[u8], now_us: u64) {
        if self.pending().is_empty() {
            self.progress_us = now_us;
        }
        if self.sent >= ROOM {
            self.bytes.drain(..self.sent);
            self.sent = 0;
        }
        self.bytes.extend(bytes);
    }

    pub(crate) fn clear(&mut self) {
        self.bytes.clear();
        self.sent = 0;
    }

    pub(crate) fn has_room(&self) -> bool {
        self.pending().len() < ROOM
    }

    /// Returns whether the host has not fetched anything for too long.
    pub(crate) fn is_stuck(&self, now_us: u64) -> bool {
        !self.pending().is_empty() && now_us.saturating_sub(self.progress_us) > LOST_US
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bytes_leave_in_order_and_room_returns() {
        let mut outbox = Outbox::default();
        outbox.push(&[1, 2, 3], 0);
        outbox.consume(2, 5);
        outbox.push(&[4], 6);
        assert_eq!(outbox.pending(), [3, 4]);
        outbox.push(&[9; ROOM], 7);
        assert!(!outbox.has_room());
        outbox.consume(2, 8);
        outbox.consume(ROOM, 9);
        assert!(outbox.pending().is_empty() && outbox.has_room() && outbox.bytes.is_empty());
    }

    #[test]
    fn a_host_is_stuck_after_two_seconds_without_progress() {
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
