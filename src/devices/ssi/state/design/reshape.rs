//! Adaptation of a frame to a different position range or code. The frame becomes longer or shorter, as if the user had
//! redrawn it.

use crate::devices::ssi::protocol::{Code, FrameDescriptor, LayoutError, PositionCode, Range};

/// Returns the frame with a different position range or code. If there are zeros after the position, they absorb the
/// change. Otherwise, the parts after the position move, and the frame becomes longer or shorter.
///
/// # Errors
/// Returns an error if the positions or code words are invalid. The caller must check whether the complete frame is
/// valid.
pub(super) fn with_positions(
    before: &FrameDescriptor,
    range: Range,
    code: Code,
) -> Result<FrameDescriptor, LayoutError> {
    let bits_before = bits(&before.range, before.code)?;
    let bits_now = bits(&range, code)?;
    let mut now = FrameDescriptor { range, code, ..before.clone() };
    let parted = matches!(range, Range::Bits { multiturn, singleturn } if multiturn > 0 && singleturn > 0);
    if !parted || code == Code::Bcd {
        now.between = 0;
    }
    let used = |descriptor: &FrameDescriptor, bits: u8| {
        u16::from(descriptor.lead) + u16::from(descriptor.between) + u16::from(bits)
    };
    let (used_before, used_now) = (used(before, bits_before), used(&now, bits_now));
    let area = u16::from(before.area);
    let is_padded = area > used_before;
    let area_now = if is_padded && used_now <= area { area } else { used_now };
    let moved = |clock: u8| {
        let clock = i32::from(clock) + i32::from(area_now) - i32::from(area);
        u8::try_from(clock.clamp(0, 255)).unwrap_or(u8::MAX)
    };
    now.area = u8::try_from(area_now).unwrap_or(u8::MAX);
    now.clocks = moved(before.clocks);
    for error in now.errors.iter_mut().filter(|error| error.clock > before.area) {
        error.clock = moved(error.clock);
    }
    if let Some(parity) = &mut now.parity {
        parity.clock = moved(parity.clock);
    }
    if let Some(repeat) = &mut now.repeat {
        // The word and its repetition become longer or shorter.
        repeat.word = moved(repeat.word);
        now.clocks = moved(now.clocks);
    }
    Ok(now)
}

fn bits(range: &Range, code: Code) -> Result<u8, LayoutError> {
    Ok(PositionCode::new(code, range.last_position()?)?.bits())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::devices::ssi::protocol::{BitMeaning, ErrorBit, Layout, Parity, Repeat};

    fn error(clock: u8) -> ErrorBit {
        ErrorBit {
            name: "E".to_owned(),
            clock,
            meaning: BitMeaning::Invalid,
            active_low: false,
            cleared_by_transfer: false,
        }
    }

    fn bits(multiturn: u8, singleturn: u8) -> Range {
        Range::Bits { multiturn, singleturn }
    }

    #[test]
    fn unpadded_frame_resizes_with_position() {
        // AFM60 with 12 + 18 bits, and the error bit after them on clock 31.
        let before = FrameDescriptor { clocks: 31, errors: vec![error(31)], ..FrameDescriptor::binary(12, 18) };
        let now = with_positions(&before, bits(12, 15), Code::Gray).unwrap();
        assert_eq!((now.clocks, now.area, now.errors[0].clock, now.code), (28, 27, 28, Code::Gray));
        let back = with_positions(&now, bits(12, 18), Code::Binary).unwrap();
        assert_eq!(back, before);
        // In decimal digits, 3600 steps need four digits. The 12 bits occupied 12 clocks.
        let steps = Range::Steps { per_turn: 3600, turns: 1 };
        let plain = FrameDescriptor { range: steps, ..FrameDescriptor::binary(0, 12) };
        let bcd = with_positions(&plain, steps, Code::Bcd).unwrap();
        assert_eq!((bcd.clocks, bcd.area), (16, 16));
    }

    #[test]
    fn trailing_zeros_absorb_position_changes() {
        // AHS36 with 14 clocks for the position and the error bit on clock 15.
        let before =
            FrameDescriptor { clocks: 15, area: 14, errors: vec![error(15)], ..FrameDescriptor::binary(0, 12) };
        let now = with_positions(&before, bits(0, 13), Code::Binary).unwrap();
        assert_eq!((now.clocks, now.area, now.errors[0].clock), (15, 14, 15));
        let longer = with_positions(&before, bits(0, 16), Code::Binary).unwrap();
        assert_eq!((longer.clocks, longer.area, longer.errors[0].clock), (17, 16, 17));
        assert!(Layout::new(longer).is_ok());
    }

    #[test]
    fn repeated_frame_grows_in_both_copies() {
        let before = FrameDescriptor {
            clocks: 27,
            parity: Some(Parity { clock: 13, even: true }),
            repeat: Some(Repeat { word: 13, gap: 1 }),
            ..FrameDescriptor::binary(0, 12)
        };
        let now = with_positions(&before, bits(0, 14), Code::Binary).unwrap();
        assert_eq!((now.clocks, now.parity.unwrap().clock, now.repeat.unwrap().word), (31, 15, 15));
        assert!(Layout::new(now).is_ok());
    }

    #[test]
    fn rejects_impossible_frames() {
        let plain = FrameDescriptor::binary(0, 12);
        assert!(with_positions(&plain, bits(0, 0), Code::Binary).is_err());
        let odd = Range::Steps { per_turn: 361, turns: 1 };
        assert!(with_positions(&plain, odd, Code::GrayExcess).is_err());
        // The frame would be too long, which must not cause a panic.
        let long = with_positions(&FrameDescriptor { lead: 40, ..plain }, bits(32, 32), Code::Binary).unwrap();
        assert!(Layout::new(long).is_err());
    }
}
