//! The encoder's values in a report: identity, parameters, and cam programs as charts and tables.

use super::cams::{Chart, Lane, VisibleRange, grid_ticks, labels as cam_labels};
use super::explain::{direction_text, error_word_text, startup_mode_text};
use super::items::unit_text;
use super::staged::StagedEdits;
use super::{TEXTS, format};
use crate::app::Text;
use crate::app::report::{ReportContent, ReportContext, StatusLine};
use crate::devices::interbus::jobs::logbook_key;
use crate::devices::interbus::profile::{InterbusProfile, ItemValue, Scale};
use crate::devices::interbus::protocol::{ErrorWord, Program, ProgramNumber, ReadOutValue};
use crate::drawing::{Drawing, DrawingLabel, DrawingShape, FAINT_COLOUR, LabelAlign, PathSegment};
use crate::profile::ProfileDocument;
use crate::report::{Block, CellStyle, Fact, Mark, Section};

/// Width of the cam names beside a chart, in drawing units.
const HEAD: u32 = 130;
/// Width of a chart, in drawing units.
const PLOT: u32 = 540;
const LANE: u32 = 18;
const RULER: u32 = 20;
/// Space to the right of a chart for half of a ruler number.
const RIGHT: u32 = 30;
/// Minimum distance between two ruler numbers.
const NUMBER_DISTANCE: f64 = 80.0;
const ON: &str = "#8cc0ee";
const OFF: &str = "#ffffff";
const BORDER: &str = "#4a6f91";
const GRID: &str = "#d5dadf";

pub(super) fn content(
    profile: &InterbusProfile,
    _document: &ProfileDocument,
    context: &ReportContext<'_>,
) -> Result<ReportContent, Text> {
    let serial = &profile.identity.serial_number;
    let class = context.localize(TEXTS.text("ib_card.class"));
    let title = if serial.is_empty() { class } else { format!("{class} · {serial}") };
    let mut sections = vec![identity_section(context, profile), parameter_section(context, profile)];
    let staged = StagedEdits::for_profile(profile.image.clone(), profile.names.clone());
    let programs = ProgramNumber::all().filter_map(|number| Some((number, Chart::from_edits(&staged, number)?)));
    let (used, unused): (Vec<_>, Vec<_>) = programs.partition(|(_, chart)| chart.lanes.iter().any(is_used));
    sections.extend(used.iter().map(|(number, chart)| program_section(context, profile, *number, chart)));
    sections.extend(unused_programs_section(context, unused.iter().map(|(number, _)| number.get())));
    let key = (!serial.is_empty()).then(|| logbook_key(serial, false));
    Ok(ReportContent { title, key, sections })
}

/// Returns the error that an encoder reports instead of its position, formatted for a report.
pub fn status_lines(error: Option<ErrorWord>) -> Vec<StatusLine> {
    let line = |error: ErrorWord| StatusLine {
        mark: Mark::Bad,
        code: error.code.get().to_string(),
        text: error_word_text(error),
        advice: Vec::new(),
    };
    error.map(line).into_iter().collect()
}

fn identity_section(context: &ReportContext<'_>, profile: &InterbusProfile) -> Section {
    let recorded = &profile.recorded;
    let facts = [
        Some(context.fact("encoder_card.title", TEXTS.text("ib_card.class"))),
        Some(context.code("encoder_card.serial", &profile.identity.serial_number)),
        profile.identity.flags.map(|flags| context.fact(TEXTS.text("ib_card.flags"), format::flags_text(flags))),
        recorded.software_version.map(|own| context.code(TEXTS.text("ib_card.version"), own.to_string())),
        recorded.mode.map(|mode| context.fact(TEXTS.text("ib_card.mode"), startup_mode_text(mode))),
        recorded.operating_minutes.map(|minutes| {
            context.fact(TEXTS.text("ib_card.time"), format::read_out_value(ReadOutValue::Minutes(minutes)))
        }),
        recorded
            .temperature_tenths
            .map(|tenths| context.fact(TEXTS.text("ib_card.temperature"), format::temperature_text(tenths))),
    ];
    Section::new(context.localize("report.identity")).with(Block::Facts(facts.into_iter().flatten().collect()))
}

fn parameter_section(context: &ReportContext<'_>, profile: &InterbusProfile) -> Section {
    let mut table = context.table([
        ("report.item".into(), CellStyle::Code),
        ("report.name".into(), CellStyle::Text),
        ("report.value".into(), CellStyle::Number),
        ("report.unit".into(), CellStyle::Short),
        ("report.meaning".into(), CellStyle::Text),
    ]);
    for item in profile.items().filter(|item| item.program().is_none()) {
        let Some(value) = profile.image.get_value(item) else { continue };
        let name = item.parameter().map_or_else(|| TEXTS.text("report.ib_shift"), format::parameter);
        let meaning = match value {
            ItemValue::Direction(direction) => context.localize(direction_text(direction)),
            _ if profile.depends_on_mounting(item) => context.localize("report.mounting"),
            _ => String::new(),
        };
        let unit = unit_text(item).map(|unit| context.localize(unit)).unwrap_or_default();
        table.add_row([item.to_string(), context.localize(name), value.to_string(), unit, meaning]);
    }
    let parameters = &profile.image.parameters;
    let range = context.fact(TEXTS.text("ib_card.range"), format::range_text(parameters.steps, parameters.revolutions));
    Section::new(context.localize("report.settings")).with(Block::Facts(vec![range])).with(Block::Table(table))
}

fn program_section(
    context: &ReportContext<'_>,
    profile: &InterbusProfile,
    number: ProgramNumber,
    chart: &Chart,
) -> Section {
    let name = profile.names.program(number);
    let title = TEXTS.text("report.ib_program").with("program", number.get());
    let title = if name.is_empty() { context.localize(title) } else { format!("{}: {name}", context.localize(title)) };
    let scale = Scale::default();
    let facts = chart.lanes.iter().filter(|lane| is_used(lane)).map(|lane| {
        Fact::new(
            context.localize(cam_labels::cam(lane)),
            context.localize(cam_labels::lane_text(lane, &scale, chart.range)),
        )
    });
    Section::new(title.clone())
        .with(Block::Drawing(cam_chart(context, chart, title)))
        .with(Block::Facts(facts.collect()))
}

/// Returns whether a cam is active or has an edge other than 0. All edges of a new encoder are 0.
fn is_used(lane: &Lane) -> bool {
    lane.on || lane.edges.is_some_and(|cam| cam.start.get() != 0 || cam.stop.get() != 0)
}

/// Returns a section that lists the unused programs, or `None` if there are none.
fn unused_programs_section(context: &ReportContext<'_>, programs: impl Iterator<Item = u8>) -> Option<Section> {
    let numbers: Vec<String> = programs.map(|number| number.to_string()).collect();
    let text = TEXTS.text("report.ib_unused").with("programs", numbers.join(", "));
    let title = context.localize(TEXTS.text("ib_card.programs"));
    (!numbers.is_empty()).then(|| Section::new(title).with(Block::Paragraph(context.localize(text))))
}

/// Draws the lanes of a program across the measuring range, as in the window.
fn cam_chart(context: &ReportContext<'_>, chart: &Chart, title: String) -> Drawing {
    let height = RULER + Program::CAMS as u32 * LANE + 1;
    let mut drawing = Drawing::new(HEAD + PLOT + RIGHT, height, title);
    let view = VisibleRange::full(chart.range);
    let x = |position: f64| f64::from(HEAD) + view.fraction_at(position) * f64::from(PLOT);
    let apart = NUMBER_DISTANCE * view.length() / f64::from(PLOT);
    let scale = Scale::default();
    for tick in grid_ticks(&scale, &view, chart.range, apart) {
        let at = x(tick.position);
        let path = vec![PathSegment::Move(at.into(), RULER.into()), PathSegment::Down(height.into())];
        let words = context.localize(cam_labels::tick_label(tick.value, tick.decimals, scale.unit()));
        let label = DrawingLabel::new(at, RULER - 6, 9, words.trim());
        drawing.shapes.extend([
            DrawingShape::Line { path, colour: GRID },
            DrawingShape::Text(DrawingLabel { align: LabelAlign::Centre, colour: Some(FAINT_COLOUR), ..label }),
        ]);
    }
    for lane in &chart.lanes {
        let top = RULER + u32::from(lane.cam.get()) * LANE;
        let right = (HEAD + PLOT).into();
        let path = vec![PathSegment::Move(0.into(), (top + LANE).into()), PathSegment::Across(right)];
        let label = DrawingLabel::new(0, top + 13, 9, context.localize(cam_labels::cam(lane)));
        drawing.shapes.extend([DrawingShape::Line { path, colour: GRID }, DrawingShape::Text(label)]);
        for range in lane.on_ranges(chart.range) {
            let (from, to) = (x(range.first.into()), x(f64::from(range.last) + 1.0));
            drawing.shapes.push(DrawingShape::Box {
                x: from.into(),
                y: (top + 3).into(),
                width: (to - from).max(1.0).into(),
                height: (LANE - 6).into(),
                fill: if lane.on { ON } else { OFF },
                line: BORDER,
            });
        }
    }
    drawing
}
