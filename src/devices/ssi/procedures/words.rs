//! SSI words as received. A word contains the bits of one clock burst.

use std::time::Duration;

use super::station::ClockSettings;
use crate::buses::bridge::procedures::Chunk;
use crate::buses::bridge::protocol::SsiData;
use crate::units::Moment;

/// A series of words at equal intervals, or a single requested word.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Words {
    /// Number of the first word, counted from the last change of the settings. The count includes missing words.
    pub first: u64,
    /// Time at which the first word was read.
    pub at: Moment,
    /// Interval between words in nanoseconds. It is 0 for a single word.
    pub period_ns: i64,
    /// Number of missing words before the first one.
    pub lost: u64,
    /// Number of bits per word, 1 to 64.
    pub clocks: u8,
    /// Received words, at least one. Each is right-justified, so the bit received first is the highest of `clocks`
    /// bits.
    pub words: Vec<u64>,
    /// Actual clock frequency in hertz, as set by the adapter.
    pub clock_hz: u32,
    /// Whether the adapter uses a longer interval than requested, because it does not support the requested one.
    pub is_limited: bool,
}

impl Words {
    pub(super) fn single(at: Moment, word: u64, clock_settings: ClockSettings, clock_hz: u32) -> Self {
        Words {
            first: 0,
            at,
            period_ns: 0,
            lost: 0,
            clocks: clock_settings.clocks,
            words: vec![word],
            clock_hz,
            is_limited: false,
        }
    }

    /// Converts a packet of streamed words. `wished_us` is the requested interval in microseconds.
    pub(super) fn run(
        portion: &Chunk,
        data: &SsiData,
        clock_settings: ClockSettings,
        clock_hz: u32,
        wished_us: u32,
    ) -> Self {
        let Chunk { first, time, period_ns, lost, .. } = *portion;
        Words {
            first,
            // The time must not be before the start of the stream.
            at: Moment::from_elapsed(Duration::from_nanos(time.as_nanoseconds().max(0).unsigned_abs())),
            period_ns,
            lost,
            clocks: clock_settings.clocks,
            words: data.values.clone(),
            clock_hz,
            is_limited: period_ns > i64::from(wished_us) * 1000,
        }
    }

    /// Returns whether the series is the first one of a stream.
    pub const fn is_stream_start(&self) -> bool {
        self.first == self.lost
    }

    pub const fn is_streamed(&self) -> bool {
        self.period_ns > 0
    }

    /// Returns an iterator over the words with the times at which they were read.
    pub fn iter_with_times(&self) -> impl Iterator<Item = (Moment, u64)> {
        let period = Duration::from_nanos(self.period_ns.unsigned_abs());
        (0..).zip(&self.words).map(move |(number, word)| (self.at + period * number, *word))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::analysis::SampleTime;
    use crate::buses::bridge::protocol::StreamData;

    #[test]
    fn packet_yields_timed_words() {
        let data = SsiData { first_index: 7, t0_us: 0, period_us: 50, lost: 0, width: 4, values: vec![1, 0x1FF_FFFF] };
        let time = SampleTime::from_nanoseconds(3_000_000);
        let portion = Chunk { first: 7, time, period_ns: 50_000, lost: 2, data: StreamData::Ssi(data.clone()) };
        let clock_settings = ClockSettings { clocks: 25, clock_hz: 1_500_000, pause_us: 25 };
        let run = Words::run(&portion, &data, clock_settings, 1_500_000, 50);
        let at = |us| Moment::from_elapsed(Duration::from_micros(us));
        assert_eq!(run.iter_with_times().collect::<Vec<_>>(), [(at(3000), 1), (at(3050), 0x1FF_FFFF)]);
        assert_eq!((run.is_stream_start(), run.is_streamed(), run.is_limited, run.lost), (false, true, false, 2));
        assert!(Words::run(&portion, &data, clock_settings, 1_500_000, 49).is_limited);
        let lone = Words::single(at(9), 5, clock_settings, 1_000_000);
        assert_eq!(lone.iter_with_times().collect::<Vec<_>>(), [(at(9), 5)]);
        assert_eq!((lone.is_stream_start(), lone.is_streamed()), (true, false));
    }
}
