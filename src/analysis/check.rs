//! A device check, for every kind of device: steps with a verdict each. The steps and their findings are defined by the
//! device.

/// How a step ended. The worse verdict is the greater one.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Verdict {
    Skipped,
    /// As required.
    Good,
    Attention,
    /// It does not work.
    Bad,
}

/// One line of a check: `S` names its step, `F` what it found.
#[derive(Clone, Debug, PartialEq)]
pub struct StepResult<S, F> {
    pub step: S,
    pub verdict: Verdict,
    pub findings: Vec<F>,
}

impl<S, F> StepResult<S, F> {
    /// Creates a step with its findings: its verdict is the worst of them, or good without any.
    pub(crate) fn of(step: S, findings: Vec<(Verdict, F)>) -> Self {
        let verdict = findings.iter().map(|(verdict, _)| *verdict).max().unwrap_or(Verdict::Good);
        StepResult { step, verdict, findings: findings.into_iter().map(|(_, finding)| finding).collect() }
    }
}

/// The known wear of a device's memory.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Wear {
    /// Write cycles counted; `None` if not known.
    pub seen: Option<u64>,
    pub warning: u64,
    pub limit: u64,
}

impl Wear {
    /// Returns the verdict on the counted write cycles; `None` if they are not known.
    pub(crate) fn judged(&self) -> Option<(Verdict, u64)> {
        let seen = self.seen?;
        let verdict = match seen {
            _ if seen >= self.limit => Verdict::Bad,
            _ if seen >= self.warning => Verdict::Attention,
            _ => Verdict::Good,
        };
        Some((verdict, seen))
    }
}
