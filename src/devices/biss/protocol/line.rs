//! The data line (SLO) in one cycle, one sample per clock after the latch: acknowledge, start bit, control bit, frame,
//! time-out (manual figure 2). The durations of clock and time-out do not matter here.

use super::single_cycle::Layout;

/// One cycle of the data line.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Cycle {
    /// Clocks for which the encoder was still working (SLO = 0), at least 1.
    pub acknowledge: usize,
    /// CDS: the bit of the control frame that the encoder sends in this cycle.
    pub control: bool,
    /// The frame, right-justified, including its checksum.
    pub raw: u64,
}

/// The reason why samples are not a cycle.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum CycleError {
    /// The line never went low: no encoder, or a broken wire.
    #[error("the encoder does not acknowledge")]
    NoAcknowledge,
    /// The line never returned to 1.
    #[error("the encoder is not ready")]
    NotReady,
    /// The samples end within the frame.
    #[error("{got} bits behind the start bit are too few for {expected}")]
    Short {
        /// Control bit and frame.
        expected: usize,
        /// Bits after the start bit.
        got: usize,
    },
    /// After the frame the line is 1 although the time-out cannot be over.
    #[error("the line is high behind the last bit: the frame is longer than {bits} bits")]
    TimeOut {
        /// Bits of the layout.
        bits: u8,
    },
}

impl Cycle {
    /// Finds the frame in the samples of a cycle. Samples after the first one of the time-out are ignored.
    ///
    /// # Errors
    /// [`CycleError`]. The frame's checksum is checked by [`Layout::parse`].
    pub fn parse(samples: &[bool], layout: &Layout) -> Result<Self, CycleError> {
        // Before the acknowledge the line is at rest.
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
        Ok(Cycle { acknowledge, control: *control, raw })
    }

    /// Returns the samples from the acknowledge to the first of the time-out.
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

    /// Reference 7: MT 1234, ST 18000, three clocks of acknowledge.
    const SAMPLES: &str = "000 1 0 0001001000110100 11000000000000000 1 1 001111 0";

    fn samples(text: &str) -> Vec<bool> {
        text.bytes().filter(|byte| *byte != b' ').map(|byte| byte == b'1').collect()
    }

    #[test]
    fn published_samples_match() {
        let layout = Layout::default();
        let cycle = Cycle { acknowledge: 3, control: false, raw: 0x024_6980_00CF };
        assert_eq!(Cycle::parse(&samples(SAMPLES), &layout), Ok(cycle));
        assert_eq!(cycle.emit(&layout), samples(SAMPLES));
        // A line at rest before it, and the line after the time-out, change nothing.
        let rested = [vec![true; 2], samples(SAMPLES), vec![false, true, true]].concat();
        assert_eq!(Cycle::parse(&rested, &layout), Ok(cycle));
        let reading = PositionData { multiturn: 0x1234, singleturn: 0x18000, error: false, warning: false };
        assert_eq!(layout.parse(cycle.raw), Ok(reading));
    }

    #[test]
    fn every_truncation_is_detected() {
        let whole = samples(SAMPLES);
        let layout = Layout::default();
        for cut in 0..whole.len() - 1 {
            let got = Cycle::parse(&whole[..cut], &layout);
            let expected = match cut {
                0 => CycleError::NoAcknowledge,
                1..=3 => CycleError::NotReady,
                _ => CycleError::Short { expected: 42, got: cut - 4 },
            };
            assert_eq!(got, Err(expected), "cut at {cut}");
        }
    }

    #[test]
    fn a_line_without_encoder_is_reported() {
        let layout = Layout::default();
        assert_eq!(Cycle::parse(&[true; 64], &layout), Err(CycleError::NoAcknowledge));
        assert_eq!(Cycle::parse(&[false; 64], &layout), Err(CycleError::NotReady));
        let long = Layout::new(16, 16, true, true, layout.crc().cloned()).unwrap();
        // One bit less than the encoder sends: its last one, 1, is in the place of the time-out.
        assert_eq!(Cycle::parse(&samples(SAMPLES), &long), Err(CycleError::TimeOut { bits: 40 }));
    }

    proptest! {
        #[test]
        fn emitted_cycles_parse_back(acknowledge in 1usize..80, control: bool, raw in 0u64..1 << 41) {
            let cycle = Cycle { acknowledge, control, raw };
            let layout = Layout::default();
            prop_assert_eq!(Cycle::parse(&cycle.emit(&layout), &layout), Ok(cycle));
        }

        #[test]
        fn no_samples_panic(samples: Vec<bool>) {
            let _ = Cycle::parse(&samples, &Layout::default());
        }
    }
}
