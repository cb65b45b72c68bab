//! Clock frequencies of the buses, and the durations of their frames.

use std::time::Duration;

pub(super) const MAX_CLOCK_HZ: u32 = 10_000_000;
const MIN_CLOCK_HZ: u32 = 80_000;
/// Frequency of the crystal in hertz. All available clocks are integer fractions of it.
const CRYSTAL_HZ: u32 = 60_000_000;
/// Maximum time in microseconds that the encoder takes to acknowledge a frame.
const ACKNOWLEDGE_US: u32 = 7;

#[derive(Clone, Copy)]
pub(super) struct BissSetting {
    pub(super) clock_hz: u32,
    pub(super) bits: u8,
    pub(super) timeout_us: u16,
}

impl BissSetting {
    /// Returns the duration of a frame with acknowledgement, start bit, control bit and time-out.
    pub(super) fn frame_duration(self) -> Duration {
        let clocks = u64::from(self.bits) + 2;
        let clocked = Duration::from_nanos((clocks * 1_000_000_000).div_ceil(self.clock_hz.max(1).into()));
        let fixed = ACKNOWLEDGE_US + u32::from(self.timeout_us);
        Duration::from_micros(fixed.into()) + Duration::from_micros(clocked.as_nanos().div_ceil(1000) as u64)
    }
}

#[derive(Clone, Copy)]
pub(super) struct SsiSetting {
    pub(super) clock_hz: u32,
    pub(super) clocks: u8,
    pub(super) pause_us: u16,
}

impl SsiSetting {
    pub(super) fn burst_duration(self) -> Duration {
        let nanoseconds = u64::from(self.clocks) * 1_000_000_000;
        Duration::from_nanos(nanoseconds.div_ceil(self.clock_hz.max(1).into()))
    }

    /// Returns the minimum sampling period, which is the duration of a word and the following pause, in whole
    /// microseconds.
    pub(super) fn min_period_us(self) -> u32 {
        let microseconds = self.burst_duration().as_nanos().div_ceil(1000);
        u32::try_from(microseconds).unwrap_or(u32::MAX).saturating_add(self.pause_us.into())
    }
}

/// Returns the fastest available clock that does not exceed the requested one. The result is `None` if the request is
/// below the slowest clock.
pub(super) fn nearest_available_clock(clock_hz: u32) -> Option<u32> {
    let wanted = clock_hz.min(MAX_CLOCK_HZ);
    (wanted >= MIN_CLOCK_HZ).then(|| CRYSTAL_HZ / CRYSTAL_HZ.div_ceil(wanted))
}
