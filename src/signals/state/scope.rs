//! Signals over time as lines of the recorder: sine, cosine, the length of their vector, and the four wires if
//! recorded. See SICK 8010701 for SIN, REFSIN, COS and REFCOS.

use super::feed::ChannelSamples;
use crate::analysis::SampleTime;
use crate::analysis::capture::Capture;
use crate::analysis::history::{BatchError, ColumnPart, Kind};
use crate::analysis::wiring::Wires;
use crate::app::recorder::{self, GroupId, Recorder, Scale, Series, UNTIMED_SAMPLE_INTERVAL_NS};
use crate::signals::state::TEXTS;
use crate::worker::stream::Batch;

#[derive(Debug)]
pub struct Scope {
    pub recorder: Recorder,
    /// Reason why the capture cannot be drawn over time, if any.
    pub refused: Option<TimeAxisError>,
    group: GroupId,
}

/// The reason why the times in a capture cannot be used as an axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TimeAxisError {
    GoBack,
    /// The times exceed 292 years, the range of nanosecond timestamps. Milliseconds may have been read as seconds.
    TooFar,
}

/// Maximum time in seconds that fits into a nanosecond timestamp.
const MAX_TIME_S: f64 = 9.2e9;

/// Maximum number of samples kept of a running source: five seconds at 100 kHz.
const MAX_KEPT_SAMPLES: usize = 500_000;
/// Initially displayed time span in nanoseconds.
const SPAN: i64 = 10_000_000;
/// Number of samples added to the recorder at a time.
const CHUNK_SAMPLES: usize = 1 << 16;

/// Text IDs and export headings of the differential signals, in volts.
const DIFFERENCES: [(&str, &str); 3] = [("scope.sine", "sine"), ("scope.cosine", "cosine"), ("scope.vector", "vector")];
/// Text IDs and export headings of the wires, in volts.
const WIRES: [(&str, &str); 4] =
    [("scope.sin", "SIN"), ("scope.refsin", "REFSIN"), ("scope.cos", "COS"), ("scope.refcos", "REFCOS")];

impl Scope {
    pub(super) fn live(with_wires: bool) -> Self {
        Scope::new(with_wires, MAX_KEPT_SAMPLES, Recorder::new(SPAN))
    }

    pub(super) fn from_capture(capture: &Capture) -> Self {
        let count = capture.sine_v.len().min(capture.cosine_v.len());
        let counts = capture.time_s.len() < count;
        let recorder = if counts { Recorder::without_timestamps(1) } else { Recorder::new(SPAN) };
        let mut scope = Scope::new(capture.wires.is_some(), count.max(1), recorder);
        let mut from = 0;
        if !counts && capture.time_s.iter().any(|seconds| seconds.abs() > MAX_TIME_S) {
            scope.refused = Some(TimeAxisError::TooFar);
        }
        while from < count && scope.refused.is_none() {
            let to = (from + CHUNK_SAMPLES).min(count);
            scope.refused = scope.add_capture(capture, from..to).err().map(|_| TimeAxisError::GoBack);
            from = to;
        }
        if scope.refused.is_some() {
            scope.recorder.clear();
        }
        scope.recorder.handle_action(recorder::RecorderAction::Fit);
        scope.recorder.finish();
        scope
    }

    fn new(with_wires: bool, capacity: usize, mut recorder: Recorder) -> Self {
        let wires = if with_wires { &WIRES[..] } else { &[] };
        let columns = vec![Kind::Real; DIFFERENCES.len() + wires.len()];
        let group = recorder.add_group(&columns, capacity, None);
        for (column, (name, heading)) in DIFFERENCES.iter().chain(wires).enumerate() {
            let scales = vec![Scale::new("unit.volts", 1.0, 4), Scale::new("unit.millivolts", 1e3, 1)];
            let line = Series::new(group, column, TEXTS.text(name), *heading, scales);
            let derived = *name == "scope.vector";
            let line = if derived { line.into_derived() } else { line };
            recorder.add_line(if column < DIFFERENCES.len() { line } else { line.initially_hidden() });
        }
        Scope { recorder, refused: None, group }
    }

    fn add_capture(&mut self, capture: &Capture, range: std::ops::Range<usize>) -> Result<(), BatchError> {
        let part = |column: &[f64]| column.get(range.clone()).unwrap_or_default().to_vec();
        let times = range.clone().map(|at| match capture.time_s.get(at) {
            Some(seconds) if !self.recorder.counts_samples() => {
                SampleTime::from_nanoseconds((seconds * 1e9).round() as i64)
            }
            _ => SampleTime::from_nanoseconds(
                i64::try_from(at).unwrap_or(i64::MAX).saturating_mul(UNTIMED_SAMPLE_INTERVAL_NS),
            ),
        });
        let times: Vec<SampleTime> = times.collect();
        let (sine, cosine) = (part(&capture.sine_v), part(&capture.cosine_v));
        let wires = capture.wires.as_ref().map(|wires| Wires {
            sin_v: part(&wires.sin_v),
            refsin_v: part(&wires.refsin_v),
            cos_v: part(&wires.cos_v),
            refcos_v: part(&wires.refcos_v),
            reference_deg: Vec::new(),
        });
        self.append(&times, &sine, &cosine, wires.as_ref())
    }

    /// Marks a gap between the previous and the following samples.
    pub(super) fn mark_gap(&mut self) {
        self.recorder.break_before_next(self.group);
    }

    /// Adds received samples. Returns the number of samples that could not be stored.
    pub(super) fn add_batch(&mut self, batch: &Batch<ChannelSamples>) -> u64 {
        if batch.lost > 0 {
            self.mark_gap();
        }
        let count = i64::try_from(batch.samples.len()).unwrap_or(0);
        let times: Vec<SampleTime> =
            (0..count).map(|at| batch.time.saturating_add_ns(at.saturating_mul(batch.period_ns))).collect();
        let ChannelSamples { sine_v, cosine_v, wires } = &batch.samples;
        match self.append(&times, sine_v, cosine_v, wires.as_ref()) {
            Ok(()) => 0,
            Err(_) => {
                self.mark_gap();
                times.len() as u64
            }
        }
    }

    fn append(
        &mut self,
        times: &[SampleTime],
        sine: &[f64],
        cosine: &[f64],
        wires: Option<&Wires>,
    ) -> Result<(), BatchError> {
        let vector: Vec<f64> = sine.iter().zip(cosine).map(|(sine, cosine)| sine.hypot(*cosine)).collect();
        let mut parts =
            vec![ColumnPart::from_reals(sine), ColumnPart::from_reals(cosine), ColumnPart::from_reals(&vector)];
        if let Some(wires) = wires {
            parts.extend(
                [&wires.sin_v, &wires.refsin_v, &wires.cos_v, &wires.refcos_v].map(|own| ColumnPart::from_reals(own)),
            );
        }
        self.recorder.append(self.group, times, &parts)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::analysis::history::Flags;

    fn names(scope: &Scope) -> Vec<&'static str> {
        scope.recorder.visible_series().map(|line| line.name.id()).collect()
    }

    fn value(scope: &Scope, line: usize, nanoseconds: i64) -> f64 {
        let line = &scope.recorder.series()[line];
        let sample = scope.recorder.nearest_sample(line, SampleTime::from_nanoseconds(nanoseconds)).unwrap();
        line.value(&sample)
    }

    #[test]
    fn shows_capture_as_lines() {
        let capture = Capture {
            time_s: vec![-1e-6, 0.0, 1e-6],
            sine_v: vec![0.3, 0.0, -0.3],
            cosine_v: vec![0.4, 0.5, 0.4],
            wires: Some(Wires {
                // The wires are drawn as measured, regardless of the differences.
                sin_v: vec![2.9, 2.5, 2.2],
                refsin_v: vec![2.5; 3],
                cos_v: vec![2.8, 2.9, 2.8],
                refcos_v: vec![2.4; 3],
                reference_deg: Vec::new(),
            }),
            ..Capture::default()
        };
        let scope = Scope::from_capture(&capture);
        assert_eq!(names(&scope), ["scope.sine", "scope.cosine", "scope.vector"]);
        assert_eq!(scope.recorder.series().len(), 7);
        // The vector of 0.3 and 0.4 is 0.5.
        for (line, expected) in [0.3, 0.4, 0.5, 2.9, 2.5, 2.8, 2.4].into_iter().enumerate() {
            assert!((value(&scope, line, -1_000) - expected).abs() < 1e-12, "{line}");
        }
        assert!(!scope.recorder.counts_samples() && scope.refused.is_none());
    }

    fn batch(first: i64, count: usize) -> Batch<ChannelSamples> {
        let column = vec![1.0; count];
        let samples = Wires {
            sin_v: column.clone(),
            refsin_v: column.clone(),
            cos_v: column.clone(),
            refcos_v: column,
            reference_deg: Vec::new(),
        };
        Batch { first: 0, time: SampleTime::from_nanoseconds(first), period_ns: 10, lost: 0, samples: samples.into() }
    }

    #[test]
    fn unrecorded_samples_break_lines() {
        let mut scope = Scope::live(true);
        let broken = |scope: &Scope| {
            let history = scope.recorder.history(&scope.recorder.series()[0]).unwrap();
            let all = history.indices();
            let is_break = |at: &u64| history.sample(0, *at).unwrap().flags.contains(Flags::BREAK);
            all.filter(is_break).collect::<Vec<u64>>()
        };
        assert_eq!(scope.add_batch(&batch(0, 3)), 0);
        let before = broken(&scope);
        scope.mark_gap();
        assert_eq!(scope.add_batch(&batch(100, 3)), 0);
        assert_eq!(broken(&scope), [before.clone(), vec![3]].concat());
        assert_eq!(scope.add_batch(&batch(50, 4)), 4, "time went back");
        assert_eq!(scope.add_batch(&batch(200, 1)), 0);
        assert_eq!(broken(&scope), [before, vec![3, 6]].concat());
    }

    #[test]
    fn numbers_untimed_samples() {
        let mut capture = Capture { sine_v: vec![1.0, 2.0, 3.0], cosine_v: vec![0.0; 3], ..Capture::default() };
        let scope = Scope::from_capture(&capture);
        assert!(scope.recorder.counts_samples() && (value(&scope, 0, 2_000) - 3.0).abs() < 1e-12);
        assert_eq!(scope.recorder.series().len(), 3);
        capture.time_s = vec![0.0, 2.0, 1.0];
        let scope = Scope::from_capture(&capture);
        assert!(scope.refused == Some(TimeAxisError::GoBack) && scope.recorder.is_empty());
        // Milliseconds since 1970 read as seconds.
        capture.time_s = vec![1.7e12, 1.7e12 + 1.0, 1.7e12 + 2.0];
        let scope = Scope::from_capture(&capture);
        assert!(scope.refused == Some(TimeAxisError::TooFar) && scope.recorder.is_empty());
        capture.time_s = vec![1.7e9, 1.7e9 + 1.0, 1.7e9 + 2.0];
        assert_eq!(Scope::from_capture(&capture).refused, None);
        assert!(Scope::from_capture(&Capture::default()).recorder.is_empty());
    }
}
