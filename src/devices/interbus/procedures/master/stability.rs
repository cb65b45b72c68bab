//! How long an IN word has been unchanged, or a condition has held, in cycles and in time. A gateway may be read more
//! often than it updates from the bus; all readings between two updates count as one.

use std::time::Duration;

use crate::units::Moment;

/// Number of consecutive cycles after which an echo or a value is stable (reference 4).
const STANDS: u32 = 2;
/// Minimum duration of a stable echo or value: longer than a gateway usually keeps one word (`U`).
const STANDS_FOR: Duration = Duration::from_millis(10);
/// Time after which a word is accepted even if it might answer the previous request (`U`).
pub(super) const STAYS_FOR: Duration = Duration::from_millis(100);
/// Number of cycles used in place of a duration for recordings, in which no time passes.
const STAYS: u32 = 20;

/// Returns the minimum number of cycles to wait for an answer, including cycles with old words. A single lost reply can
/// use up the whole time limit.
pub(super) const fn least_cycles(recorded: bool) -> u32 {
    if recorded { STAYS + 4 } else { 8 }
}

/// Minimum time limit. A shorter one would miss words that persist.
pub(super) const LEAST_PATIENCE: Duration = Duration::from_millis(150);

#[derive(Clone, Copy, Debug)]
pub(super) struct StabilityTimer {
    /// Whether only cycles count, as in a recording, in which no time passes.
    timeless: bool,
    cycles: u32,
    since: Option<Moment>,
    lasted: Duration,
}

impl StabilityTimer {
    /// Creates a check whose condition does not hold yet.
    pub(super) const fn new(timeless: bool) -> Self {
        StabilityTimer { timeless, cycles: 0, since: None, lasted: Duration::ZERO }
    }

    /// Records whether the condition holds in the current cycle.
    pub(super) fn go_on(&mut self, holds: bool, now: Moment) {
        if !holds {
            *self = StabilityTimer::new(self.timeless);
            return;
        }
        self.cycles += 1;
        self.lasted = now.since(*self.since.get_or_insert(now));
    }

    /// Returns whether the condition has held long enough to exclude an old answer.
    pub(super) fn is_stable(self) -> bool {
        self.cycles >= STANDS && self.is_stable_for(STANDS_FOR)
    }

    pub(super) fn is_settled(self) -> bool {
        self.has_lasted(STAYS_FOR)
    }

    /// Returns whether the condition has held for the given time and, with a slow gateway, for the minimum number of
    /// cycles.
    pub(super) fn has_lasted(self, duration: Duration) -> bool {
        let least = if self.timeless { STAYS } else { STANDS };
        self.cycles >= least && self.is_stable_for(duration)
    }

    /// Returns the time from the first cycle to the last in which the condition held.
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
