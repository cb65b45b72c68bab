//! Cam programs compiled for fast evaluation.

use super::cam::{Program, ProgramNumber};
use super::value::Value;

/// Cam programs, stored as a list of sections with constant outputs. A preview evaluates them at millions of positions.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct CompiledPrograms {
    /// Start positions of the sections in ascending order. `before` holds the outputs at positions below the first
    /// start.
    starts: Vec<u32>,
    /// Outputs in each section, one byte per program, with the first program in the lowest byte.
    outputs: Vec<u64>,
    before: u64,
}

impl CompiledPrograms {
    /// Compiles eight programs.
    pub fn new(programs: &[Program; ProgramNumber::COUNT]) -> Self {
        let at =
            |position: u32| u64::from_le_bytes(programs.map(|program| program.outputs(Value::from_word(position))));
        let cams = programs.iter().flat_map(|program| program.cams.iter().flatten());
        let mut starts: Vec<u32> = cams.flat_map(|cam| [cam.start.get(), cam.stop.get() + 1]).collect();
        starts.sort_unstable();
        starts.dedup();
        // No section begins after the last position.
        starts.retain(|start| (1..=Value::MAX.get()).contains(start));
        let outputs = starts.iter().map(|start| at(*start)).collect();
        CompiledPrograms { starts, outputs, before: at(0) }
    }

    /// Returns the outputs of all programs at a position, one byte per program with bit i for cam i. Each byte equals
    /// [`Program::outputs`].
    pub fn outputs(&self, position: Value) -> [u8; ProgramNumber::COUNT] {
        let begun = self.starts.partition_point(|start| *start <= position.get());
        let stretch = begun.checked_sub(1).and_then(|at| self.outputs.get(at));
        stretch.unwrap_or(&self.before).to_le_bytes()
    }
}
