//! A device check, for every kind of device: steps with a verdict each. Which steps there are and what they find is the
//! device's.

/// How a step ended. The worse verdict is the greater one.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Verdict {
    /// It was not checked.
    Skipped,
    /// As it should be.
    Good,
    /// Works, but needs attention.
    Attention,
    /// It does not work.
    Bad,
}

/// One line of a check: `S` names its step, `F` what it found.
#[derive(Clone, Debug, PartialEq)]
pub struct StepResult<S, F> {
    pub step: S,
    pub verdict: Verdict,
    /// The findings: values and codes.
    pub findings: Vec<F>,
}

impl<S, F> StepResult<S, F> {
    /// A step with what it found: it ended as the worst of that, and well where it found nothing.
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
    /// From here on a person should know.
    pub warning: u64,
    /// Write cycles that the memory endures.
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
