//! The visible time range.

use super::Recorder;
use crate::analysis::SampleTime;

/// Minimum length of a view in nanoseconds.
const MIN_LENGTH_NS: i64 = 100;
/// Maximum length of a view in nanoseconds: a hundred days.
const MAX_LENGTH_NS: i64 = 100 * 86_400 * 1_000_000_000;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TimeWindow {
    /// Displays the newest samples over a fixed duration.
    Follow {
        /// Duration of the view in nanoseconds, at least 1.
        span: i64,
    },
    Fixed {
        from: SampleTime,
        to: SampleTime,
    },
}

impl Default for TimeWindow {
    fn default() -> Self {
        TimeWindow::Follow { span: 10_000_000_000 }
    }
}

impl Recorder {
    pub fn time_window(&self) -> TimeWindow {
        self.view
    }

    pub fn follows_newest(&self) -> bool {
        matches!(self.view, TimeWindow::Follow { .. })
    }

    pub fn window_bounds(&self) -> (SampleTime, SampleTime) {
        match self.view {
            TimeWindow::Fixed { from, to } => (from, to),
            TimeWindow::Follow { span } => match self.recorded_span() {
                Some((first, last)) if last.nanoseconds_since(first) >= span => (last.saturating_add_ns(-span), last),
                Some((first, _)) => (first, first.saturating_add_ns(span)),
                None => (SampleTime::ORIGIN, SampleTime::ORIGIN.saturating_add_ns(span)),
            },
        }
    }

    pub fn window_length(&self) -> i64 {
        let (from, to) = self.window_bounds();
        to.nanoseconds_since(from).max(1)
    }

    pub(super) fn follow_newest(&mut self) {
        // The view keeps its duration.
        self.view = TimeWindow::Follow { span: self.window_length() };
        self.lines.iter_mut().for_each(|line| line.range = None);
    }

    pub(super) fn pause(&mut self) {
        let (from, to) = self.window_bounds();
        self.view = TimeWindow::Fixed { from, to };
    }

    pub(super) fn fit_window(&mut self) {
        self.lines.iter_mut().for_each(|line| line.range = None);
        let Some((first, last)) = self.recorded_span() else { return };
        // The view ends slightly after the last sample, so the sample is visible.
        let span = last.nanoseconds_since(first).max(MIN_LENGTH_NS);
        self.view = TimeWindow::Fixed { from: first, to: last.saturating_add_ns(span / 200 + 1) };
    }

    pub(super) fn zoom_to(&mut self, from: SampleTime, to: SampleTime) {
        let (from, to) = (from.min(to), from.max(to));
        let span = to.nanoseconds_since(from).clamp(MIN_LENGTH_NS, MAX_LENGTH_NS);
        self.view = TimeWindow::Fixed { from, to: from.saturating_add_ns(span) };
    }

    pub(super) fn set_span(&mut self, span: i64) {
        let span = span.clamp(MIN_LENGTH_NS, MAX_LENGTH_NS);
        self.view = match self.view {
            TimeWindow::Follow { .. } => TimeWindow::Follow { span },
            TimeWindow::Fixed { to, .. } => TimeWindow::Fixed { from: to.saturating_add_ns(-span), to },
        };
    }

    /// Returns the maximum length of the view. It is limited further if the recording is complete.
    fn longest(&self) -> i64 {
        /// Maximum length of the view relative to a complete recording.
        const TIMES: i64 = 4;
        let recorded_span = self.recorded_span().filter(|_| self.finished);
        recorded_span.map_or(MAX_LENGTH_NS, |(first, last)| {
            last.nanoseconds_since(first).saturating_mul(TIMES).clamp(MIN_LENGTH_NS, MAX_LENGTH_NS)
        })
    }

    /// Zooms around a time. A view that follows the samples keeps the newest sample in place.
    pub(super) fn zoom_around(&mut self, about: SampleTime, factor: f64) {
        if !factor.is_finite() || factor <= 0.0 {
            return;
        }
        let longer = |nanoseconds: i64| (nanoseconds as f64 * factor).round() as i64;
        let span = longer(self.window_length()).clamp(MIN_LENGTH_NS, self.longest());
        match self.view {
            TimeWindow::Follow { .. } => self.view = TimeWindow::Follow { span },
            TimeWindow::Fixed { from, to } => {
                let share = about.seconds_since(from) / to.seconds_since(from);
                let before = (span as f64 * share.clamp(0.0, 1.0)).round() as i64;
                let from = about.clamp(from, to).saturating_add_ns(-before);
                self.view = TimeWindow::Fixed { from, to: from.saturating_add_ns(span) };
            }
        }
    }
}
