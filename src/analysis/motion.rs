//! Speed and acceleration from unwrapped positions. Differences are taken over a period of time instead of a number of
//! samples, so faster polling does not make them noisier. A difference never spans a break.

use std::collections::VecDeque;

use super::SampleTime;

#[derive(Clone, Debug)]
pub struct Motion {
    /// Averaging window in nanoseconds, at least 1.
    window: i64,
    /// Positions within the last two windows, oldest first.
    recent: VecDeque<(SampleTime, i64)>,
}

#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct MotionRates {
    /// Speed in steps/s, averaged over the last window, or `None` until a window has passed. It applies to the middle
    /// of the window.
    pub speed: Option<f64>,
    /// Acceleration in steps/s² from the last two windows, or `None` until two windows have passed.
    pub acceleration: Option<f64>,
}

impl Motion {
    /// Divisor of the window that yields the minimum time between stored positions. Positions closer together are
    /// thinned out, which limits memory at any sample rate.
    const RESOLUTION: i64 = 1024;

    /// Creates averages over `window` nanoseconds, at least 1. If samples arrive more slowly than that, an average
    /// covers one sample interval.
    pub fn with_window(window: i64) -> Self {
        Motion { window: window.max(1), recent: VecDeque::with_capacity(4 * Self::RESOLUTION as usize + 16) }
    }

    /// Resets the averages. The next position is then treated as the first one.
    pub fn reset(&mut self) {
        self.recent.clear();
    }

    /// Processes the next position in steps and returns the rates. A position that is not later than the previous one
    /// yields no rates.
    pub fn next(&mut self, time: SampleTime, steps: i64) -> MotionRates {
        if self.recent.back().is_some_and(|(before, _)| time <= *before) {
            return MotionRates::default();
        }
        let middle = self.position_before(time.saturating_add_ns(-self.window));
        let oldest = middle.and_then(|(middle, _)| self.position_before(middle.saturating_add_ns(-self.window)));
        let speed = middle.map(|middle| slope(middle, (time, steps)));
        let acceleration = match (speed, middle, oldest) {
            (Some(speed), Some(middle), Some(oldest)) => {
                // The two slopes apply to the middles of their ranges.
                let apart = time.seconds_since(oldest.0) / 2.0;
                Some((speed - slope(oldest, middle)) / apart)
            }
            _ => None,
        };
        self.push(time, steps);
        MotionRates { speed, acceleration }
    }

    /// Returns the newest position at or before `time`, or `None` if there is none.
    fn position_before(&self, time: SampleTime) -> Option<(SampleTime, i64)> {
        let after = self.recent.partition_point(|(at, _)| *at <= time);
        self.recent.get(after.checked_sub(1)?).copied()
    }

    fn push(&mut self, time: SampleTime, steps: i64) {
        // The last position but one represents those close to it. The last one is always kept, because the next may
        // come much later.
        let crowded = self
            .recent
            .len()
            .checked_sub(2)
            .and_then(|at| self.recent.get(at))
            .is_some_and(|(before, _)| time.nanoseconds_since(*before) < self.window / Self::RESOLUTION);
        if crowded {
            self.recent.pop_back();
        }
        self.recent.push_back((time, steps));
        // One position older than two windows must stay, because a range starts there.
        let start = self
            .position_before(time.saturating_add_ns(-self.window))
            .and_then(|(middle, _)| self.position_before(middle.saturating_add_ns(-self.window)));
        while let (Some(start), Some(first)) = (start, self.recent.front())
            && first.0 < start.0
        {
            self.recent.pop_front();
        }
    }
}

/// Returns the speed in steps/s between two positions. `from` is the earlier one. The differences are exact before the
/// division.
fn slope(from: (SampleTime, i64), to: (SampleTime, i64)) -> f64 {
    to.1.saturating_sub(from.1) as f64 / to.0.seconds_since(from.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    const MILLISECOND: i64 = 1_000_000;

    fn at(milliseconds: i64) -> SampleTime {
        SampleTime::from_nanoseconds(milliseconds * MILLISECOND)
    }

    #[test]
    fn steady_speed_is_exact() {
        for (label, period) in [("slow", 250), ("as the window", 100), ("fast", 1)] {
            let mut motion = Motion::with_window(100 * MILLISECOND);
            let days = 10 * 86_400_000;
            let rates: Vec<MotionRates> =
                (0..1000).map(|k| motion.next(at(days + k * period), (1 << 50) + k * period * 3)).collect();
            assert_eq!(rates[0], MotionRates::default(), "{label}");
            assert_eq!(rates[999], MotionRates { speed: Some(3000.0), acceleration: Some(0.0) }, "{label}");
        }
    }

    #[test]
    fn parabola_has_constant_acceleration() {
        let mut motion = Motion::with_window(50 * MILLISECOND);
        let mut last = MotionRates::default();
        // Uneven periods: 7 and 13 ms.
        let mut now = 0;
        for k in 0..100 {
            last = motion.next(at(now), now * now);
            now += if k % 2 == 0 { 7 } else { 13 };
        }
        // steps = t² in ms²: 2 steps/ms² are 2e6 steps/s².
        assert!((last.acceleration.unwrap() - 2e6).abs() < 1e-3, "{last:?}");
    }

    #[test]
    fn first_window_and_breaks_have_no_speed() {
        let mut motion = Motion::with_window(10 * MILLISECOND);
        assert_eq!(motion.next(at(0), 0).speed, None);
        assert_eq!(motion.next(at(9), 9).speed, None);
        assert_eq!(motion.next(at(10), 10), MotionRates { speed: Some(1000.0), acceleration: None });
        assert_eq!(motion.next(at(10), 11), MotionRates::default());
        motion.reset();
        assert_eq!(motion.next(at(30), 1_000_000).speed, None);
        assert_eq!(motion.next(at(40), 1_000_000).speed, Some(0.0));
    }

    #[test]
    fn bounds_memory_at_any_rate() {
        let mut motion = Motion::with_window(1_000 * MILLISECOND);
        let capacity = motion.recent.capacity();
        let mut last = MotionRates::default();
        for k in 0..300_000 {
            last = motion.next(SampleTime::from_nanoseconds(k * 10_000), k);
        }
        assert_eq!(motion.recent.capacity(), capacity);
        assert!((last.speed.unwrap() - 100_000.0).abs() < 1e-6);
    }
}
