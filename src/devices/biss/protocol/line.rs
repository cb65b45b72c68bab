//! One cycle on the data line SLO, sampled once per clock after the latch. A cycle consists of acknowledge, start bit,
//! control bit, frame and time-out. This module depends on neither the clock period nor the duration of the time-out.
//! See manual, figure 2.

use super::single_cycle::Layout;

/// One cycle of the data line.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct BissCycle {
    /// Number of clocks, at least 1, for which SLO was low while the encoder was busy.
    pub acknowledge: usize,
    /// CDS, the control frame bit that the encoder sends in this cycle.
    pub control: bool,
    /// Frame bits including the checksum, right-justified.
    pub raw: u64,
}

/// Reason why the samples are not a valid cycle.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum CycleError {
    /// The line never went low, because no encoder is connected or a wire is broken.
    #[error("the encoder does not acknowledge")]
    NoAcknowledge,
    /// The line never returned to high.
    #[error("the encoder is not ready")]
    NotReady,
    /// The samples end before the frame does.
    #[error("{got} bits were received after the start bit instead of {expected}")]
    Short {
        /// Number of samples needed for the control bit and the frame.
        expected: usize,
        /// Number of samples received after the start bit.
        got: usize,
    },
    /// The line is high immediately after the frame, when the time-out cannot have elapsed yet.
    #[error("the line is high after the last bit: the frame is longer than {bits} bits")]
    TimeOut {
        /// Frame length in the layout, in bits.
        bits: u8,
    },
}

impl BissCycle {
    /// Finds the frame in the samples of a cycle. Samples after the start of the time-out are ignored.
    ///
    /// # Errors
    /// Returns a [`CycleError`] if the samples do not contain a complete cycle. The checksum of the frame is not
    /// verified here, but by [`Layout::parse`].
    pub fn parse(samples: &[bool], layout: &Layout) -> Result<Self, CycleError> {
        // The line is high before the acknowledge.
        let low = samples.iter().position(|sample| !sample).ok_or(CycleError::NoAcknowledge)?;
        let behind_low = samples.get(low..).unwrap_or_default();
        let acknowledge = behind_low.iter().position(|sample| *sample).ok_or(CycleError::NotReady)?;
        let behind_start = behind_low.get(acknowledge + 1..).unwrap_or_default();
        let expected = 1 + usize::from(layout.bits());
        let (Some((control, rest)), true) = (behind_start.split_first(), behind_start.len() >= expected) else {
            return Err(CycleError::Short { expected, got: behind_start.len() });
        };
        let (frame, after) = rest.split_at(expected - 1);
        if after.first() == Some(&true) {
            return Err(CycleError::TimeOut { bits: layout.bits() });
        }
        let raw = frame.iter().fold(0, |raw, bit| raw << 1 | u64::from(*bit));
        Ok(BissCycle { acknowledge, control: *control, raw })
    }

    /// Returns the samples from the acknowledge to the first sample of the time-out.
    pub fn emit(&self, layout: &Layout) -> Vec<bool> {
        let mut samples = vec![false; self.acknowledge.max(1)];
        samples.extend([true, self.control]);
        samples.extend((0..layout.bits()).rev().map(|at| self.raw >> at & 1 == 1));
        samples.push(false);
        samples
    }
}

#[cfg(test)]
mod tests {
    use super::super::single_cycle::PositionData;
    use super::*;
    use proptest::prelude::*;

    /// Cycle from section 7 of the reference with multiturn 1234h, singleturn 18000h and an acknowledge of three
    /// clocks.
    const SAMPLES: &str = "000 1 0 0001001000110100 11000000000000000 1 1 001111 0";

    fn samples(text: &str) -> Vec<bool> {
        text.bytes().filter(|byte| *byte != b' ').map(|byte| byte == b'1').collect()
    }

    #[test]
    fn published_samples_match() {
        let layout = Layout::default();
        let cycle = BissCycle { acknowledge: 3, control: false, raw: 0x024_6980_00CF };
        assert_eq!(BissCycle::parse(&samples(SAMPLES), &layout), Ok(cycle));
        assert_eq!(cycle.emit(&layout), samples(SAMPLES));
        // The level of the line before the cycle and after the time-out is ignored.
        let rested = [vec![true; 2], samples(SAMPLES), vec![false, true, true]].concat();
        assert_eq!(BissCycle::parse(&rested, &layout), Ok(cycle));
        let reading = PositionData { multiturn: 0x1234, singleturn: 0x18000, error: false, warning: false };
        assert_eq!(layout.parse(cycle.raw), Ok(reading));
    }

    #[test]
    fn detects_every_truncation() {
        let whole = samples(SAMPLES);
        let layout = Layout::default();
        for cut in 0..whole.len() - 1 {
            let got = BissCycle::parse(&whole[..cut], &layout);
            let expected = match cut {
                0 => CycleError::NoAcknowledge,
                1..=3 => CycleError::NotReady,
                _ => CycleError::Short { expected: 42, got: cut - 4 },
            };
            assert_eq!(got, Err(expected), "cut at {cut}");
        }
    }

    #[test]
    fn detects_line_without_encoder() {
        let layout = Layout::default();
        assert_eq!(BissCycle::parse(&[true; 64], &layout), Err(CycleError::NoAcknowledge));
        assert_eq!(BissCycle::parse(&[false; 64], &layout), Err(CycleError::NotReady));
        let long = Layout::new(16, 16, true, true, layout.crc().cloned()).unwrap();
        // The layout is one bit shorter than the encoder's frame, so the last bit of the frame, which is 1, falls into
        // the time-out.
        assert_eq!(BissCycle::parse(&samples(SAMPLES), &long), Err(CycleError::TimeOut { bits: 40 }));
    }

    proptest! {
        #[test]
        fn emitted_cycles_parse_back(acknowledge in 1usize..80, control: bool, raw in 0u64..1 << 41) {
            let cycle = BissCycle { acknowledge, control, raw };
            let layout = Layout::default();
            prop_assert_eq!(BissCycle::parse(&cycle.emit(&layout), &layout), Ok(cycle));
        }

        #[test]
        fn arbitrary_samples_never_panic(samples: Vec<bool>) {
            let _ = BissCycle::parse(&samples, &Layout::default());
        }
    }
}
