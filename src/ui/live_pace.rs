//! Adjusts the frame interval while live values arrive. If the window is drawn in software, as in a virtual machine, a
//! frame costs far more processor time, so the interval is longer.

use std::time::Duration;

/// Minimum interval. At this interval, motion looks smooth.
const MIN_INTERVAL: Duration = Duration::from_millis(50);
/// Maximum interval. At this interval, the user can still follow the values.
const MAX_INTERVAL: Duration = Duration::from_millis(125);
/// Fraction of one processor core that the whole program may use while displaying live values.
const PROCESSOR_SHARE: f64 = 0.2;
/// Time over which processor usage is measured.
const MEASURING_TIME: Duration = Duration::from_secs(1);

pub(super) struct LivePace {
    interval: Duration,
    /// Time of the last measurement, and processor time used up to it.
    last: Option<(Duration, Duration)>,
}

impl Default for LivePace {
    fn default() -> Self {
        LivePace { interval: MIN_INTERVAL, last: None }
    }
}

impl LivePace {
    /// Returns the interval between the frame at `now`, on the window's clock, and the next frame. `used` is the
    /// processor time that the program has used so far, if the system reports it.
    pub(super) fn next(&mut self, now: Duration, used: Option<Duration>) -> Duration {
        let Some(used) = used else { return self.interval };
        let Some((since, before)) = self.last else {
            self.last = Some((now, used));
            return self.interval;
        };
        let elapsed = now.saturating_sub(since);
        if elapsed >= MEASURING_TIME {
            self.last = Some((now, used));
            // After a pause without live values, the measured usage does not apply to them.
            if elapsed < 2 * MEASURING_TIME {
                let share = used.saturating_sub(before).as_secs_f64() / elapsed.as_secs_f64();
                let wanted = self.interval.mul_f64((share / PROCESSOR_SHARE).clamp(0.5, 2.0));
                self.interval = ((self.interval + wanted) / 2).clamp(MIN_INTERVAL, MAX_INTERVAL);
            }
        }
        self.interval
    }
}

/// Returns the processor time used by all threads of the program, or `None` if the system does not report it.
#[cfg(unix)]
pub(super) fn processor_time() -> Option<Duration> {
    let time = rustix::time::clock_gettime(rustix::time::ClockId::ProcessCPUTime);
    Some(Duration::new(u64::try_from(time.tv_sec).ok()?, u32::try_from(time.tv_nsec).ok()?))
}

/// Returns the processor time used by all threads of the program, or `None` if the system does not report it.
#[cfg(windows)]
pub(super) fn processor_time() -> Option<Duration> {
    let (_, _, kernel, user) = winsafe::HPROCESS::GetCurrentProcess().GetProcessTimes().ok()?;
    // Units of 100 ns.
    let counts = u64::from(kernel).checked_add(u64::from(user))?;
    Some(Duration::from_nanos(counts.checked_mul(100)?))
}

/// Returns the processor time used by all threads of the program, or `None` if the system does not report it.
#[cfg(not(any(unix, windows)))]
pub(super) fn processor_time() -> Option<Duration> {
    None
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Returns the interval after 20 seconds if each frame takes `cost` of processor time.
    fn settled(cost: Duration) -> Duration {
        let (mut pace, mut now, mut used) = (LivePace::default(), Duration::ZERO, Duration::ZERO);
        let end = now + Duration::from_secs(20);
        while now < end {
            used += cost;
            now += pace.next(now, Some(used));
        }
        pace.interval
    }

    #[test]
    fn frame_interval_grows_with_cost() {
        assert_eq!(settled(Duration::from_millis(2)), MIN_INTERVAL, "2 of 50 ms are 4 %");
        let interval = settled(Duration::from_millis(18));
        assert!((85..=95).contains(&interval.as_millis()), "18 of 90 ms are 20 %: {interval:?}");
        assert_eq!(settled(Duration::from_millis(60)), MAX_INTERVAL);
    }

    #[test]
    fn frame_interval_recovers() {
        let (now, second) = (Duration::ZERO, Duration::from_secs(1));
        let mut pace = LivePace { interval: MAX_INTERVAL, last: Some((now, Duration::ZERO)) };
        for seconds in 1..=10 {
            pace.next(now + seconds * second, Some(seconds * Duration::from_millis(20)));
        }
        assert_eq!(pace.interval, MIN_INTERVAL);
        let mut unknown = LivePace::default();
        assert_eq!(unknown.next(now, None), MIN_INTERVAL);
        // A break of an hour, during which the program used a lot of processor time.
        let mut paused = LivePace { interval: MIN_INTERVAL, last: Some((now, Duration::ZERO)) };
        assert_eq!(paused.next(now + 3600 * second, Some(3600 * second)), MIN_INTERVAL);
    }
}
