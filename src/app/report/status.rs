//! The status that a device reported when it was read for a report.

use super::ReportContext;
use crate::app::Text;
use crate::profile::Body;
use crate::report::{Block, CellStyle, Mark, Section};

/// An error or warning, either current or from the memory of the device.
#[derive(Clone, Debug, PartialEq)]
pub struct StatusLine {
    pub mark: Mark,
    /// Code in the notation of the manual.
    pub code: String,
    pub text: Text,
    /// Causes and remedies given in the manual, if any.
    pub advice: Vec<Text>,
}

/// Values read from a device for a report, with the status it reported. The status is `None` for a kind of device
/// without one.
#[derive(Clone, Debug)]
pub struct DeviceReading {
    pub body: Body,
    pub status: Option<Vec<StatusLine>>,
}

pub(super) fn status_section(context: &ReportContext<'_>, status: &[StatusLine]) -> Section {
    let section = Section::new(context.localize("report.status"));
    if status.is_empty() {
        return section.with(Block::Paragraph(context.localize("report.no_errors")));
    }
    let mut table = context.table([
        ("report.code".into(), CellStyle::Short),
        ("report.meaning".into(), CellStyle::Text),
        ("report.advice".into(), CellStyle::Text),
        ("report.verdict".into(), CellStyle::Short),
    ]);
    for line in status {
        let advice: Vec<String> = line.advice.iter().map(|text| context.localize(text.clone())).collect();
        let verdict = Text::new(match line.mark {
            Mark::Bad => "report.error",
            Mark::Warning => "report.warning",
            Mark::Good | Mark::None => "report.earlier",
        });
        let cells =
            [line.code.clone(), context.localize(line.text.clone()), advice.join(" "), context.localize(verdict)];
        table.add_marked_row(line.mark, cells);
    }
    section.with(Block::Table(table))
}
