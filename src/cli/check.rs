//! Output of `do DEVICE check`, one line per item.

use serde_json::{Value as Json, json};

use super::output::{Lines, Output};
use super::{Failure, Result, Success};
use crate::analysis::check::Verdict;
use crate::app::Text;
use crate::app::check::{CheckResultLine, verdict_text};
use crate::link::LineQuality;

/// Prints the results of the check. Returns an error if a result is a fault.
pub(crate) fn show(output: &Output, lines: &[CheckResultLine]) -> Result {
    show_check(output, lines, None)
}

/// Prints the results of the check, and the line quality if it was measured. Returns an error if a result is a fault.
pub(crate) fn show_check(output: &Output, lines: &[CheckResultLine], quality: Option<&LineQuality>) -> Result {
    let good = lines.iter().all(|line| line.verdict != Verdict::Bad);
    let findings = |line: &CheckResultLine| line.findings.iter().map(Text::terminal_text).collect::<Vec<_>>();
    let (mut list, mut results) = (Vec::new(), Vec::new());
    let mut text = Lines::default();
    for line in lines {
        let (step, word) = (line.step.terminal_text(), verdict_keyword(line.verdict));
        let verdict = verdict_text(line.verdict).terminal_text();
        let found = findings(line);
        // Only the end of the line has a full stop, not each finding.
        let found: Vec<&str> = found.iter().map(|words| words.trim_end_matches('.')).collect();
        let found = found.join("; ");
        text.add_line(&step, format!("{verdict:9}  {found}").trim_end());
        results.push(json!({"name": step, "verdict": word, "text": found}));
        list.push(json!({"step": step, "verdict": verdict, "findings": findings(line)}));
    }
    let mut json = json!({"done": "check", "ok": good, "lines": results, "steps": list});
    if let (Some(quality), Some(object)) = (quality, json.as_object_mut()) {
        object.insert("line_quality".to_owned(), line_quality(quality));
    }
    output.show(&json, &text.text())?;
    if good {
        Ok(Success::Completed)
    } else {
        Err(Failure::Failed(vec!["The check found the faults named above.".to_owned()]))
    }
}

fn verdict_keyword(verdict: Verdict) -> &'static str {
    match verdict {
        Verdict::Skipped => "skipped",
        Verdict::Good => "good",
        Verdict::Attention => "warning",
        Verdict::Bad => "bad",
    }
}

fn line_quality(quality: &LineQuality) -> Json {
    let milliseconds = |percent| quality.answer_time_percentile(percent).map(|time| time.as_secs_f64() * 1e3);
    json!({
        "requests": quality.requests,
        "replies": quality.replies,
        "retries": quality.retries,
        "damaged": quality.damaged,
        "silent": quality.unanswered,
        "late": quality.late,
        "answer_ms_median": milliseconds(50),
        "answer_ms_p99": milliseconds(99),
    })
}
