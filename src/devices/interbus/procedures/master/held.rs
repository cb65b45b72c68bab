//! How long an IN word was received, or a condition has held: in cycles and in time. A gateway may be read more often than
//! it reads the bus, and returns the same word meanwhile.

use std::time::Duration;

use crate::units::Moment;

/// Number of consecutive cycles after which an echo or a value is stable (reference 4),
const STANDS: u32 = 2;
/// and the minimum time: longer than a gateway usually repeats one word (`U`).
const STANDS_FOR: Duration = Duration::from_millis(10);
/// Time after which a word that may be the reply to the previous one is stable (`U`),
pub(super) const STAYS_FOR: Duration = Duration::from_millis(100);
/// or the number of cycles of a recording, in which no time passes.
const STAYS: u32 = 20;

/// Returns the minimum number of cycles for a reply, including old words: a lost one can take the whole time limit.
pub(super) const fn least_cycles(recorded: bool) -> u32 {
    if recorded { STAYS + 4 } else { 8 }
}

/// Minimum time limit: a stable word must be recognisable within it.
pub(super) const LEAST_PATIENCE: Duration = Duration::from_millis(150);

/// How long a condition holds, cycle by cycle.
#[derive(Clone, Copy, Debug)]
pub(super) struct Held {
    /// In a recording no time passes between two readings: only cycles count.
    timeless: bool,
    cycles: u32,
    since: Option<Moment>,
    lasted: Duration,
}

impl Held {
    /// Creates the check; the condition does not hold yet.
    pub(super) const fn new(timeless: bool) -> Self {
        Held { timeless, cycles: 0, since: None, lasted: Duration::ZERO }
    }

    /// Takes whether the condition holds in the cycle that ends now.
    pub(super) fn go_on(&mut self, holds: bool, now: Moment) {
        if !holds {
            *self = Held::new(self.timeless);
            return;
        }
        self.cycles += 1;
        self.lasted = now.since(*self.since.get_or_insert(now));
    }

    /// Returns whether it lasts long enough for an answer that cannot be an old one.
    pub(super) fn stands(self) -> bool {
        self.cycles >= STANDS && self.lasts(STANDS_FOR)
    }

    /// Returns whether it lasts long enough for one that could be.
    pub(super) fn stays(self) -> bool {
        self.stays_for(STAYS_FOR)
    }

    /// Returns whether it stayed this long; with a slow gateway, for as many cycles as show that it is stable.
    pub(super) fn stays_for(self, duration: Duration) -> bool {
        let least = if self.timeless { STAYS } else { STANDS };
        self.cycles >= least && self.lasts(duration)
    }

    /// Returns the time from the first of these cycles to the last.
    pub(super) const fn lasted(self) -> Duration {
        self.lasted
    }

    fn lasts(self, duration: Duration) -> bool {
        self.timeless || self.lasted >= duration
    }
}

#[derive(Clone, Copy, Debug)]
pub(super) struct CycleResult {
    /// Time of the last cycle.
    pub(super) now: Moment,
    pub(super) word: u32,
    /// How long the word was the same.
    pub(super) same: Held,
}
