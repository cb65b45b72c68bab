//! A layout in a report: its settings, the frame and the timing as drawings, and the settings for interface modules.

use std::sync::Arc;

use super::TEXTS;
use super::design::LayoutDesigner;
use super::export::ExportFormat;
use super::form::{Entry, Row};
use crate::app::Text;
use crate::app::report::{ReportContent, ReportContext};
use crate::devices::ssi::jobs;
use crate::devices::ssi::profile::SsiProfile;
use crate::profile::ProfileDocument;
use crate::report::{Block, Fact, Section};

pub(super) fn content(
    profile: &SsiProfile,
    _document: &ProfileDocument,
    context: &ReportContext<'_>,
) -> Result<ReportContent, Text> {
    let (families, _) = jobs::families(context.store);
    let mut designer = LayoutDesigner::factory_default(Arc::new(families));
    designer.open(profile.clone());
    let mut facts = Vec::new();
    if let Some(family) = designer.family() {
        facts.push(Fact::new(context.localize(TEXTS.text("report.ssi_family")), &family.name));
    }
    let mut settings = Section::new(context.localize("report.settings")).with(Block::Facts(facts));
    for group in designer.form_groups() {
        let rows = group.rows.iter().map(|row| row_fact(context, row)).collect();
        settings = settings.with(Block::Heading(context.localize(TEXTS.text(group.title)))).with(Block::Facts(rows));
    }
    let reading = designer.reading_form().iter().map(|row| row_fact(context, row)).collect();
    let reading = Section::new(context.localize("report.interface")).with(Block::Facts(reading));
    let drawings = [("report.ssi_frame", ExportFormat::Frame), ("report.ssi_timing", ExportFormat::Timing)];
    let drawings = drawings.into_iter().filter_map(|(title, format)| {
        let drawing = designer.layout_drawing(format, context.language)?;
        Some(Section::new(context.localize(TEXTS.text(title))).with(Block::Drawing(drawing)))
    });
    let sections = drawings.collect::<Vec<_>>();
    let sections = [settings, reading].into_iter().chain(sections).collect();
    Ok(ReportContent { title: designer.title(), key: None, sections })
}

fn row_fact(context: &ReportContext<'_>, row: &Row) -> Fact {
    let label = context.localize(row.name.clone());
    match &row.entry {
        Entry::Number { value, unit } => {
            let unit = unit.as_ref().map(|unit| format!(" {}", context.localize(unit.clone()))).unwrap_or_default();
            Fact::new(label, format!("{value}{unit}"))
        }
        Entry::Frequency(hertz) => Fact::new(label, frequency_text(context, *hertz)),
        Entry::Choice { options, chosen } => {
            Fact::new(label, options.get(*chosen).map(|text| context.localize(text.clone())).unwrap_or_default())
        }
        Entry::Switch(on) => Fact::new(label, context.localize(if *on { "report.yes" } else { "report.no" })),
        Entry::Words(words) => Fact::new(label, words),
    }
}

fn frequency_text(context: &ReportContext<'_>, hertz: u32) -> String {
    let kilohertz = f64::from(hertz) / 1000.0;
    let decimals = if hertz.is_multiple_of(1000) { 0 } else { 3 };
    format!("{} kHz", context.number(kilohertz, decimals))
}
