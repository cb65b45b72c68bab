//! How long an IN word has been unchanged, or a condition has held, in cycles and in time. A gateway may be read more
//! often than it updates from the bus; all readings between two updates count as one.

use std::time::Duration;

use crate::units::Moment;

/// An echo or a value stands when it came in so many cycles, one after the other (reference 4),
const STANDS: u32 = 2;
/// and for so long: longer than a gateway usually keeps one word (`U`).
const STANDS_FOR: Duration = Duration::from_millis(10);
/// A word that may be the answer to the one before stands after so long (`U`),
pub(super) const STAYS_FOR: Duration = Duration::from_millis(100);
/// or after so many cycles of a recording, in which no time passes.
const STAYS: u32 = 20;

/// A reply that is lost can take all the patience: an answer has so many cycles at least, old words among them.
pub(super) const fn least_cycles(recorded: bool) -> u32 {
    if recorded { STAYS + 4 } else { 8 }
}

/// Less patience than this is none: what stays has to be seen.
pub(super) const LEAST_PATIENCE: Duration = Duration::from_millis(150);

/// For how long something holds, cycle after cycle.
#[derive(Clone, Copy, Debug)]
pub(super) struct Held {
    /// In a recording no time passes between two looks: cycles alone count.
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

    /// Long enough for an answer that cannot be an old one.
    pub(super) fn is_stable(self) -> bool {
        self.cycles >= STANDS && self.lasts(STANDS_FOR)
    }

    pub(super) fn is_settled(self) -> bool {
        self.stays_for(STAYS_FOR)
    }

    /// Returns whether it stayed this long; with a slow gateway, for as many cycles as show that it stands.
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
    pub(super) now: Moment,
    pub(super) word: u32,
    pub(super) same: Held,
}
