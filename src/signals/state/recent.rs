//! The newest samples of a running source, without gaps. Received batches are shared with the measurement, not copied.

use std::collections::VecDeque;
use std::sync::Arc;

use super::feed::ChannelSamples;
use crate::analysis::SampleTime;
use crate::analysis::capture::Capture;
use crate::analysis::wiring::Wires;
use crate::worker::stream::Batch;

#[derive(Default)]
pub(super) struct RecentSamples {
    chunks: VecDeque<Arc<ChannelSamples>>,
    count: usize,
    newest: Option<SampleTime>,
    period_ns: i64,
}

/// The newest samples over a given duration.
pub(super) struct Window {
    chunks: Vec<Arc<ChannelSamples>>,
    /// Number of samples to skip at the start of the first batch because they are too old.
    skip: usize,
    period_ns: i64,
}

/// Maximum number of samples in one measurement.
pub(super) const MAX_SAMPLES: usize = 500_000;
const EVERY_NS: i64 = 250_000_000;

impl RecentSamples {
    pub(super) fn add_batch(&mut self, batch: Batch<ChannelSamples>) {
        if batch.lost > 0 || batch.period_ns != self.period_ns {
            (self.chunks, self.count) = (VecDeque::new(), 0);
        }
        self.period_ns = batch.period_ns;
        let count = i64::try_from(batch.samples.len()).unwrap_or(0);
        self.newest = Some(batch.time.saturating_add_ns((count - 1).max(0).saturating_mul(batch.period_ns)));
        self.count += batch.samples.len();
        self.chunks.push_back(Arc::new(batch.samples));
        while let Some(oldest) = self.chunks.front().map(|chunk| chunk.len())
            && self.count - oldest >= MAX_SAMPLES
        {
            self.chunks.pop_front();
            self.count -= oldest;
        }
    }

    pub(super) fn latest_time(&self) -> Option<SampleTime> {
        self.newest
    }

    /// Returns whether the newest sample is at least a quarter of a second later than the last measurement.
    pub(super) fn is_due(&self, measured: Option<SampleTime>) -> bool {
        match (self.newest, measured) {
            (Some(newest), Some(measured)) => newest.nanoseconds_since(measured) >= EVERY_NS,
            (newest, None) => newest.is_some(),
            (None, Some(_)) => false,
        }
    }

    /// Returns the samples of the last `milliseconds`, but at most [`MAX_SAMPLES`]. Returns `None` until enough samples
    /// have arrived.
    pub(super) fn latest_window(&self, milliseconds: u32) -> Option<Window> {
        let wanted = i64::from(milliseconds) * 1_000_000 / self.period_ns.max(1);
        let count = usize::try_from(wanted).unwrap_or(MAX_SAMPLES).clamp(1, MAX_SAMPLES);
        let mut skip = self.count.checked_sub(count)?;
        let too_old = |chunk: &&Arc<ChannelSamples>| {
            let is_too_old = chunk.len() <= skip;
            skip -= if is_too_old { chunk.len() } else { 0 };
            is_too_old
        };
        let chunks = self.chunks.iter().skip_while(too_old).cloned().collect();
        Some(Window { chunks, skip, period_ns: self.period_ns })
    }
}

impl Window {
    /// Copies the samples to a capture whose times begin at zero.
    pub(super) fn to_capture(&self) -> Capture {
        let column = |of: fn(&ChannelSamples) -> &[f64]| -> Vec<f64> {
            self.chunks.iter().flat_map(|chunk| of(chunk).iter().copied()).skip(self.skip).collect()
        };
        let (sine_v, cosine_v) = (column(|own| &own.sine_v), column(|own| &own.cosine_v));
        // The virtual encoder always provides the single wires. An adapter never does.
        let wires = Wires {
            sin_v: column(|own| own.wire_samples(|wires| &wires.sin_v)),
            refsin_v: column(|own| own.wire_samples(|wires| &wires.refsin_v)),
            cos_v: column(|own| own.wire_samples(|wires| &wires.cos_v)),
            refcos_v: column(|own| own.wire_samples(|wires| &wires.refcos_v)),
            reference_deg: Vec::new(),
        };
        let reference_deg = column(|own| own.wire_samples(|wires| &wires.reference_deg));
        let period_s = self.period_ns as f64 * 1e-9;
        Capture {
            skipped_rows: 0,
            time_s: (0..sine_v.len()).map(|at| at as f64 * period_s).collect(),
            sine_v,
            cosine_v,
            reference_deg: (!reference_deg.is_empty()).then_some(reference_deg),
            wires: Some(wires).filter(|wires| !wires.sin_v.is_empty()),
            absolute: None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::buses::bridge::jobs::SineCosineSamples;

    fn batch(first: u64, count: usize, period_ns: i64, lost: u64) -> Batch<ChannelSamples> {
        let column = |at: f64| (0..count).map(|own| (first as f64 + own as f64) * at).collect();
        let samples = Wires {
            sin_v: column(2.0),
            refsin_v: column(1.0),
            cos_v: column(4.0),
            refcos_v: column(1.0),
            reference_deg: column(0.5),
        };
        let time = SampleTime::from_nanoseconds(first as i64 * period_ns);
        Batch { first, time, period_ns, lost, samples: samples.into() }
    }

    #[test]
    fn measures_signals_without_wire_samples() {
        let mut recent = RecentSamples::default();
        let pair = SineCosineSamples { sine_v: vec![1.0, 2.0, 3.0], cosine_v: vec![4.0, 5.0, 6.0] };
        recent.add_batch(Batch {
            first: 0,
            time: SampleTime::ORIGIN,
            period_ns: 1_000_000,
            lost: 0,
            samples: pair.into(),
        });
        let window = recent.latest_window(2).unwrap().to_capture();
        assert_eq!((window.sine_v, window.cosine_v), (vec![2.0, 3.0], vec![5.0, 6.0]));
        assert!(window.wires.is_none() && window.reference_deg.is_none());
        assert_eq!(window.time_s, [0.0, 0.001]);
    }

    #[test]
    fn window_holds_newest_contiguous_samples() {
        let mut recent = RecentSamples::default();
        assert!(recent.latest_window(10).is_none() && !recent.is_due(None));
        recent.add_batch(batch(0, 5, 1_000_000, 0));
        recent.add_batch(batch(5, 6, 1_000_000, 0));
        // Ten milliseconds are ten samples, 1 to 10; sine is 2n − n, cosine 4n − n.
        let window = recent.latest_window(10).unwrap().to_capture();
        assert_eq!((window.sine_v.len(), window.sine_v[0], window.cosine_v[9]), (10, 1.0, 30.0));
        assert!((window.time_s[9] - 0.009).abs() < 1e-12);
        assert_eq!((window.wires.unwrap().cos_v[9], window.reference_deg.unwrap()[9]), (40.0, 5.0));
        // Five milliseconds are in the second batch only.
        let window = recent.latest_window(5).unwrap();
        assert_eq!((window.chunks.len(), window.to_capture().sine_v), (1, vec![6.0, 7.0, 8.0, 9.0, 10.0]));
        recent.add_batch(batch(20, 4, 1_000_000, 9));
        assert!(recent.latest_window(10).is_none(), "what is before the gap does not belong to it");
        recent.add_batch(batch(24, 4, 500_000, 0));
        assert_eq!(recent.count, 4, "another rate is another signal");
    }

    #[test]
    fn limits_shared_chunks_to_window() {
        let mut recent = RecentSamples::default();
        for at in 0..70 {
            recent.add_batch(batch(at * 10_000, 10_000, 1_000, 0));
        }
        assert_eq!((recent.count, recent.chunks.len()), (MAX_SAMPLES, 50));
        let window = recent.latest_window(10_000).unwrap();
        assert!(Arc::ptr_eq(&window.chunks[0], &recent.chunks[0]));
        // Half a second at 1 MHz is the maximum: samples 200 000 to 699 999.
        let capture = window.to_capture();
        assert_eq!((capture.sine_v.len(), capture.sine_v[0]), (MAX_SAMPLES, 200_000.0));
    }

    #[test]
    fn measures_four_times_per_second() {
        let mut recent = RecentSamples::default();
        recent.add_batch(batch(0, 100, 1_000_000, 0));
        assert!(recent.is_due(None));
        let measured = recent.newest;
        recent.add_batch(batch(100, 249, 1_000_000, 0));
        assert!(!recent.is_due(measured));
        recent.add_batch(batch(349, 1, 1_000_000, 0));
        assert!(recent.is_due(measured));
    }
}
