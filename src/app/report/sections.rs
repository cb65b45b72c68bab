//! Sections that the reports of all devices have.

use jiff::Timestamp;
use jiff::tz::TimeZone;

use super::ReportContext;
use crate::app::Text;
use crate::profile::Comparison;
use crate::report::{Block, CellStyle, Fact, Section};

/// Formats a time. Reports give UTC, so that a report of the same content is the same everywhere.
pub(super) fn time(at: Timestamp) -> String {
    at.to_zoned(TimeZone::UTC).strftime("%Y-%m-%d %H:%M:%S UTC").to_string()
}

/// Lists the differences to another profile.
pub(super) fn comparison_section(context: &ReportContext<'_>, name: &str, comparison: &Comparison) -> Section {
    let section = Section::new(context.say(Text::new("report.compared").with("name", name)));
    let missing = &comparison.one_sided_items();
    let is_equal = comparison.differences.is_empty() && missing.is_empty();
    let summary = match is_equal {
        true => Text::new("report.equal"),
        false => Text::new("report.different").with("count", comparison.differences.len() + missing.len()),
    };
    let section = section.with(Block::Paragraph(context.say(summary.with("compared", comparison.compared))));
    if is_equal {
        return section;
    }
    let mut table = context.table([
        (Text::new("report.item"), CellStyle::Code),
        (Text::new("report.here"), CellStyle::Code),
        (Text::new("report.there"), CellStyle::Code),
    ]);
    for difference in &comparison.differences {
        table.add_row([difference.item.clone(), difference.left.clone(), difference.right.clone()]);
    }
    let section = if table.rows.is_empty() { section } else { section.with(Block::Table(table)) };
    let sides = [("report.only_here", &comparison.only_left), ("report.only_there", &comparison.only_right)];
    let sides = sides.into_iter().filter(|(_, items)| !items.is_empty());
    let sides: Vec<Fact> = sides.map(|(id, items)| context.code(id, items.join(", "))).collect();
    if sides.is_empty() { section } else { section.with(Block::Facts(sides)) }
}
