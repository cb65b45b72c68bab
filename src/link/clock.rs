//! Clocks. The real clock is used for hardware and for virtual devices in the window, the virtual clock in tests.

use std::sync::atomic::{AtomicU64, Ordering};
use std::time::{Duration, Instant};

use crate::units::Moment;

/// A source of time on which threads can wait.
pub trait Clock: Send + Sync {
    /// Returns the current time.
    fn now(&self) -> Moment;

    /// Blocks until `moment`.
    fn sleep_until(&self, moment: Moment);
}

/// The monotonic clock of the computer. It starts at zero when it is created.
#[derive(Debug)]
pub struct RealClock(Instant);

impl RealClock {
    /// Creates a clock that starts at zero.
    pub fn start() -> Self {
        RealClock(Instant::now())
    }
}

impl Clock for RealClock {
    fn now(&self) -> Moment {
        Moment::from_elapsed(self.0.elapsed())
    }

    fn sleep_until(&self, moment: Moment) {
        let left = moment.since(self.now());
        if !left.is_zero() {
            std::thread::sleep(left);
        }
    }
}

/// A clock that advances only while a thread waits on it. Waiting an hour takes no real time.
#[derive(Debug, Default)]
pub struct VirtualClock {
    nanoseconds: AtomicU64,
}

impl Clock for VirtualClock {
    fn now(&self) -> Moment {
        Moment::from_elapsed(Duration::from_nanos(self.nanoseconds.load(Ordering::SeqCst)))
    }

    fn sleep_until(&self, moment: Moment) {
        let target = u64::try_from(moment.since_start().as_nanos()).unwrap_or(u64::MAX);
        self.nanoseconds.fetch_max(target, Ordering::SeqCst);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn virtual_time_only_moves_forward() {
        let clock = VirtualClock::default();
        clock.sleep_until(Moment::from_elapsed(Duration::from_secs(3600)));
        clock.sleep_until(Moment::from_elapsed(Duration::from_secs(1)));
        assert_eq!(clock.now(), Moment::from_elapsed(Duration::from_secs(3600)));
    }
}
