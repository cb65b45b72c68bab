//! Sections on an adapter or a hub in a report: identities, the travel of each drive, and all parameters.

use super::rows::Row;
use super::ruler::PositionUnit;
use super::{HiperdriveDevice, TEXTS};
use crate::app::Text;
use crate::app::report::{ReportContent, ReportContext, StatusLine};
use crate::app::session::Session;
use crate::devices::hiperdrive::jobs::logbook_key;
use crate::devices::hiperdrive::procedures::DriveStatus;
use crate::devices::hiperdrive::profile::{HiperdriveProfile, Item, ProfileDrive};
use crate::devices::hiperdrive::protocol::{DriveNumber, ErrorCode, StatusBit, Topology};
use crate::devices::hiperdrive::state::explain;
use crate::profile::ProfileDocument;
use crate::report::{Block, CellStyle, Fact, Mark, Section, Table};

pub(super) fn content(
    profile: &HiperdriveProfile,
    document: &ProfileDocument,
    context: &ReportContext<'_>,
) -> Result<ReportContent, Text> {
    let identity = &profile.identity;
    let mut unit = HiperdriveDevice::from_session(Session::without_tab(document));
    unit.adopt_profile(profile);
    let category = identity.topology.map_or("HIPERDRIVE", Topology::category);
    let parts = [category, identity.serial_number.as_str()];
    let title = parts.into_iter().filter(|part| !part.is_empty()).collect::<Vec<_>>().join(" · ");
    let mut sections = Vec::new();
    if !identity.is_device_unknown() {
        let facts = [
            ("hd_device.name", &identity.name),
            ("hd_device.article", &identity.article_number),
            ("hd_device.serial", &identity.serial_number),
            ("hd_device.version", &identity.version),
        ];
        let facts = facts.map(|(label, value)| context.code(TEXTS.text(label), value)).into();
        sections.push(Section::new(context.localize("report.identity")).with(Block::Facts(facts)));
    }
    let of_device = parameter_table(context, profile, unit.rows(None));
    if !of_device.rows.is_empty() {
        let title = context.localize(TEXTS.text("hd_params.device"));
        sections.push(Section::new(title).with(Block::Table(of_device)));
    }
    sections.extend(unit.drives().into_iter().map(|drive| drive_section(context, profile, &unit, drive)));
    let key = (!identity.serial_number.is_empty()).then(|| logbook_key(category, &identity.serial_number, false));
    Ok(ReportContent { title, key, sections })
}

/// Returns the errors of a drive, newest first, and whether it is outside its limits. Acknowledged errors are marked as
/// earlier ones.
pub fn status_lines(drive: &DriveStatus) -> Vec<StatusLine> {
    let place = TEXTS.text("report.hd_drive").with("drive", drive.number.get());
    let present = drive.present_error_count();
    let error = |(at, code): (usize, &ErrorCode)| {
        let explained = explain::error_code_explanation(*code);
        StatusLine {
            mark: if at < present { Mark::Bad } else { Mark::None },
            code: format!("0x{:04X}", code.code()),
            text: Text::new("plain.words").with_list("words", [place.clone(), explained.name]),
            advice: vec![explained.cause, explained.remedy],
        }
    };
    let mut lines: Vec<StatusLine> = drive.buffer.iter().enumerate().map(error).collect();
    if drive.status.is_set(StatusBit::PositionLimit) {
        lines.push(StatusLine {
            mark: Mark::Warning,
            code: format!("0x{:04X}", drive.status.to_u16()),
            text: Text::new("plain.words").with_list("words", [place, explain::status_bit(StatusBit::PositionLimit)]),
            advice: Vec::new(),
        });
    }
    lines
}

fn drive_section(
    context: &ReportContext<'_>,
    profile: &HiperdriveProfile,
    unit: &HiperdriveDevice,
    drive: DriveNumber,
) -> Section {
    let title = context.localize(TEXTS.text("report.hd_drive").with("drive", drive.get()));
    let mut section = Section::new(title);
    let identity = profile.drive(drive).map(|own| drive_facts(context, own)).unwrap_or_default();
    let facts: Vec<Fact> = identity.into_iter().chain(travel_fact(context, profile, unit, drive)).collect();
    if !facts.is_empty() {
        section = section.with(Block::Facts(facts));
    }
    section.with(Block::Table(parameter_table(context, profile, unit.rows(Some(drive)))))
}

/// Returns the limits of a drive in turns of its shaft, and the distance between them.
fn travel_fact(
    context: &ReportContext<'_>,
    profile: &HiperdriveProfile,
    unit: &HiperdriveDevice,
    drive: DriveNumber,
) -> Option<Fact> {
    let (lower, upper) = profile.image.limits(drive)?;
    let ruler = unit.edited_ruler(drive);
    let turns = |steps| ruler.from_steps(steps, PositionUnit::Turns);
    let text = TEXTS
        .text("report.hd_travel")
        .with_number("lower", turns(lower)?, 3)
        .with_number("upper", turns(upper)?, 3)
        .with_number("span", turns(upper - lower)?, 3)
        .with_text("unit", TEXTS.text(PositionUnit::Turns.unit()));
    Some(context.fact(TEXTS.text("hd_travel.title"), text))
}

fn drive_facts(context: &ReportContext<'_>, drive: &ProfileDrive) -> Vec<Fact> {
    let variant = drive.variant.map(|own| context.fact(TEXTS.text("report.hd_variant"), explain::variant_text(own)));
    let facts = [
        ("hd_device.name", &drive.name),
        ("hd_device.article", &drive.article_number),
        ("hd_device.serial", &drive.serial_number),
        ("hd_device.version", &drive.version),
    ];
    // A profile that was written by hand has no identity.
    let facts = facts.into_iter().filter(|(_, value)| !value.is_empty());
    variant.into_iter().chain(facts.map(|(label, value)| context.code(TEXTS.text(label), value))).collect()
}

/// Lists the parameters that the profile contains.
fn parameter_table(context: &ReportContext<'_>, profile: &HiperdriveProfile, rows: Vec<Row>) -> Table {
    let mut table = context.table([
        ("report.number_of".into(), CellStyle::Short),
        ("report.name".into(), CellStyle::Text),
        ("report.value".into(), CellStyle::Number),
        ("report.unit".into(), CellStyle::Short),
        ("report.meaning".into(), CellStyle::Text),
        ("report.range".into(), CellStyle::Text),
        ("report.factory".into(), CellStyle::Number),
    ]);
    for row in rows.into_iter().filter(|row| row.value.is_some()) {
        let say = |text: Option<Text>| text.map(|text| context.localize(text)).unwrap_or_default();
        let mounting = profile.depends_on_mounting(Item(row.number)).then(|| context.localize("report.mounting"));
        let meaning = row.meaning.map(|text| context.localize(text));
        let meaning = meaning.into_iter().chain(mounting).collect::<Vec<_>>().join(", ");
        table.add_row([
            row.number.to_string(),
            context.localize(row.name),
            row.shown,
            say(row.unit),
            meaning,
            say(row.range),
            row.factory,
        ]);
    }
    table
}
