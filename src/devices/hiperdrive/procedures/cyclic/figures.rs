//! The figures of a cyclic connection.

use std::time::Duration;

use crate::devices::hiperdrive::protocol::DriveNumber;
use crate::link::LinkError;

/// Counts of a connection since it was opened.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct LinkFigures {
    /// From packet to packet, each way, as the target has agreed.
    pub interval: Duration,
    /// Packets to the target.
    pub sent: u64,
    /// Packets that counted.
    pub received: u64,
    /// Packets that should have come before one that came.
    pub missed: u64,
    /// Packets that a newer one had overtaken, or that came twice.
    pub stale: u64,
    /// Packets that were none of this connection, or broken.
    pub malformed: u64,
    /// From packet to packet, as they came.
    pub intervals: Histogram,
}

/// Deviations of the intervals, in buckets.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Histogram {
    counts: [u64; EDGES.len() + 1],
    least: Option<i64>,
    greatest: Option<i64>,
}

/// Why a cyclic connection has ended by itself.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum CyclicLost {
    /// Nothing has come for three intervals.
    #[error("nothing has come for {} ms", after.as_millis())]
    Silent {
        /// Duration of the silence.
        after: Duration,
    },
    /// The port is gone.
    #[error(transparent)]
    Port(#[from] LinkError),
    /// The drive does not stand whatever it is sent: the connection was closed, so that the target stops it.
    #[error("drive {} did not stop", .0.get())]
    DoesNotStand(DriveNumber),
    /// The session's own connection, over TCP, is gone.
    #[error("the connection for parameters is gone")]
    Session,
    /// The program has failed.
    #[error("its thread has failed")]
    Failed,
}

/// Microseconds off, between the buckets.
const EDGES: [i64; 14] = [-5000, -2000, -1000, -500, -200, -100, -50, 50, 100, 200, 500, 1000, 2000, 5000];

/// Number of intervals with this deviation.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Bucket {
    /// Microseconds too long at least, negative for too short; `None`: however short.
    pub from_us: Option<i64>,
    /// Microseconds too long at most; `None`: however long.
    pub below_us: Option<i64>,
    /// Number of intervals.
    pub count: u64,
}

impl Histogram {
    /// An interval of `took` where `wanted` was wanted.
    pub fn count(&mut self, wanted: Duration, took: Duration) {
        let nanoseconds = |duration: Duration| i64::try_from(duration.as_nanos()).unwrap_or(i64::MAX);
        let off = nanoseconds(took).saturating_sub(nanoseconds(wanted)) / 1000;
        let bucket = EDGES.partition_point(|edge| *edge <= off);
        if let Some(count) = self.counts.get_mut(bucket) {
            *count += 1;
        }
        self.least = Some(self.least.map_or(off, |least| least.min(off)));
        self.greatest = Some(self.greatest.map_or(off, |greatest| greatest.max(off)));
    }

    /// The buckets, the shortest intervals first.
    pub fn buckets(&self) -> impl Iterator<Item = Bucket> {
        let from = std::iter::once(None).chain(EDGES.iter().copied().map(Some));
        let below = EDGES.iter().copied().map(Some).chain(std::iter::once(None));
        let buckets = from.zip(below).zip(self.counts);
        buckets.map(|((from_us, below_us), count)| Bucket { from_us, below_us, count })
    }

    /// The least and the greatest, in microseconds off; `None` before there was any.
    pub fn range_us(&self) -> Option<(i64, i64)> {
        self.least.zip(self.greatest)
    }

    /// Returns the number of intervals.
    pub fn total(&self) -> u64 {
        self.counts.iter().sum()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn intervals_fall_into_buckets() {
        let mut histogram = Histogram::default();
        assert_eq!((histogram.total(), histogram.range_us()), (0, None));
        let wanted = Duration::from_millis(10);
        for us in [10_000, 10_049, 9_951, 10_050, 9_949, 0, 15_000, 14_999, 1_000_000] {
            histogram.count(wanted, Duration::from_micros(us));
        }
        let filled: Vec<_> = histogram.buckets().filter(|bucket| bucket.count > 0).collect();
        let bucket = |from_us, below_us, count| Bucket { from_us, below_us, count };
        assert_eq!(
            filled,
            [
                bucket(None, Some(-5000), 1),
                bucket(Some(-100), Some(-50), 1),
                bucket(Some(-50), Some(50), 3),
                bucket(Some(50), Some(100), 1),
                bucket(Some(2000), Some(5000), 1),
                bucket(Some(5000), None, 2),
            ]
        );
        assert_eq!((histogram.total(), histogram.range_us()), (9, Some((-10_000, 990_000))));
    }
}
