//! Spectra of both channels, reduced for drawing. In each frequency range, only the highest line is kept, so that no
//! peak is lost.

use crate::analysis::position_error::Samples;
use crate::analysis::spectrum::{SpectralLine, Spectrum, SpectrumError, sample_rate_hz};

#[derive(Clone, Debug, PartialEq)]
pub struct Spectra {
    pub sine: ChannelSpectrum,
    pub cosine: ChannelSpectrum,
    pub spacing_hz: f64,
    /// Number of samples in the transform, taken from the end of a long capture.
    pub samples: usize,
}

#[derive(Clone, Debug, PartialEq)]
pub struct ChannelSpectrum {
    /// Frequency in hertz and peak amplitude in volts, sorted by frequency.
    pub lines: Vec<(f64, f64)>,
    /// Highest peaks, sorted by descending amplitude.
    pub peaks: Vec<SpectralLine>,
}

/// Maximum number of samples in a transform.
const MAX_SAMPLES: usize = 1 << 20;
const LINES: usize = 1_000;
const PEAKS: usize = 6;
/// Minimum amplitude of a labelled peak, as a fraction of the highest peak.
const MIN_PEAK: f64 = 1e-4;
/// Minimum amplitude of a labelled peak, as a multiple of the median of all lines. Anything lower may be noise: in a
/// million lines of noise, the highest one reaches 4.5.
const NOISE: f64 = 6.0;

impl Spectra {
    /// Calculates the spectra of a capture.
    ///
    /// # Errors
    /// Returns an error if the times are missing or uneven, or if there are too few samples.
    pub(super) fn from_samples(samples: Samples<'_>) -> Result<Self, SpectrumError> {
        let Samples { time_s, sine_v, cosine_v } = samples;
        let count = sine_v.len().min(cosine_v.len()).min(time_s.len());
        let from = count.saturating_sub(MAX_SAMPLES);
        let last = |column: &[f64]| column.get(from..count).unwrap_or_default().to_vec();
        let rate_hz = sample_rate_hz(&last(time_s))?;
        let channel = |column: &[f64]| Spectrum::from_samples(&last(column), rate_hz);
        let (sine, cosine) = (channel(sine_v)?, channel(cosine_v)?);
        Ok(Spectra {
            spacing_hz: sine.spacing_hz(),
            samples: count - from,
            sine: decimate_spectrum(&sine),
            cosine: decimate_spectrum(&cosine),
        })
    }
}

fn decimate_spectrum(spectrum: &Spectrum) -> ChannelSpectrum {
    let amplitudes = spectrum.amplitudes_v();
    let stretch = amplitudes.len().div_ceil(LINES).max(1);
    let highest = |(number, lines): (usize, &[f64])| {
        let (at, volts) = lines.iter().enumerate().max_by(|a, b| a.1.total_cmp(b.1))?;
        Some(((number * stretch + at) as f64 * spectrum.spacing_hz(), *volts))
    };
    let lines = amplitudes.chunks(stretch).enumerate().filter_map(highest).collect();
    let peaks = spectrum.highest_peaks(PEAKS);
    let most = peaks.first().map_or(0.0, |peak| peak.amplitude_v);
    let least = (MIN_PEAK * most).max(NOISE * median(amplitudes));
    let peaks = peaks.into_iter().filter(|peak| peak.amplitude_v >= least).collect();
    ChannelSpectrum { lines, peaks }
}

fn median(values: &[f64]) -> f64 {
    let mut values = values.to_vec();
    let middle = values.len() / 2;
    if values.is_empty() { 0.0 } else { *values.select_nth_unstable_by(middle, f64::total_cmp).1 }
}

/// Converts a peak amplitude in volts to an rms level in decibels relative to one volt.
pub fn to_decibel_volts(peak_v: f64) -> f64 {
    /// Lowest level in decibels, at which an amplitude is practically zero.
    const MIN_DECIBELS: f64 = -160.0;
    (20.0 * (peak_v / std::f64::consts::SQRT_2).log10()).max(MIN_DECIBELS)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Reduction keeps every peak of a 100 kHz capture, with 1 kHz at 0.5 V on both channels and 8 kHz at 20 mV on the
    /// sine.
    #[test]
    fn decimation_keeps_spectrum_peaks() {
        let time_s: Vec<f64> = (0..50_000).map(|at| f64::from(at) * 1e-5).collect();
        let tone = |time: f64, hertz: f64| (std::f64::consts::TAU * hertz * time).sin();
        let sine_v: Vec<f64> =
            time_s.iter().map(|time| 0.5 * tone(*time, 1_000.0) + 0.02 * tone(*time, 8_000.0)).collect();
        let cosine_v: Vec<f64> = time_s.iter().map(|time| 0.5 * tone(*time, 1_000.0)).collect();
        let spectra = Spectra::from_samples(Samples { time_s: &time_s, sine_v: &sine_v, cosine_v: &cosine_v }).unwrap();
        assert!(spectra.samples == 50_000 && (spectra.spacing_hz - 2.0).abs() < 1e-9);
        assert!(spectra.sine.lines.len() <= 1_000);
        let [first, second] = spectra.sine.peaks[..] else { panic!("{:?}", spectra.sine.peaks) };
        assert!((first.frequency_hz - 1_000.0).abs() < 0.1 && (first.amplitude_v - 0.5).abs() < 1e-3);
        assert!((second.frequency_hz - 8_000.0).abs() < 0.1 && (second.amplitude_v - 0.02).abs() < 1e-4);
        assert_eq!(spectra.cosine.peaks.len(), 1);
        let drawn = spectra.sine.lines.iter().find(|(hertz, _)| (*hertz - 8_000.0).abs() < 1.0).unwrap();
        assert!((drawn.1 - 0.02).abs() < 1e-4, "{drawn:?}");
    }

    #[test]
    fn uneven_times_yield_no_spectrum() {
        let column = vec![0.5; 20];
        let none = Samples { time_s: &[], sine_v: &column, cosine_v: &column };
        assert_eq!(Spectra::from_samples(none), Err(SpectrumError::TooFew { samples: 0 }));
        let mut time_s: Vec<f64> = (0..20).map(f64::from).collect();
        time_s[10] = 10.5;
        let uneven = Samples { time_s: &time_s, sine_v: &column, cosine_v: &column };
        assert!(matches!(Spectra::from_samples(uneven), Err(SpectrumError::Uneven { .. })));
    }

    #[test]
    fn levels_refer_to_rms() {
        // A sine of √2 V peak has 1 V rms; a tenth of it is 20 dB less.
        assert!(to_decibel_volts(2.0_f64.sqrt()).abs() < 1e-12);
        assert!((to_decibel_volts(0.2_f64.sqrt() / 10.0_f64.sqrt() * 1.0) - -20.0).abs() < 1e-9);
        assert_eq!(to_decibel_volts(0.0), -160.0);
    }
}
