//! Packs the frames of a stream. The hardware clocks frames at equal intervals and keeps a limited number of them.
//! Frames that are not fetched in time are lost, and the next packet reports how many.

use alloc::vec::Vec;

use bridge_codec::{BissData, MAX_BODY, SsiData, StreamData};

use crate::{Bus, Clocking, FrameWords};

/// Maximum time in microseconds before a packet is sent, even if it is not full.
const FLUSH_US: u64 = 10_000;
/// Number of bytes before the samples in a packet.
const HEADER_BYTES: usize = 20;

/// A running stream of SSI or BiSS frames.
#[derive(Clone, Debug)]
pub struct ClockedStream {
    clocking: Clocking,
    period_us: u32,
    /// Time of the first frame of the stream.
    start_us: u64,
    /// Number of the next frame, counted from the start of the stream.
    next: u64,
    lost: u32,
}

impl ClockedStream {
    pub(crate) const fn new(clocking: Clocking, period_us: u32, start_us: u64) -> Self {
        ClockedStream { clocking, period_us, start_us, next: 0, lost: 0 }
    }

    pub(crate) const fn clocking(&self) -> Clocking {
        self.clocking
    }

    const fn bits(&self) -> u8 {
        match self.clocking {
            Clocking::Ssi(setting) => setting.clocks,
            Clocking::Biss(setting) => setting.sampled_bits(),
        }
    }

    /// Returns the sizes of a value and of a sample in a packet, in bytes.
    fn width(&self) -> (u8, usize) {
        match self.clocking {
            Clocking::Ssi(setting) => (setting.clocks.div_ceil(8), usize::from(setting.clocks.div_ceil(8))),
            Clocking::Biss(setting) => (setting.bits.div_ceil(8), usize::from(setting.bits.div_ceil(8)) + 1),
        }
    }

    /// Returns the next packet, or `None` if it is neither full nor due.
    pub(crate) fn packet<B: Bus>(&mut self, bus: &B) -> Option<StreamData> {
        let words = u32::from(FrameWords::count(self.bits()));
        // The number of received words wraps around, but is always less than 2³² ahead.
        let taken = (self.next as u32).wrapping_mul(words);
        let mut ready = bus.received().wrapping_sub(taken) / words;
        // The oldest words may be overwritten while they are read.
        let kept = B::CAPACITY / words - B::CAPACITY / words / 8;
        if ready > kept {
            // Half of the frames are dropped, so that no more are lost directly afterwards.
            let lost = ready - kept / 2;
            self.next += u64::from(lost);
            self.lost = self.lost.saturating_add(lost);
            ready -= lost;
        }
        let (width, size) = self.width();
        let fit = ((MAX_BODY - HEADER_BYTES) / size.max(1)).min(255);
        let full = u32::try_from(fit).unwrap_or(255);
        let t0_us = self.start_us + self.next * u64::from(self.period_us);
        let is_due = bus.now_us() >= t0_us + FLUSH_US;
        if ready == 0 || (ready < full && !is_due) {
            return None;
        }
        let count = ready.min(full);
        // The number of the first sample reveals gaps of more than 65 535 samples.
        let lost = u16::try_from(core::mem::take(&mut self.lost)).unwrap_or(u16::MAX);
        let first_index = self.next as u32;
        let frames: Vec<FrameWords> = (0..count).map(|at| self.frame(bus, self.next + u64::from(at), words)).collect();
        self.next += u64::from(count);
        let period_us = self.period_us;
        Some(match self.clocking {
            Clocking::Ssi(setting) => {
                let values = frames.into_iter().map(|words| words.join(setting.clocks) as u64).collect();
                StreamData::Ssi(SsiData { first_index, t0_us, period_us, lost, width, values })
            }
            Clocking::Biss(setting) => {
                let decoded = frames.into_iter().map(|words| setting.decode(words));
                let values = decoded.map(|frame| (frame.status, frame.raw)).collect();
                StreamData::Biss(BissData { first_index, t0_us, period_us, lost, width, values })
            }
        })
    }

    fn frame<B: Bus>(&self, bus: &B, number: u64, words: u32) -> FrameWords {
        let first = (number as u32).wrapping_mul(words);
        let mut frame = FrameWords::default();
        for (at, word) in (0..words).zip(&mut frame.0) {
            *word = bus.word(first.wrapping_add(at));
        }
        frame
    }
}
