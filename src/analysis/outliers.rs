//! Detection of samples far from the ellipse, such as those caused by a relay spark or a loose contact. Even a few such
//! outliers would distort an ellipse fitted by least squares. They are found by a robust measure, the median of the
//! distances, then reported and left out of a second fit.

use std::ops::Range;

use super::coverage::Coverage;
use super::ellipse::{Ellipse, FitError, SignalChannel};
use super::moments::{Moments, Scale};

/// Samples excluded from a fit.
#[derive(Clone, Debug, PartialEq)]
pub struct Outliers {
    /// Ranges of outliers by sample index, counted from 0, in ascending order. The ranges do not touch each other.
    pub excluded_ranges: Vec<Range<usize>>,
    pub count: usize,
    pub longest: usize,
    /// Largest distance of an outlier from the ellipse, in volts.
    pub farthest_v: f64,
    /// Ellipse fitted to all samples, and its coverage, or `None` if the samples do not determine an ellipse.
    pub all: Option<(Ellipse, Coverage)>,
}

/// A sample is left out if its distance exceeds this number of robust deviations. Normally distributed noise exceeds it
/// in one of 10¹⁵ samples.
pub const OUTLIER_DEVIATIONS: f64 = 8.0;
/// Distance, as a fraction of the amplitude, within which a sample is never an outlier, however low the noise is.
pub const MIN_OUTLIER_DISTANCE: f64 = 0.02;
/// Maximum fraction of outliers. If more samples deviate, they are considered part of the signal.
pub const MAX_OUTLIER_SHARE: f64 = 0.05;
/// Minimum number of samples required to recognise outliers.
pub const MIN_SAMPLES: usize = 50;

/// Approximate number of evenly spread samples used to determine a median.
const MEDIAN_SAMPLES: usize = 1 << 15;
/// Maximum number of fits without outliers. The search ends earlier if the outliers no longer change.
const MAX_FITS: usize = 4;
/// Ratio of a normal distribution's standard deviation to the median of its distances from zero.
const NORMAL_DEVIATION_RATIO: f64 = 1.4826;
/// Maximum median distance from an upright ellipse, as a fraction of its amplitude. Above it, the samples lie on no
/// ellipse. A cloud of samples has a median distance of 0.3.
const MAX_MEDIAN_DISTANCE: f64 = 0.15;
/// A channel is constant if its range is below this fraction of the other channel's range.
const DEAD_CHANNEL_FRACTION: f64 = 0.05;

pub(super) enum OutlierResult {
    /// No outliers were found, or too many samples deviate to be outliers.
    Nothing,
    Outliers(Ellipse, Outliers),
}

/// Searches for outliers. `all` is the ellipse fitted to all samples, if known.
pub(super) fn find(sine: &[f64], cosine: &[f64], all: Option<&Ellipse>) -> OutlierResult {
    let count = sine.len().min(cosine.len());
    if count < MIN_SAMPLES {
        return OutlierResult::Nothing;
    }
    // An odd stride does not lock onto a period of 2ⁿ samples.
    let stride = (count / MEDIAN_SAMPLES) | 1;
    let sampled = |values: &[f64]| values.iter().take(count).step_by(stride).copied().collect::<Vec<f64>>();
    let (ys, xs) = (sampled(sine), sampled(cosine));
    // An ellipse distorted by an outlier misses the other samples. The upright ellipse is used if it fits them better.
    let upright = ellipse_from_quantiles(&ys, &xs)
        .ok()
        .filter(|boxed| median_deviation(&ys, &xs, boxed) < MAX_MEDIAN_DISTANCE * boxed.amplitude_v);
    let start = match (all, upright) {
        (Some(all), Some(upright)) => {
            let off = median_deviation(&ys, &xs, all);
            let misses = off > MIN_OUTLIER_DISTANCE * upright.amplitude_v && off > median_deviation(&ys, &xs, &upright);
            if misses { upright } else { *all }
        }
        (Some(all), None) => *all,
        (None, Some(upright)) => upright,
        (None, None) => return OutlierResult::Nothing,
    };
    let mut ellipse = start;
    let mut excluded_ranges: Vec<Range<usize>> = Vec::new();
    for round in 0..MAX_FITS {
        let limit = (OUTLIER_DEVIATIONS * NORMAL_DEVIATION_RATIO * median_deviation(&ys, &xs, &ellipse))
            .max(MIN_OUTLIER_DISTANCE * ellipse.amplitude_v);
        let found = find_outliers(sine, cosine, &ellipse, limit);
        let left_out: usize = found.iter().map(Range::len).sum();
        if left_out as f64 > MAX_OUTLIER_SHARE * count as f64 {
            return OutlierResult::Nothing;
        }
        if (round > 0 || Some(&ellipse) == all) && found == excluded_ranges {
            break;
        }
        excluded_ranges = found;
        let scale = Scale::new(ellipse.offset_sine_v, ellipse.offset_cosine_v, ellipse.amplitude_v);
        match fit_remaining_samples(sine, cosine, &excluded_ranges, scale) {
            Ok(better) => ellipse = better,
            Err(_) => return OutlierResult::Nothing,
        }
    }
    if excluded_ranges.is_empty() {
        return OutlierResult::Nothing;
    }
    let outliers = Outliers {
        count: excluded_ranges.iter().map(Range::len).sum(),
        longest: excluded_ranges.iter().map(Range::len).max().unwrap_or(0),
        farthest_v: max_distance(sine, cosine, &excluded_ranges, &ellipse),
        all: all.and_then(|all| Some((*all, Coverage::measure(sine, cosine, all)?))),
        excluded_ranges,
    };
    OutlierResult::Outliers(ellipse, outliers)
}

/// Returns the channel that is constant except for single samples, or `None` if both channels move.
pub(super) fn dead_channel(sine: &[f64], cosine: &[f64]) -> Option<SignalChannel> {
    let few = sine.len().min(cosine.len()) < MIN_SAMPLES;
    ellipse_from_quantiles(sine, cosine).err().flatten().filter(|_| !few)
}

/// Returns the ranges of `length` samples that remain after the ranges in `left_out` are removed.
pub(crate) fn remaining_ranges(length: usize, left_out: &[Range<usize>]) -> impl Iterator<Item = Range<usize>> {
    let starts = std::iter::once(0).chain(left_out.iter().map(|stretch| stretch.end));
    let ends = left_out.iter().map(|stretch| stretch.start).chain(std::iter::once(length));
    starts.zip(ends).filter(|(start, end)| start < end).map(|(start, end)| start..end)
}

fn fit_remaining_samples(
    sine: &[f64],
    cosine: &[f64],
    left_out: &[Range<usize>],
    scale: Scale,
) -> Result<Ellipse, FitError> {
    let mut moments = Moments::new(scale);
    for part in remaining_ranges(sine.len().min(cosine.len()), left_out) {
        moments.add_samples(sine.get(part.clone()).unwrap_or_default(), cosine.get(part).unwrap_or_default())?;
    }
    Ellipse::from_moments(&moments)
}

/// Returns an upright ellipse derived from quantiles, which a few outliers do not affect.
///
/// # Errors
/// Returns the constant channel, or `None` if both channels are constant.
fn ellipse_from_quantiles(sine: &[f64], cosine: &[f64]) -> Result<Ellipse, Option<SignalChannel>> {
    /// Fraction of samples beyond each quantile. A sine is outside cos(0.05·π) of its amplitude for a tenth of the
    /// time.
    const QUANTILE_SHARE: f64 = 0.05;
    let reach = (QUANTILE_SHARE * std::f64::consts::PI).cos();
    let channel = |values: &[f64]| {
        let mut values = values.to_vec();
        let (last, rank) = (values.len().saturating_sub(1), (values.len() as f64 * QUANTILE_SHARE) as usize);
        let low = value_at_rank(&mut values, rank);
        let high = value_at_rank(&mut values, last.saturating_sub(rank));
        ((low + high) / 2.0, (high - low) / 2.0 / reach)
    };
    let ((offset_sine_v, sine_v), (offset_cosine_v, amplitude_v)) = (channel(sine), channel(cosine));
    let most = sine_v.max(amplitude_v);
    // A constant 2.5 V still varies by a few units in the last place.
    if most <= 1e-9 * offset_sine_v.abs().max(offset_cosine_v.abs()) {
        Err(None)
    } else if sine_v < DEAD_CHANNEL_FRACTION * most {
        Err(Some(SignalChannel::Sine))
    } else if amplitude_v < DEAD_CHANNEL_FRACTION * most {
        Err(Some(SignalChannel::Cosine))
    } else {
        let gain_ratio = amplitude_v / sine_v;
        Ok(Ellipse { amplitude_v, offset_cosine_v, offset_sine_v, gain_ratio, phase_error_rad: 0.0 })
    }
}

/// Returns the median distance of the samples from an ellipse, in volts on its corrected circle.
fn median_deviation(sine: &[f64], cosine: &[f64], ellipse: &Ellipse) -> f64 {
    let correction = ellipse.correction();
    let off = |(y, x): (&f64, &f64)| {
        let (y, x) = correction.apply(*y, *x);
        (y.hypot(x) - ellipse.amplitude_v).abs()
    };
    let mut offs: Vec<f64> = sine.iter().zip(cosine).map(off).collect();
    let middle = offs.len() / 2;
    value_at_rank(&mut offs, middle)
}

/// Returns the value with the given rank. Rank 0 is the smallest value.
fn value_at_rank(values: &mut [f64], rank: usize) -> f64 {
    if rank < values.len() { *values.select_nth_unstable_by(rank, f64::total_cmp).1 } else { f64::NAN }
}

/// Returns the ranges of samples farther from the ellipse than `limit` volts.
fn find_outliers(sine: &[f64], cosine: &[f64], ellipse: &Ellipse, limit: f64) -> Vec<Range<usize>> {
    /// Number of samples that are checked at a time, because usually none of them is an outlier.
    const BLOCK: usize = 256;
    let correction = ellipse.correction();
    let squared = |volts: f64| volts * volts;
    let (least, most) = (squared((ellipse.amplitude_v - limit).max(0.0)), squared(ellipse.amplitude_v + limit));
    let is_beyond = |y: &f64, x: &f64| {
        let (y, x) = correction.apply(*y, *x);
        let square = y * y + x * x;
        (square > most) | (square < least)
    };
    let mut excluded_ranges: Vec<Range<usize>> = Vec::new();
    for (block, (ys, xs)) in sine.chunks(BLOCK).zip(cosine.chunks(BLOCK)).enumerate() {
        if !ys.iter().zip(xs).fold(false, |any, (y, x)| any | is_beyond(y, x)) {
            continue;
        }
        for at in ys.iter().zip(xs).enumerate().filter(|(_, (y, x))| is_beyond(y, x)).map(|(at, _)| block * BLOCK + at)
        {
            match excluded_ranges.last_mut() {
                Some(last) if last.end == at => last.end = at + 1,
                _ => excluded_ranges.push(at..at + 1),
            }
        }
    }
    excluded_ranges
}

fn max_distance(sine: &[f64], cosine: &[f64], excluded_ranges: &[Range<usize>], ellipse: &Ellipse) -> f64 {
    let correction = ellipse.correction();
    let samples = excluded_ranges.iter().flat_map(|part| {
        sine.get(part.clone()).unwrap_or_default().iter().zip(cosine.get(part.clone()).unwrap_or_default())
    });
    samples.fold(0.0, |most: f64, (y, x)| {
        let (y, x) = correction.apply(*y, *x);
        most.max((y.hypot(x) - ellipse.amplitude_v).abs())
    })
}

#[cfg(test)]
mod tests;
