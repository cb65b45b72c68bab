//! Content of an encoder report: identity, interface, extended label, and the data fields as a map and as bytes.

use std::ops::Range;

use super::TEXTS;
use super::explain;
use crate::app::Text;
use crate::app::report::{ReportContent, ReportContext, StatusLine, byte_table};
use crate::devices::hiperface::jobs::{device_key, encoder_types};
use crate::devices::hiperface::procedures::{Identity, recorded_identity};
use crate::devices::hiperface::profile::{FieldImage, HiperfaceProfile};
use crate::devices::hiperface::protocol::StatusCode;
use crate::drawing::{Drawing, DrawingLabel, DrawingShape, LabelAlign};
use crate::profile::ProfileDocument;
use crate::report::{Block, CellStyle, Fact, Mark, Section};

/// Size of a memory block in bytes.
const BLOCK_BYTES: usize = 16;
/// Number of blocks in a row of the map.
const MAP_ROW: u32 = 32;
/// Side length of a block in the map.
const BLOCK: u32 = 20;
/// Fill colours of the fields, on which black text remains legible in print.
const COLOURS: [&str; 6] = ["#b8dcff", "#ffd9a0", "#cdebc9", "#e2d3f7", "#ffd0cb", "#e4e2b4"];
const UNUSED_COLOUR: &str = "#ffffff";
const BORDER: &str = "#8a939b";

pub(super) fn content(
    profile: &HiperfaceProfile,
    _document: &ProfileDocument,
    context: &ReportContext<'_>,
) -> Result<ReportContent, Text> {
    let types = encoder_types(context.store).map_err(|error| explain::table_error_text(&error))?;
    let identity = recorded_identity(profile, &types);
    let serial = &identity.serial.serial_number;
    let parts = [identity.name.as_str(), serial.as_str()];
    let title = parts.into_iter().filter(|part| !part.is_empty()).collect::<Vec<_>>().join(" · ");
    let mut sections = vec![identity_section(context, &identity), interface_section(context, profile, &identity)];
    sections.extend(label_section(context, &identity));
    sections.push(memory_section(context, profile));
    Ok(ReportContent { title, key: Some(device_key(&identity, false)), sections })
}

/// Returns the status codes as lines of a report.
pub fn status_lines(codes: &[StatusCode]) -> Vec<StatusLine> {
    let line = |code: &StatusCode| StatusLine {
        mark: if code.is_warning() { Mark::Warning } else { Mark::Bad },
        code: format!("{:02X}h", code.byte()),
        text: explain::status_code_name(*code),
        advice: Vec::new(),
    };
    codes.iter().map(line).collect()
}

fn identity_section(context: &ReportContext<'_>, identity: &Identity) -> Section {
    let serial = &identity.serial;
    let resolution = identity.geometry.map_or_else(|| TEXTS.text("encoder_card.no_geometry"), explain::geometry_text);
    Section::new(context.localize("report.identity")).with(Block::Facts(vec![
        Fact::new(context.localize("encoder_card.title"), identity.name.as_str()),
        context.code("encoder_card.serial", &serial.serial_number),
        context.code(TEXTS.text("encoder_card.type"), format!("{:02X}h", identity.label.encoder_type)),
        context.fact(TEXTS.text("encoder_card.resolution"), resolution),
        context.code("encoder_card.firmware", format!("{}  {}", serial.firmware_version, serial.firmware_date)),
        context.code(TEXTS.text("encoder_card.options"), format!("{:02X}h", identity.label.options)),
    ]))
}

fn interface_section(context: &ReportContext<'_>, profile: &HiperfaceProfile, identity: &Identity) -> Section {
    let mut facts = vec![
        context.code(TEXTS.text("encoder_card.address"), format!("{:02X}h", identity.address)),
        context.fact(TEXTS.text("encoder_card.settings"), explain::line_settings(identity.label.settings)),
    ];
    let position = profile.recorded.position.map(|position| {
        let place = identity.geometry.map(|geometry| explain::position_text(geometry.position(position)));
        let value = place.unwrap_or_else(|| explain::raw_position_text(position));
        context.fact(TEXTS.text("report.hf_position"), value)
    });
    let counter = profile.recorded.counter;
    facts.extend(position);
    facts.extend(counter.map(|counter| context.code(TEXTS.text("recorder.counter"), counter.to_string())));
    Section::new(context.localize("report.interface")).with(Block::Facts(facts))
}

fn label_section(context: &ReportContext<'_>, identity: &Identity) -> Option<Section> {
    let rows = explain::label_rows(identity.extended_label.as_deref()?);
    let mut table = context.table([
        (TEXTS.text("encoder_card.address"), CellStyle::Code),
        ("report.bytes".into(), CellStyle::Code),
        ("report.meaning".into(), CellStyle::Text),
    ]);
    for row in rows {
        table.add_row([row.addresses, row.bytes, context.localize(row.meaning)]);
    }
    Some(Section::new(context.localize(TEXTS.text("label_card.title"))).with(Block::Table(table)))
}

fn memory_section(context: &ReportContext<'_>, profile: &HiperfaceProfile) -> Section {
    let fields = &profile.fields;
    let used: usize = fields.iter().map(|field| field.status.size().bytes()).sum();
    let id = if fields.len() == 1 { "memory.used_one" } else { "memory.used" };
    let text = TEXTS.text(id).with("fields", fields.len()).with("used", used);
    let size = TEXTS.text("report.hf_memory").with("bytes", profile.identity.eeprom_bytes);
    let mut section = Section::new(context.localize(TEXTS.text("report.hf_fields"))).with(Block::Paragraph(format!(
        "{} {}",
        context.localize(size),
        context.localize(text)
    )));
    if fields.is_empty() {
        return section;
    }
    section = section.with(Block::Drawing(field_map(context, profile)));
    for field in fields {
        let name = context.localize(TEXTS.text("memory.field").with("number", field.number));
        section = section
            .with(Block::Heading(name))
            .with(Block::Paragraph(context.localize(explain::field_status(field.status))))
            .with(field_block(context, profile, field));
    }
    section
}

/// Returns the bytes of a field as a table. Mounting values have their meaning next to them.
fn field_block(context: &ReportContext<'_>, profile: &HiperfaceProfile, field: &FieldImage) -> Block {
    let Some(bytes) = &field.bytes else {
        return Block::Paragraph(context.localize(TEXTS.text("report.hf_locked")));
    };
    let meaning = |range: Range<usize>| {
        let marks = profile.mounting.iter().filter(|mark| {
            let item = mark.item;
            range.clone().any(|address| item.contains(field.number, address))
        });
        marks.map(|mark| mark.meaning.as_str()).collect::<Vec<_>>().join(", ")
    };
    Block::Table(byte_table(context, bytes, |at| format!("{at:04X}h"), meaning))
}

/// Draws the memory as blocks of 16 bytes, coloured by field. The first block of a field shows its number.
fn field_map(context: &ReportContext<'_>, profile: &HiperfaceProfile) -> Drawing {
    let owners = profile.fields.iter().flat_map(|field| {
        let blocks = field.status.size().bytes() / BLOCK_BYTES;
        (0..blocks).map(move |block| (field.number, block == 0))
    });
    let total = profile.identity.eeprom_bytes.div_ceil(BLOCK_BYTES as u32);
    let mut owners: Vec<(u8, bool)> = owners.collect();
    let used = u32::try_from(owners.len()).unwrap_or(u32::MAX);
    owners.truncate(1 << 12);
    let blocks = total.max(used).min(1 << 12);
    let rows = blocks.div_ceil(MAP_ROW).max(1);
    let title = context.localize(TEXTS.text("report.hf_fields"));
    let mut drawing = Drawing::new(MAP_ROW * BLOCK + 2, rows * (BLOCK + 4) + 2, title);
    let mut owners = owners.into_iter();
    for block in 0..blocks {
        let owner = owners.next();
        let (x, y) = (1 + block % MAP_ROW * BLOCK, 1 + block / MAP_ROW * (BLOCK + 4));
        let colour = owner.and_then(|(field, _)| COLOURS.get(usize::from(field) % COLOURS.len()).copied());
        drawing.shapes.push(DrawingShape::Box {
            x: x.into(),
            y: y.into(),
            width: BLOCK.into(),
            height: BLOCK.into(),
            fill: colour.unwrap_or(UNUSED_COLOUR),
            line: BORDER,
        });
        if let Some((field, true)) = owner {
            let label = DrawingLabel::new(x + BLOCK / 2, y + 14, 10, field.to_string());
            drawing.shapes.push(DrawingShape::Text(DrawingLabel { align: LabelAlign::Centre, ..label }));
        }
    }
    drawing
}
