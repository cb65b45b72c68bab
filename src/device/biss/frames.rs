//! The frames of a stream, each with its checksum looked at: what a reading says, or why there is none.

use crate::protocol::biss::{FrameError, Layout, Reading};
use crate::protocol::bridge::{BissData, BissStatus};

/// Why a frame of a stream has no reading.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum NoReading {
    /// Nobody acknowledged.
    #[error("nobody acknowledges on the bus")]
    NoAcknowledge,
    /// Its bits are no frame: a wrong checksum, a line that does not move.
    #[error(transparent)]
    Frame(#[from] FrameError),
    /// The adapter says something that this version does not know.
    #[error("the adapter has no frame, status {}", .0.byte())]
    Status(BissStatus),
}

/// A frame of a stream.
pub type Frame = Result<Reading, NoReading>;

/// What the frames of a packet say.
pub fn frames(layout: &Layout, data: &BissData) -> Vec<Frame> {
    data.values.iter().map(|(status, raw)| frame(layout, *status, *raw)).collect()
}

fn frame(layout: &Layout, status: BissStatus, raw: u64) -> Frame {
    match status {
        BissStatus::OK => Ok(layout.parse(raw)?),
        BissStatus::NO_ACKNOWLEDGE => Err(NoReading::NoAcknowledge),
        BissStatus::STUCK_LOW => Err(FrameError::StuckLow.into()),
        BissStatus::STUCK_HIGH => Err(FrameError::StuckHigh.into()),
        status => Err(NoReading::Status(status)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// BiSS reference 2: a good frame, the same with an error, the same with a flipped bit.
    #[test]
    fn a_frame_has_a_reading_or_says_why_not() {
        let reading = Reading { multiturn: 0x1234, singleturn: 0x18000, error: false, warning: false };
        let cases = [
            (BissStatus::OK, 0x024_6980_00CF, Ok(reading)),
            (BissStatus::OK, 0x000_0000_007C, Ok(Reading { error: true, ..Reading::default() })),
            (BissStatus::OK, 0x024_6980_00CE, Err(FrameError::Crc { expected: 0x0F, got: 0x0E }.into())),
            (BissStatus::OK, 0, Err(FrameError::StuckLow.into())),
            (BissStatus::NO_ACKNOWLEDGE, 0x024_6980_00CF, Err(NoReading::NoAcknowledge)),
            (BissStatus::STUCK_LOW, 0, Err(FrameError::StuckLow.into())),
            (BissStatus::STUCK_HIGH, (1 << 41) - 1, Err(FrameError::StuckHigh.into())),
            (BissStatus::new(9), 0x024_6980_00CF, Err(NoReading::Status(BissStatus::new(9)))),
        ];
        let values = cases.iter().map(|(status, raw, _)| (*status, *raw)).collect();
        let data = BissData { first_index: 0, t0_us: 0, period_us: 50, lost: 0, width: 6, values };
        let expected: Vec<Frame> = cases.into_iter().map(|(.., frame)| frame).collect();
        assert_eq!(frames(&Layout::default(), &data), expected);
    }
}
