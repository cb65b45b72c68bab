//! The motion of the shaft, derived from position readings: direction, speed, speed variation and standstill. The
//! monitor itself sends no requests.

use std::collections::VecDeque;
use std::time::Duration;

use crate::analysis::{PositionUnwrapper, SampleTime};
use crate::devices::biss::procedures::PositionReading;

#[derive(Debug)]
pub(super) struct SpeedMonitor {
    /// Duration of the window in nanoseconds.
    window: i64,
    unwrap: Option<PositionUnwrapper>,
    steps_per_turn: f64,
    /// Positions in the window, oldest first. The oldest was sampled at or before the start of the window.
    places: VecDeque<(SampleTime, i64)>,
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ShaftMotion {
    /// Mean speed in revolutions per minute, positive clockwise. Positions increase during clockwise rotation.
    pub rpm: f64,
    /// Largest difference between the speed in a quarter of the window and the mean speed, in revolutions per minute.
    pub spread: f64,
    pub travel: f64,
}

impl ShaftMotion {
    /// Allowed jitter of a shaft at rest, in revolutions. The jitter is not documented (`U`).
    const REST_JITTER: f64 = 1.0 / 8192.0;

    pub fn is_shaft_at_rest(&self) -> bool {
        self.travel <= Self::REST_JITTER
    }
}

impl SpeedMonitor {
    /// Number of equal parts of the window in which the speed is measured separately.
    const WINDOW_SECTION_COUNT: i32 = 4;

    pub(super) fn with_window(window: Duration) -> Self {
        let window = i64::try_from(window.as_nanos()).unwrap_or(i64::MAX).max(1);
        SpeedMonitor { window, unwrap: None, steps_per_turn: 1.0, places: VecDeque::new() }
    }

    pub(super) fn next(&mut self, reading: &PositionReading) {
        let bits = u32::from(reading.position_word().bits);
        self.steps_per_turn = f64::powi(2.0, reading.singleturn_bits.into());
        let range = 1_i64.checked_shl(bits).filter(|range| *range > 0);
        let unwrap = self.unwrap.get_or_insert_with(|| {
            range.and_then(PositionUnwrapper::rotary).unwrap_or_else(PositionUnwrapper::without_wrap)
        });
        let word = i64::try_from(reading.position()).unwrap_or(i64::MAX);
        let time = SampleTime::from(reading.at);
        let Some(place) = unwrap.next(word) else { return };
        if place.broken || self.places.back().is_some_and(|(before, _)| time <= *before) {
            self.places.clear();
        }
        self.places.push_back((time, place.steps));
        // The last position before the window provides the value at the start of the window.
        while self.places.get(1).is_some_and(|(second, _)| time.nanoseconds_since(*second) >= self.window) {
            self.places.pop_front();
        }
    }

    /// Returns the measured motion, or `None` until positions cover the whole window.
    pub(super) fn motion(&self) -> Option<ShaftMotion> {
        let ((first, _), (last, _)) = (self.places.front()?, self.places.back()?);
        if last.nanoseconds_since(*first) < self.window {
            return None;
        }
        let places: Vec<(f64, f64)> =
            self.places.iter().map(|(time, steps)| (time.seconds_since(*first), self.to_turns(*steps))).collect();
        let rpm = slope(&places)? * 60.0;
        let part = last.seconds_since(*first) / f64::from(Self::WINDOW_SECTION_COUNT);
        let mut spread: f64 = 0.0;
        for number in 0..Self::WINDOW_SECTION_COUNT {
            let (from, to) = (part * f64::from(number), part * f64::from(number + 1));
            let own: Vec<(f64, f64)> = places.iter().copied().filter(|(at, _)| (from..=to).contains(at)).collect();
            if let Some(slope) = slope(&own) {
                spread = spread.max((slope * 60.0 - rpm).abs());
            }
        }
        let turns = places.iter().map(|(_, turns)| *turns);
        let travel = turns.clone().fold(f64::MIN, f64::max) - turns.fold(f64::MAX, f64::min);
        Some(ShaftMotion { rpm, spread, travel })
    }

    /// Converts a number of steps since the first position of the window to revolutions.
    fn to_turns(&self, steps: i64) -> f64 {
        let first = self.places.front().map_or(steps, |(_, first)| *first);
        steps.saturating_sub(first) as f64 / self.steps_per_turn
    }
}

/// Returns the slope of a least-squares fit, or `None` if there are fewer than two points.
fn slope(places: &[(f64, f64)]) -> Option<f64> {
    let count = places.len() as f64;
    let mean = |values: &mut dyn Iterator<Item = f64>| values.sum::<f64>() / count;
    let middle = mean(&mut places.iter().map(|(at, _)| *at));
    let height = mean(&mut places.iter().map(|(_, turns)| *turns));
    let squares: f64 = places.iter().map(|(at, _)| (at - middle) * (at - middle)).sum();
    let products: f64 = places.iter().map(|(at, turns)| (at - middle) * (turns - height)).sum();
    (squares > 0.0).then(|| products / squares)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::units::Moment;

    const REVOLUTION: f64 = 131_072.0;

    fn reading(milliseconds: u64, turns: f64, multiturn_bits: u8) -> PositionReading {
        let range = f64::powi(2.0, multiturn_bits.into());
        let steps = (turns.rem_euclid(range) * REVOLUTION) as u64;
        PositionReading {
            at: Moment::from_elapsed(Duration::from_millis(milliseconds)),
            turns: (steps >> 17) as u32,
            steps: (steps & 0x1_FFFF) as u32,
            error: None,
            warning: None,
            crc_errors: 0,
            multiturn_bits,
            singleturn_bits: 17,
            is_split_known: true,
            frame: None,
        }
    }

    /// Returns the motion measured from positions every 20 ms for 1.2 s. `turns` gives the position at a time in
    /// seconds.
    fn measured(multiturn_bits: u8, turns: impl Fn(f64) -> f64) -> ShaftMotion {
        let mut gauge = SpeedMonitor::with_window(Duration::from_secs(1));
        for at in (0..=1200).step_by(20) {
            gauge.next(&reading(at, turns(at as f64 / 1000.0), multiturn_bits));
            assert_eq!(gauge.motion().is_some(), at >= 1000, "{at}");
        }
        gauge.motion().unwrap()
    }

    #[test]
    fn steady_shaft_yields_speed_and_direction() {
        // The shaft crosses the end of the range, or the encoder does not count turns. 500 rpm is 25/3 revolutions per
        // second.
        for (bits, rpm) in [(16, 500.0), (16, -500.0), (16, 2000.0), (0, 700.0), (0, -300.0)] {
            let motion = measured(bits, |seconds| 0.25 + seconds * rpm / 60.0);
            assert!((motion.rpm - rpm).abs() < 0.01 && motion.spread < 0.02, "{bits} {rpm}: {motion:?}");
            assert!((motion.travel - f64::abs(rpm) / 60.0).abs() < 0.001, "{motion:?}");
            assert!(!motion.is_shaft_at_rest());
        }
    }

    /// The speed rises from 490 to 510 rpm within one second, so that the mean speeds in the quarters are 492.5, 497.5,
    /// 502.5 and 507.5 rpm.
    #[test]
    fn accelerating_shaft_is_unsteady() {
        let motion = measured(16, |seconds| {
            let from = seconds - 0.2;
            from * 490.0 / 60.0 + from * from * 20.0 / 120.0
        });
        assert!((motion.rpm - 500.0).abs() < 0.1, "{motion:?}");
        assert!((motion.spread - 7.5).abs() < 0.1, "{motion:?}");
    }

    #[test]
    fn tolerates_jitter_at_rest() {
        let tremble = |steps: f64| {
            measured(16, move |seconds| 0.5 + if (seconds * 50.0) as i64 % 2 == 0 { steps / REVOLUTION } else { 0.0 })
        };
        assert!(tremble(16.0).is_shaft_at_rest(), "16 steps are 1/8192 of a revolution");
        assert!(!tremble(18.0).is_shaft_at_rest());
        // The shaft moves by half a degree per second.
        assert!(!measured(16, |seconds| seconds / 720.0).is_shaft_at_rest());
    }

    #[test]
    fn gap_restarts_measurement() {
        let mut gauge = SpeedMonitor::with_window(Duration::from_secs(1));
        for at in (0..=1000).step_by(20) {
            gauge.next(&reading(at, 0.0, 0));
        }
        assert!(gauge.motion().is_some());
        // The shaft may have turned half a revolution in either direction.
        gauge.next(&reading(1020, 0.5, 0));
        assert_eq!(gauge.motion(), None);
        // No speed can be calculated if no time has passed.
        gauge.next(&reading(1020, 0.5, 0));
        assert_eq!(gauge.motion(), None);
    }
}
