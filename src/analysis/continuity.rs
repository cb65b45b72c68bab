//! Detects missing samples and times that go backwards in a capture. Quantities that depend on consecutive samples,
//! such as the number of periods for a frequency, are counted within continuous sections only.
//!
//! A time step longer than one and a half usual steps is a gap (U). The times in a table have few digits, so rounding
//! can turn equal steps into steps of two lengths. Steps that differ by one digit are therefore not gaps.

/// Factor by which a time step must exceed the usual step to be a gap.
const GAP: f64 = 1.5;
/// Approximate number of time steps from which the usual step is determined as the median.
const SAMPLED_STEPS: usize = 1 << 14;
/// Relative tolerance within which a time step is equal to the usual step.
const STEP_TOLERANCE: f64 = 0.01;
/// Minimum fraction of equal time steps in evenly spaced samples. If fewer steps are equal, the times are assumed to be
/// rounded.
const EVEN_STEP_SHARE: f64 = 0.9;

#[derive(Clone, Debug, Default, PartialEq)]
pub struct Continuity {
    /// Missing samples, or `None` if the capture has no gap or no times.
    pub missing: Option<MissingSamples>,
    /// Index of the first sample that is earlier than its predecessor, counted from 0.
    pub first_backward_sample: Option<usize>,
    /// Total duration of the continuous sections in seconds, or `None` without times.
    pub continuous_s: Option<f64>,
    /// Index of the first sample of each continuous section, except the first section.
    pub(super) breaks: Vec<usize>,
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MissingSamples {
    pub gaps: usize,
    pub longest_s: f64,
}

impl Continuity {
    /// Checks the continuity of times given in seconds.
    pub fn from_times(times_s: &[f64]) -> Self {
        let Some(longest_even) = longest_even_step(times_s) else { return Continuity::default() };
        let mut continuity = Continuity::default();
        let mut lost_s = 0.0;
        for (before, pair) in times_s.windows(2).enumerate() {
            let [from, to] = pair else { continue };
            let step = to - from;
            if (0.0..=longest_even).contains(&step) {
                continue;
            }
            lost_s += step;
            continuity.breaks.push(before + 1);
            if step < 0.0 {
                continuity.first_backward_sample = continuity.first_backward_sample.or(Some(before + 1));
            } else {
                let missing = continuity.missing.get_or_insert(MissingSamples { gaps: 0, longest_s: 0.0 });
                missing.gaps += 1;
                missing.longest_s = missing.longest_s.max(step);
            }
        }
        let whole_s = times_s.last().zip(times_s.first()).map(|(last, first)| last - first - lost_s);
        continuity.continuous_s = whole_s.filter(|seconds| seconds.is_finite() && *seconds > 0.0);
        continuity
    }
}

/// Returns the longest time step in seconds that does not count as a gap. Returns `None` if the times do not advance.
fn longest_even_step(times_s: &[f64]) -> Option<f64> {
    // An odd stride does not fall in step with a pattern of length 2ⁿ.
    let stride = (times_s.len() / SAMPLED_STEPS) | 1;
    let mut steps: Vec<f64> = times_s.windows(2).step_by(stride).filter_map(time_step).collect();
    let middle = steps.len() / 2;
    let median = (middle < steps.len()).then(|| *steps.select_nth_unstable_by(middle, f64::total_cmp).1)?;
    let forward = || steps.iter().filter(|step| **step >= 0.0);
    // If the samples are closer together than the digits of the times can resolve, most steps are zero.
    let usual = if median > 0.0 { median } else { forward().sum::<f64>() / forward().count().max(1) as f64 };
    let same = steps.iter().filter(|step| (**step / usual - 1.0).abs() <= STEP_TOLERANCE).count();
    let digit = if same as f64 >= EVEN_STEP_SHARE * steps.len() as f64 { 0.0 } else { last_digit(times_s, stride) };
    // Rounding must not turn a step exactly at the limit into a gap.
    let longest = (GAP * usual + digit) * (1.0 + 1e-6);
    (longest.is_finite() && longest > 0.0).then_some(longest)
}

fn time_step(pair: &[f64]) -> Option<f64> {
    match pair {
        [from, to] => Some(to - from),
        _ => None,
    }
}

/// Returns the weight of the last decimal digit of the times, in seconds. Returns 0 below a nanosecond.
fn last_digit(times_s: &[f64], stride: usize) -> f64 {
    let is_whole = |value: f64| (value - value.round()).abs() <= 1e-3;
    let fits = |places: &i32| times_s.iter().step_by(stride).all(|time| is_whole(time * 10_f64.powi(*places)));
    (0..=9).find(fits).map_or(0.0, |places| 10_f64.powi(-places))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn times(count: i32, of: impl Fn(f64) -> f64) -> Vec<f64> {
        (0..count).map(|at| of(f64::from(at))).collect()
    }

    #[track_caller]
    fn near(found: Option<f64>, expected: f64) {
        assert!(found.is_some_and(|found| (found - expected).abs() < 1e-9), "{found:?} instead of {expected}");
    }

    #[test]
    fn missing_rows_leave_gap() {
        // 2.5 µs per row, with 799 rows missing after row 1000: one step of 800 intervals.
        let mut capture = times(4000, |at| at * 2.5e-6);
        capture.drain(1000..1799);
        let told = Continuity::from_times(&capture);
        let missing = told.missing.unwrap();
        assert_eq!((missing.gaps, told.breaks.as_slice(), told.first_backward_sample), (1, [1000].as_slice(), None));
        near(Some(missing.longest_s), 2e-3);
        // 3201 rows have 3199 usual steps.
        near(told.continuous_s, 3199.0 * 2.5e-6);
        let mut one = times(100, |at| at * 1e-3);
        one.remove(50);
        assert_eq!(Continuity::from_times(&one).breaks, [50], "a single sample");
    }

    #[test]
    fn locates_backward_time_step() {
        // Two recordings in one file.
        let capture = times(2000, |at| (at % 1000.0) * 1e-5);
        let told = Continuity::from_times(&capture);
        assert_eq!(
            (told.first_backward_sample, told.missing, told.breaks.as_slice()),
            (Some(1000), None, [1000].as_slice())
        );
        near(told.continuous_s, 2.0 * 999e-5);
    }

    #[test]
    fn rounded_times_are_not_gaps() {
        for (label, step, digit) in [
            ("two and three digits", 2.5e-6, 1e-6),
            ("one and two", 1.5e-6, 1e-6),
            ("none and one", 0.3e-6, 1e-6),
            ("exact", 1e-3, 1e-3),
        ] {
            let told = Continuity::from_times(&times(5000, |at| (at * step / digit + 1e-6).floor() * digit));
            assert_eq!((told.missing, told.first_backward_sample, told.breaks.len()), (None, None, 0), "{label}");
        }
        let mut gap = times(5000, |at| (at * 2.5).floor() * 1e-6);
        gap.drain(100..110);
        assert_eq!(Continuity::from_times(&gap).breaks, [100], "27 or 28 µs are one");
    }

    #[test]
    fn reports_nothing_without_times() {
        for nothing in [&[][..], &[1.0], &[1.0, 1.0, 1.0], &[f64::NAN, f64::NAN, f64::NAN]] {
            assert_eq!(Continuity::from_times(nothing), Continuity::default(), "{nothing:?}");
        }
        assert_eq!(Continuity::from_times(&[3.0, 2.0, 1.0]).continuous_s, None, "backwards all along");
    }
}
