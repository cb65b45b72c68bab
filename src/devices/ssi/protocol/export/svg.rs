//! Pictures of a layout: the frame as a row of cells, and a timing diagram of a burst to scale.

use super::text::{ExportText, TranslateFn};
use crate::devices::ssi::protocol::explain::Role;
use crate::devices::ssi::protocol::layout::Layout;
use crate::devices::ssi::protocol::timing::{ReadConditions, Times};
use crate::drawing::{Drawing, DrawingLabel, DrawingLength, DrawingShape, FAINT_COLOUR, LabelAlign, PathSegment};

/// Minimum distance between the content of a drawing and its edges.
const MARGIN: u32 = 16;
const CELL: u32 = 22;
const WIDTH: u32 = 900;
const CLOCK: &str = "#1a5fb4";
const DATA: &str = "#26a269";
const BITS: &str = "#b8dcff";

/// Returns the print colour of a field, which is light enough for black text.
fn role_colour(role: Role) -> &'static str {
    match role {
        Role::Zero => "#eeeeee",
        Role::Multiturn(_) => "#ffd9a0",
        Role::Singleturn(_) | Role::Position(_) => BITS,
        Role::Error(_) => "#ffb8b0",
        Role::Parity => "#d5c4f7",
        Role::Repetition(_) => "#d9e8d0",
    }
}

fn family(role: Role) -> &'static str {
    match role {
        Role::Zero => "0",
        Role::Multiturn(_) => "MT",
        Role::Singleturn(_) => "ST",
        Role::Position(_) => "P",
        Role::Error(_) => "E",
        Role::Parity => "PAR",
        Role::Repetition(_) => "=",
    }
}

/// Returns the name of a bit's role, translated by `say`. See also [`Layout::role_name`].
pub(super) fn role_name(layout: &Layout, role: Role, say: TranslateFn<'_>) -> String {
    match role {
        Role::Parity => say(&ExportText::ParityBit),
        role => layout.role_name(role),
    }
}

/// Creates a drawing with its title as the first label.
fn titled_drawing(width: u32, height: u32, title: &str) -> Drawing {
    let heading = DrawingLabel { is_bold: true, ..DrawingLabel::new(MARGIN, 20, 12, title) };
    Drawing { shapes: vec![DrawingShape::Text(heading)], ..Drawing::new(width, height, title) }
}

/// Draws the frame with one cell per clock. If `frame` is `Some`, the cells show its bits.
pub fn frame_drawing(layout: &Layout, frame: Option<u64>, title: &str, say: TranslateFn<'_>) -> Drawing {
    let roles = layout.clock_roles();
    let clocks = u32::from(layout.clock_count());
    let mut picture = titled_drawing(2 * MARGIN + clocks * CELL, 112, title);
    let mut begins = 0_usize;
    for (index, role) in roles.iter().enumerate() {
        let x = MARGIN + index as u32 * CELL;
        let clock = index + 1;
        let bit = frame.map_or_else(String::new, |frame| (frame >> (clocks as usize - clock) & 1).to_string());
        let middle = DrawingLength::Whole(x + CELL / 2);
        let centred = |y, size, text: String| DrawingLabel {
            align: LabelAlign::Centre,
            ..DrawingLabel::new(middle, y, size, text)
        };
        picture.shapes.extend([
            DrawingShape::Box {
                x: DrawingLength::Whole(x),
                y: 44.into(),
                width: DrawingLength::Whole(CELL),
                height: 28.into(),
                fill: role_colour(*role),
                line: FAINT_COLOUR,
            },
            DrawingShape::Text(DrawingLabel { colour: Some(FAINT_COLOUR), ..centred(38, 9, clock.to_string()) }),
            DrawingShape::Text(centred(63, 13, bit)),
        ]);
        let ends =
            roles.get(index + 1).is_none_or(|next| family(*next) != family(*role) || matches!(role, Role::Error(_)));
        if ends {
            let from = MARGIN + begins as u32 * CELL;
            let to = x + CELL;
            let first = roles.get(begins).copied().unwrap_or(*role);
            let name = match role {
                Role::Error(_) | Role::Parity => role_name(layout, *role, say),
                Role::Zero => "0".to_owned(),
                _ if begins == index => layout.role_name(*role),
                _ => format!("{} … {}", layout.role_name(first), layout.role_name(*role)),
            };
            // The names of single clocks alternate between two heights, so that neighbouring names do not overlap.
            let y = if begins == index && index % 2 == 1 { 104 } else { 90 };
            let middle = DrawingLength::Whole(u32::midpoint(from, to));
            let path = vec![
                PathSegment::Move(DrawingLength::Whole(from + 2), 77.into()),
                PathSegment::Across(DrawingLength::Whole(to - 2)),
            ];
            picture.shapes.extend([
                DrawingShape::Line { path, colour: FAINT_COLOUR },
                DrawingShape::Text(DrawingLabel {
                    align: LabelAlign::Centre,
                    ..DrawingLabel::new(middle, y, 10, name)
                }),
            ]);
            begins = index + 1;
        }
    }
    picture
}

/// Draws a burst and the pause after it to scale, with the clock, the data and the transfer times. See figure 2 of the
/// manual.
pub fn timing_drawing(
    layout: &Layout,
    times: &Times,
    reads: &ReadConditions,
    title: &str,
    say: TranslateFn<'_>,
) -> Drawing {
    let timing = times.calculate_timing(reads);
    let (burst, pause) = (timing.burst.as_secs_f64(), reads.pause.as_secs_f64());
    let scale = f64::from(WIDTH - 2 * MARGIN) / (burst + pause).max(1e-9);
    let x = |seconds: f64| DrawingLength::Scaled(f64::from(MARGIN) + seconds * scale);
    let period = timing.period.as_secs_f64();
    let mut picture = titled_drawing(WIDTH, 170, title);
    // The clock idles high. The first falling edge latches the position, and each rising edge shifts out a bit.
    let mut clock = vec![PathSegment::Move(x(0.0), 50.into())];
    for index in 0..layout.clock_count() {
        let at = f64::from(index) * period;
        let ends = [PathSegment::Across(x(at + period / 2.0)), PathSegment::Across(x(at + period))];
        let [falls, rises] = ends;
        clock.extend([PathSegment::Down(74.into()), falls, PathSegment::Down(50.into()), rises]);
    }
    let end = x(burst + pause);
    clock.push(PathSegment::Across(end));
    let monoflop = times.monoflop.1 * 1e-6;
    let idle = x((burst + monoflop).min(burst + pause));
    let first = x(period / 2.0);
    let data = vec![
        PathSegment::Move(x(0.0), 92.into()),
        PathSegment::Across(first),
        PathSegment::Move(x(burst), 116.into()),
        PathSegment::Across(idle),
        PathSegment::Down(92.into()),
        PathSegment::Across(end),
    ];
    let width = DrawingLength::Scaled(x(burst).units() - first.units());
    picture.shapes.extend([
        DrawingShape::Line { path: clock, colour: CLOCK },
        DrawingShape::Box { x: first, y: 92.into(), width, height: 24.into(), fill: BITS, line: FAINT_COLOUR },
        DrawingShape::Line { path: data, colour: DATA },
    ]);
    for (y, name) in [(46, ExportText::ClockLine), (88, ExportText::DataLine)] {
        let label = DrawingLabel::new(DrawingLength::Whole(MARGIN), y, 10, say(&name));
        picture.shapes.push(DrawingShape::Text(DrawingLabel { colour: Some(FAINT_COLOUR), ..label }));
    }
    let micros = burst * 1e6;
    let spans = [
        (0.0, burst, ExportText::BurstSpan { clocks: layout.clock_count(), micros }),
        (burst, burst + pause, ExportText::PauseSpan { micros: pause * 1e6, monoflop_micros: monoflop * 1e6 }),
    ];
    for (from, to, text) in spans {
        let (from, to, y) = (x(from), x(to), 130_u32);
        let end = |at| [PathSegment::Move(at, (y - 4).into()), PathSegment::Down((y + 4).into())];
        let path = [&[PathSegment::Move(from, y.into()), PathSegment::Across(to)][..], &end(from), &end(to)].concat();
        let middle = DrawingLength::Scaled(f64::midpoint(from.units(), to.units()));
        picture.shapes.extend([
            DrawingShape::Line { path, colour: FAINT_COLOUR },
            DrawingShape::Text(DrawingLabel {
                align: LabelAlign::Centre,
                ..DrawingLabel::new(middle, y + 14, 11, say(&text))
            }),
        ]);
    }
    picture
}
