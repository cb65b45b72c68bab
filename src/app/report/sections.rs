//! Sections common to the reports of all devices.

use jiff::Timestamp;
use jiff::tz::TimeZone;

use super::ReportContext;
use crate::app::{ComparedRows, ItemValue, Text};
use crate::bits::hex;
use crate::report::{Block, CellStyle, Fact, Section};

/// Formats a time in UTC, so that reports with the same content are identical everywhere.
pub(super) fn time(at: Timestamp) -> String {
    at.to_zoned(TimeZone::UTC).strftime("%Y-%m-%d %H:%M:%S UTC").to_string()
}

/// Lists the differences from another profile.
pub(super) fn comparison_section(context: &ReportContext<'_>, name: &str, compared: &ComparedRows) -> Section {
    let section = Section::new(context.localize(Text::new("report.compared").with("name", name)));
    let summary = match compared.different {
        0 => Text::new("report.equal"),
        count => Text::new("report.different").with("count", count),
    };
    let section = section.with(Block::Paragraph(context.localize(summary.with("compared", compared.compared))));
    let mut table = context.table([
        (Text::new("report.item"), CellStyle::Text),
        (Text::new("report.here"), CellStyle::Code),
        (Text::new("report.there"), CellStyle::Code),
    ]);
    let mut one_sided = [("report.only_here", Vec::new()), ("report.only_there", Vec::new())];
    let [(_, only_here), (_, only_there)] = &mut one_sided;
    for row in compared.groups.iter().flat_map(|group| &group.rows).filter(|row| row.differs) {
        let name = context.localize(row.name.clone());
        match (&row.left, &row.right) {
            (Some(left), Some(right)) => table.add_row([name, value(context, left), value(context, right)]),
            (Some(_), None) => only_here.push(name),
            (None, _) => only_there.push(name),
        }
    }
    let section = if table.rows.is_empty() { section } else { section.with(Block::Table(table)) };
    let sides = one_sided.into_iter().filter(|(_, names)| !names.is_empty());
    let sides: Vec<Fact> = sides.map(|(id, names)| Fact::new(context.localize(id), names.join("; "))).collect();
    if sides.is_empty() { section } else { section.with(Block::Facts(sides)) }
}

fn value(context: &ReportContext<'_>, value: &ItemValue) -> String {
    match value {
        ItemValue::Bytes(bytes) => hex(bytes),
        ItemValue::Text(text) => context.localize(text.clone()),
    }
}
