//! Detection of an unknown frame length. Only at the correct length does the checksum keep matching while the shaft
//! turns. See section 2 of the reference.

use super::crc::Crc;

/// Data widths to be tried, in bits. The range is not documented (`U`).
const DATA_BITS: std::ops::RangeInclusive<u8> = 10..=48;
/// Number of different frames in a row whose checksum must match. The number is not documented (`U`).
const REQUIRED_FRAMES: usize = 8;

/// Returns the data width without the checksum, or `None` if no width fits or too few frames differ.
///
/// Each frame contains the first `clocked` bits after the control bit. Bit 0 is the last bit received.
///
/// Consecutive frames with the same data are counted once. At a wrong length, one frame in 64 matches by chance, and
/// repetitions of such a frame would match as well.
pub fn detect_data_bits(frames: &[u64], clocked: u8, crc: &Crc) -> Option<u8> {
    DATA_BITS.into_iter().find(|bits| matches_widths(frames, clocked, *bits, crc))
}

fn matches_widths(frames: &[u64], clocked: u8, bits: u8, crc: &Crc) -> bool {
    let Some(behind) = clocked.checked_sub(bits + crc.width()) else { return false };
    let sums = |frame: u64| {
        let data = frame.checked_shr(u32::from(behind) + u32::from(crc.width())).unwrap_or(0);
        (data, frame.checked_shr(behind.into()).unwrap_or(0) & ((1 << crc.width()) - 1))
    };
    let (mut before, mut in_a_row) = (None, 0);
    for frame in frames {
        let (data, sum) = sums(*frame);
        if before.replace(data) == Some(data) {
            continue;
        }
        in_a_row = if u64::from(crc.compute(data, bits)) == sum { in_a_row + 1 } else { 0 };
        if in_a_row >= REQUIRED_FRAMES {
            return true;
        }
    }
    false
}

#[cfg(test)]
mod tests {
    use super::super::{Layout, PositionData};
    use super::*;
    use proptest::prelude::*;

    fn crc() -> Crc {
        Crc::new(Crc::POSITION, 0, true).unwrap()
    }

    /// Returns the first 64 bits on the line: a `frame` of `bits` bits, followed by zeros.
    fn first_bits_on_line(frame: u64, bits: u8) -> u64 {
        frame << (64 - bits)
    }

    /// Returns frames from a shaft that moves by `step` between frames.
    fn turning(layout: &Layout, step: u32, count: u32) -> Vec<u64> {
        let place = |at: u32| 0x155 + at * step;
        let reading = |at| PositionData { multiturn: 3, singleturn: place(at), ..PositionData::default() };
        (0..count).map(|at| first_bits_on_line(layout.emit(&reading(at)), layout.bits())).collect()
    }

    #[test]
    fn eight_distinct_frames_determine_width() {
        let kit = Layout::default();
        let frames = turning(&kit, 7, 8);
        assert_eq!(detect_data_bits(&frames, 64, &crc()), Some(35));
        assert_eq!(detect_data_bits(&frames[..7], 64, &crc()), None);
        let at_rest = [frames[0]; 100];
        assert_eq!(detect_data_bits(&at_rest, 64, &crc()), None);
        let mut damaged = frames.clone();
        damaged[4] ^= 1 << 40;
        assert_eq!(detect_data_bits(&damaged, 64, &crc()), None, "one that does not fit begins anew");
        let [_, rest @ ..] = frames.as_slice() else { panic!() };
        assert_eq!(detect_data_bits(&[&damaged, rest, &turning(&kit, 9, 2)[1..]].concat(), 64, &crc()), Some(35));
        let short: Vec<u64> = frames.iter().map(|frame| frame >> 24).collect();
        assert_eq!(detect_data_bits(&short, 40, &crc()), None, "not clocked far enough");
        assert_eq!(detect_data_bits(&[0; 20], 64, &crc()), None);
        assert_eq!(detect_data_bits(&[u64::MAX; 20], 64, &crc()), None);
    }

    proptest! {
        /// Frames whose upper bits are constant must not be mistaken for shorter frames.
        #[test]
        fn finds_any_frame_length(multiturn in 0u8..=16, singleturn in 9u8..=30, step in 1u32..40) {
            let layout = Layout::new(multiturn, singleturn, true, true, Some(crc())).unwrap();
            let expected = layout.data_bits();
            prop_assume!(expected <= 48);
            prop_assert_eq!(detect_data_bits(&turning(&layout, step, 12), 64, &crc()), Some(expected));
        }

        #[test]
        fn arbitrary_frames_never_panic(frames: Vec<u64>, clocked: u8) {
            let _ = detect_data_bits(&frames, clocked, &crc());
        }
    }
}
