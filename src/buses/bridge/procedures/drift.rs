//! Drift between the clock of an adapter and the local clock. A packet cannot arrive before it was sampled. Therefore,
//! the packet with the shortest transit reveals the offset of the clocks, and later packets reveal the drift. The
//! offset is corrected slowly, so samples stay equidistant and time never runs backwards.

use crate::analysis::SampleTime;

/// Offset between the clock of a streaming adapter and the local clock. It follows the drift.
#[derive(Clone, Debug, Default)]
pub(super) struct ClockDrift {
    /// Offset in nanoseconds to add to the adapter's time, or `None` before the first packet.
    offset_ns: Option<i128>,
    /// Minimum offset in the current and the previous section of the stream, in nanoseconds.
    least: Option<(i128, Option<i128>)>,
    since_ns: i128,
    /// Time of the previous packet in nanoseconds of the adapter's clock.
    before_ns: i128,
}

/// Length of a section of the stream in nanoseconds, long enough for at least one packet to arrive without delay.
const STRETCH_NS: i128 = 10_000_000_000;
/// Variation of transit times over USB, in nanoseconds.
const SLACK_NS: i128 = 2_000_000;
/// Reciprocal of the maximum correction rate. The rate exceeds the mismatch between two oscillators but is too low to
/// affect measured speeds. During a packet, the correction is less than one of its 255 samples.
const CORRECTION_DIVISOR: i128 = 4000;
/// Change in the offset, in nanoseconds, that is too large for drift: a clock was stopped or set.
const JUMP_NS: i128 = 1_000_000_000;

impl ClockDrift {
    /// Converts the adapter time `own_ns` to local time, which is at most `latest`.
    pub(super) fn time(&mut self, own_ns: i128, latest: SampleTime) -> SampleTime {
        let most = i128::from(latest.as_nanoseconds()) - own_ns;
        let lead = self.minimum_offset_ns(own_ns, most);
        let elapsed = (own_ns - self.before_ns).max(0);
        self.before_ns = own_ns;
        let ahead = match self.offset_ns {
            Some(ahead) if (lead - ahead).abs() <= JUMP_NS => {
                let wrong = lead - ahead;
                let beyond = wrong - wrong.clamp(-SLACK_NS, SLACK_NS);
                ahead + beyond.clamp(-elapsed / CORRECTION_DIVISOR, elapsed / CORRECTION_DIVISOR)
            }
            _ => lead,
        };
        self.offset_ns = Some(ahead);
        SampleTime::from_nanoseconds(i64::try_from(own_ns + ahead).unwrap_or(i64::MAX))
    }

    /// Returns the minimum offset over the current and the previous section of the stream, in nanoseconds.
    fn minimum_offset_ns(&mut self, own_ns: i128, most: i128) -> i128 {
        let fits = (0..=STRETCH_NS).contains(&(own_ns - self.since_ns));
        let (least, before) = match self.least {
            Some((least, before)) if fits => (least.min(most), before),
            other => {
                self.since_ns = own_ns;
                (most, other.map(|(least, _)| least))
            }
        };
        self.least = Some((least, before));
        before.map_or(least, |before| before.min(least))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const MS: i64 = 1_000_000;
    /// Duration of a packet with a hundred samples of 50 µs.
    const PACKET: i64 = 5 * MS;

    /// Simulates hours of packets, each delayed by 0.3 ms to 6 ms, from an adapter whose clock deviates from the local
    /// clock by the given rate.
    fn drift(parts_per_million: i64, hours: i64) {
        let (mut drift, mut before) = (ClockDrift::default(), None);
        let mut random = 1_u64;
        for packet in 0..hours * 3_600 * 200 {
            // `sampled` is local time. The clock of the adapter was started at another time.
            let sampled = packet * PACKET;
            let own = i128::from(sampled + sampled / 1_000_000 * parts_per_million) + 77_000_000_000;
            random = random.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            let under_way = 300_000 + (random >> 33) as i64 % 5_700_000;
            let time =
                drift.time(own / 1000 * 1000, SampleTime::from_nanoseconds(sampled + under_way)).as_nanoseconds();
            assert!((-5 * MS..7 * MS).contains(&(time - sampled)), "{packet}: {} ns off", time - sampled);
            let last = before.replace(time).unwrap_or(time - PACKET);
            assert!((time - last - PACKET).abs() <= PACKET / 1000, "{packet}: {} ns on", time - last);
        }
    }

    #[test]
    fn tracks_fast_or_slow_clock() {
        for parts_per_million in [-100, 100] {
            drift(parts_per_million, 3);
        }
    }

    #[test]
    fn resynchronizes_stopped_clock() {
        let mut drift = ClockDrift::default();
        let at = |ms: i64| SampleTime::from_nanoseconds(ms * MS);
        assert_eq!(drift.time(0, at(500)), at(500));
        assert_eq!(drift.time(5_000_000, at(506)), at(505), "it was under way for longer");
        // The computer slept for an hour, during which its clock stood still.
        let hour = 3_600_000;
        assert_eq!(drift.time(i128::from((hour + 10) * MS), at(510)), at(510));
        // The clock of the adapter stood still for 13.5 s. Until two sections have passed, this looks the same as late
        // packets.
        for (own, came, expected) in [(20, 520, 520), (25_000, 39_000, 25_500), (36_000, 50_000, 50_000)] {
            assert_eq!(drift.time(i128::from((hour + own) * MS), at(came)), at(expected), "{own}");
        }
    }
}
