//! Interpolation of the cosine to the time of the sine, for adapters that convert the signals one after the other. The
//! cosine is sampled later by a fraction of the sampling interval, so its value at the time of the sine lies between
//! the previous sample and this one. It is interpolated with the cubic polynomial through the four nearest samples.

use std::collections::VecDeque;

/// State for interpolating consecutive cosine samples.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct SkewCorrection {
    /// Delay of the cosine as a fraction of the interval, above 0 and below 1.
    share: f64,
    /// The latest cosine samples of the previous batch, at most three.
    before: VecDeque<f64>,
}

/// Number of samples used for one interpolated value.
const POINTS: usize = 4;

impl SkewCorrection {
    /// Creates the correction from a delay and a sampling interval in nanoseconds. Returns `None` if both signals are
    /// sampled at the same time, or if the delay is not below the interval.
    pub(super) fn new(skew_ns: u16, period_ns: i64) -> Option<Self> {
        let share = f64::from(skew_ns) / period_ns.max(1) as f64;
        (share > 0.0 && share < 1.0).then(|| SkewCorrection { share, before: VecDeque::new() })
    }

    /// Discards the previous samples. Call this when samples are missing.
    pub(super) fn reset(&mut self) {
        self.before.clear();
    }

    /// Replaces each cosine with its value at the time of the sine.
    pub(super) fn apply(&mut self, samples: &mut [(i16, i16)]) {
        let start = self.before.len();
        let cosines: Vec<f64> =
            self.before.iter().copied().chain(samples.iter().map(|(_, cosine)| f64::from(*cosine))).collect();
        for (at, (_, cosine)) in samples.iter_mut().enumerate() {
            let first = (start + at).saturating_sub(POINTS / 2).min(cosines.len().saturating_sub(POINTS));
            let points = cosines.get(first..).unwrap_or_default();
            let place = (start + at - first) as f64 - self.share;
            // The result is saturated in the same way as in the converter.
            *cosine = interpolate(points.get(..POINTS).unwrap_or(points), place).round() as i16;
        }
        self.before = cosines.iter().rev().take(POINTS - 1).rev().copied().collect();
    }
}

/// Evaluates, at `place`, the Lagrange polynomial that passes through `points` at 0, 1, 2 and so on.
fn interpolate(points: &[f64], place: f64) -> f64 {
    let weight = |own: usize| -> f64 {
        let others = (0..points.len()).filter(|other| *other != own);
        others.map(|other| (place - other as f64) / (own as f64 - other as f64)).product()
    };
    points.iter().enumerate().map(|(own, point)| point * weight(own)).sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::TAU;

    /// Returns samples of a sine and a cosine of `hz` with an amplitude of 20 000. They are taken every 10 µs, and the
    /// cosine is sampled 2 µs late.
    fn sampled(hz: f64, count: usize) -> Vec<(i16, i16)> {
        let value = |angle: f64| (20_000.0 * angle).round() as i16;
        let at = |sample: usize, late: f64| TAU * hz * (sample as f64 * 10e-6 + late);
        (0..count).map(|sample| (value(at(sample, 0.0).sin()), value(at(sample, 2e-6).cos()))).collect()
    }

    /// Returns the largest error of the angle in degrees after a correction in chunks of the given lengths.
    fn largest_error(hz: f64, portions: &[usize]) -> f64 {
        let mut samples = sampled(hz, portions.iter().sum());
        let mut correction = SkewCorrection::new(2_000, 10_000).unwrap();
        let mut rest = samples.as_mut_slice();
        for length in portions {
            let (portion, behind) = std::mem::take(&mut rest).split_at_mut(*length);
            correction.apply(portion);
            rest = behind;
        }
        let error = |(sample, (sine, cosine)): (usize, &(i16, i16))| {
            let angle = f64::from(*sine).atan2(f64::from(*cosine)) - TAU * hz * sample as f64 * 10e-6;
            (angle - TAU * (angle / TAU).round()).to_degrees().abs()
        };
        // The first sample has no predecessor and is extrapolated.
        samples.iter().enumerate().skip(1).map(error).fold(0.0, f64::max)
    }

    /// Without the correction, a delay of 2 µs causes an angle error of 0.72° at 1 kHz and of 3.6° at 5 kHz.
    #[test]
    fn aligns_cosine_with_sine() {
        for (hz, limit) in [(50.0, 0.01), (1_000.0, 0.01), (5_000.0, 0.05), (10_000.0, 0.5)] {
            let error = largest_error(hz, &[1000]);
            assert!(error < limit, "{hz} Hz: {error}°");
        }
    }

    #[test]
    fn continues_across_packet_lengths() {
        for portions in [vec![124; 8], vec![1; 100], vec![2, 3, 1, 50, 5]] {
            let error = largest_error(1_000.0, &portions);
            assert!(error < 0.05, "{portions:?}: {error}°");
        }
    }

    #[test]
    fn gap_discards_previous_samples() {
        let mut correction = SkewCorrection::new(2_000, 10_000).unwrap();
        correction.apply(&mut [(0, 32_767); 10]);
        correction.reset();
        let mut samples = [(0, -100); 10];
        correction.apply(&mut samples);
        assert_eq!(samples, [(0, -100); 10]);
    }

    #[test]
    fn keeps_simultaneous_signals() {
        assert_eq!(SkewCorrection::new(0, 10_000), None);
        assert_eq!(SkewCorrection::new(10_000, 10_000), None);
        let mut empty: [(i16, i16); 0] = [];
        SkewCorrection::new(1, 10).unwrap().apply(&mut empty);
    }
}
