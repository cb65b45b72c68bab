//! BiSS C settings, the resulting times, and the content of a frame (`protocol/biss.md`, sections 1 and 2).
//!
//! The state machines sample four levels before the data: the line before the frame, the acknowledgement, the start bit
//! and the control bit. Without an encoder, the search for an edge ends after a fixed number of clocks, so that every
//! frame has the same number of bits.

use bridge_codec::{BissStatus, ErrorCode};

use crate::{FrameWords, Refusal};

/// Settings for reading BiSS frames.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct BissSetting {
    /// Number of data and CRC bits after the control bit, 1 to 64.
    pub bits: u8,
    /// Divisor of [`MAX_HZ`](Self::MAX_HZ).
    pub divisor: u16,
    /// Time in microseconds after which the encoder detects the end of a frame.
    pub timeout_us: u16,
}

/// The content of a frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct BissFrame {
    pub(crate) status: BissStatus,
    /// Control bit of the encoder.
    pub(crate) cds: bool,
    /// Right-justified data and CRC.
    pub(crate) raw: u64,
}

impl BissSetting {
    /// Maximum clock frequency in hertz. Every clock frequency is this value divided by an integer.
    pub const MAX_HZ: u32 = 10_000_000;
    const MIN_HZ: u32 = 80_000;
    const MAX_TIMEOUT_US: u16 = 500;
    /// Number of levels sampled before the data.
    const LEADING_LEVELS: u8 = 4;
    /// Maximum round-trip delay of the line, in tenths of a microsecond.
    const LINE_DELAY: u32 = 10;
    /// Maximum time that an encoder needs to prepare its data, in tenths of a microsecond, with a margin over the
    /// specified 7 µs.
    const BUSY: u32 = 80;

    /// Checks the settings. The actual clock frequency does not exceed the requested one.
    pub(crate) fn new(clock_hz: u32, data_bits: u8, crc_bits: u8, timeout_us: u16) -> Result<Self, Refusal> {
        let bits = data_bits.saturating_add(crc_bits);
        if data_bits == 0 || bits > 64 {
            return Err((ErrorCode::BAD_ARGUMENT, "1 to 64 bits"));
        }
        if clock_hz < Self::MIN_HZ {
            return Err((ErrorCode::BAD_ARGUMENT, "a clock of at least 80 kHz"));
        }
        // A register access takes at most 97 frames, during which the adapter does nothing else.
        if timeout_us > Self::MAX_TIMEOUT_US {
            return Err((ErrorCode::BAD_ARGUMENT, "a time-out of 500 µs at most"));
        }
        // At most 125.
        let divisor = Self::MAX_HZ.div_ceil(clock_hz.min(Self::MAX_HZ)) as u16;
        Ok(BissSetting { bits, divisor, timeout_us })
    }

    /// Returns the actual clock frequency in hertz, rounded down.
    pub fn clock_hz(self) -> u32 {
        Self::MAX_HZ / u32::from(self.divisor.max(1))
    }

    /// Returns the number of bits sampled by the state machine.
    pub const fn sampled_bits(self) -> u8 {
        self.bits + Self::LEADING_LEVELS
    }

    /// Returns the number of steps after which the search for an edge ends. A step is a sixth of a clock for the
    /// acknowledgement, and a clock for the start bit.
    pub fn search_steps(self) -> u32 {
        let clocks = |tenths: u32| tenths.div_ceil(u32::from(self.divisor.max(1)));
        (6 * (2 + clocks(Self::LINE_DELAY))).max(2 + clocks(Self::BUSY))
    }

    /// Returns the maximum duration of a frame without the time-out, in microseconds.
    pub fn frame_us(self) -> u32 {
        let steps = self.search_steps();
        // Search for the acknowledgement, search for the start bit, start bit, control bit, data, and two final clocks.
        let clocks = (steps / 6 + 1) + steps + 4 + u32::from(self.bits);
        (clocks * u32::from(self.divisor)).div_ceil(10)
    }

    /// Returns the minimum interval between two frames in microseconds.
    pub(crate) fn least_period_us(self) -> u32 {
        let divisor = u32::from(self.divisor);
        // A valid frame is followed by the time-out. Its parts: half a clock, twice the delay, start, control, data,
        // and end.
        let clocks = (5 + u32::from(self.bits)) * divisor;
        let good = (clocks + Self::BUSY + 2 * Self::LINE_DELAY).div_ceil(10) + u32::from(self.timeout_us);
        good.max(self.frame_us() + 1)
    }

    /// Decodes a frame from its words.
    pub(crate) fn decode(self, words: FrameWords) -> BissFrame {
        let frame = words.join(self.sampled_bits());
        let mask = u64::MAX >> (64 - u32::from(self.bits.clamp(1, 64)));
        let raw = frame as u64 & mask;
        let [idle, acknowledged, start, cds] = [3, 2, 1, 0].map(|at| frame >> (self.bits + at) & 1 == 1);
        let status = match (idle, acknowledged, start) {
            (true, false, true) => BissStatus::OK,
            (_, true, _) => BissStatus::STUCK_HIGH,
            (false, false, _) => BissStatus::STUCK_LOW,
            // The line was high before the frame and did not return to high.
            (true, false, false) => BissStatus::NO_ACKNOWLEDGE,
        };
        BissFrame { status, cds, raw: if status == BissStatus::OK { raw } else { 0 } }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn setting(clock_hz: u32) -> BissSetting {
        BissSetting::new(clock_hz, 35, 6, 18).unwrap()
    }

    #[test]
    fn never_exceeds_requested_clock() {
        let cases = [
            (80_000, 80_000),
            (1_000_000, 1_000_000),
            (2_000_000, 2_000_000),
            (3_000_000, 2_500_000),
            (9_999_999, 5_000_000),
            (10_000_000, 10_000_000),
            (u32::MAX, 10_000_000),
        ];
        for (wanted, actual) in cases {
            assert_eq!(setting(wanted).clock_hz(), actual, "{wanted} Hz");
        }
        for (hz, data, crc) in [(79_999, 35, 6), (1_000_000, 0, 6), (1_000_000, 60, 5), (1_000_000, 255, 255)] {
            assert_eq!(BissSetting::new(hz, data, crc, 18).unwrap_err().0, ErrorCode::BAD_ARGUMENT);
        }
        assert!(BissSetting::new(1_000_000, 35, 6, 500).is_ok() && BissSetting::new(1_000_000, 35, 6, 501).is_err());
    }

    /// The longest frame times are from `protocol/biss.md`, section 2, for 7 µs busy time and 18 µs time-out, in tenths
    /// of a microsecond. The adapter also allows for a line delay of 1 µs and two more clocks.
    #[test]
    fn interval_holds_longest_frame() {
        for (hz, worst) in [(1_000_000, 700), (2_000_000, 475), (5_000_000, 340), (10_000_000, 295), (80_000, 5875)] {
            let least = setting(hz).least_period_us() * 10;
            assert!((worst..worst + 130 + 2 * 10_000_000 / hz * 10).contains(&least), "{hz} Hz: {least}");
        }
    }

    /// The search lasts long enough for the slowest encoder (7 µs busy time) on the longest line (1 µs delay).
    #[test]
    fn search_covers_long_line_and_slow_encoder() {
        for hz in [80_000, 1_000_000, 2_000_000, 5_000_000, 10_000_000] {
            let steps = f64::from(setting(hz).search_steps());
            let clock_us = 1e6 / f64::from(setting(hz).clock_hz());
            assert!(steps / 6.0 * clock_us >= 1.0 + clock_us, "{hz} Hz: {steps} steps to the acknowledgement");
            assert!(steps * clock_us >= 7.0 + clock_us, "{hz} Hz: {steps} steps to the start bit");
        }
    }

    #[test]
    fn frame_has_status_control_bit_and_data() {
        // Idle 1, acknowledgement 0, start 1, control bit 1, then the example frame of the reference for 1234 and
        // 18000.
        let words = |head: u32| {
            let frame = u64::from(head) << 41 | 0x024_6980_00CF;
            FrameWords([(frame >> 13) as u32, (frame & 0x1FFF) as u32, 0])
        };
        let read = |head| setting(1_000_000).decode(words(head));
        assert_eq!(read(0b1011), BissFrame { status: BissStatus::OK, cds: true, raw: 0x024_6980_00CF });
        assert!(!read(0b1010).cds);
        for (head, status) in [
            (0b1111, BissStatus::STUCK_HIGH),
            (0b0000, BissStatus::STUCK_LOW),
            (0b0010, BissStatus::STUCK_LOW),
            (0b1000, BissStatus::NO_ACKNOWLEDGE),
        ] {
            assert_eq!((read(head).status, read(head).raw), (status, 0), "{head:04b}");
        }
    }
}
