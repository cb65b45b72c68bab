//! Tracking of positions across wrap-arounds, with speed and acceleration. Missing positions are bridged if the shaft
//! is too slow to have made an unnoticed turn.

use super::PositionScales;
use crate::analysis::{Motion, MotionRates, PositionUnwrapper, SampleTime, UnwrappedPosition};

/// Duration in nanoseconds over which speed is averaged.
const WINDOW: i64 = 250_000_000;

#[derive(Debug)]
pub(super) struct PositionTracker {
    pub(super) meaning: PositionScales,
    unwrap: PositionUnwrapper,
    motion: Motion,
    /// Last unwrapped position, with its time.
    last: Option<(SampleTime, i64)>,
    /// Absolute speed between the last two positions, in steps per second.
    pace: Option<f64>,
    /// Whether samples without a position have arrived since the last position.
    has_missed: bool,
}

impl PositionTracker {
    pub(super) fn new(meaning: PositionScales) -> Self {
        let unwrap = meaning.range.and_then(PositionUnwrapper::rotary).unwrap_or_else(PositionUnwrapper::without_wrap);
        PositionTracker {
            meaning,
            unwrap,
            motion: Motion::with_window(WINDOW),
            last: None,
            pace: None,
            has_missed: false,
        }
    }

    /// Returns whether the next position is joined to the last one.
    ///
    /// It must arrive within `apart` nanoseconds. If there were samples without a position in between, the shaft must
    /// be too slow to have turned through the whole range in that time.
    pub(super) fn is_contiguous_with_last(&self, time: SampleTime, apart: i64) -> bool {
        let Some((before, _)) = self.last else { return true };
        if time.nanoseconds_since(before) > apart {
            return false;
        }
        let Some(range) = self.meaning.range.filter(|_| self.has_missed) else { return true };
        self.pace.is_some_and(|pace| pace * time.seconds_since(before) < range as f64 / 4.0)
    }

    pub(super) fn record_missing_sample(&mut self) {
        self.has_missed = true;
    }

    /// Returns the next unwrapped position, with its speed and acceleration. Returns `None` if `word` is out of range.
    pub(super) fn next(&mut self, time: SampleTime, word: i64) -> Option<(UnwrappedPosition, MotionRates)> {
        let next = self.unwrap.next(word)?;
        if next.broken {
            self.motion.reset();
            (self.last, self.pace) = (None, None);
        }
        self.follow_position(time, next.steps);
        Some((next, self.motion.next(time, next.steps)))
    }

    fn follow_position(&mut self, time: SampleTime, steps: i64) {
        let pace = |(before, from): (SampleTime, i64)| {
            let seconds = time.seconds_since(before);
            (seconds > 0.0).then(|| (steps.saturating_sub(from) as f64 / seconds).abs())
        };
        self.pace = self.last.and_then(pace).or(self.pace);
        (self.last, self.has_missed) = (Some((time, steps)), false);
    }

    pub(super) fn reset_tracking(&mut self) {
        self.unwrap.mark_gap();
        self.motion.reset();
        (self.last, self.pace, self.has_missed) = (None, None, false);
    }
}
