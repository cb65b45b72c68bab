//! Settings of the virtual sine/cosine source and their ranges.

use crate::analysis::wiring::Wire;

/// The settings of the analogue source. Voltages are peak values unless stated as rms.
#[derive(Clone, Debug, PartialEq)]
pub struct Settings {
    /// Number of signal periods per revolution, which must be whole.
    pub periods: f64,
    /// Speed in revolutions per minute, in steps of 0.001. At negative speeds, the angle decreases.
    pub speed_rpm: f64,
    /// Sample rate in hertz. The sample period is rounded to whole nanoseconds. See [`Settings::period_ns`].
    pub rate_hz: f64,
    /// Differential amplitude R of the cosine channel in volts.
    pub amplitude_v: f64,
    /// Offset q of the sine channel in volts.
    pub offset_sine_v: f64,
    /// Offset p of the cosine channel in volts.
    pub offset_cosine_v: f64,
    /// Ratio r of the cosine amplitude to the sine amplitude.
    pub gain_ratio: f64,
    /// Phase error α in degrees. The sine follows the cosine by a quarter of a period plus α.
    pub phase_error_deg: f64,
    /// Mean level of the reference wires in volts.
    pub level_v: f64,
    /// Third harmonic, in percent of the amplitude.
    pub third_harmonic_percent: f64,
    /// Amplitude modulation once per revolution, in percent.
    pub modulation_percent: f64,
    /// White noise of each differential channel, in volts rms.
    pub noise_v: f64,
    /// Frequency of the interference in hertz, in steps of 0.001.
    pub interference_hz: f64,
    /// Amplitude of the interference on the sine channel, in volts. On the cosine channel, it is half as large with
    /// opposite sign.
    pub interference_v: f64,
    /// Mains frequency in hertz, in steps of 0.001.
    pub hum_hz: f64,
    /// Amplitude of the mains hum in volts, in phase on both channels.
    pub hum_v: f64,
    /// Eccentricity of the encoder's scale, given as the amplitude of the resulting angle error in mechanical seconds
    /// of arc. The error repeats once per revolution.
    pub eccentricity_arcsec: f64,
    /// Broken wire, if any.
    pub open_wire: Option<Wire>,
    /// Whether the receiver has a 120 Ω resistor between the wires of a pair, as the manuals require.
    pub terminated: bool,
    /// Level of the reference wires.
    pub references: ReferenceLevel,
    /// Seed of the noise. Equal seeds yield equal noise.
    pub seed: u64,
}

/// Level of REFSIN and REFCOS.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ReferenceLevel {
    /// The references are at the mean level, as in HIPERFACE encoders. Only SIN and COS carry the signal.
    Level,
    /// The references carry the inverted signal, as in encoders with complementary outputs. Each wire carries half of
    /// the signal.
    Complement,
}

/// A numeric setting.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Quantity {
    /// [`Settings::periods`].
    Periods,
    /// [`Settings::speed_rpm`].
    Speed,
    /// [`Settings::rate_hz`].
    Rate,
    /// [`Settings::amplitude_v`].
    Amplitude,
    /// [`Settings::offset_sine_v`].
    OffsetSine,
    /// [`Settings::offset_cosine_v`].
    OffsetCosine,
    /// [`Settings::gain_ratio`].
    GainRatio,
    /// [`Settings::phase_error_deg`].
    PhaseError,
    /// [`Settings::level_v`].
    Level,
    /// [`Settings::third_harmonic_percent`].
    ThirdHarmonic,
    /// [`Settings::modulation_percent`].
    Modulation,
    /// [`Settings::noise_v`].
    Noise,
    /// [`Settings::interference_hz`].
    InterferenceFrequency,
    /// [`Settings::interference_v`].
    Interference,
    /// [`Settings::hum_hz`].
    HumFrequency,
    /// [`Settings::hum_v`].
    Hum,
    /// [`Settings::eccentricity_arcsec`].
    Eccentricity,
}

/// The error for a setting that is outside its range.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[error("{quantity:?} must be from {least} to {most}, not {value}")]
pub struct SettingError {
    /// Setting whose value was rejected.
    pub quantity: Quantity,
    /// Rejected value.
    pub value: f64,
    /// Minimum value.
    pub least: f64,
    /// Maximum value.
    pub most: f64,
}

/// Settings that are all within their ranges.
#[derive(Clone, Debug, PartialEq)]
pub struct CheckedSettings(Settings);

impl Quantity {
    /// All quantities, in the order of [`Settings`].
    pub const ALL: [Quantity; 17] = [
        Quantity::Periods,
        Quantity::Speed,
        Quantity::Rate,
        Quantity::Amplitude,
        Quantity::OffsetSine,
        Quantity::OffsetCosine,
        Quantity::GainRatio,
        Quantity::PhaseError,
        Quantity::Level,
        Quantity::ThirdHarmonic,
        Quantity::Modulation,
        Quantity::Noise,
        Quantity::InterferenceFrequency,
        Quantity::Interference,
        Quantity::HumFrequency,
        Quantity::Hum,
        Quantity::Eccentricity,
    ];

    /// Returns the unit symbol, which is the same in every language, or an empty string for a plain number.
    pub const fn unit(self) -> &'static str {
        match self {
            Quantity::Periods | Quantity::GainRatio => "",
            Quantity::Speed => "1/min",
            Quantity::Rate | Quantity::InterferenceFrequency | Quantity::HumFrequency => "Hz",
            Quantity::Amplitude
            | Quantity::OffsetSine
            | Quantity::OffsetCosine
            | Quantity::Level
            | Quantity::Noise
            | Quantity::Interference
            | Quantity::Hum => "V",
            Quantity::PhaseError => "°",
            Quantity::ThirdHarmonic | Quantity::Modulation => "%",
            Quantity::Eccentricity => "″",
        }
    }

    /// Returns the minimum and maximum value.
    pub const fn value_range(self) -> (f64, f64) {
        match self {
            Quantity::Periods => (1.0, 65_536.0),
            Quantity::Speed => (-60_000.0, 60_000.0),
            Quantity::Rate => (10.0, 1_000_000.0),
            Quantity::Amplitude => (0.0, 2.0),
            Quantity::OffsetSine | Quantity::OffsetCosine => (-1.0, 1.0),
            Quantity::GainRatio => (0.2, 5.0),
            Quantity::PhaseError => (-45.0, 45.0),
            Quantity::Level => (0.0, 5.0),
            Quantity::ThirdHarmonic => (0.0, 30.0),
            Quantity::Modulation => (0.0, 50.0),
            Quantity::Noise | Quantity::Interference | Quantity::Hum => (0.0, 1.0),
            Quantity::InterferenceFrequency => (0.0, 10_000_000.0),
            Quantity::HumFrequency => (0.0, 1_000.0),
            Quantity::Eccentricity => (0.0, 36_000.0),
        }
    }
}

impl Settings {
    /// Returns the value of a quantity.
    pub fn get(&self, quantity: Quantity) -> f64 {
        *self.clone().value_mut(quantity)
    }

    /// Returns a copy of the settings with one quantity changed to `value`.
    #[must_use]
    pub fn with_value(mut self, quantity: Quantity, value: f64) -> Self {
        *self.value_mut(quantity) = value;
        self
    }

    /// Returns the sample period in whole nanoseconds, such as 10 000 ns for 100 kHz and 22 676 ns for 44.1 kHz.
    pub fn period_ns(&self) -> i64 {
        (1e9 / self.rate_hz).round() as i64
    }

    /// Checks that all settings are within their ranges.
    ///
    /// # Errors
    /// Returns a [`SettingError`] with the first setting that is outside its range, and the range. A fractional number
    /// of periods is also rejected.
    pub fn validate(self) -> Result<CheckedSettings, SettingError> {
        for quantity in Quantity::ALL {
            let (value, (least, most)) = (self.get(quantity), quantity.value_range());
            let whole = quantity != Quantity::Periods || value.fract() == 0.0;
            if !(least..=most).contains(&value) || !whole {
                return Err(SettingError { quantity, value, least, most });
            }
        }
        Ok(CheckedSettings(self))
    }

    fn value_mut(&mut self, quantity: Quantity) -> &mut f64 {
        match quantity {
            Quantity::Periods => &mut self.periods,
            Quantity::Speed => &mut self.speed_rpm,
            Quantity::Rate => &mut self.rate_hz,
            Quantity::Amplitude => &mut self.amplitude_v,
            Quantity::OffsetSine => &mut self.offset_sine_v,
            Quantity::OffsetCosine => &mut self.offset_cosine_v,
            Quantity::GainRatio => &mut self.gain_ratio,
            Quantity::PhaseError => &mut self.phase_error_deg,
            Quantity::Level => &mut self.level_v,
            Quantity::ThirdHarmonic => &mut self.third_harmonic_percent,
            Quantity::Modulation => &mut self.modulation_percent,
            Quantity::Noise => &mut self.noise_v,
            Quantity::InterferenceFrequency => &mut self.interference_hz,
            Quantity::Interference => &mut self.interference_v,
            Quantity::HumFrequency => &mut self.hum_hz,
            Quantity::Hum => &mut self.hum_v,
            Quantity::Eccentricity => &mut self.eccentricity_arcsec,
        }
    }
}

impl CheckedSettings {
    /// Returns the checked settings.
    pub fn settings(&self) -> &Settings {
        &self.0
    }
}

impl Default for Settings {
    /// Returns the settings of a good HIPERFACE encoder: 1024 periods at 60 rev/min, sampled at 100 kHz, with an
    /// amplitude of 0.5 V and 0.5 mV of noise. The interference frequency is 8 kHz, as is common in drives, and the
    /// mains frequency is 50 Hz.
    fn default() -> Self {
        Settings {
            periods: 1024.0,
            speed_rpm: 60.0,
            rate_hz: 100_000.0,
            amplitude_v: 0.5,
            offset_sine_v: 0.0,
            offset_cosine_v: 0.0,
            gain_ratio: 1.0,
            phase_error_deg: 0.0,
            level_v: 2.5,
            third_harmonic_percent: 0.0,
            modulation_percent: 0.0,
            noise_v: 0.0005,
            interference_hz: 8_000.0,
            interference_v: 0.0,
            hum_hz: 50.0,
            hum_v: 0.0,
            eccentricity_arcsec: 0.0,
            open_wire: None,
            terminated: true,
            references: ReferenceLevel::Level,
            seed: 1,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rejects_out_of_range_values() {
        for quantity in Quantity::ALL {
            let (least, most) = quantity.value_range();
            for value in [least, most] {
                let settings = Settings::default().with_value(quantity, value);
                assert_eq!(settings.get(quantity), value);
                assert!(settings.validate().is_ok(), "{quantity:?} {value}");
            }
            for value in [least.next_down(), most.next_up(), f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
                let error = Settings::default().with_value(quantity, value).validate().unwrap_err();
                assert_eq!((error.quantity, error.least, error.most), (quantity, least, most), "{value}");
            }
        }
        let error = Settings::default().with_value(Quantity::Periods, 16.5).validate().unwrap_err();
        assert_eq!(error.to_string(), "Periods must be from 1 to 65536, not 16.5");
    }

    #[test]
    fn quantities_have_separate_fields() {
        for quantity in Quantity::ALL {
            let changed = Settings::default().with_value(quantity, 0.123);
            let others = Quantity::ALL.into_iter().filter(|other| *other != quantity);
            others.for_each(|other| assert_eq!(changed.get(other), Settings::default().get(other), "{quantity:?}"));
        }
    }

    #[test]
    fn sample_period_is_whole_nanoseconds() {
        for (rate, nanoseconds) in [(1e6, 1_000), (44_100.0, 22_676), (10.0, 100_000_000), (30_000.0, 33_333)] {
            assert_eq!(Settings::default().with_value(Quantity::Rate, rate).period_ns(), nanoseconds);
        }
    }
}
