//! Filter for cyclic packets. It drops duplicates and packets that arrive after a newer one.

/// Tracks the packets received on one connection.
#[derive(Clone, Copy, Debug, Default)]
pub struct PacketTracker {
    newest: Option<u32>,
    lost: u64,
    stale: u64,
}

/// The classification of a received packet.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PacketVerdict {
    /// The packet is new.
    New {
        /// Number of preceding packets that have not arrived. They are stale if they arrive later.
        missing: u32,
    },
    /// This packet, or a newer one, has already been received.
    Stale,
}

impl PacketTracker {
    /// Classifies a packet by its sequence number. Numbers wrap around, so a packet is newer if it is ahead by less
    /// than half their range.
    pub fn classify(&mut self, sequence: u32) -> PacketVerdict {
        let ahead = match self.newest {
            None => 1,
            Some(newest) => sequence.wrapping_sub(newest),
        };
        if ahead == 0 || ahead > u32::MAX / 2 {
            self.stale += 1;
            return PacketVerdict::Stale;
        }
        self.newest = Some(sequence);
        let missing = ahead - 1;
        self.lost += u64::from(missing);
        PacketVerdict::New { missing }
    }

    /// Returns the number of packets that did not arrive or arrived too late.
    pub const fn lost_count(&self) -> u64 {
        self.lost
    }

    /// Returns the number of stale packets.
    pub const fn stale_count(&self) -> u64 {
        self.stale
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn classifies_packets_in_any_order() {
        const NEXT: PacketVerdict = PacketVerdict::New { missing: 0 };
        let mut arrivals = PacketTracker::default();
        for (sequence, expected) in [
            (u32::MAX - 1, NEXT),
            (u32::MAX, NEXT),
            (u32::MAX, PacketVerdict::Stale),
            (0, NEXT),
            (u32::MAX, PacketVerdict::Stale),
            (4, PacketVerdict::New { missing: 3 }),
            (2, PacketVerdict::Stale),
            (5, NEXT),
        ] {
            assert_eq!(arrivals.classify(sequence), expected, "{sequence}");
        }
        assert_eq!((arrivals.lost_count(), arrivals.stale_count()), (3, 3));
    }

    proptest! {
        /// Accepted sequence numbers never go back, in whatever order the packets arrive.
        #[test]
        fn accepted_sequence_numbers_increase(start: u32, order in proptest::collection::vec(0u32..1000, 1..200)) {
            let mut arrivals = PacketTracker::default();
            let mut counted: Vec<u32> = Vec::new();
            for at in &order {
                if matches!(arrivals.classify(start.wrapping_add(*at)), PacketVerdict::New { .. }) {
                    counted.push(*at);
                }
            }
            prop_assert!(counted.is_sorted_by(|one, other| one < other));
            prop_assert_eq!(counted.last(), order.iter().max());
            prop_assert_eq!(counted.len() as u64 + arrivals.stale_count(), order.len() as u64);
        }
    }
}
