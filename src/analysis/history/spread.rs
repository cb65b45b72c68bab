//! Mean and deviation that can be combined from parts, and stay accurate for small noise on a large value. They are
//! computed from raw samples only, with Welford's recurrence for groups (Chan, Golub, LeVeque 1979).

use super::number::Number;

/// Count, mean, sum of squared deviations and range of a set of samples.
#[derive(Clone, Copy, Debug)]
pub(super) struct RunningStatistics<T> {
    pub(super) count: u64,
    pub(super) base: T,
    pub(super) mean: f64,
    pub(super) squares: f64,
    pub(super) min: T,
    pub(super) max: T,
}

impl<T: Number> RunningStatistics<T> {
    /// Returns the statistics of `values`, which must all be finite. Returns `None` if `values` is empty.
    pub(super) fn from_values(values: &[T]) -> Option<Self> {
        let base = *values.first()?;
        let (min, max) = min_and_max(values)?;
        let count = values.len() as f64;
        let mean = sum(values, |value| value.difference_from(base)) / count;
        let squares = sum(values, |value| {
            let deviation = value.difference_from(base) - mean;
            deviation * deviation
        });
        Some(RunningStatistics { count: values.len() as u64, base, mean, squares, min, max })
    }

    /// Returns the combined statistics of both sets of samples.
    pub(super) fn merge(self, other: Self) -> Self {
        let (own, others) = (self.count as f64, other.count as f64);
        let all = own + others;
        let apart = other.base.difference_from(self.base) + other.mean - self.mean;
        RunningStatistics {
            count: self.count + other.count,
            base: self.base,
            mean: self.mean + apart * (others / all),
            squares: self.squares + other.squares + apart * apart * (own * others / all),
            min: if other.min < self.min { other.min } else { self.min },
            max: if other.max > self.max { other.max } else { self.max },
        }
    }
}

pub(super) fn combine_spreads<T: Number>(
    one: Option<RunningStatistics<T>>,
    other: Option<RunningStatistics<T>>,
) -> Option<RunningStatistics<T>> {
    match (one, other) {
        (Some(one), Some(other)) => Some(one.merge(other)),
        (one, other) => one.or(other),
    }
}

/// Returns the minimum and maximum of `values`, which must all be finite. Eight values are compared in parallel.
pub(super) fn min_and_max<T: Number>(values: &[T]) -> Option<(T, T)> {
    let (groups, rest) = values.as_chunks::<8>();
    let of_groups = groups.split_first().map(|(first, others)| {
        let (mut least, mut most) = (*first, *first);
        for group in others {
            for ((least, most), value) in least.iter_mut().zip(&mut most).zip(group) {
                *least = smaller_number(*least, *value);
                *most = larger_number(*most, *value);
            }
        }
        (reduce_eight(least, smaller_number), reduce_eight(most, larger_number))
    });
    let start = of_groups.or_else(|| rest.first().map(|first| (*first, *first)))?;
    Some(rest.iter().fold(start, |(least, most), value| (smaller_number(least, *value), larger_number(most, *value))))
}

pub(super) fn min_max_of_eight<T: Number>(values: &[T; 8]) -> (T, T) {
    (reduce_eight(*values, smaller_number), reduce_eight(*values, larger_number))
}

/// Reduces eight values pairwise, so that fewer operations have to wait for a previous result.
fn reduce_eight<T: Number>([a, b, c, d, e, f, g, h]: [T; 8], choose: impl Fn(T, T) -> T) -> T {
    choose(choose(choose(a, e), choose(b, f)), choose(choose(c, g), choose(d, h)))
}

fn smaller_number<T: Number>(one: T, other: T) -> T {
    if other < one { other } else { one }
}

fn larger_number<T: Number>(one: T, other: T) -> T {
    if other > one { other } else { one }
}

/// Sums the terms in eight parallel sums, which take little more time than a single sum.
fn sum<T: Number>(values: &[T], term: impl Fn(T) -> f64) -> f64 {
    let (groups, rest) = values.as_chunks::<8>();
    let mut sums = [0.0; 8];
    for group in groups {
        for (sum, value) in sums.iter_mut().zip(group) {
            *sum += term(*value);
        }
    }
    sums.iter().sum::<f64>() + rest.iter().map(|value| term(*value)).sum::<f64>()
}
