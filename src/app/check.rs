//! Formats the results of a device check as texts, for every kind of device.

use super::Text;
use crate::analysis::check::{StepResult, Verdict};

#[derive(Clone, Debug, PartialEq, Eq)]
pub struct CheckResultLine {
    pub step: Text,
    pub verdict: Verdict,
    pub findings: Vec<Text>,
}

impl CheckResultLine {
    pub(crate) fn from_step<S: Copy, F>(line: &StepResult<S, F>, step: fn(S) -> Text, finding: fn(&F) -> Text) -> Self {
        CheckResultLine {
            step: step(line.step),
            verdict: line.verdict,
            findings: line.findings.iter().map(finding).collect(),
        }
    }
}

pub fn verdict_text(verdict: Verdict) -> Text {
    Text::new(match verdict {
        Verdict::Skipped => "check.skipped",
        Verdict::Good => "check.good",
        Verdict::Attention => "check.attention",
        Verdict::Bad => "check.bad",
    })
}
