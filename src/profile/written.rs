//! What a write came to, where every operation of a plan is done or not.

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
