//! The values of an encoder in a report: identity, settings, data sheet, procedure results and data areas.

use std::sync::Arc;

use super::explain as explained;
use super::{Encoder, TEXTS, format};
use crate::app::Text;
use crate::app::explain::literal_text;
use crate::app::report::{ReportContent, ReportContext, StatusLine, byte_table};
use crate::app::session::Session;
use crate::bits::hex;
use crate::devices::biss::jobs::{load_descriptions, logbook_key};
use crate::devices::biss::procedures::{EncoderStatus, FlagRegister};
use crate::devices::biss::profile::{BissProfile, DataImage};
use crate::devices::biss::protocol::{PulseVoltage, RegisterAddress, WiegandResult};
use crate::profile::ProfileDocument;
use crate::report::{Block, CellStyle, Fact, Mark, Section};

pub(super) fn content(
    profile: &BissProfile,
    document: &ProfileDocument,
    context: &ReportContext<'_>,
) -> Result<ReportContent, Text> {
    let identity = &profile.identity;
    let descriptions = load_descriptions(context.store).0;
    let described = descriptions.find_by_name(&identity.description).or_else(|| descriptions.iter().last()).cloned();
    let mut encoder = Encoder::from_session(Session::without_tab(document));
    encoder.set_description(described.map(Arc::new));
    encoder.load_profile(profile);
    let parts = [identity.description.as_str(), identity.serial_number.as_str()];
    let title = parts.into_iter().filter(|part| !part.is_empty()).collect::<Vec<_>>().join(" · ");
    let mut sections = vec![identity_section(context, profile), settings_section(context, profile)];
    sections.extend(procedures_section(context, profile));
    sections.extend(data_sheet_section(context, &encoder));
    sections.extend(profile.data.iter().map(|area| data_section(context, profile, area)));
    let key = logbook_key(&identity.kind(), &identity.serial_number, false);
    Ok(ReportContent { title, key: Some(key), sections })
}

/// Returns the errors and warnings of an encoder for a report.
pub fn status_lines(status: &EncoderStatus) -> Vec<StatusLine> {
    let lines = |bits: &Option<FlagRegister>, mark: Mark| {
        let set = bits.as_ref().map(|bits| bits.set.clone()).unwrap_or_default();
        set.into_iter().map(move |(bit, name)| StatusLine {
            mark,
            code: format!("b{bit}"),
            text: explained::flag_text(name.as_ref()),
            advice: Vec::new(),
        })
    };
    lines(&status.errors, Mark::Bad).chain(lines(&status.warnings, Mark::Warning)).collect()
}

fn identity_section(context: &ReportContext<'_>, profile: &BissProfile) -> Section {
    let identity = &profile.identity;
    let code = identity.manufacturer;
    let firmware = identity.firmware.map(|own| own.to_string()).unwrap_or_default();
    let mut facts = vec![
        Fact::new(context.localize("encoder_card.title"), identity.description.as_str()),
        context.code("encoder_card.serial", &identity.serial_number),
        context.code("encoder_card.firmware", firmware),
        context.code(TEXTS.text("biss_card.profile"), identity.profile_id.to_string()),
        context.code(TEXTS.text("biss_card.device_id"), hex(&identity.device_id)),
        context.code(TEXTS.text("biss_card.manufacturer"), format!("{}  {}", hex(&code), code.escape_ascii())),
    ];
    if let Some(singleturn) = identity.singleturn_bits {
        let widths = TEXTS
            .text("biss_card.position_widths")
            .with("multiturn", identity.multiturn_bits.unwrap_or_default())
            .with("singleturn", singleturn);
        facts.push(context.fact(TEXTS.text("biss_card.frame"), widths));
    }
    Section::new(context.localize("report.identity")).with(Block::Facts(facts))
}

fn settings_section(context: &ReportContext<'_>, profile: &BissProfile) -> Section {
    let mut facts = Vec::new();
    if let Some(filter) = profile.filter {
        facts.push(context.fact(TEXTS.text("biss_status.filter"), format::filter(filter)));
    }
    if let Some(preset) = &profile.preset {
        let bits = profile.identity.singleturn_bits.unwrap_or_default();
        let value = explained::preset_value_text(preset.value, bits);
        facts.push(context.fact(TEXTS.text("biss_status.preset"), value));
    }
    if let Some(mode) = profile.recorded.device_mode {
        facts.push(context.fact(TEXTS.text("biss_status.mode"), explained::mode_text(mode)));
    }
    let marks = profile.mounting.iter();
    facts.extend(marks.map(|mark| {
        let value = format!("{} ({})", mark.item, mark.meaning);
        Fact::new(context.localize("report.mounting"), value)
    }));
    Section::new(context.localize("report.settings")).with(Block::Facts(facts))
}

/// Returns the results of the calibration and of the Wiegand tests, or `None` if the profile contains none.
fn procedures_section(context: &ReportContext<'_>, profile: &BissProfile) -> Option<Section> {
    let recorded = &profile.recorded;
    let tests: Vec<(&str, WiegandResult)> = [
        ("report.biss_last", recorded.wiegand_last),
        ("report.biss_production", recorded.wiegand_production),
        ("report.biss_saved", recorded.wiegand_saved),
    ]
    .into_iter()
    .filter_map(|(id, result)| Some((id, result?)))
    .collect();
    let mut section = Section::new(context.localize(TEXTS.text("report.biss_procedures")));
    if let Some(status) = recorded.calibration_status {
        let label = TEXTS.text("report.biss_calibration");
        section = section.with(Block::Facts(vec![context.code(label, format!("0x{status:02X}"))]));
    }
    if !tests.is_empty() {
        let limit = TEXTS.text("report.biss_limit").with_number("limit", PulseVoltage::LIMIT.volts(), 1);
        let mut table = context.table([
            (TEXTS.text("report.biss_test"), CellStyle::Text),
            (TEXTS.text("report.biss_direction"), CellStyle::Text),
            (TEXTS.text("report.biss_average"), CellStyle::Number),
            (TEXTS.text("report.biss_lowest"), CellStyle::Number),
            (limit, CellStyle::Text),
        ]);
        for (id, result) in tests {
            for (direction, average, lowest) in [
                ("report.biss_cw", result.average_cw, result.lowest_cw),
                ("report.biss_ccw", result.average_ccw, result.lowest_ccw),
            ] {
                // If there is no result, the voltages are 0.
                let (mark, verdict) = match average.byte() {
                    0 => (Mark::None, TEXTS.text("report.biss_untested")),
                    _ if lowest > PulseVoltage::LIMIT => (Mark::Good, Text::new("report.within")),
                    _ => (Mark::Warning, Text::new("report.outside")),
                };
                table.add_marked_row(
                    mark,
                    [
                        context.localize(TEXTS.text(id)),
                        context.localize(TEXTS.text(direction)),
                        context.number(average.volts(), 1),
                        context.number(lowest.volts(), 1),
                        context.localize(verdict),
                    ],
                );
            }
        }
        section = section.with(Block::Table(table));
    }
    (!section.blocks.is_empty()).then_some(section)
}

/// Returns the named registers in the profile that are outside the data areas, with their decoded values.
fn data_sheet_section(context: &ReportContext<'_>, encoder: &Encoder) -> Option<Section> {
    let mut section = Section::new(context.localize(TEXTS.text("report.biss_registers")));
    for group in encoder.table.groups() {
        let mut table = context.table([
            ("report.address".into(), CellStyle::Short),
            ("report.name".into(), CellStyle::Text),
            ("report.bytes".into(), CellStyle::Code),
            ("report.meaning".into(), CellStyle::Text),
        ]);
        for (index, row) in group.rows().iter().enumerate() {
            if row.is_data || row.register.name.is_empty() {
                continue;
            }
            let Some(entry) = group.entry(index, &encoder.memory) else { continue };
            let Some(bytes) = &entry.bytes else { continue };
            let number = || entry.to_number().map(literal_text);
            let meaning = encoder.describe_register(&entry).or_else(number);
            table.add_row([
                row.register.address.to_string(),
                context.localize(explained::name_text(&row.register.name)),
                hex(bytes),
                meaning.map(|text| context.localize(text)).unwrap_or_default(),
            ]);
        }
        if table.rows.is_empty() {
            continue;
        }
        if let Some(name) = &group.name {
            section = section.with(Block::Heading(context.localize(explained::name_text(name))));
        }
        section = section.with(Block::Table(table));
    }
    (!section.blocks.is_empty()).then_some(section)
}

fn data_section(context: &ReportContext<'_>, profile: &BissProfile, area: &DataImage) -> Section {
    let (first, last) = (format!("0x{:02X}", area.first), format!("0x{:02X}", area.last));
    let text = TEXTS.text("report.biss_area").with("name", &area.name).with("first", first).with("last", last);
    let mut section = Section::new(context.localize(text));
    if let Some(byte) = area.empty {
        let count = usize::from(area.last.saturating_sub(area.first)) + 1 - area.listed.len();
        let text = TEXTS.text("report.biss_empty").with("count", count).with("byte", format!("0x{byte:02X}"));
        section = section.with(Block::Paragraph(context.localize(text)));
    }
    for listed in &area.listed {
        let bank = listed.bank;
        let at = |offset: usize| {
            let offset = u8::try_from(offset).unwrap_or(RegisterAddress::BANK_SIZE);
            RegisterAddress::in_bank(bank.number, offset)
        };
        let heading = TEXTS.text("report.biss_bank").with("bank", format!("0x{:02X}", bank.number));
        let address = |offset| at(offset).map(|address| address.to_string()).unwrap_or_default();
        let is_mounting =
            |range: std::ops::Range<usize>| range.filter_map(at).any(|address| profile.depends_on_mounting(address));
        let meaning = |range| if is_mounting(range) { context.localize("report.mounting") } else { String::new() };
        section = section.with(Block::Heading(context.localize(heading))).with(Block::Table(byte_table(
            context,
            &bank.bytes,
            address,
            meaning,
        )));
    }
    section
}
