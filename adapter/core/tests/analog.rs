//! Tests of an adapter's analogue inputs, from the perspective of a host. The inputs are simulated.

#![allow(clippy::unwrap_used, clippy::indexing_slicing, clippy::panic)]

mod model;

use bridge_codec::{ErrorCode, Message, Reply, Request, StreamData};
use model::{Bench, refusal};

/// The sine is converted every 10 µs, and the cosine 2 µs after it.
#[test]
fn samples_pairs_back_to_back() {
    let mut bench = Bench::new();
    assert_eq!(refusal(bench.ask(&Request::AnalogStream { on: true })).1, ErrorCode::BAD_ARGUMENT, "not configured");
    // The value encodes the time, without repeating within a packet.
    bench.model().input = |input, t_us| if input < 2 { (t_us / 2 % 4096) as u16 } else { 999 };
    assert_eq!(bench.ask(&Request::AnalogSkew), Message::Reply(Reply::AnalogSkew { skew_ns: 2_000 }));
    for (wanted, actual) in [(100_000, 100_000), (30_000, 25_000), (1_000, 1_000)] {
        let config = Reply::AnalogConfig { sample_hz: actual, full_scale_microvolt: 749_977, bits: 12 };
        assert_eq!(bench.ask(&Request::AnalogConfig { sample_hz: wanted }), Message::Reply(config));
        bench.ask(&Request::AnalogStream { on: true });
        assert_eq!(refusal(bench.ask(&Request::AnalogStream { on: true })).1, ErrorCode::BUSY);
        assert_eq!(refusal(bench.ask(&Request::AnalogConfig { sample_hz: 1_000 })).1, ErrorCode::BUSY);
        let (mut next, period) = (0, u64::from(1_000_000 / actual));
        for step in (0..500).map(|at| 100 + at * 37 % 3_000) {
            for message in bench.run(step) {
                let Message::Data(StreamData::Analog(data)) = message else { panic!("{message:?}") };
                assert_eq!((data.first_index, data.lost), (next, 0));
                for (at, sample) in (0..).zip(&data.samples) {
                    let value = |t_us: u64| ((t_us / 2 % 4096) as i16 - 2048) * 16;
                    let t_us = data.t0_us + at * period;
                    assert_eq!(*sample, (value(t_us), value(t_us + 2)));
                }
                next += data.samples.len() as u32;
            }
        }
        assert!(u64::from(next) * period > 700_000, "{next} samples");
        bench.ask(&Request::AnalogStream { on: false });
        assert!(bench.model().conversions.is_none());
    }
}

#[test]
fn reports_missed_conversions() {
    let mut bench = Bench::new();
    bench.ask(&Request::AnalogConfig { sample_hz: 100_000 });
    bench.ask(&Request::AnalogStream { on: true });
    let mut next = 0;
    let mut lost = Vec::new();
    for step in 0..200 {
        bench.model().has_overrun = step == 50;
        // The model keeps 16 384 conversions of 2 µs.
        for message in bench.run(if step == 100 { 60_000 } else { 1_000 }) {
            let Message::Data(StreamData::Analog(data)) = message else { panic!("{message:?}") };
            assert_eq!(data.first_index - next, u32::from(data.lost), "the index shows the gap");
            lost.extend((data.lost > 0).then_some(data.lost));
            next = data.first_index + data.samples.len() as u32;
        }
    }
    assert_eq!(lost.len(), 2, "{lost:?}");
    assert!(lost[0] < 300 && (3_500..5_500).contains(&lost[1]), "{lost:?}");
    let Message::Reply(Reply::Status(status)) = bench.ask(&Request::Status) else { panic!("no status") };
    assert_eq!(status.lost, lost.iter().map(|lost| u32::from(*lost)).sum::<u32>());
    assert_eq!(status.restart, bridge_codec::RestartReason::WATCHDOG);
    bench.ask(&Request::Hello);
    assert!(!bench.adapter.is_streaming() && bench.model().conversions.is_none());
}
