//! Results of the current session for a report: device checks and procedures. Profiles do not contain these results.

use super::ReportContext;
use crate::analysis::check::Verdict;
use crate::app::Text;
use crate::app::check::{CheckResultLine, verdict_text};
use crate::report::{Block, CellStyle, Mark, Section};

/// A result of the current session.
#[derive(Clone, Debug, PartialEq)]
pub enum SessionResult {
    /// Results of a device check.
    Check(Vec<CheckResultLine>),
    /// Title of a procedure, and its results in order.
    Procedure { title: Text, lines: Vec<Text> },
}

pub(super) fn result_section(context: &ReportContext<'_>, result: &SessionResult) -> Section {
    match result {
        SessionResult::Check(lines) => check_section(context, lines),
        SessionResult::Procedure { title, lines } => {
            let paragraphs = lines.iter().map(|line| Block::Paragraph(context.localize(line.clone())));
            paragraphs.fold(Section::new(context.localize(title.clone())), Section::with)
        }
    }
}

fn check_section(context: &ReportContext<'_>, lines: &[CheckResultLine]) -> Section {
    let mut table = context.table([
        ("report.name".into(), CellStyle::Text),
        ("logbook.result".into(), CellStyle::Text),
        ("report.verdict".into(), CellStyle::Short),
    ]);
    for line in lines {
        let mark = match line.verdict {
            Verdict::Skipped => Mark::None,
            Verdict::Good => Mark::Good,
            Verdict::Attention => Mark::Warning,
            Verdict::Bad => Mark::Bad,
        };
        let findings: Vec<String> = line.findings.iter().map(|text| context.localize(text.clone())).collect();
        let cells =
            [context.localize(line.step.clone()), findings.join("; "), context.localize(verdict_text(line.verdict))];
        table.add_marked_row(mark, cells);
    }
    Section::new(context.localize("check_card.title")).with(Block::Table(table))
}
