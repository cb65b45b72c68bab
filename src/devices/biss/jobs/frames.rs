//! Position frames streamed by an adapter.

use crate::buses::bridge::jobs::StreamFormat;
use crate::buses::bridge::procedures::{StreamRequest, StreamingAdapter};
use crate::buses::bridge::protocol::StreamData;
use crate::devices::biss::procedures::{Frame, parse_frames};
use crate::devices::biss::protocol::Layout;

/// A stream of BiSS position frames whose checksums are verified.
#[derive(Clone, Debug)]
pub struct BissFrames {
    pub layout: Layout,
    /// Clock frequency in hertz.
    pub clock_hz: u32,
    /// Sampling interval in microseconds.
    pub period_us: u32,
}

impl StreamFormat for BissFrames {
    type Samples = Vec<Frame>;

    fn stream_request(&self) -> StreamRequest {
        StreamRequest::Biss {
            clock_hz: self.clock_hz,
            data_bits: self.layout.data_bits(),
            crc_bits: self.layout.crc_bits(),
            period_us: self.period_us,
        }
    }

    fn read(&self, data: StreamData, _: &StreamingAdapter) -> Option<Vec<Frame>> {
        let StreamData::Biss(data) = data else { return None };
        Some(parse_frames(&self.layout, &data))
    }
}

#[cfg(test)]
mod tests {
    use std::time::Duration;

    use super::*;
    use crate::analysis::SampleTime;
    use crate::buses::bridge::jobs::tests::{bench, count, virtual_adapter};
    use crate::devices::biss::protocol::PositionData;
    use crate::worker::stream::Producer;

    /// A stream of 20,000 frames per second. A frame of 43 clocks takes 21.5 µs at 2 MHz and is followed by a pause of
    /// 27 µs.
    fn biss() -> BissFrames {
        BissFrames { layout: Layout::default(), clock_hz: 2_000_000, period_us: 50 }
    }

    #[test]
    fn streams_20_000_frames_without_gap() {
        let mut bench = bench(biss(), virtual_adapter("rpm=3000&position=0"));
        let batches = bench.take(Duration::from_secs(5));
        let (frames, lost) = count(&batches);
        // The last samples may still be in transit, or the last wait may have been slightly longer.
        assert!((99_880..=100_500).contains(&frames) && lost == 0, "{frames} frames, {lost} lost");
        let begin = batches[0].time;
        assert!(
            (0..10_000_000).contains(&begin.nanoseconds_since(SampleTime::from_nanoseconds(3_000_000_000))),
            "{begin:?}"
        );
        let mut before = None;
        for batch in &batches {
            assert_eq!((batch.time, batch.period_ns), (begin.saturating_add_ns(batch.first as i64 * 50_000), 50_000));
            for frame in &batch.samples {
                let PositionData { multiturn, singleturn, error, warning } = frame.unwrap();
                let position = i64::from(multiturn) * 131_072 + i64::from(singleturn);
                // 50 revolutions per second correspond to 327.68 steps per frame.
                assert!(before.is_none_or(|before| (327..=328).contains(&(position - before))) && !error && !warning);
                before = Some(position);
            }
        }
        let streaming = bench.bridge.streaming_adapter().get().cloned().unwrap();
        assert_eq!((streaming.hello.name.as_str(), streaming.period_ns), ("virtual adapter", 50_000));
        assert!(bench.unsolicited_byte_count() > 100_000);
        bench.bridge.end(&*bench.clock);
        assert_eq!(bench.unsolicited_byte_count(), 0, "the adapter was told to stop");
    }

    #[test]
    fn wrong_crc_yields_no_reading() {
        let mut bench = bench(biss(), virtual_adapter("noise=0.01&seed=4"));
        let batches = bench.take(Duration::from_secs(2));
        let (frames, lost) = count(&batches);
        let bad = batches.iter().flat_map(|batch| &batch.samples).filter(|frame| frame.is_err()).count() as f64;
        assert_eq!(lost, 0);
        assert!((0.007..0.013).contains(&(bad / frames as f64)), "{bad} of {frames}");
    }
}
