//! Paints the chart: grid, axes, lines, cursors, the trigger and the readout under the pointer.

use egui::{Align2, Color32, FontId, Painter, Pos2, Rect, Shape, Stroke, pos2, vec2};

use super::lanes::{Lane, Layout, ReducedLane};
use super::pointer::Drag;
use super::trace::{self, TraceStyle};
use super::{Context, axes};
use crate::app::recorder::{Cursor, Series, TriggerState};
use crate::ui::Theme;

/// Lane height in points below which line names are omitted.
const LOW_LANE_HEIGHT: f32 = 64.0;

pub(super) fn series_colour(theme: &Theme, line: &Series) -> Color32 {
    let series = &theme.palette.series;
    series.get(line.colour % series.len()).copied().unwrap_or(theme.palette.accent).into()
}

pub(super) fn paint(
    painter: &Painter,
    context: &Context<'_>,
    layout: &Layout,
    reduced: &ReducedLane,
    drag: Option<&Drag>,
    hovered: Option<Pos2>,
) {
    let theme = context.theme;
    let font = FontId::monospace(theme.sizes.caption);
    time_axis(painter, context, layout, &font);
    for lane in &layout.lanes {
        value_axis(painter, theme, lane, &font);
        // The names may cover the grid but never a line.
        paint_names(painter, context, lane);
        paint_lines(painter, context, layout, lane, reduced);
    }
    paint_trigger(painter, context, layout, &font);
    paint_cursors(painter, context, layout, &font);
    if let Some(place) = hovered {
        paint_pointer_readout(painter, context, layout, place);
    }
    if let Some(Drag::Box { from, to }) = drag {
        let colour = Color32::from(theme.palette.accent);
        let chosen = Rect::from_two_pos(*from, *to).intersect(layout.chart);
        painter.rect(chosen, 0.0, colour.gamma_multiply(0.15), Stroke::new(1.0, colour), egui::StrokeKind::Inside);
    }
}

fn time_axis(painter: &Painter, context: &Context<'_>, layout: &Layout, font: &FontId) {
    let (theme, chart) = (context.theme, layout.chart);
    let most = (chart.width() / 76.0).max(1.0) as usize;
    let (from, to) = (layout.time.time(chart.left()), layout.time.time(chart.right()));
    let ticks = if context.recorder.counts_samples() { axes::sample_ticks } else { axes::time_ticks };
    let ticks = ticks(from, to, most, theme.language);
    let grid = Stroke::new(1.0, theme.palette.line);
    let bottom = chart.bottom() + 3.0;
    let mut free = chart.left() - 30.0;
    if let Some(base) = &ticks.base {
        let words = painter.layout_no_wrap(base.clone(), font.clone(), theme.palette.text.into());
        free = chart.left() + words.size().x + 8.0;
        painter.galley(pos2(chart.left(), bottom), words, Color32::PLACEHOLDER);
    }
    for (at, label) in ticks.ticks {
        let x = layout.time.x(at).round();
        if !chart.x_range().contains(x) {
            continue;
        }
        for lane in &layout.lanes {
            painter.vline(x, lane.rect.y_range(), grid);
        }
        let words = painter.layout_no_wrap(label, font.clone(), theme.palette.muted.into());
        let left = (x - words.size().x / 2.0).min(painter.clip_rect().right() - words.size().x - 4.0);
        if left >= free {
            free = left + words.size().x + 8.0;
            painter.galley(pos2(left, bottom), words, Color32::PLACEHOLDER);
        }
    }
}

/// Minimum distance of a label from the edge of its lane, in points.
const EDGE_DISTANCE: f32 = 2.0;
/// Half of the height of a label, in points.
const HALF_LABEL_HEIGHT: f32 = 5.5;

/// Returns the labelled ticks with the vertical positions of their labels. A label is normally next to its tick,
/// because the space between two lanes holds half a label. If a small lane has fewer than two such ticks, the labels of
/// the outermost ticks are moved inside.
fn labelled_ticks(ticks: &[(f64, f32)], top: f32, bottom: f32) -> Vec<(f64, f32)> {
    let inside: Vec<(f64, f32)> =
        ticks.iter().copied().filter(|(_, y)| (top + EDGE_DISTANCE..=bottom - EDGE_DISTANCE).contains(y)).collect();
    let (Some((first, low)), Some((last, high))) = (ticks.first(), ticks.last()) else { return inside };
    let within = |y: f32| y.min(bottom - HALF_LABEL_HEIGHT).max(top + HALF_LABEL_HEIGHT);
    let (low, high) = (within(*low), within(*high));
    let two = inside.len() < 2 && low - high >= HALF_LABEL_HEIGHT * 2.0;
    if two { vec![(*first, low), (*last, high)] } else { inside }
}

fn value_axis(painter: &Painter, theme: &Theme, lane: &Lane, font: &FontId) {
    let axis = lane.value_axis();
    let rect = lane.rect;
    let ticks: Vec<(f64, f32)> =
        axes::tick_values(lane.range.0, lane.range.1, lane.step).map(|value| (value, axis.y(value).round())).collect();
    for (_, y) in &ticks {
        painter.hline(rect.x_range(), *y, Stroke::new(1.0, theme.palette.line));
    }
    if !lane.empty {
        for (value, y) in labelled_ticks(&ticks, rect.top(), rect.bottom()) {
            let label = axes::value_label(value, lane.step, theme.language);
            let place = pos2(rect.left() - 6.0, y);
            painter.text(place, Align2::RIGHT_CENTER, label, font.clone(), theme.palette.muted.into());
        }
    }
    painter.rect_stroke(rect, 0.0, Stroke::new(1.0, theme.palette.line), egui::StrokeKind::Inside);
}

fn paint_lines(painter: &Painter, context: &Context<'_>, layout: &Layout, lane: &Lane, reduced: &ReducedLane) {
    let palette = context.theme.palette;
    let clipped = painter.with_clip_rect(lane.rect.intersect(painter.clip_rect()));
    let axis = lane.value_axis();
    let mut shapes = Vec::new();
    for id in &lane.lines {
        let (Some(line), Some(picture)) = (context.recorder.series_by_id(*id), reduced.rendered_line(*id)) else {
            continue;
        };
        let colour = series_colour(context.theme, line);
        let (bad, warning) = (palette.bad.into(), palette.warn.into());
        let pen = TraceStyle { colour, factor: line.factor(), marks: !line.derived, bad, warning };
        trace::trace_shapes(picture, lane.rect, &layout.time, &axis, &pen, &mut shapes);
    }
    clipped.extend(shapes);
}

/// Paints the name and unit of each line of a lane, in the line's colour.
fn paint_names(painter: &Painter, context: &Context<'_>, lane: &Lane) {
    let theme = context.theme;
    if lane.rect.height() < LOW_LANE_HEIGHT {
        // The names would cover the line. The numbers below also show them.
        return;
    }
    let mut place = lane.rect.min + vec2(8.0, 4.0);
    for line in lane.lines.iter().filter_map(|id| context.recorder.series_by_id(*id)) {
        let unit = line.scale().map(|scale| theme.format_text(&scale.unit)).unwrap_or_default();
        let words = format!("{} / {unit}", theme.format_text(&line.name));
        let words =
            painter.layout_no_wrap(words, FontId::proportional(theme.sizes.caption), series_colour(theme, line));
        let ground = Rect::from_min_size(place, words.size()).expand2(vec2(4.0, 1.0));
        if ground.right() > lane.rect.right() {
            break;
        }
        painter.rect_filled(ground, 2.0, Color32::from(theme.palette.sunken).gamma_multiply(0.85));
        painter.galley(place, words.clone(), Color32::PLACEHOLDER);
        place.x += words.size().x + 16.0;
    }
}

fn paint_cursors(painter: &Painter, context: &Context<'_>, layout: &Layout, font: &FontId) {
    let palette = context.theme.palette;
    for cursor in Cursor::BOTH {
        let Some(time) = context.recorder.cursor(cursor) else { continue };
        let x = layout.time.x(time).round();
        if !layout.chart.x_range().contains(x) {
            continue;
        }
        painter.vline(x, layout.chart.y_range(), Stroke::new(1.0, palette.text));
        let handle = Rect::from_center_size(pos2(x, layout.chart.top() + 8.0), vec2(16.0, 16.0));
        painter.rect_filled(handle, 3.0, palette.text);
        painter.text(handle.center(), Align2::CENTER_CENTER, cursor.keyword(), font.clone(), palette.sunken.into());
        // Marks the points at which the cursor crosses the lines. These are the raw samples of the readout.
        for (lane, line) in layout.lanes.iter().flat_map(|lane| lane.lines.iter().map(move |line| (lane, line))) {
            if let Some(line) = context.recorder.series_by_id(*line) {
                paint_dot(painter, context, layout, lane, line, time);
            }
        }
    }
}

/// Draws a dot at the raw sample nearest to the given time.
fn paint_dot(
    painter: &Painter,
    context: &Context<'_>,
    layout: &Layout,
    lane: &Lane,
    line: &Series,
    time: crate::analysis::SampleTime,
) {
    let Some(sample) = context.recorder.sample_at(line, time) else { return };
    let place = pos2(layout.time.x(sample.time), lane.value_axis().y(line.value(&sample)));
    if place.is_finite() && lane.rect.contains(place) {
        painter.circle(place, 3.5, series_colour(context.theme, line), Stroke::new(1.0, context.theme.palette.sunken));
    }
}

fn paint_pointer_readout(painter: &Painter, context: &Context<'_>, layout: &Layout, place: Pos2) {
    let faint = Stroke::new(1.0, Color32::from(context.theme.palette.muted).gamma_multiply(0.6));
    painter.vline(place.x.round(), layout.chart.y_range(), faint);
    let time = layout.time.time(place.x);
    let words = match context.recorder.counts_samples() {
        true => axes::sample_number(time),
        false => axes::time_of_day(time, context.recorder.window_length(), context.theme.language),
    };
    let font = FontId::monospace(context.theme.sizes.caption);
    let words = painter.layout_no_wrap(words, font, context.theme.palette.text.into());
    let room = layout.chart.right() - words.size().x - 2.0;
    let corner = pos2(
        (place.x - words.size().x / 2.0).clamp(layout.chart.left(), room.max(layout.chart.left())),
        layout.chart.bottom() + 3.0,
    );
    painter.rect_filled(
        Rect::from_min_size(corner, words.size()).expand2(vec2(4.0, 1.0)),
        2.0,
        context.theme.palette.raised,
    );
    painter.galley(corner, words, Color32::PLACEHOLDER);
    for lane in &layout.lanes {
        for line in lane.lines.iter().filter_map(|id| context.recorder.series_by_id(*id)) {
            paint_dot(painter, context, layout, lane, line, time);
        }
    }
}

fn paint_trigger(painter: &Painter, context: &Context<'_>, layout: &Layout, font: &FontId) {
    let Some((trigger, state)) = context.recorder.trigger() else { return };
    let palette = context.theme.palette;
    let colour = Color32::from(palette.accent);
    if let Some(lane) = layout.lanes.iter().find(|lane| lane.lines.contains(&trigger.line))
        && trigger.when.needs_level()
    {
        let y = lane.value_axis().y(trigger.level).round();
        if lane.rect.y_range().contains(y) {
            let ends = [pos2(lane.rect.left(), y), pos2(lane.rect.right(), y)];
            painter.extend(Shape::dashed_line(&ends, Stroke::new(1.0, colour), 6.0, 4.0));
            let place = pos2(lane.rect.right() - 4.0, y - 2.0);
            painter.text(place, Align2::RIGHT_BOTTOM, "T", font.clone(), colour);
        }
    }
    if let TriggerState::Fired(at) | TriggerState::Held(at) = state {
        let x = layout.time.x(at).round();
        if layout.chart.x_range().contains(x) {
            let ends = [pos2(x, layout.chart.top()), pos2(x, layout.chart.bottom())];
            painter.extend(Shape::dashed_line(&ends, Stroke::new(1.0, colour), 2.0, 4.0));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn low_lane_labels_both_ends() {
        // Lines at both edges and in the middle. Heights increase downwards.
        let low = [(-5.0, 27.0), (0.0, 13.5), (5.0, 0.0)];
        assert_eq!(labelled_ticks(&low, 0.0, 27.0), [(-5.0, 21.5), (5.0, 5.5)]);
        let high = [(-5.0, 100.0), (-2.5, 75.0), (0.0, 50.0), (2.5, 25.0), (5.0, 0.0)];
        assert_eq!(labelled_ticks(&high, 0.0, 100.0), [(-2.5, 75.0), (0.0, 50.0), (2.5, 25.0)]);
        assert_eq!(labelled_ticks(&[(0.0, 5.0)], 0.0, 10.0), [(0.0, 5.0)], "too low for two");
    }
}
