//! SSI settings and the resulting times (`protocol/ssi.md`, section 1).

use bridge_codec::{ErrorCode, SsiFlags};

use crate::Refusal;

/// Settings for reading SSI words.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SsiSetting {
    /// Number of clock pulses per word, 1 to 64.
    pub clocks: u8,
    /// Divisor of [`BASE_HZ`](Self::BASE_HZ).
    pub divisor: u16,
    /// Pause after a word in microseconds.
    pub pause_us: u16,
}

impl SsiSetting {
    /// Base frequency in hertz. Every SSI clock frequency is this value divided by an integer, so all edges are evenly
    /// spaced.
    pub const BASE_HZ: u32 = 12_000_000;
    /// Maximum clock frequency in hertz.
    pub const MAX_HZ: u32 = 4_000_000;
    const MIN_HZ: u32 = 50_000;

    /// Checks the settings. The actual clock frequency does not exceed the requested one.
    pub(crate) fn new(clocks: u8, clock_hz: u32, pause_us: u16, flags: SsiFlags) -> Result<Self, Refusal> {
        if !(1..=64).contains(&clocks) {
            return Err((ErrorCode::BAD_ARGUMENT, "1 to 64 clocks"));
        }
        if clock_hz < Self::MIN_HZ {
            return Err((ErrorCode::BAD_ARGUMENT, "a clock of at least 50 kHz"));
        }
        if flags != SsiFlags::FALLING_EDGE {
            return Err((ErrorCode::BAD_ARGUMENT, "sampling at the falling edge only"));
        }
        // At most 240.
        let divisor = Self::BASE_HZ.div_ceil(clock_hz.min(Self::MAX_HZ)) as u16;
        Ok(SsiSetting { clocks, divisor, pause_us })
    }

    /// Returns the actual clock frequency in hertz, rounded down.
    pub fn clock_hz(self) -> u32 {
        Self::BASE_HZ / u32::from(self.divisor.max(1))
    }

    /// Returns the duration of the clock burst for a word in microseconds, rounded up.
    pub fn burst_us(self) -> u32 {
        // 64 clocks at the lowest frequency are 1280 µs.
        (u32::from(self.clocks) * u32::from(self.divisor)).div_ceil(12)
    }

    /// Returns the minimum interval between two words in microseconds.
    pub(crate) fn least_period_us(self) -> u32 {
        self.burst_us() + u32::from(self.pause_us) + 2
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn never_exceeds_requested_clock() {
        let cases = [
            (50_000, 50_000),
            (80_000, 80_000),
            (100_000, 100_000),
            (300_000, 300_000),
            (400_000, 400_000),
            (700_000, 666_666),
            (1_000_000, 1_000_000),
            (1_500_000, 1_500_000),
            (2_000_000, 2_000_000),
            (3_999_999, 3_000_000),
            (4_000_000, 4_000_000),
            (u32::MAX, 4_000_000),
        ];
        for (wanted, actual) in cases {
            let setting = SsiSetting::new(25, wanted, 20, SsiFlags::FALLING_EDGE).unwrap();
            assert_eq!(setting.clock_hz(), actual, "{wanted} Hz");
        }
    }

    /// The expected durations are from `protocol/ssi.md`, section 1: at 400 kHz, 25 clocks take 62.5 µs and 33 clocks
    /// take 82.5 µs.
    #[test]
    fn durations_match_reference() {
        let burst = |clocks, hz| SsiSetting::new(clocks, hz, 25, SsiFlags::FALLING_EDGE).unwrap();
        assert_eq!(burst(25, 400_000).burst_us(), 63);
        assert_eq!(burst(33, 400_000).burst_us(), 83);
        assert_eq!(burst(25, 1_000_000).burst_us(), 25);
        assert_eq!(burst(33, 400_000).least_period_us(), 83 + 25 + 2);
    }

    #[test]
    fn rejects_invalid_settings() {
        let falling = SsiFlags::FALLING_EDGE;
        for (clocks, hz, flags) in [
            (0, 1_000_000, falling),
            (65, 1_000_000, falling),
            (25, 49_999, falling),
            (25, 0, falling),
            (25, 1_000_000, SsiFlags::new(0)),
            (25, 1_000_000, SsiFlags::new(3)),
        ] {
            let refused = SsiSetting::new(clocks, hz, 20, flags).unwrap_err();
            assert_eq!(refused.0, ErrorCode::BAD_ARGUMENT, "{clocks} {hz}");
        }
    }
}
