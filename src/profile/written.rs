//! The result of a write whose operations are each done or not.

/// What was written.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Written {
    /// Operations carried out, of the plan's.
    pub ops: usize,
    /// Things changed, counted as a comparison counts them; else one an operation.
    pub written: u64,
    /// Those of them that were read back and found as they should be.
    pub verified: u64,
    /// Persistent writes spent, or that may have been; repeated ones included.
    pub write_cycles: u64,
}

/// The record of a write that a kind of device keeps.
pub trait WriteRecord: Default {
    /// Operations carried out, of the plan's.
    fn ops(&self) -> usize;
    /// Persistent writes spent, or that may have been.
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
    /// Counts an operation that was carried out, and so many things that it has changed.
    pub fn carried_out(&mut self, changed: u64) {
        self.ops += 1;
        self.written += changed;
    }
}
