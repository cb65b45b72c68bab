//! Compares the outputs in received words with the cam programs of the encoder.

use crate::devices::interbus::procedures::WordReading;
use crate::devices::interbus::protocol::{CompiledPrograms, Program, ProgramNumber, StartupMode, Value};

/// The encoder's cam programs, and how many words had outputs that match them.
#[derive(Clone, Debug)]
pub struct OutputComparison {
    programs: [Option<Program>; ProgramNumber::COUNT],
    compiled: CompiledPrograms,
    /// Number of words whose outputs match their program.
    pub same: u64,
    pub other: u64,
    /// The latest word with outputs that differ from its program.
    pub last: Option<OutputMismatch>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct OutputMismatch {
    pub position: u32,
    /// Outputs in the word of the encoder, with bit i for cam i.
    pub own: u8,
    pub expected: u8,
}

impl Default for OutputComparison {
    fn default() -> Self {
        OutputComparison::from_programs([None; ProgramNumber::COUNT])
    }
}

impl OutputComparison {
    fn from_programs(programs: [Option<Program>; ProgramNumber::COUNT]) -> Self {
        let compiled = CompiledPrograms::new(&programs.map(Option::unwrap_or_default));
        OutputComparison { programs, compiled, same: 0, other: 0, last: None }
    }

    /// Sets the programs of the encoder. If they have changed, the comparison starts again.
    pub(super) fn set_programs(&mut self, programs: &[Option<Program>; ProgramNumber::COUNT]) {
        if self.programs != *programs {
            *self = OutputComparison::from_programs(*programs);
        }
    }

    /// Compares the outputs in a word with its program at the same position. Words without outputs or a position are
    /// ignored.
    pub(super) fn compare(&mut self, reading: &WordReading) {
        let Some(StartupMode::Cams(program)) = reading.mode else { return };
        let at = usize::from(program.get() - 1);
        let is_known = self.programs.get(at).is_some_and(Option::is_some);
        let value = reading.position().and_then(Value::new).filter(|_| is_known);
        let (Some(value), Some(own)) = (value, reading.cams()) else { return };
        let all = self.compiled.outputs(value);
        let Some(expected) = all.get(at).copied() else { return };
        if own.outputs == expected {
            self.same += 1;
        } else {
            self.other += 1;
            self.last = Some(OutputMismatch { position: value.get(), own: own.outputs, expected });
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::devices::interbus::protocol::{Cam, Gear, WindowShift};
    use crate::units::Moment;

    /// Cam 3 of program 2 is on from 15 to 213 (reference 7).
    #[test]
    fn compares_outputs_with_program() {
        let mut program = Program { mask: 8, ..Program::default() };
        program.cams[3] = Some(Cam { start: Value::new(15).unwrap(), stop: Value::new(213).unwrap() });
        let mut programs = [None; ProgramNumber::COUNT];
        programs[1] = Some(program);
        let mut preview = OutputComparison::default();
        preview.set_programs(&programs);
        let reading = |number: u8, position: u32, outputs: u32| WordReading {
            at: Moment::START,
            word: position << 8 | outputs,
            mode: ProgramNumber::new(number).map(StartupMode::Cams),
            gear: Gear::new(3600, 1).ok(),
            shift: WindowShift::new(0),
        };
        for (position, outputs) in [(14, 0), (15, 8), (213, 8), (214, 0)] {
            preview.compare(&reading(2, position, outputs));
        }
        // Other programs are unknown.
        preview.compare(&reading(1, 15, 0));
        assert_eq!((preview.same, preview.other), (4, 0));
        preview.compare(&reading(2, 214, 8));
        assert_eq!(preview.last, Some(OutputMismatch { position: 214, own: 8, expected: 0 }));
        preview.set_programs(&programs);
        assert_eq!(preview.other, 1, "the same programs");
        preview.set_programs(&[None; ProgramNumber::COUNT]);
        assert_eq!((preview.same, preview.other), (0, 0));
    }
}
