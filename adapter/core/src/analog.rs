//! Sampling of sine and cosine. The converter samples all inputs in turn without a pause, so the cosine follows its
//! sine with the same delay in every pair. At lower rates, only every nth pair is used.

use alloc::vec::Vec;

use bridge_codec::{AnalogData, ErrorCode, MAX_BODY, StreamData};

use crate::{Bus, Refusal};

/// Sample rate of the analogue inputs, as a divisor.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct AnalogSetting {
    /// Divisor of [`MAX_HZ`](Self::MAX_HZ) without a remainder.
    divisor: u32,
}

/// Offset and gain that correct the amplifier at a converter input.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Correction {
    /// Value without a signal, in sixteenths of a converter step.
    pub offset: u16,
    /// Gain in 16384ths.
    pub gain: u16,
}

/// A running stream of analogue samples.
#[derive(Clone, Debug)]
pub(crate) struct AnalogStream {
    divisor: u32,
    corrections: [Correction; 2],
    /// Start time of the current conversions, and the number of the first pair sampled by them.
    start: (u64, u64),
    /// Number of conversions since this start.
    converted: u64,
    /// Number of the next pair, counted from the start of the stream.
    next: u64,
    lost: u32,
}

impl AnalogSetting {
    /// Number of inputs that are converted in turn: sine, cosine, supply voltage, board voltage and temperature.
    pub const INPUTS: u32 = 5;
    /// Duration of a conversion in microseconds.
    const CONVERSION_US: u32 = 2;
    /// Maximum sample rate in pairs per second.
    pub const MAX_HZ: u32 = 1_000_000 / (Self::INPUTS * Self::CONVERSION_US);
    /// Delay of the cosine after the sine in nanoseconds.
    pub const SKEW_NS: u16 = 1_000 * Self::CONVERSION_US as u16;
    const MIN_HZ: u32 = 10;
    /// Resolution of the converter in bits.
    pub(crate) const BITS: u8 = 12;
    /// Differential voltage of the encoder, in microvolts, that is converted to 32 767. The amplifier has a gain of
    /// 2.2, and the converter has a range of ±1.65 V.
    pub(crate) const FULL_SCALE_MICROVOLT: u32 = 749_977;

    /// Creates the setting for a requested sample rate. The actual rate does not exceed it.
    pub(crate) fn new(sample_hz: u32) -> Result<Self, Refusal> {
        if sample_hz < Self::MIN_HZ {
            return Err((ErrorCode::BAD_ARGUMENT, "a rate of at least 10 Hz"));
        }
        let least = Self::MAX_HZ.div_ceil(sample_hz.min(Self::MAX_HZ));
        let divisor = (least..=Self::MAX_HZ).find(|divisor| Self::MAX_HZ.is_multiple_of(*divisor));
        Ok(AnalogSetting { divisor: divisor.unwrap_or(Self::MAX_HZ) })
    }

    /// Returns the actual rate in hertz.
    pub(crate) fn sample_hz(self) -> u32 {
        Self::MAX_HZ / self.divisor.max(1)
    }
}

impl Correction {
    /// No correction: the offset is in the middle of the range, and the gain is 1.
    pub const NONE: Correction = Correction { offset: 2048 * 16, gain: 1 << 14 };

    /// Converts a converter value to a fraction of full scale.
    fn apply(self, value: u16) -> i16 {
        let steps = i32::from(value) * 16 - i32::from(self.offset);
        let corrected = steps.saturating_mul(self.gain.into()) >> 14;
        // The value is within the range of the type.
        corrected.clamp(i16::MIN.into(), i16::MAX.into()) as i16
    }
}

impl AnalogStream {
    /// Maximum time in microseconds before a packet is sent, even if it is not full.
    const FLUSH_US: u64 = 5_000;
    /// Number of bytes before the samples in a packet.
    const HEADER_BYTES: usize = 15;
    /// Maximum number of samples in a packet.
    const MAX_SAMPLES: u64 = ((MAX_BODY - Self::HEADER_BYTES) / 4) as u64;

    /// Starts the conversions.
    pub(crate) fn begin<B: Bus>(setting: AnalogSetting, corrections: [Correction; 2], bus: &mut B) -> Self {
        let start = (bus.start_conversions(), 0);
        AnalogStream { divisor: setting.divisor, corrections, start, converted: 0, next: 0, lost: 0 }
    }

    /// Returns the interval between two pairs in microseconds.
    fn period_us(&self) -> u64 {
        u64::from(self.divisor * AnalogSetting::INPUTS * AnalogSetting::CONVERSION_US)
    }

    /// Returns the number of the conversion that samples the sine of a pair.
    fn conversion(&self, pair: u64) -> u64 {
        (pair - self.start.1) * u64::from(self.divisor * AnalogSetting::INPUTS)
    }

    /// Returns the next packet, or `None` if it is neither full nor due.
    pub(crate) fn packet<B: Bus>(&mut self, bus: &mut B) -> Option<StreamData> {
        if bus.has_overrun() {
            self.restart(bus);
        }
        self.converted += u64::from(bus.converted().wrapping_sub(self.converted as u32));
        // The oldest conversions may be overwritten while they are read.
        let kept = u64::from(B::CONVERSIONS - B::CONVERSIONS / 8);
        let oldest = self.converted.saturating_sub(kept);
        let next = self.conversion(self.next);
        let step = u64::from(self.divisor * AnalogSetting::INPUTS);
        if next < oldest {
            // Half of the samples are dropped, so that no more are lost directly afterwards.
            let lost = (oldest + kept / 2 - next).div_ceil(step);
            self.next += lost;
            self.lost = self.lost.saturating_add(u32::try_from(lost).unwrap_or(u32::MAX));
        }
        let next = self.conversion(self.next);
        // A pair is complete once its cosine is converted.
        let ready = self.converted.checked_sub(next + 2).map_or(0, |behind| behind / step + 1);
        let t0_us = self.start.0 + (self.next - self.start.1) * self.period_us();
        if ready == 0 || ready < Self::MAX_SAMPLES && bus.now_us() < t0_us + Self::FLUSH_US {
            return None;
        }
        let count = ready.min(Self::MAX_SAMPLES);
        let [sine, cosine] = self.corrections;
        let samples: Vec<(i16, i16)> = (0..count)
            .map(|at| {
                // Conversion numbers wrap around.
                let number = (next + at * step) as u32;
                let value = |number: u32| bus.conversion(number);
                (sine.apply(value(number)), cosine.apply(value(number.wrapping_add(1))))
            })
            .collect();
        let first_index = self.next as u32;
        self.next += count;
        let lost = u16::try_from(core::mem::take(&mut self.lost)).unwrap_or(u16::MAX);
        Some(StreamData::Analog(AnalogData { first_index, t0_us, lost, samples }))
    }

    /// Restarts the conversions after a missed conversion, which changes the order of the inputs.
    fn restart<B: Bus>(&mut self, bus: &mut B) {
        bus.stop_conversions();
        let start_us = bus.start_conversions();
        let elapsed = start_us.saturating_sub(self.start.0);
        let pair = (self.start.1 + elapsed.div_ceil(self.period_us())).max(self.next);
        self.lost = self.lost.saturating_add(u32::try_from(pair - self.next).unwrap_or(u32::MAX));
        (self.start, self.next, self.converted) = ((start_us, pair), pair, 0);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rates_divide_highest_rate() {
        for (wanted, actual) in [
            (u32::MAX, 100_000),
            (100_000, 100_000),
            (99_999, 50_000),
            (40_000, 25_000),
            (20_000, 20_000),
            (10_000, 10_000),
            (9_000, 6_250),
            (1_000, 1_000),
            (10, 10),
        ] {
            assert_eq!(AnalogSetting::new(wanted).unwrap().sample_hz(), actual, "{wanted}");
        }
        assert!(AnalogSetting::new(9).is_err());
    }

    /// A converter step is 16 units, and 32 768 units correspond to 0.75 V: a range of ±1.65 V with a gain of 2.2.
    #[test]
    fn values_are_fractions_of_full_scale() {
        let values = [0, 2047, 2048, 2049, 4095].map(|value| Correction::NONE.apply(value));
        assert_eq!(values, [-32_768, -16, 0, 16, 32_752]);
        let full_scale = 1.65e6 / 2.2 * 32_767.0 / 32_768.0;
        assert!((f64::from(AnalogSetting::FULL_SCALE_MICROVOLT) - full_scale).abs() < 0.5);
    }

    #[test]
    fn corrects_and_limits_offset_and_gain() {
        let correction = Correction { offset: 2050 * 16 + 8, gain: 18_022 };
        assert_eq!(correction.apply(2051), 8);
        // 16 008 · 1.1.
        assert_eq!(correction.apply(3051), 17_608);
        assert_eq!(correction.apply(0), i16::MIN);
        assert_eq!(Correction { offset: 0, gain: u16::MAX }.apply(4095), i16::MAX);
    }
}
