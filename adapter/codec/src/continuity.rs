//! Detects gaps between stream packets (`protocol/bridge.md`, section 3).

use super::data::StreamData;

/// A detector of gaps between stream packets, which holds the sample number expected next.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Continuity {
    next: u32,
}

/// The gap between a packet and the previous one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PacketGap {
    /// There is no gap.
    None,
    /// This number of samples is missing.
    Missing(u32),
    /// The packet starts before the end of the previous one. Either the stream was restarted, or the packet is late.
    Backwards,
}

impl Continuity {
    /// Creates a detector for the start of a stream, where sample 0 is expected.
    pub const fn at_start() -> Self {
        Continuity { next: 0 }
    }

    /// Returns the gap before a packet, and expects the next packet to follow this one.
    pub fn gap_before(&mut self, data: &StreamData) -> PacketGap {
        let (first, count, lost) = data.sample_range();
        let ahead = first.wrapping_sub(self.next);
        // A packet has at most 255 samples.
        self.next = first.wrapping_add(u32::try_from(count).unwrap_or(0));
        match ahead.max(lost.into()) {
            0 => PacketGap::None,
            _ if ahead > u32::MAX / 2 => PacketGap::Backwards,
            missing => PacketGap::Missing(missing),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::data::AnalogData;
    use super::*;
    use std::vec;

    fn data(first_index: u32, count: usize, lost: u16) -> StreamData {
        StreamData::Analog(AnalogData { first_index, t0_us: 0, lost, samples: vec![(0, 0); count] })
    }

    #[test]
    fn finds_gaps_by_index_and_lost_count() {
        let mut stream = Continuity::at_start();
        let cases = [
            (data(0, 10, 0), PacketGap::None),
            (data(10, 10, 0), PacketGap::None),
            (data(25, 5, 0), PacketGap::Missing(5)),
            (data(30, 5, 3), PacketGap::Missing(3)),
            (data(38, 2, 3), PacketGap::Missing(3)),
            (data(50, 2, 3), PacketGap::Missing(10)),
            (data(0, 2, 0), PacketGap::Backwards),
            (data(2, 0, 0), PacketGap::None),
            (data(2, 1, 0), PacketGap::None),
            (data(u32::MAX - 1, 4, 0), PacketGap::Backwards),
            (data(2, 1, 0), PacketGap::None),
        ];
        for (data, gap) in cases {
            assert_eq!(stream.gap_before(&data), gap, "{:?}", data.sample_range());
        }
        assert_eq!(
            Continuity::at_start().gap_before(&data(7, 1, 0)),
            PacketGap::Missing(7),
            "the first packet was lost"
        );
    }
}
