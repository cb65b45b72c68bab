//! `do DEVICE check`: the lines of a device check, printed.

use serde_json::json;

use super::output::{Lines, Output};
use super::{Done, Failure, Result};
use crate::app::Text;
use crate::app::check::{CheckLine, verdict};
use crate::device::check::Verdict;

/// Prints the lines; one that is bad makes the command fail.
pub(super) fn show(output: &Output, lines: &[CheckLine]) -> Result {
    let good = lines.iter().all(|line| line.verdict != Verdict::Bad);
    let findings = |line: &CheckLine| line.findings.iter().map(Text::terminal).collect::<Vec<_>>();
    let mut list = Vec::new();
    let mut text = Lines::default();
    for line in lines {
        let (step, verdict) = (line.step.terminal(), verdict(line.verdict).terminal());
        let found = findings(line);
        // A sentence ends with the line, and not in the middle of it.
        let found: Vec<&str> = found.iter().map(|words| words.trim_end_matches('.')).collect();
        let words = format!("{verdict:9}  {}", found.join("; "));
        text.add(&step, words.trim_end());
        list.push(json!({"step": step, "verdict": verdict, "findings": findings(line)}));
    }
    output.show(&json!({"done": "check", "ok": good, "steps": list}), &text.text())?;
    if good { Ok(Done::Well) } else { Err(Failure::Failed(vec!["The check found faults, named above.".to_owned()])) }
}
