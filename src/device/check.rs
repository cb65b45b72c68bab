//! A device check, for every kind of device: steps with a verdict each. Which steps there are and what they find is the
//! device's.

/// How a step ended. The worse is the greater.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Verdict {
    /// As it should be.
    Good,
    /// It works, and somebody should look.
    Attention,
    /// It does not work.
    Bad,
}

/// One line of a check: `S` names its step, `F` what it found.
#[derive(Clone, Debug, PartialEq)]
pub struct Line<S, F> {
    /// What was checked.
    pub step: S,
    /// How it ended.
    pub verdict: Verdict,
    /// What was found: values and codes.
    pub findings: Vec<F>,
}
