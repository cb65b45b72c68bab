//! Statistics of a cyclic connection.

use std::time::Duration;

use crate::devices::hiperdrive::protocol::DriveNumber;
use crate::link::LinkError;

#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct LinkStatistics {
    /// Interval between packets in both directions, as agreed by the target.
    pub interval: Duration,
    pub sent: u64,
    pub received: u64,
    /// Number of packets that had not arrived when a later packet arrived.
    pub missed: u64,
    /// Number of packets that were received twice or after a newer one.
    pub stale: u64,
    /// Number of packets that were malformed or did not belong to this connection.
    pub malformed: u64,
    pub intervals: Histogram,
}

/// Histogram of the deviations from the nominal interval.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Histogram {
    counts: [u64; EDGES.len() + 1],
    least: Option<i64>,
    greatest: Option<i64>,
}

/// Reason why a cyclic connection ended without being closed.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum ConnectionLoss {
    /// No packet has arrived for three intervals.
    #[error("no cyclic data was received for {} ms", after.as_millis())]
    Silent { after: Duration },
    #[error(transparent)]
    Port(#[from] LinkError),
    /// The drive ignored every stop command, so the connection was closed to stop it.
    #[error("drive {} did not stop", .0.get())]
    DoesNotStand(DriveNumber),
    /// The TCP connection of the session was lost.
    #[error("the TCP connection of the session was lost")]
    Session,
    #[error("the thread of the connection has failed")]
    Failed,
}

/// Bucket boundaries of the histogram: deviations in microseconds.
const EDGES: [i64; 14] = [-5000, -2000, -1000, -500, -200, -100, -50, 50, 100, 200, 500, 1000, 2000, 5000];

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Bucket {
    /// Lower bound of the deviation in microseconds, or `None` if there is no bound. It is negative for short
    /// intervals.
    pub from_us: Option<i64>,
    /// Upper bound of the deviation in microseconds, or `None` if there is no bound.
    pub below_us: Option<i64>,
    pub count: u64,
}

impl Histogram {
    /// Counts an interval that took `took` instead of `wanted`.
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

    /// Returns the buckets, beginning with the shortest intervals.
    pub fn buckets(&self) -> impl Iterator<Item = Bucket> {
        let from = std::iter::once(None).chain(EDGES.iter().copied().map(Some));
        let below = EDGES.iter().copied().map(Some).chain(std::iter::once(None));
        let buckets = from.zip(below).zip(self.counts);
        buckets.map(|((from_us, below_us), count)| Bucket { from_us, below_us, count })
    }

    /// Returns the minimum and maximum deviation in microseconds, or `None` before the first interval.
    pub fn deviation_range_us(&self) -> Option<(i64, i64)> {
        self.least.zip(self.greatest)
    }

    pub fn total(&self) -> u64 {
        self.counts.iter().sum()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn counts_intervals_per_bucket() {
        let mut histogram = Histogram::default();
        assert_eq!((histogram.total(), histogram.deviation_range_us()), (0, None));
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
        assert_eq!((histogram.total(), histogram.deviation_range_us()), (9, Some((-10_000, 990_000))));
    }
}
