//! Amplitude spectrum of a sine or cosine channel, computed with realfft and a Hann window. It shows interference,
//! harmonics and noise. The gain of the window is compensated, so a sine appears with its peak amplitude.

use std::f64::consts::TAU;

use realfft::RealFftPlanner;

#[derive(Clone, Debug, PartialEq)]
pub struct Spectrum {
    spacing_hz: f64,
    amplitudes_v: Vec<f64>,
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SpectralLine {
    pub frequency_hz: f64,
    /// Peak amplitude in the unit of the samples (volts).
    pub amplitude_v: f64,
}

#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum SpectrumError {
    /// A spectrum requires at least eight samples.
    #[error("{samples} samples are too few: at least 8 are required")]
    TooFew { samples: usize },
    /// The times are not evenly spaced.
    #[error("the time between sample {index} and the next one differs from the others")]
    Uneven {
        /// Index of the sample before the uneven step, counted from 0.
        index: usize,
    },
    /// A sample or the rate is not a finite number, or the rate is not positive.
    #[error("a sample or the sample rate is not a number")]
    NotFinite,
}

const MIN_SAMPLES: usize = 8;
/// Number of lines on each side of a peak that belong to it in a Hann window.
const PEAK_HALF_WIDTH: usize = 2;

impl Spectrum {
    /// Calculates the spectrum of samples taken at `rate_hz`, after removing their mean.
    ///
    /// # Errors
    /// Returns a [`SpectrumError`] if there are too few samples, or if a sample is not finite.
    pub fn from_samples(samples: &[f64], rate_hz: f64) -> Result<Self, SpectrumError> {
        let count = samples.len();
        if count < MIN_SAMPLES {
            return Err(SpectrumError::TooFew { samples: count });
        }
        let mean = samples.iter().sum::<f64>() / count as f64;
        if !mean.is_finite() || !rate_hz.is_finite() || rate_hz <= 0.0 {
            return Err(SpectrumError::NotFinite);
        }
        let hann = |at: usize| 0.5 - 0.5 * (TAU * at as f64 / count as f64).cos();
        let mut windowed: Vec<f64> = samples.iter().enumerate().map(|(at, value)| (value - mean) * hann(at)).collect();
        let transform = RealFftPlanner::new().plan_fft_forward(count);
        let mut lines = transform.make_output_vec();
        // The buffers match this transform, so it cannot fail. An overflow appears in the lines.
        transform.process(&mut windowed, &mut lines).map_err(|_| SpectrumError::NotFinite)?;
        // A sine has half its amplitude in each of its two lines, and the window has the mean ½.
        let amplitudes_v = lines.iter().map(|line| line.norm() * 4.0 / count as f64).collect();
        Ok(Spectrum { spacing_hz: rate_hz / count as f64, amplitudes_v })
    }

    /// Returns the distance between lines in hertz, which is the reciprocal of the duration.
    pub fn spacing_hz(&self) -> f64 {
        self.spacing_hz
    }

    /// Returns the peak amplitudes in volts, from 0 Hz to half the sample rate, [`spacing_hz`](Self::spacing_hz) apart.
    pub fn amplitudes_v(&self) -> &[f64] {
        &self.amplitudes_v
    }

    /// Returns up to `most` of the highest peaks in descending order, with interpolated frequency and amplitude. Lines
    /// that belong to a higher peak are skipped, as are those around 0 Hz, which belong to the mean.
    pub fn highest_peaks(&self, most: usize) -> Vec<SpectralLine> {
        let lines = &self.amplitudes_v;
        let mut order: Vec<usize> = (PEAK_HALF_WIDTH..lines.len())
            .filter(|at| {
                let height = |at: usize| lines.get(at).copied().unwrap_or(0.0);
                height(*at) > 0.0 && height(*at) >= height(at - 1) && height(*at) > height(at + 1)
            })
            .collect();
        order.sort_by(|a, b| {
            let height = |at: &usize| lines.get(*at).copied().unwrap_or(0.0);
            height(b).total_cmp(&height(a))
        });
        let mut taken: Vec<usize> = Vec::new();
        for at in order {
            if taken.len() == most {
                break;
            }
            if taken.iter().all(|other| other.abs_diff(at) > PEAK_HALF_WIDTH) {
                taken.push(at);
            }
        }
        taken.into_iter().map(|at| self.interpolate_peak(at)).collect()
    }

    /// Interpolates frequency and amplitude of a sine between two lines of a Hann window, from the ratio of the highest
    /// line to its higher neighbour.
    pub(super) fn interpolate_peak(&self, at: usize) -> SpectralLine {
        let height = |at: usize| self.amplitudes_v.get(at).copied().unwrap_or(0.0);
        let (before, top, after) = (height(at.saturating_sub(1)), height(at), height(at + 1));
        let (side, sign) = if after > before { (after, 1.0) } else { (before, -1.0) };
        let off = ((2.0 * side - top) / (side + top)).clamp(0.0, 0.5);
        // The shape of the window: sinc(δ)/(1 − δ²).
        let shape = if off < 1e-9 { 1.0 } else { (TAU / 2.0 * off).sin() / (TAU / 2.0 * off) / (1.0 - off * off) };
        SpectralLine { frequency_hz: (at as f64 + sign * off) * self.spacing_hz, amplitude_v: top / shape }
    }
}

/// Returns the sample rate in hertz of equidistant times in seconds. Steps may differ by a tenth, as in times with few
/// digits.
///
/// # Errors
/// Returns a [`SpectrumError`] if there are fewer than eight times, or if they do not increase evenly.
pub fn sample_rate_hz(times_s: &[f64]) -> Result<f64, SpectrumError> {
    let (Some(first), Some(last), true) = (times_s.first(), times_s.last(), times_s.len() >= MIN_SAMPLES) else {
        return Err(SpectrumError::TooFew { samples: times_s.len() });
    };
    let mean = (last - first) / (times_s.len() - 1) as f64;
    if !mean.is_finite() || mean <= 0.0 {
        return Err(SpectrumError::NotFinite);
    }
    let even = |pair: &[f64]| matches!(pair, [a, b] if ((b - a) / mean - 1.0).abs() <= 0.1);
    match times_s.windows(2).position(|pair| !even(pair)) {
        Some(index) => Err(SpectrumError::Uneven { index }),
        None => Ok(1.0 / mean),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn finds_sines_on_and_between_lines() {
        for (frequency, offset) in [(100.0, 2.5), (100.5, 0.0), (103.27, -1.0)] {
            let samples: Vec<f64> = (0..4000)
                .map(|at| {
                    let t = f64::from(at) / 4000.0;
                    offset + 0.5 * (TAU * frequency * t).sin() + 0.01 * (TAU * (3.0 * frequency) * t + 1.0).sin()
                })
                .collect();
            let peaks = Spectrum::from_samples(&samples, 4000.0).unwrap().highest_peaks(2);
            for (peak, (hertz, volts)) in peaks.iter().zip([(frequency, 0.5), (3.0 * frequency, 0.01)]) {
                assert!((peak.frequency_hz - hertz).abs() < 0.02, "{peaks:?}");
                assert!((peak.amplitude_v / volts - 1.0).abs() < 0.01, "{peaks:?}");
            }
            assert_eq!(peaks.len(), 2);
        }
    }

    #[test]
    fn constant_has_no_peak() {
        let spectrum = Spectrum::from_samples(&[1.5; 64], 100.0).unwrap();
        assert_eq!((spectrum.highest_peaks(3), spectrum.amplitudes_v().len()), (Vec::new(), 33));
        assert_eq!(spectrum.spacing_hz(), 100.0 / 64.0);
    }

    #[test]
    fn rejects_data_without_spectrum() {
        assert_eq!(Spectrum::from_samples(&[0.0; 7], 1.0), Err(SpectrumError::TooFew { samples: 7 }));
        assert_eq!(Spectrum::from_samples(&[f64::NAN; 8], 1.0), Err(SpectrumError::NotFinite));
        assert_eq!(Spectrum::from_samples(&[0.0; 8], 0.0), Err(SpectrumError::NotFinite));
        let mut times: Vec<f64> = (0..20).map(|at| 1.0 + f64::from(at) * 1e-6).collect();
        assert!((sample_rate_hz(&times).unwrap() / 1e6 - 1.0).abs() < 1e-6);
        times[10] += 0.3e-6;
        assert_eq!(sample_rate_hz(&times), Err(SpectrumError::Uneven { index: 9 }));
        assert_eq!(sample_rate_hz(&[1.0; 9]), Err(SpectrumError::NotFinite));
        assert_eq!(sample_rate_hz(&[]), Err(SpectrumError::TooFew { samples: 0 }));
    }
}
