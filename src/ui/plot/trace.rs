//! Draws a line of samples as shapes. Dense samples form one mesh without antialiasing, which is fast to fill. Sparse
//! samples form a smooth line with dots. Breaks appear as gaps, and invalid samples and warnings are always visible.

use egui::epaint::{Vertex, WHITE_UV};
use egui::{Color32, Mesh, Pos2, Rect, Shape, Stroke, pos2, vec2};

use crate::analysis::SampleTime;
use crate::analysis::history::{Flags, RenderedHistory};

const LINE_WIDTH: f32 = 1.5;
/// Maximum number of points of a smooth line.
const MAX_SMOOTH_POINTS: usize = 1500;
/// Minimum sample spacing in points at which each sample is drawn with a dot.
const DOT_SPACING: f32 = 8.0;

#[derive(Clone, Copy, Debug)]
pub(super) struct TimeAxis {
    pub(super) from: SampleTime,
    pub(super) left: f32,
    /// Points per nanosecond.
    pub(super) scale: f64,
    /// Width of a pixel in points.
    pub(super) pixel: f32,
}

impl TimeAxis {
    pub(super) fn x(&self, time: SampleTime) -> f32 {
        self.left + (time.nanoseconds_since(self.from) as f64 * self.scale) as f32
    }

    /// Returns the left edge of the pixel column that contains a time. Column positions do not depend on the samples.
    fn column(&self, time: SampleTime) -> f32 {
        self.left + ((self.x(time) - self.left) / self.pixel).floor() * self.pixel
    }

    pub(super) fn time(&self, x: f32) -> SampleTime {
        self.from.saturating_add_ns((f64::from(x - self.left) / self.scale) as i64)
    }
}

#[derive(Clone, Copy, Debug)]
pub(super) struct ValueAxis {
    pub(super) low: f64,
    pub(super) bottom: f32,
    /// Points per value unit, never zero.
    pub(super) scale: f64,
}

impl ValueAxis {
    pub(super) fn new(rect: Rect, (low, high): (f64, f64)) -> Self {
        let span = high - low;
        let span = if span.is_finite() && span > 0.0 { span } else { 1.0 };
        ValueAxis { low, bottom: rect.bottom(), scale: f64::from(rect.height().max(1.0)) / span }
    }

    pub(super) fn y(&self, value: f64) -> f32 {
        // Far outside, the exact position does not matter, but it must stay within the range of f32.
        let y = f64::from(self.bottom) - (value - self.low) * self.scale;
        y.clamp(-1e6, 1e6) as f32
    }

    pub(super) fn value(&self, y: f32) -> f64 {
        self.low + f64::from(self.bottom - y) / self.scale
    }
}

#[derive(Clone, Copy, Debug)]
pub(super) struct TraceStyle {
    pub(super) colour: Color32,
    /// Factor from the unit of the samples to the displayed unit.
    pub(super) factor: f64,
    pub(super) marks: bool,
    /// Colours of invalid samples and of warnings.
    pub(super) bad: Color32,
    pub(super) warning: Color32,
}

pub(super) fn trace_shapes(
    picture: &RenderedHistory,
    lane: Rect,
    time: &TimeAxis,
    value: &ValueAxis,
    pen: &TraceStyle,
    out: &mut Vec<Shape>,
) {
    if picture.raw {
        draw_sparse_trace(picture, lane, time, value, pen, out)
    } else {
        draw_dense_trace(picture, lane, time, value, pen, out)
    }
    if pen.marks {
        add_flag_ticks(picture, lane, time, pen, out);
    }
}

/// Draws one vertical bar per pixel column. The bar spans the minimum to the maximum of the samples, and is extended to
/// join the end of the previous column.
fn draw_dense_trace(
    picture: &RenderedHistory,
    lane: Rect,
    time: &TimeAxis,
    value: &ValueAxis,
    pen: &TraceStyle,
    out: &mut Vec<Shape>,
) {
    let mut mesh = Mesh::default();
    mesh.reserve_vertices(picture.pixels.len() * 4);
    mesh.reserve_triangles(picture.pixels.len() * 2);
    let mut before: Option<(f32, f32)> = None;
    for pixel in &picture.pixels {
        let Some(values) = pixel.values else { continue };
        let y = |own: f64| value.y(own * pen.factor);
        let (one, other) = (y(values.min), y(values.max));
        let (mut top, mut bottom) = (one.min(other), one.max(other));
        // The last sample is always in the column. The first one may be slightly before it.
        let left = time.column(pixel.to);
        if let Some((x, y)) = before.filter(|_| pixel.joined) {
            (top, bottom) = (top.min(y), bottom.max(y));
            // Bridge the gap if there are columns without samples in between.
            if left > x + 0.01 {
                add_bar(
                    &mut mesh,
                    Rect::from_min_max(pos2(x, y - LINE_WIDTH / 2.0), pos2(left, y + LINE_WIDTH / 2.0)),
                    lane,
                    pen.colour,
                );
            }
        }
        let right = left + time.pixel;
        let thick = (LINE_WIDTH - (bottom - top)).max(0.0) / 2.0;
        add_bar(&mut mesh, Rect::from_min_max(pos2(left, top - thick), pos2(right, bottom + thick)), lane, pen.colour);
        before = Some((right, y(values.last)));
    }
    out.push(Shape::mesh(mesh));
}

fn add_bar(mesh: &mut Mesh, rect: Rect, lane: Rect, colour: Color32) {
    let rect = rect.intersect(lane);
    if rect.is_positive() {
        mesh.add_colored_rect(rect, colour);
    }
}

fn draw_sparse_trace(
    picture: &RenderedHistory,
    lane: Rect,
    time: &TimeAxis,
    value: &ValueAxis,
    pen: &TraceStyle,
    out: &mut Vec<Shape>,
) {
    let smooth = picture.pixels.len() <= MAX_SMOOTH_POINTS;
    let dots = picture.pixels.len() as f32 * DOT_SPACING < lane.width();
    let around = lane.expand(LINE_WIDTH * 4.0);
    let mut mesh = Mesh::default();
    let mut run: Vec<Pos2> = Vec::new();
    let mut before: Option<Pos2> = None;
    let end = |run: &mut Vec<Pos2>, out: &mut Vec<Shape>| {
        if run.len() > 1 {
            out.push(Shape::line(std::mem::take(run), Stroke::new(LINE_WIDTH, pen.colour)));
        }
        run.clear();
    };
    for (at, pixel) in picture.pixels.iter().enumerate() {
        let Some(values) = pixel.values else { continue };
        let here = pos2(time.x(pixel.from), value.y(values.first * pen.factor));
        // Without this, a sample that is joined on neither side would be invisible.
        let lonely = !pixel.joined && picture.pixels.get(at + 1).is_none_or(|next| !next.joined);
        if (dots || lonely) && lane.contains(here) {
            out.push(Shape::circle_filled(here, 2.0, pen.colour));
        }
        match before.filter(|_| pixel.joined).and_then(|before| clip_segment(before, here, around)) {
            Some((from, to)) if smooth => {
                if run.last() != Some(&from) {
                    end(&mut run, out);
                    run.push(from);
                }
                run.push(to);
            }
            Some((from, to)) => add_segment(&mut mesh, from, to, pen.colour),
            None => end(&mut run, out),
        }
        before = Some(here);
    }
    end(&mut run, out);
    if !mesh.is_empty() {
        out.push(Shape::mesh(mesh));
    }
}

fn add_segment(mesh: &mut Mesh, from: Pos2, to: Pos2, color: Color32) {
    let along = (to - from).normalized() * (LINE_WIDTH / 2.0);
    let (across, first) = (along.rot90(), mesh.vertices.len() as u32);
    // Extend the segments slightly. Otherwise, they would leave a notch at an angle.
    let (from, to) = (from - along * 0.5, to + along * 0.5);
    mesh.vertices.extend([from + across, to + across, from - across, to - across].map(|pos| Vertex {
        pos,
        uv: WHITE_UV,
        color,
    }));
    mesh.add_triangle(first, first + 1, first + 2);
    mesh.add_triangle(first + 2, first + 1, first + 3);
}

/// Returns the part of a line segment inside a rectangle (Liang–Barsky clipping).
fn clip_segment(from: Pos2, to: Pos2, rect: Rect) -> Option<(Pos2, Pos2)> {
    if rect.contains(from) && rect.contains(to) {
        return Some((from, to));
    }
    let along = to - from;
    let (mut enters, mut leaves) = (0.0_f32, 1.0_f32);
    for (step, room) in [
        (-along.x, from.x - rect.left()),
        (along.x, rect.right() - from.x),
        (-along.y, from.y - rect.top()),
        (along.y, rect.bottom() - from.y),
    ] {
        if step == 0.0 {
            if room < 0.0 {
                return None;
            }
        } else if step < 0.0 {
            enters = enters.max(room / step);
        } else {
            leaves = leaves.min(room / step);
        }
    }
    (enters <= leaves).then(|| (from + along * enters, from + along * leaves))
}

/// Draws ticks at the bottom of the lane for invalid samples and warnings, at any zoom level.
fn add_flag_ticks(picture: &RenderedHistory, lane: Rect, time: &TimeAxis, pen: &TraceStyle, out: &mut Vec<Shape>) {
    let mut mesh = Mesh::default();
    for pixel in &picture.pixels {
        let (colour, height) = if pixel.flags.contains(Flags::BAD) {
            (pen.bad, 6.0)
        } else if pixel.flags.contains(Flags::WARNING) {
            (pen.warning, 4.0)
        } else {
            continue;
        };
        let x = time.x(pixel.from);
        let tick = Rect::from_min_size(pos2(x - 1.0, lane.bottom() - height), vec2(2.0, height));
        add_bar(&mut mesh, tick, lane, colour);
    }
    if !mesh.is_empty() {
        out.push(Shape::mesh(mesh));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::analysis::history::{ColumnPart, Grid, History, Kind};

    const LANE: Rect = Rect { min: Pos2::ZERO, max: pos2(100.0, 50.0) };
    const PEN: TraceStyle =
        TraceStyle { colour: Color32::WHITE, factor: 1.0, marks: true, bad: Color32::RED, warning: Color32::YELLOW };

    #[test]
    fn clips_segment_at_lane() {
        assert_eq!(
            clip_segment(pos2(-100.0, 25.0), pos2(200.0, 25.0), LANE),
            Some((pos2(0.0, 25.0), pos2(100.0, 25.0)))
        );
        assert_eq!(clip_segment(pos2(10.0, 10.0), pos2(20.0, 10.0), LANE), Some((pos2(10.0, 10.0), pos2(20.0, 10.0))));
        assert_eq!(clip_segment(pos2(10.0, -10.0), pos2(20.0, -10.0), LANE), None);
        assert_eq!(clip_segment(pos2(-10.0, 10.0), pos2(-5.0, 40.0), LANE), None);
        assert_eq!(clip_segment(pos2(50.0, -50.0), pos2(50.0, 25.0), LANE), Some((pos2(50.0, 0.0), pos2(50.0, 25.0))));
    }

    /// Draws `count` samples spread evenly over 100 columns of one nanosecond each. `flags` marks some of them.
    fn drawn(count: i64, value: impl Fn(i64) -> f64, flags: impl Fn(i64) -> Flags) -> Vec<Shape> {
        let mut history = History::new(&[Kind::Real], 1_000_000);
        let times: Vec<SampleTime> = (0..count).map(|at| SampleTime::from_nanoseconds(at * 100_000 / count)).collect();
        let values: Vec<f64> = (0..count).map(value).collect();
        let flags: Vec<Flags> = (0..count).map(flags).collect();
        history.append(&times, &[ColumnPart::from_reals(&values).with_flags(&flags)]).unwrap();
        let grid = Grid::new(SampleTime::ORIGIN, SampleTime::from_nanoseconds(100_000), 100);
        let mut picture = RenderedHistory::default();
        history.render_column(0, &history.divide_into_pixels(&grid), &mut picture);
        let time = TimeAxis { from: SampleTime::ORIGIN, left: 0.0, scale: 1e-3, pixel: 1.0 };
        let mut shapes = Vec::new();
        super::trace_shapes(&picture, LANE, &time, &ValueAxis::new(LANE, (0.0, 1.0)), &PEN, &mut shapes);
        shapes
    }

    fn reach_text(shapes: &[Shape]) -> Rect {
        shapes.iter().fold(Rect::NOTHING, |all, shape| all.union(shape.visual_bounding_rect()))
    }

    #[test]
    fn draws_single_sample_spike_to_peak() {
        let shapes = drawn(50_000, |at| if at == 31_234 { 1.0 } else { 0.5 }, |_| Flags::NONE);
        assert_eq!(shapes.len(), 1, "one mesh");
        let reach = reach_text(&shapes);
        assert!(reach.top() <= 0.5 && reach.bottom() < 27.0, "{reach}");
    }

    #[test]
    fn draws_bar_per_pixel_column() {
        for count in [50_000, 51_234, 499_999] {
            let shapes = drawn(count, |at| (at % 2) as f64, |_| Flags::NONE);
            let [Shape::Mesh(mesh)] = shapes.as_slice() else { panic!("{shapes:?}") };
            let tall = |column: usize| {
                let x = column as f32 + 0.5;
                mesh.vertices.chunks(4).any(|bar| {
                    let rect = Rect::from_points(&bar.iter().map(|vertex| vertex.pos).collect::<Vec<_>>());
                    rect.x_range().contains(x) && rect.height() > 45.0
                })
            };
            let missing: Vec<usize> = (0..100).filter(|column| !tall(*column)).collect();
            assert!(missing.is_empty(), "{count}: {missing:?}");
        }
    }

    fn is_marked(shapes: &[Shape]) -> bool {
        let red = |mesh: &Mesh| mesh.vertices.iter().any(|vertex| vertex.color == Color32::RED);
        shapes.iter().any(|shape| matches!(shape, Shape::Mesh(mesh) if red(mesh)))
    }

    #[test]
    fn keeps_gaps_and_draws_marks() {
        let gap = |at| if at == 5 { Flags::BAD } else { Flags::NONE };
        let shapes = drawn(10, |_| 0.5, gap);
        let lines = shapes.iter().filter(|shape| matches!(shape, Shape::Path(_))).count();
        assert_eq!(lines, 2, "before and behind the gap");
        assert!(is_marked(&shapes));
        let many = drawn(50_000, |_| 0.5, |at| if at == 31_234 { Flags::BAD } else { Flags::NONE });
        assert!(is_marked(&many));
        assert!(!is_marked(&drawn(10, |_| 0.5, |_| Flags::NONE)));
    }

    #[test]
    fn clamps_values_to_lane() {
        for count in [10, 3_000, 50_000] {
            let reach = reach_text(&drawn(count, |at| if at % 2 == 0 { 1e30 } else { -1e30 }, |_| Flags::NONE));
            assert!(LANE.expand(20.0).contains_rect(reach), "{count}: {reach}");
        }
    }
}
