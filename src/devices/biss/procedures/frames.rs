//! Frames of a stream. Each frame yields a position with a verified checksum or an error.

use std::sync::Arc;
use std::time::Duration;

use crate::buses::bridge::procedures::Chunk;
use crate::buses::bridge::protocol::{BissData, BissStatus};
use crate::devices::biss::protocol::{FrameError, Layout, PositionData};
use crate::units::Moment;

/// The reason why a streamed frame yields no position.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum FrameReadError {
    #[error("no encoder acknowledges on the bus")]
    NoAcknowledge,
    /// The bits are not a valid frame, because the checksum is wrong or the level of the line does not change.
    #[error(transparent)]
    Frame(#[from] FrameError),
    #[error("the adapter has no frame, status {}", .0.byte())]
    Status(BissStatus),
}

pub type Frame = Result<PositionData, FrameReadError>;

/// Consecutive frames of a stream, at equal intervals.
#[derive(Clone, Debug, PartialEq)]
pub struct ConsecutiveFrames {
    /// Number of the first frame since the start of the stream, including missing frames.
    pub first: u64,
    pub at: Moment,
    pub period_ns: i64,
    /// Number of frames lost before the first of these frames.
    pub lost: u64,
    /// The frames, at least one.
    pub frames: Vec<Frame>,
    pub layout: Arc<Layout>,
    /// Whether the multiturn width is known, so that positions can be split into turns and steps.
    pub is_split_known: bool,
    pub clock_hz: u32,
    /// Whether the adapter cannot send frames at the requested interval.
    pub is_limited: bool,
}

impl ConsecutiveFrames {
    pub(super) fn new(
        portion: &Chunk,
        frames: Vec<Frame>,
        (layout, is_split_known): (Arc<Layout>, bool),
        clock_hz: u32,
        wished_us: u32,
    ) -> Self {
        let Chunk { first, time, period_ns, lost, .. } = *portion;
        let is_limited = period_ns > i64::from(wished_us) * 1000;
        // A time before the start of the stream is replaced by the start.
        let at = Moment::from_elapsed(Duration::from_nanos(time.as_nanoseconds().max(0).unsigned_abs()));
        ConsecutiveFrames { first, at, period_ns, lost, frames, layout, is_split_known, clock_hz, is_limited }
    }

    pub const fn is_stream_start(&self) -> bool {
        self.first == self.lost
    }

    /// Returns each frame with its sampling time.
    pub fn iter_with_times(&self) -> impl Iterator<Item = (Moment, &Frame)> {
        let period = Duration::from_nanos(self.period_ns.unsigned_abs());
        (0..).zip(&self.frames).map(move |(number, frame)| (self.at + period * number, frame))
    }

    pub fn crc_errors(&self) -> usize {
        let is_wrong = |frame: &&Frame| matches!(frame, Err(FrameReadError::Frame(FrameError::Crc { .. })));
        self.frames.iter().filter(is_wrong).count()
    }
}

pub fn parse_frames(layout: &Layout, data: &BissData) -> Vec<Frame> {
    data.values.iter().map(|(status, raw)| parse_frame(layout, *status, *raw)).collect()
}

fn parse_frame(layout: &Layout, status: BissStatus, raw: u64) -> Frame {
    match status {
        BissStatus::OK => Ok(layout.parse(raw)?),
        BissStatus::NO_ACKNOWLEDGE => Err(FrameReadError::NoAcknowledge),
        BissStatus::STUCK_LOW => Err(FrameError::StuckLow.into()),
        BissStatus::STUCK_HIGH => Err(FrameError::StuckHigh.into()),
        status => Err(FrameReadError::Status(status)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The frames are taken from section 2 of the BiSS reference: a valid frame, the same frame with the error bit, and
    /// the same frame with a flipped bit.
    #[test]
    fn frame_yields_reading_or_error() {
        let reading = PositionData { multiturn: 0x1234, singleturn: 0x18000, error: false, warning: false };
        let cases = [
            (BissStatus::OK, 0x024_6980_00CF, Ok(reading)),
            (BissStatus::OK, 0x000_0000_007C, Ok(PositionData { error: true, ..PositionData::default() })),
            (BissStatus::OK, 0x024_6980_00CE, Err(FrameError::Crc { expected: 0x0F, got: 0x0E }.into())),
            (BissStatus::OK, 0, Err(FrameError::StuckLow.into())),
            (BissStatus::NO_ACKNOWLEDGE, 0x024_6980_00CF, Err(FrameReadError::NoAcknowledge)),
            (BissStatus::STUCK_LOW, 0, Err(FrameError::StuckLow.into())),
            (BissStatus::STUCK_HIGH, (1 << 41) - 1, Err(FrameError::StuckHigh.into())),
            (BissStatus::new(9), 0x024_6980_00CF, Err(FrameReadError::Status(BissStatus::new(9)))),
        ];
        let values = cases.iter().map(|(status, raw, _)| (*status, *raw)).collect();
        let data = BissData { first_index: 0, t0_us: 0, period_us: 50, lost: 0, width: 6, values };
        let expected: Vec<Frame> = cases.into_iter().map(|(.., frame)| frame).collect();
        assert_eq!(parse_frames(&Layout::default(), &data), expected);
    }
}
