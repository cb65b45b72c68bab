//! Interval of frames while live values arrive. Where software draws the window, as in a virtual machine, a frame costs
//! far more processor time. Frames are then further apart, which leaves the processor to other programs.

use std::time::Duration;

/// Shortest interval, at which motion looks smooth.
const SHORTEST: Duration = Duration::from_millis(50);
/// Longest interval, at which values can still be followed.
const LONGEST: Duration = Duration::from_millis(125);
/// Share of one processor core that the whole program may use while it displays live values.
const SHARE: f64 = 0.2;
/// Time over which the share is measured.
const MEASURED: Duration = Duration::from_secs(1);

pub(super) struct LivePace {
    interval: Duration,
    /// Time of the last measurement, and the processor time used by then.
    last: Option<(Duration, Duration)>,
}

impl Default for LivePace {
    fn default() -> Self {
        LivePace { interval: SHORTEST, last: None }
    }
}

impl LivePace {
    /// Returns the interval to the frame after the one at `now`, on the clock of the window. `used` is the processor
    /// time of the program so far, if the system reports it.
    pub(super) fn next(&mut self, now: Duration, used: Option<Duration>) -> Duration {
        let Some(used) = used else { return self.interval };
        let Some((since, before)) = self.last else {
            self.last = Some((now, used));
            return self.interval;
        };
        let elapsed = now.saturating_sub(since);
        if elapsed >= MEASURED {
            self.last = Some((now, used));
            // After a pause without live values, the measured share does not describe them.
            if elapsed < 2 * MEASURED {
                let share = used.saturating_sub(before).as_secs_f64() / elapsed.as_secs_f64();
                let wanted = self.interval.mul_f64((share / SHARE).clamp(0.5, 2.0));
                self.interval = ((self.interval + wanted) / 2).clamp(SHORTEST, LONGEST);
            }
        }
        self.interval
    }
}

/// Returns the processor time that all threads of the program have used. Returns `None` if the system does not report
/// it.
#[cfg(unix)]
pub(super) fn processor_time() -> Option<Duration> {
    let time = rustix::time::clock_gettime(rustix::time::ClockId::ProcessCPUTime);
    Some(Duration::new(u64::try_from(time.tv_sec).ok()?, u32::try_from(time.tv_nsec).ok()?))
}

/// Returns the processor time that all threads of the program have used. Returns `None` if the system does not report
/// it.
#[cfg(windows)]
pub(super) fn processor_time() -> Option<Duration> {
    let (_, _, kernel, user) = winsafe::HPROCESS::GetCurrentProcess().GetProcessTimes().ok()?;
    // Counts of 100 ns.
    let counts = u64::from(kernel).checked_add(u64::from(user))?;
    Some(Duration::from_nanos(counts.checked_mul(100)?))
}

/// Returns the processor time that all threads of the program have used. Returns `None` if the system does not report
/// it.
#[cfg(not(any(unix, windows)))]
pub(super) fn processor_time() -> Option<Duration> {
    None
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Returns the interval after 20 seconds in which each frame costs `cost` of processor time.
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
    fn frames_are_as_far_apart_as_their_cost_requires() {
        assert_eq!(settled(Duration::from_millis(2)), SHORTEST, "2 of 50 ms are 4 %");
        let interval = settled(Duration::from_millis(18));
        assert!((85..=95).contains(&interval.as_millis()), "18 of 90 ms are 20 %: {interval:?}");
        assert_eq!(settled(Duration::from_millis(60)), LONGEST);
    }

    #[test]
    fn the_interval_returns_when_frames_become_cheap() {
        let (now, second) = (Duration::ZERO, Duration::from_secs(1));
        let mut pace = LivePace { interval: LONGEST, last: Some((now, Duration::ZERO)) };
        for seconds in 1..=10 {
            pace.next(now + seconds * second, Some(seconds * Duration::from_millis(20)));
        }
        assert_eq!(pace.interval, SHORTEST);
        let mut unknown = LivePace::default();
        assert_eq!(unknown.next(now, None), SHORTEST);
        // A break of an hour, in which much was computed.
        let mut paused = LivePace { interval: SHORTEST, last: Some((now, Duration::ZERO)) };
        assert_eq!(paused.next(now + 3600 * second, Some(3600 * second)), SHORTEST);
    }
}
