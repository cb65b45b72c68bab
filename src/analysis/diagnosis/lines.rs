//! Detection of spectral lines that are not harmonics of the signal: interference from a drive, the mains or a
//! switching supply.
//!
//! An uneven motion also adds lines next to those of the signal, and so does an amplitude that varies over the
//! revolution. They can be distinguished from interference by their direction. External interference moves the vector
//! of both channels in any direction, and on average half of it is along the radius. An uneven motion moves the vector
//! only along the circle, and an uneven amplitude only along the radius.

use std::f64::consts::TAU;
use std::ops::Range;

use super::MIN_INTERFERENCE_FRACTION;
use crate::analysis::ellipse::EllipseCorrection;
use crate::analysis::position_error::Samples;
use crate::analysis::signal_analysis::Analysis;
use crate::analysis::spectrum::{Spectrum, sample_rate_hz};

pub(super) const MAINS_HZ: [f64; 2] = [50.0, 60.0];
/// Highest multiple of the mains frequency that is attributed to the mains.
const MAX_MAINS_HARMONIC: f64 = 10.0;
/// Largest line spacing of the spectrum at which lines are attributed to the mains.
const MAINS_SPACING_HZ: f64 = 10.0;

/// Preferred minimum length of the examined record in seconds, equal to ten periods of 50 Hz mains.
const PREFERRED_RECORD_LENGTH_S: f64 = 0.2;
/// Minimum and maximum number of samples in the spectrum.
const SAMPLES: (usize, usize) = (1 << 16, 1 << 20);
/// Minimum number of signal periods. With fewer, the signal's own line would cover the whole spectrum.
const MIN_PERIODS: f64 = 8.0;
/// Number of signal harmonics that are skipped at a steady speed and at a varying speed. At a varying speed, the wide
/// harmonics cover much of the spectrum and do not stand out as lines, so fewer are skipped.
const HARMONICS: (usize, usize) = (25, 5);
/// Number of lines on each side of a harmonic that belong to it in a Hann window.
const HARMONIC_HALF_WIDTH: usize = 3;
/// Fraction of the signal's peak above which neighbouring lines belong to the signal.
const SIGNAL_PEAK_FRACTION: f64 = 0.01;
/// Number of neighbouring lines on each side from which the noise is determined.
const NEIGHBOURS_PER_SIDE: usize = 50;
/// Minimum ratio of a line to the median of its neighbours. Below it, the line is noise.
const LINE_TO_NOISE_RATIO: f64 = 6.0;
/// Maximum number of lines reported.
const MAX_LINES: usize = 8;
/// Range of the radial fraction of an interference line, where radial means in the direction of the signal vector.
const RADIAL_SHARE: Range<f64> = 0.25..0.75;
/// Maximum phase difference between channels that are in phase, in radians.
const IN_PHASE_RAD: f64 = TAU / 12.0;

/// Spectral line that is not a harmonic of the signal.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Interference {
    pub frequency_hz: f64,
    /// Peak in the stronger channel, in volts.
    pub volts: f64,
    /// Whether the line is in phase and about equally strong in both channels.
    pub common: bool,
    /// Mains frequency, if the line is at that frequency or a multiple of it.
    pub mains_hz: Option<f64>,
}

/// Spectral line, and its contribution to the distance from the ellipse.
struct StrongLine {
    line: Interference,
    radial_v2: f64,
}

pub(super) struct SpectrumContent {
    /// Lines found, strongest first.
    pub(super) lines: Vec<Interference>,
    /// RMS white noise of one channel, in volts.
    pub(super) noise_v: f64,
    /// Spacing of the spectrum's lines in hertz.
    pub(super) spacing_hz: f64,
    /// Contribution of all lines to the distance from the ellipse, as a mean square in V².
    pub(super) radial_v2: f64,
}

/// Finds the interference lines. Returns `None` if the samples are not evenly spaced, are too few, or cover too few
/// periods.
pub(super) fn find_interference(samples: &Samples<'_>, analysis: &Analysis) -> Option<SpectrumContent> {
    let count = samples.sine_v.len().min(samples.cosine_v.len()).min(samples.time_s.len());
    let all = samples.time_s.get(..count)?;
    let wanted = (PREFERRED_RECORD_LENGTH_S * count.saturating_sub(1) as f64 / (all.last()? - all.first()?)) as usize;
    let length = wanted.clamp(SAMPLES.0, SAMPLES.1).min(count);
    // The middle of the record is used, because the motion is steadiest there.
    let start = (count - length) / 2;
    let rate_hz = sample_rate_hz(all.get(start..start + length)?).ok()?;
    if analysis.coverage.periods * length as f64 / (count as f64) < MIN_PERIODS {
        return None;
    }
    let without = |values: &[f64]| {
        let mut values = values.get(start..start + length).unwrap_or_default().to_vec();
        replace_outliers(&mut values, start, analysis);
        values
    };
    let (sine, cosine) = (without(samples.sine_v), without(samples.cosine_v));
    let spectra = (Spectrum::from_samples(&sine, rate_hz).ok()?, Spectrum::from_samples(&cosine, rate_hz).ok()?);
    let both: Vec<f64> = spectra
        .0
        .amplitudes_v()
        .iter()
        .zip(spectra.1.amplitudes_v())
        .map(|(sine, cosine)| sine.hypot(*cosine))
        .collect();
    let is_signal = signal_line_mask(&both);
    let rest: Vec<f64> =
        both.iter().zip(&is_signal).filter(|(_, signal)| !**signal).map(|(height, _)| *height).collect();
    let noise_v = noise_from_median(median(rest)?, length);
    let projector =
        FrequencyProbe { sine: &sine, cosine: &cosine, analysis, correction: analysis.ellipse.correction(), rate_hz };
    let spacing_hz = spectra.0.spacing_hz();
    let mut found: Vec<StrongLine> = peak_candidates(&both, &is_signal, analysis.ellipse.amplitude_v)
        .into_iter()
        .filter_map(|at| {
            let louder =
                |at: usize| magnitude_at(spectra.0.amplitudes_v(), at) > magnitude_at(spectra.1.amplitudes_v(), at);
            let spectrum = if louder(at) { &spectra.0 } else { &spectra.1 };
            projector.strong_line_at(spectrum.interpolate_peak(at).frequency_hz)
        })
        .filter(|found| found.line.volts >= MIN_INTERFERENCE_FRACTION * analysis.ellipse.amplitude_v)
        .collect();
    found.sort_by(|a, b| b.line.volts.total_cmp(&a.line.volts));
    found.truncate(MAX_LINES);
    let radial_v2 = found.iter().map(|found| found.radial_v2).sum();
    let mut lines: Vec<Interference> = found.into_iter().map(|found| found.line).collect();
    assign_mains_frequencies(&mut lines, spacing_hz);
    Some(SpectrumContent { lines, noise_v, spacing_hz, radial_v2 })
}

/// Replaces each outlier with the preceding value, because a spike would raise all spectral lines.
fn replace_outliers(values: &mut [f64], start: usize, analysis: &Analysis) {
    let end = start + values.len();
    let stretches = analysis.outliers.as_ref().map_or(&[][..], |outliers| &outliers.excluded_ranges);
    for stretch in stretches.iter().filter(|stretch| stretch.start < end && stretch.end > start) {
        let (from, to) = (stretch.start.max(start) - start, stretch.end.min(end) - start);
        let before = from.checked_sub(1).or(Some(to)).and_then(|at| values.get(at)).copied();
        if let (Some(before), Some(part)) = (before, values.get_mut(from..to)) {
            part.fill(before);
        }
    }
}

fn magnitude_at(lines: &[f64], at: usize) -> f64 {
    lines.get(at).copied().unwrap_or(0.0)
}

/// Returns a mask of the lines that belong to the signal: the fundamental and its harmonics, including those aliased at
/// half the sample rate.
fn signal_line_mask(both: &[f64]) -> Vec<bool> {
    let mut belongs = vec![false; both.len()];
    let first = HARMONIC_HALF_WIDTH.min(both.len());
    let peak =
        (first..both.len()).max_by(|a, b| magnitude_at(both, *a).total_cmp(&magnitude_at(both, *b))).unwrap_or(0);
    // An uneven motion widens each harmonic in proportion to its order.
    let above = |at: usize| magnitude_at(both, at) > SIGNAL_PEAK_FRACTION * magnitude_at(both, peak);
    let up = (peak..both.len()).take_while(|at| above(*at)).count();
    let down = (0..=peak).rev().take_while(|at| above(*at)).count();
    let width = up.max(down).saturating_sub(1);
    let whole = 2 * both.len().saturating_sub(1).max(1);
    let even = width <= HARMONIC_HALF_WIDTH;
    for order in 0..=if even { HARMONICS.0 } else { HARMONICS.1 } {
        let place = order * peak % whole;
        let place = place.min(whole - place);
        let reach = if even { HARMONIC_HALF_WIDTH + order / 2 } else { width * order.max(1) };
        let (from, to) = (place.saturating_sub(reach), (place + reach + 1).min(both.len()));
        belongs.get_mut(from..to).unwrap_or_default().fill(true);
    }
    belongs
}

fn peak_candidates(both: &[f64], is_signal: &[bool], amplitude: f64) -> Vec<usize> {
    let free = |at: usize| !is_signal.get(at).copied().unwrap_or(true);
    let mut found: Vec<usize> = (1..both.len().saturating_sub(1))
        .filter(|at| {
            let own = magnitude_at(both, *at);
            let peak = own >= magnitude_at(both, at - 1) && own > magnitude_at(both, at + 1);
            free(*at) && peak && own >= MIN_INTERFERENCE_FRACTION / 2.0 * amplitude
        })
        .collect();
    found.sort_by(|a, b| magnitude_at(both, *b).total_cmp(&magnitude_at(both, *a)));
    let mut taken: Vec<usize> = Vec::new();
    // Lines at noise level are never reported, no matter how many exist.
    for at in found.into_iter().take(4 * MAX_LINES) {
        let near = (at.saturating_sub(NEIGHBOURS_PER_SIDE)..at + NEIGHBOURS_PER_SIDE)
            .filter(|other| free(*other) && other.abs_diff(at) > HARMONIC_HALF_WIDTH);
        let floor = median(near.map(|other| magnitude_at(both, other)).collect()).unwrap_or(0.0);
        if magnitude_at(both, at) >= LINE_TO_NOISE_RATIO * floor
            && taken.iter().all(|other| other.abs_diff(at) > HARMONIC_HALF_WIDTH)
        {
            taken.push(at);
        }
    }
    taken
}

/// Returns the white noise of one channel from the median line of both channels combined. The power of such a line is
/// a sum of four squared normal variables, whose median is 3.3567 times their variance.
fn noise_from_median(median: f64, samples: usize) -> f64 {
    const MEDIAN_VARIANCE_RATIO: f64 = 3.356_694;
    // A line is 4/n times a sum whose real and imaginary parts each have the variance σ²·Σw²/2, where Σw² = 3n/8.
    median * samples as f64 / 4.0 / (MEDIAN_VARIANCE_RATIO * 3.0 * samples as f64 / 16.0).sqrt()
}

fn median(mut values: Vec<f64>) -> Option<f64> {
    let middle = values.len() / 2;
    (middle < values.len()).then(|| *values.select_nth_unstable_by(middle, f64::total_cmp).1)
}

/// Assigns lines to a mains frequency. The multiples 300 Hz and 600 Hz are shared by both mains frequencies, so the
/// other lines decide.
fn assign_mains_frequencies(lines: &mut [Interference], spacing_hz: f64) {
    if spacing_hz > MAINS_SPACING_HZ {
        return;
    }
    let is_of = |line: &Interference, mains: f64| {
        let times = (line.frequency_hz / mains).round();
        (1.0..=MAX_MAINS_HARMONIC).contains(&times)
            && (line.frequency_hz - times * mains).abs() <= (0.2 * spacing_hz).max(0.5)
    };
    let of = MAINS_HZ.map(|mains| lines.iter().filter(|line| is_of(line, mains)).count());
    let [fifty, sixty] = MAINS_HZ;
    let order = if of[1] > of[0] { [sixty, fifty] } else { [fifty, sixty] };
    for line in lines {
        line.mains_hz = order.into_iter().find(|mains| is_of(line, *mains));
    }
}

#[derive(Clone, Copy, Default)]
struct Complex {
    re: f64,
    im: f64,
}

impl Complex {
    fn scaled(self, factor: f64) -> Self {
        Complex { re: self.re * factor, im: self.im * factor }
    }

    fn plus(self, other: Complex) -> Self {
        Complex { re: self.re + other.re, im: self.im + other.im }
    }

    fn multiply(self, by: Complex) -> Self {
        Complex { re: self.re * by.re - self.im * by.im, im: self.re * by.im + self.im * by.re }
    }

    fn magnitude_squared(self) -> f64 {
        self.re * self.re + self.im * self.im
    }
}

/// Measurement of a single frequency in both channels and in the radial component.
struct FrequencyProbe<'a> {
    sine: &'a [f64],
    cosine: &'a [f64],
    analysis: &'a Analysis,
    correction: EllipseCorrection,
    rate_hz: f64,
}

impl FrequencyProbe<'_> {
    /// Returns the spectral line at a frequency, or `None` if the line is not interference.
    fn strong_line_at(&self, frequency_hz: f64) -> Option<StrongLine> {
        let [sine, cosine, along_sine, along_cosine] = self.amplitudes_at(frequency_hz);
        let stretch = self.correction.correction_factors();
        // The correction is linear, so it can be applied to the line instead of the samples.
        let corrected =
            sine.scaled(stretch.1).plus(cosine.scaled(stretch.0)).magnitude_squared() + cosine.magnitude_squared();
        let radial = (along_sine.magnitude_squared() + along_cosine.magnitude_squared()) / corrected;
        if !RADIAL_SHARE.contains(&radial.sqrt()) {
            return None;
        }
        let (sine_v, cosine_v) = (sine.magnitude_squared().sqrt(), cosine.magnitude_squared().sqrt());
        let apart = (sine.im * cosine.re - sine.re * cosine.im).atan2(sine.re * cosine.re + sine.im * cosine.im);
        let equal = (0.5..2.0).contains(&(sine_v / cosine_v));
        let common = equal && apart.abs() < IN_PHASE_RAD;
        let line = Interference { frequency_hz, volts: sine_v.max(cosine_v), common, mains_hz: None };
        // Half of the sum of both channels' mean squares is radial.
        Some(StrongLine { line, radial_v2: (sine.magnitude_squared() + cosine.magnitude_squared()) / 4.0 })
    }

    /// Returns the amplitude and phase, in a Hann window, of sine, cosine and the radial component of the corrected
    /// values.
    fn amplitudes_at(&self, frequency_hz: f64) -> [Complex; 4] {
        let count = self.sine.len() as f64;
        let turn = |angle: f64| Complex { re: angle.cos(), im: angle.sin() };
        let (step, window_step) = (turn(TAU * frequency_hz / self.rate_hz), turn(TAU / count));
        let mut sums = [Complex::default(); 4];
        let (mut phasor, mut window) = (turn(0.0), turn(0.0));
        for (y, x) in self.sine.iter().zip(self.cosine) {
            let (own_y, own_x) = self.correction.apply(*y, *x);
            let length = own_y.hypot(own_x);
            let off = 1.0 - self.analysis.ellipse.amplitude_v / length.max(f64::MIN_POSITIVE);
            // Without this subtraction, the mean level would leak into low frequencies.
            let y = y - self.analysis.ellipse.offset_sine_v;
            let x = x - self.analysis.ellipse.offset_cosine_v;
            let weight = 1.0 - window.re;
            for (sum, value) in sums.iter_mut().zip([y, x, off * own_y, off * own_x]) {
                *sum = sum.plus(phasor.scaled(weight * value));
            }
            (phasor, window) = (phasor.multiply(step), window.multiply(window_step));
        }
        // The weights have a mean of 1, and a sine contributes half its amplitude at its frequency.
        sums.map(|sum| sum.scaled(2.0 / count))
    }
}
