//! A real clock for hardware and for virtual devices in the window, and a virtual clock for tests.

use std::sync::atomic::{AtomicU64, Ordering};
use std::time::{Duration, Instant};

use crate::units::Moment;

/// A source of time that threads can wait on.
pub trait Clock: Send + Sync {
    /// Returns the current time.
    fn now(&self) -> Moment;

    /// Blocks until `moment`.
    fn sleep_until(&self, moment: Moment);
}

/// The computer's monotonic clock, which starts when the value is created.
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
        let left = moment.duration_since(self.now());
        if !left.is_zero() {
            std::thread::sleep(left);
        }
    }
}

/// Measures the resolution of the timer, which is the duration of the shortest sleep. Windows before version 10 (1803)
/// wakes threads only at ticks that are up to 15.6 ms apart.
pub fn measure_timer_step(clock: &dyn Clock) -> Duration {
    const SHORT_SLEEP: Duration = Duration::from_millis(1);
    let sleep = || {
        let began = clock.now();
        clock.sleep_until(began + SHORT_SLEEP);
        clock.now().duration_since(began)
    };
    // The first sleep may begin just before a tick, so it is ignored. The shortest of the others is used, because a
    // busy computer makes some of them longer.
    sleep();
    (0..4).map(|_| sleep()).min().unwrap_or_default()
}

/// A clock that advances only while a thread waits on it. Even a wait of an hour takes no real time.
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

    /// A clock whose sleeps end only at ticks of 15.625 ms.
    #[derive(Default)]
    struct TickingClock(VirtualClock);

    impl Clock for TickingClock {
        fn now(&self) -> Moment {
            self.0.now()
        }

        fn sleep_until(&self, moment: Moment) {
            let tick = 15_625_000;
            let ticks = moment.since_start().as_nanos().div_ceil(tick);
            self.0.sleep_until(Moment::from_elapsed(Duration::from_nanos(u64::try_from(ticks * tick).unwrap())));
        }
    }

    #[test]
    fn measures_timer_step() {
        assert_eq!(measure_timer_step(&VirtualClock::default()), Duration::from_millis(1));
        let ticking = TickingClock::default();
        ticking.0.sleep_until(Moment::from_elapsed(Duration::from_micros(14_000)));
        assert_eq!(measure_timer_step(&ticking), Duration::from_micros(15_625));
    }

    #[test]
    fn virtual_time_never_decreases() {
        let clock = VirtualClock::default();
        clock.sleep_until(Moment::from_elapsed(Duration::from_secs(3600)));
        clock.sleep_until(Moment::from_elapsed(Duration::from_secs(1)));
        assert_eq!(clock.now(), Moment::from_elapsed(Duration::from_secs(3600)));
    }
}
