//! The result of a write. Each operation is either completed or not started.

/// The changes that were written.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct WrittenChanges {
    /// Number of operations of the plan that were executed.
    pub ops: usize,
    /// Number of changed values, counted as in a comparison. Some operations change only one value.
    pub written: u64,
    /// Number of values that were read back and found correct.
    pub verified: u64,
    /// Number of persistent writes, including repetitions and those that may not have taken place.
    pub write_cycles: u64,
}

/// A record of the progress of a write.
pub trait WriteRecord: Default {
    /// Returns the number of operations of the plan that were executed.
    fn operation_count(&self) -> usize;
    /// Returns the number of persistent writes, including those that may not have taken place.
    fn write_cycles(&self) -> u64;
}

impl WriteRecord for WrittenChanges {
    fn operation_count(&self) -> usize {
        self.ops
    }

    fn write_cycles(&self) -> u64 {
        self.write_cycles
    }
}

impl WrittenChanges {
    /// Counts a completed operation and the values that it changed.
    pub fn count_operation(&mut self, changed: u64) {
        self.ops += 1;
        self.written += changed;
    }
}
