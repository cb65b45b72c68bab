//! Detection of harmonics, clipped channels, and an amplitude that varies over the revolution. None of the methods
//! needs evenly spaced samples.

use std::f64::consts::TAU;

use crate::analysis::ellipse::SignalChannel;
use crate::analysis::outliers::remaining_ranges;
use crate::analysis::position_error::Samples;
use crate::analysis::signal_analysis::Analysis;

/// Number of sectors per period in which the distance from the ellipse is averaged.
const SECTORS: usize = 64;
/// Maximum number of samples examined for harmonics.
const SAMPLES: usize = 1 << 18;
/// Orders examined in the averaged distance from the ellipse. The ellipse fit absorbs the first two orders.
const ORDERS: std::ops::RangeInclusive<usize> = 3..=8;
const SECTORS_PER_REVOLUTION: usize = 36;
/// Number of samples per period sufficient to follow the angle.
const SAMPLES_PER_PERIOD: f64 = 16.0;

/// Distance from the end of the range, as a fraction of the amplitude, within which a sample counts as being at that
/// end.
const END_DISTANCE: f64 = 0.002;
/// Minimum fraction of samples at the end of the range in a clipped channel. An unclipped sine has a third of this
/// fraction there: √(2·0.002)/π = 2 %.
const CLIPPED_FRACTION: f64 = 3.0 * 0.0201;
/// Minimum number of periods for the detection of clipping. If the shaft is at rest, all samples are at one level,
/// which looks like clipping.
const MIN_PERIODS: f64 = 2.0;
/// Minimum RMS distance of a clipped sine from its ellipse, as a fraction of the amplitude.
const MIN_RESIDUAL: f64 = 0.002;

/// Returns the strongest order in the distance from the ellipse over the period, and its peak as a fraction of the
/// amplitude. Returns `None` if part of the period has no samples.
pub(super) fn strongest_harmonic(samples: &Samples<'_>, analysis: &Analysis) -> Option<(usize, f64)> {
    let correction = analysis.ellipse.correction();
    let mut sectors = [(0.0, 0_u32); SECTORS];
    // An odd stride does not fall in step with a period of 2ⁿ samples.
    let stride = (analysis.samples / SAMPLES) | 1;
    for (y, x) in included_samples(samples, analysis).step_by(stride) {
        let (y, x) = correction.apply(y, x);
        let share = (y.atan2(x) / TAU).rem_euclid(1.0);
        if let Some((sum, count)) = sectors.get_mut((share * SECTORS as f64) as usize) {
            *sum += y.hypot(x) / analysis.ellipse.amplitude_v - 1.0;
            *count += 1;
        }
    }
    if sectors.iter().any(|(_, count)| *count == 0) {
        return None;
    }
    let order_of = |order: usize| {
        let (mut sine, mut cosine) = (0.0, 0.0);
        for (at, (sum, count)) in sectors.iter().enumerate() {
            let angle = TAU * order as f64 * at as f64 / SECTORS as f64;
            let height = sum / f64::from(*count);
            (sine, cosine) = (sine + height * angle.sin(), cosine + height * angle.cos());
        }
        // Averaging over a sector attenuates the higher orders.
        let half = TAU / 2.0 * order as f64 / SECTORS as f64;
        2.0 / SECTORS as f64 * f64::hypot(sine, cosine) * half / half.sin()
    };
    ORDERS.map(|order| (order, order_of(order))).max_by(|a, b| a.1.total_cmp(&b.1))
}

/// Returns the clipped channels, each with its clipping voltage and the fraction of samples at that voltage.
pub(super) fn find_clipping(samples: &Samples<'_>, analysis: &Analysis) -> Vec<(SignalChannel, f64, f64)> {
    if analysis.coverage.periods < MIN_PERIODS || analysis.coverage.residual_rms < MIN_RESIDUAL {
        return Vec::new();
    }
    let ellipse = &analysis.ellipse;
    let channels = [
        (
            SignalChannel::Sine,
            included_samples(samples, analysis).map(|(y, _)| y).collect::<Vec<f64>>(),
            ellipse.amplitude_sine_v(),
        ),
        (SignalChannel::Cosine, included_samples(samples, analysis).map(|(_, x)| x).collect(), ellipse.amplitude_v),
    ];
    let mut found = Vec::new();
    for (channel, values, amplitude) in channels {
        let least = values.iter().copied().fold(f64::INFINITY, f64::min);
        let most = values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        for end in [least, most] {
            let standing = values.iter().filter(|value| (*value - end).abs() <= END_DISTANCE * amplitude).count();
            let share = standing as f64 / values.len().max(1) as f64;
            if share >= CLIPPED_FRACTION {
                found.push((channel, end, share));
            }
        }
    }
    found
}

/// Returns the amplitude variation over a revolution of the given number of periods, as a fraction. Returns `None` if
/// the capture covers less than one revolution.
pub(super) fn amplitude_modulation(samples: &Samples<'_>, analysis: &Analysis, periods: u32) -> Option<f64> {
    let revolution = f64::from(periods);
    if periods == 0 || analysis.coverage.periods < revolution {
        return None;
    }
    let correction = analysis.ellipse.correction();
    let mut sectors = [(0.0, 0_u32); SECTORS_PER_REVOLUTION];
    let stride = ((analysis.samples as f64 / analysis.coverage.periods / SAMPLES_PER_PERIOD) as usize).max(1);
    let (mut place, mut last) = (0.0, None);
    for (y, x) in included_samples(samples, analysis).step_by(stride) {
        let (y, x) = correction.apply(y, x);
        let phase = y.atan2(x) / TAU;
        let step: f64 = phase - last.unwrap_or(phase);
        place += step - step.round();
        last = Some(phase);
        let share = (place / revolution).rem_euclid(1.0);
        if let Some((sum, count)) = sectors.get_mut((share * SECTORS_PER_REVOLUTION as f64) as usize) {
            *sum += y.hypot(x);
            *count += 1;
        }
    }
    if sectors.iter().any(|(_, count)| *count == 0) {
        return None;
    }
    let lengths = sectors.map(|(sum, count)| sum / f64::from(count));
    let least = lengths.into_iter().fold(f64::INFINITY, f64::min);
    let most = lengths.into_iter().fold(f64::NEG_INFINITY, f64::max);
    Some((most - least) / (most + least))
}

/// Returns the sine and cosine of the samples that were not excluded.
fn included_samples<'a>(samples: &Samples<'a>, analysis: &'a Analysis) -> impl Iterator<Item = (f64, f64)> {
    let (sine, cosine) = (samples.sine_v, samples.cosine_v);
    let left_out = analysis.outliers.as_ref().map_or(&[][..], |outliers| &outliers.excluded_ranges);
    remaining_ranges(sine.len().min(cosine.len()), left_out).flat_map(move |part| {
        let values = |values: &'a [f64]| values.get(part.clone()).unwrap_or_default().iter().copied();
        values(sine).zip(values(cosine))
    })
}
