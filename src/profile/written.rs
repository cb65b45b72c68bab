//! Result of a write whose operations are complete or not started, never partial.

/// The changes that were written.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Written {
    /// Number of operations of the plan that were carried out.
    pub ops: usize,
    /// Number of changed values, counted as in a comparison, or otherwise one per operation.
    pub written: u64,
    /// Number of values that were read back and are correct.
    pub verified: u64,
    /// Number of persistent writes performed or possibly performed, including repetitions.
    pub write_cycles: u64,
}

/// The record of a write kept by a kind of device.
pub trait WriteRecord: Default {
    /// Returns the number of operations of the plan that were carried out.
    fn ops(&self) -> usize;
    /// Returns the number of persistent writes performed or possibly performed.
    fn write_cycles(&self) -> u64;
}

impl WriteRecord for Written {
    fn ops(&self) -> usize {
        self.ops
    }

    fn write_cycles(&self) -> u64 {
        self.write_cycles
    }
}

impl Written {
    /// Counts an operation that was carried out, and the number of values it changed.
    pub fn carried_out(&mut self, changed: u64) {
        self.ops += 1;
        self.written += changed;
    }
}
