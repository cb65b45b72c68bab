//! Equidistant samples in packets. A packet contains the samples of five milliseconds, or as many as fit into it.
//! Samples that the host does not fetch within a second are dropped, and the next packet reports their number.

use std::time::Duration;

use crate::analysis::SampleTime;
use crate::buses::bridge::protocol::{AnalogData, BissData, BissStatus, MAX_BODY, SsiData, StreamData};
use crate::sim::sine_cosine::{CheckedSettings, Source};
use crate::units::Moment;

/// Maximum time to wait for a packet to fill.
const FLUSH: Duration = Duration::from_millis(5);
/// How long the adapter buffers samples until the host fetches them.
const BACKLOG: Duration = Duration::from_secs(1);

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    Ssi,
    Biss,
}

#[derive(Clone, Debug)]
struct PacketTiming {
    start: Moment,
    period: Duration,
    capacity: u64,
    /// Index of the first sample in the next packet.
    first: u64,
    lost: u64,
}

impl PacketTiming {
    /// Creates a stream. A packet has `head` bytes before the samples, and each sample has `size` bytes.
    fn new(start: Moment, period: Duration, head: usize, size: usize) -> Self {
        let fit = (MAX_BODY - head) / size.max(1);
        let in_time = FLUSH.as_nanos() / period.as_nanos().max(1);
        // The smaller of both is at most 255.
        let capacity = in_time.clamp(1, fit.min(255) as u128) as u64;
        PacketTiming { start, period, capacity, first: 0, lost: 0 }
    }

    fn sample_time(&self, index: u64) -> Moment {
        let nanoseconds = self.period.as_nanos().saturating_mul(index.into());
        self.start + Duration::from_nanos(u64::try_from(nanoseconds).unwrap_or(u64::MAX))
    }

    fn next_packet_time(&self) -> Moment {
        self.sample_time(self.first + self.capacity - 1)
    }

    /// Drops samples that are too old to be kept.
    fn drop_before(&mut self, to: Moment) {
        let behind = to.duration_since(self.next_packet_time());
        if behind > BACKLOG {
            let packet = self.period.as_nanos().max(1) * u128::from(self.capacity);
            let packets = u64::try_from((behind - BACKLOG).as_nanos() / packet).unwrap_or(u64::MAX);
            let samples = packets.saturating_mul(self.capacity);
            self.first += samples;
            self.lost += samples;
        }
    }

    /// Returns the number and the time of the first sample in the next packet, and the number of lost samples before
    /// it. Then advances to the packet after that.
    fn next(&mut self) -> (u32, u64, u16) {
        let first = (self.first % (1 << 32)) as u32;
        let t0_us = u64::try_from(self.sample_time(self.first).since_start().as_micros()).unwrap_or(u64::MAX);
        let lost = u16::try_from(self.lost).unwrap_or(u16::MAX);
        self.first += self.capacity;
        self.lost = 0;
        (first, t0_us, lost)
    }
}

#[derive(Clone, Debug)]
pub(super) struct ClockedStream {
    pub(super) kind: Kind,
    pace: PacketTiming,
    width: u8,
    taken: Vec<(BissStatus, u64)>,
}

impl ClockedStream {
    const HEADER_BYTES: usize = 20;

    /// Creates a stream whose values have the given number of bits.
    pub(super) fn new(kind: Kind, start: Moment, period: Duration, bits: u8) -> Self {
        let width = bits.div_ceil(8).clamp(1, 8);
        let size = usize::from(width) + usize::from(kind == Kind::Biss);
        ClockedStream {
            kind,
            pace: PacketTiming::new(start, period, Self::HEADER_BYTES, size),
            width,
            taken: Vec::new(),
        }
    }

    pub(super) fn next_packet_time(&self) -> Moment {
        self.pace.next_packet_time()
    }

    /// Takes the samples up to `to` and returns the completed packets with their times. Must be called before a change
    /// that takes effect at `to`.
    pub(super) fn run(
        &mut self,
        to: Moment,
        mut take: impl FnMut(Moment) -> (BissStatus, u64),
    ) -> Vec<(Moment, StreamData)> {
        let mut packets = Vec::new();
        let before = self.pace.first;
        self.pace.drop_before(to);
        if self.pace.first != before {
            self.taken.clear();
        }
        loop {
            let at = self.pace.sample_time(self.pace.first + self.taken.len() as u64);
            if at > to {
                return packets;
            }
            self.taken.push(take(at));
            if self.taken.len() as u64 == self.pace.capacity {
                packets.push((at, self.next_packet()));
            }
        }
    }

    fn next_packet(&mut self) -> StreamData {
        let values = std::mem::take(&mut self.taken);
        let (first_index, t0_us, lost) = self.pace.next();
        let (width, period_us) = (self.width, u32::try_from(self.pace.period.as_micros()).unwrap_or(u32::MAX));
        match self.kind {
            Kind::Ssi => {
                let values = values.into_iter().map(|(_, value)| value).collect();
                StreamData::Ssi(SsiData { first_index, t0_us, period_us, lost, width, values })
            }
            Kind::Biss => StreamData::Biss(BissData { first_index, t0_us, period_us, lost, width, values }),
        }
    }
}

#[derive(Clone, Debug)]
pub(super) struct SampledStream {
    pace: PacketTiming,
    source: Source,
}

impl SampledStream {
    /// Voltage in microvolts that a sample of 32767 represents.
    pub(super) const FULL_SCALE_MICROVOLT: u32 = 1_250_000;
    const HEADER_BYTES: usize = 15;

    pub(super) fn new(start: Moment, settings: CheckedSettings) -> Self {
        let period = Duration::from_nanos(settings.settings().period_ns().unsigned_abs());
        SampledStream {
            pace: PacketTiming::new(start, period, Self::HEADER_BYTES, 4),
            source: Source::new(settings, SampleTime::ORIGIN),
        }
    }

    pub(super) fn next_packet_time(&self) -> Moment {
        self.pace.next_packet_time()
    }

    pub(super) fn change_settings(&mut self, now: Moment, settings: CheckedSettings) {
        let elapsed = now.duration_since(self.pace.start).as_nanos();
        let index = elapsed.div_ceil(self.pace.period.as_nanos().max(1));
        self.source.change_settings(u64::try_from(index).unwrap_or(u64::MAX), settings);
    }

    /// Returns the packets that are complete at `to`, each with its time. An encoder without power sends no signals.
    pub(super) fn run(&mut self, to: Moment, is_supplied: bool) -> Vec<(Moment, StreamData)> {
        let mut packets = Vec::new();
        self.pace.drop_before(to);
        while self.pace.next_packet_time() <= to {
            let at = self.pace.next_packet_time();
            let count = usize::try_from(self.pace.capacity).unwrap_or(0);
            // A change in the past may no longer be known. The packet is then empty, so that the gap is visible.
            let samples = self.source.samples_from(self.pace.first, count).map_or(Vec::new(), |wires| {
                wires
                    .sine_v()
                    .into_iter()
                    .zip(wires.cosine_v())
                    .map(
                        |(sine, cosine)| {
                            if is_supplied { (to_full_scale(sine), to_full_scale(cosine)) } else { (0, 0) }
                        },
                    )
                    .collect()
            });
            let (first_index, t0_us, lost) = self.pace.next();
            packets.push((at, StreamData::Analog(AnalogData { first_index, t0_us, lost, samples })));
        }
        packets
    }
}

/// Converts a voltage to a fraction of full scale. Values beyond full scale are clamped.
fn to_full_scale(volts: f64) -> i16 {
    // The result is saturated in the same way as in the adapter's converter.
    (volts * 1e6 / f64::from(SampledStream::FULL_SCALE_MICROVOLT) * 32_767.0).round() as i16
}
