//! Result of a device check: a list of steps, each with a verdict. The steps and findings depend on the kind of device.

/// Outcome of a check step. A worse verdict compares as greater.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Verdict {
    Skipped,
    /// The step meets the requirements.
    Good,
    Attention,
    Bad,
}

/// Result of one check step. `S` identifies the step, and `F` is a finding.
#[derive(Clone, Debug, PartialEq)]
pub struct StepResult<S, F> {
    pub step: S,
    pub verdict: Verdict,
    pub findings: Vec<F>,
}

impl<S, F> StepResult<S, F> {
    /// Creates the result of a step. The verdict is that of the worst finding, or good if there are no findings.
    pub(crate) fn new(step: S, findings: Vec<(Verdict, F)>) -> Self {
        let verdict = findings.iter().map(|(verdict, _)| *verdict).max().unwrap_or(Verdict::Good);
        StepResult { step, verdict, findings: findings.into_iter().map(|(_, finding)| finding).collect() }
    }
}

/// Number of a device's write cycles recorded in the logbook. Writes by other programs are not recorded.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct CycleCount {
    pub seen: u64,
    /// Whether the logbook is complete. Entries may be missing if the logbook server is unavailable or the file was
    /// damaged.
    pub is_complete: bool,
}

impl CycleCount {
    /// Returns a count that is known to be complete.
    pub const fn complete(seen: u64) -> Self {
        CycleCount { seen, is_complete: true }
    }
}

/// Known wear of a device's non-volatile memory.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct MemoryWear {
    /// Counted write cycles, if known.
    pub seen: Option<CycleCount>,
    pub warning: u64,
    pub limit: u64,
}

impl MemoryWear {
    /// Returns the number of counted write cycles and the verdict on it. Returns `None` if the number is unknown.
    pub(crate) fn verdict(&self) -> Option<(Verdict, CycleCount)> {
        let count = self.seen?;
        let verdict = match count.seen {
            seen if seen >= self.limit => Verdict::Bad,
            seen if seen >= self.warning => Verdict::Attention,
            _ => Verdict::Good,
        };
        Some((verdict, count))
    }
}
