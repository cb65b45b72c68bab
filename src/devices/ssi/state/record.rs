//! Recording of an SSI encoder: the received words, their positions over time, and the findings about them. If the
//! layout changes, the stored words are decoded again.

use std::collections::VecDeque;
use std::convert::Infallible;
use std::time::Duration;

use jiff::Zoned;

use super::trial::Decoded;
use crate::analysis::SampleTime;
use crate::app::Recording;
use crate::app::recorder::Recorder;
use crate::app::track::{DeviceRecorder, PositionSample, PositionScales};
use crate::devices::ssi::procedures::Words;
use crate::devices::ssi::protocol::{BitMeaning as Says, FindingCounts, Flags, FrameDescriptor, Layout, Range};
use crate::units::Moment;

/// Number of SSI words stored for searches and for decoding with another layout.
const MAX_STORED_WORDS: usize = 40_000;

/// SSI words read from an encoder, decoded with its layout.
pub struct Record {
    track: DeviceRecorder<Infallible>,
    layout: Layout,
    meaning: PositionScales,
    kept: VecDeque<Words>,
    held: usize,
    tally: FindingCounts,
    /// Time up to which findings are hidden, if any.
    hidden_until: Option<Moment>,
    last: Option<ReceivedWord>,
    stream: Option<WordStream>,
    lost: u64,
}

#[derive(Clone, Debug, PartialEq)]
pub struct ReceivedWord {
    pub at: Moment,
    pub clocks: u8,
    /// Decoded word, or `None` if its number of clocks differs from that of the layout.
    pub decoded: Option<Decoded>,
    /// Right-justified word as received.
    pub word: u64,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct WordStream {
    next: u64,
    period_ns: i64,
    is_limited: bool,
}

impl WordStream {
    pub fn frame_rate_hz(&self) -> f64 {
        1e9 / self.period_ns.max(1) as f64
    }

    /// Returns whether the requested interval is too short for the adapter.
    pub const fn is_limited(&self) -> bool {
        self.is_limited
    }
}

impl Record {
    pub(super) fn new(layout: Layout) -> Self {
        Record {
            track: DeviceRecorder::default(),
            meaning: position_scales(&layout),
            tally: FindingCounts::default(),
            hidden_until: None,
            layout,
            kept: VecDeque::new(),
            held: 0,
            last: None,
            stream: None,
            lost: 0,
        }
    }

    pub(super) fn begin_session(&mut self, began: &Zoned) {
        self.track.begin_session(began);
        self.kept.clear();
        (self.held, self.stream, self.last, self.hidden_until) = (0, None, None, None);
    }

    /// Adds new words, before which `dropped` words were lost.
    pub(super) fn add_words(&mut self, runs: Vec<Words>, dropped: u64) {
        match self.stream {
            // The numbers of streamed words show how many were dropped.
            Some(_) if dropped > 0 => self.track.mark_gap(),
            _ => self.track.record_dropped(dropped),
        }
        for run in runs {
            self.compare_with_previous(&run);
            self.add_run(&run);
            self.buffer_words(run);
        }
    }

    /// Compares a series of words with the previous one. Missing words are counted and leave a gap in the recording.
    fn compare_with_previous(&mut self, run: &Words) {
        let before = self.stream.filter(|_| !run.is_stream_start()).map(|stream| run.first.saturating_sub(stream.next));
        let missing = before.unwrap_or(run.lost);
        if run.is_streamed() && (run.is_stream_start() || missing > 0) {
            self.track.mark_gap();
        }
        self.lost += missing;
        let next = run.first + run.words.len() as u64;
        self.stream =
            run.is_streamed().then_some(WordStream { next, period_ns: run.period_ns, is_limited: run.is_limited });
    }

    fn add_run(&mut self, run: &Words) {
        let fits = run.clocks == self.layout.clock_count();
        let mut sightings = Vec::with_capacity(run.words.len());
        for (at, word) in run.iter_with_times() {
            if !fits {
                sightings.push(PositionSample { at, position: None, is_bad: true, is_warned: false });
                continue;
            }
            let reading = self.layout.decode(word);
            if self.hidden_until.is_none_or(|until| at > until) {
                self.tally.count_findings(&self.layout, reading, SampleTime::from(at));
            }
            let is_bad = !self.layout.is_valid(reading);
            let warned = || self.layout.to_findings(reading).iter().any(|finding| finding.meaning() == Says::Warning);
            let position = i64::try_from(reading.position).ok();
            // The search for findings is skipped for most words, which have none.
            let is_warned = reading.flags != Flags::NONE && warned();
            sightings.push(PositionSample { at, position, is_bad, is_warned });
        }
        self.track.add_positions(&sightings, &self.meaning);
        if let Some((at, word)) = run.iter_with_times().last() {
            self.last = Some(ReceivedWord {
                at,
                clocks: run.clocks,
                decoded: fits.then(|| Decoded::decode(&self.layout, word)),
                word,
            });
        }
    }

    fn buffer_words(&mut self, run: Words) {
        self.held += run.words.len();
        self.kept.push_back(run);
        while self.held > MAX_STORED_WORDS && self.kept.len() > 1 {
            self.held -= self.kept.pop_front().map_or(0, |run| run.words.len());
        }
    }

    /// Changes the layout. Stored words are decoded again, and earlier recordings are dropped. If only names differ,
    /// the recording is kept.
    pub(super) fn reinterpret(&mut self, layout: &Layout) {
        if self.layout == *layout {
            return;
        }
        let before = std::mem::replace(&mut self.layout, layout.clone());
        if descriptor_without_names(&before) == descriptor_without_names(layout) {
            self.tally.rename();
            if let Some(last) = self.last.as_mut() {
                last.decoded = (last.clocks == layout.clock_count()).then(|| Decoded::decode(layout, last.word));
            }
            return;
        }
        self.meaning = position_scales(layout);
        self.tally.reset();
        self.track.prepare_redecoding(self.held);
        let kept = std::mem::take(&mut self.kept);
        let (lost, stream) = (self.lost, self.stream);
        for run in &kept {
            self.compare_with_previous(run);
            self.add_run(run);
        }
        (self.kept, self.lost, self.stream) = (kept, lost, stream);
    }

    /// Returns the newest stored words that follow each other without a gap and have `clocks` bits.
    pub(super) fn latest_words(&self, clocks: u8) -> Vec<u64> {
        let mut runs: Vec<&Words> = self.recent_runs(clocks).collect();
        runs.reverse();
        runs.into_iter().flat_map(|run| run.words.iter().copied()).collect()
    }

    /// Returns how many of the newest stored words follow each other without a gap and have `clocks` bits.
    pub fn count(&self, clocks: u8) -> usize {
        self.recent_runs(clocks).map(|run| run.words.len()).sum()
    }

    /// Returns an iterator over the newest contiguous series of words with `clocks` bits, newest first.
    fn recent_runs(&self, clocks: u8) -> impl Iterator<Item = &Words> {
        let mut later: Option<&Words> = None;
        self.kept.iter().rev().take_while(move |run| {
            let goes_on = later.is_none_or(|later| {
                let ends = run.first + run.words.len() as u64;
                !later.is_stream_start() && later.first == ends && later.period_ns == run.period_ns
            });
            later = Some(run);
            goes_on && run.clocks == clocks
        })
    }

    pub fn finding_counts(&self) -> &FindingCounts {
        &self.tally
    }

    /// Hides all previous findings, even if the words are decoded again.
    pub(super) fn reset_tally(&mut self) {
        self.tally.reset();
        self.hidden_until = self.last.as_ref().map(|last| last.at);
    }

    pub fn last(&self) -> Option<&ReceivedWord> {
        self.last.as_ref()
    }

    /// Returns the current stream, or `None` if words are read one at a time.
    pub(super) fn current_stream(&self) -> Option<&WordStream> {
        self.stream.as_ref()
    }

    pub fn position_count(&self) -> u64 {
        self.track.position_count()
    }
}

impl Recording for Record {
    fn recorder(&self) -> &Recorder {
        &self.track.recorder
    }

    fn recorder_mut(&mut self) -> &mut Recorder {
        &mut self.track.recorder
    }

    // The result includes words that an adapter could not send.
    fn dropped_count(&self) -> u64 {
        self.track.dropped_count().saturating_add(self.lost)
    }

    fn poll(&mut self, interval: Option<Duration>, begins: bool) {
        self.track.poll(interval, begins);
        if interval.is_none() {
            self.stream = None;
        }
    }
}

/// Returns the descriptor without names, which have no effect on positions and verdicts.
fn descriptor_without_names(layout: &Layout) -> FrameDescriptor {
    let mut descriptor = layout.descriptor().clone();
    descriptor.errors.iter_mut().for_each(|bit| bit.name.clear());
    descriptor.patterns.iter_mut().for_each(|pattern| pattern.name.clear());
    descriptor
}

/// Returns the range and scale of a layout's positions.
fn position_scales(layout: &Layout) -> PositionScales {
    let range = layout.descriptor().range;
    let all = range.last_position().ok().and_then(|last| i64::try_from(last).ok()?.checked_add(1));
    match range {
        Range::Bits { singleturn, .. } => PositionScales::for_steps_per_turn(all, f64::from(singleturn).exp2()),
        Range::Steps { per_turn, .. } => PositionScales::for_steps_per_turn(all, per_turn.into()),
        Range::RoundAxis { steps, revolutions } => {
            let around = f64::from(steps) * f64::from(revolutions.denominator);
            PositionScales::for_steps_per_turn(all, around / f64::from(revolutions.numerator))
        }
        Range::Length { step_nanometres, .. } => PositionScales::for_millimetres(f64::from(step_nanometres) * 1e-6),
    }
}

#[cfg(test)]
mod tests;
