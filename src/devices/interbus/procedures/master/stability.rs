//! Measures how long an IN word or a condition has been stable, in cycles and in time. Cycles alone are not enough,
//! because a gateway may be read more often than it updates its registers.

use std::time::Duration;

use crate::units::Moment;

/// Number of consecutive cycles after which an echo or a value is stable (reference 4).
const STABLE_CYCLES: u32 = 2;
/// Minimum duration of a stable echo or value, longer than a gateway usually keeps an old word (`U`: not documented).
const MIN_STABLE_TIME: Duration = Duration::from_millis(10);
/// Time after which a word is accepted even if it could be the reply to the previous request (`U`: not documented).
pub(super) const ACCEPTANCE_TIME: Duration = Duration::from_millis(100);
/// Number of cycles that stands in for a duration in recordings, where no time passes.
const RECORDED_CYCLES: u32 = 20;

/// Returns the minimum number of cycles to wait for a reply. This allows for cycles with old words and for a lost reply
/// that takes the whole time limit.
pub(super) const fn min_wait_cycles(recorded: bool) -> u32 {
    if recorded { RECORDED_CYCLES + 4 } else { 8 }
}

/// Minimum value for the handshake time limit. With a shorter one, words could not persist long enough to be accepted.
pub(super) const MIN_HANDSHAKE_TIMEOUT: Duration = Duration::from_millis(150);

#[derive(Clone, Copy, Debug)]
pub(super) struct StabilityTimer {
    /// Whether only cycles are counted, because replies come from a recording in which no time passes.
    timeless: bool,
    cycles: u32,
    since: Option<Moment>,
    lasted: Duration,
}

impl StabilityTimer {
    /// Creates a timer whose condition does not hold yet.
    pub(super) const fn new(timeless: bool) -> Self {
        StabilityTimer { timeless, cycles: 0, since: None, lasted: Duration::ZERO }
    }

    /// Records whether the condition holds in the current cycle.
    pub(super) fn update(&mut self, holds: bool, now: Moment) {
        if !holds {
            *self = StabilityTimer::new(self.timeless);
            return;
        }
        self.cycles += 1;
        self.lasted = now.duration_since(*self.since.get_or_insert(now));
    }

    /// Returns whether the condition has held long enough for an echo or a value to be stable.
    pub(super) fn is_stable(self) -> bool {
        self.cycles >= STABLE_CYCLES && self.is_stable_for(MIN_STABLE_TIME)
    }

    pub(super) fn is_settled(self) -> bool {
        self.has_held_for(ACCEPTANCE_TIME)
    }

    /// Returns whether the condition has held for the given time and the minimum number of cycles.
    pub(super) fn has_held_for(self, duration: Duration) -> bool {
        let least = if self.timeless { RECORDED_CYCLES } else { STABLE_CYCLES };
        self.cycles >= least && self.is_stable_for(duration)
    }

    /// Returns the time from the first to the last cycle in which the condition held.
    pub(super) const fn stable_duration(self) -> Duration {
        self.lasted
    }

    fn is_stable_for(self, duration: Duration) -> bool {
        self.timeless || self.lasted >= duration
    }
}

#[derive(Clone, Copy, Debug)]
pub(super) struct CycleResult {
    pub(super) now: Moment,
    pub(super) word: u32,
    pub(super) same: StabilityTimer,
}
