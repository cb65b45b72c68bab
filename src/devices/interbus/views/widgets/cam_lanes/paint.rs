//! Paints the lanes.

use egui::{Align2, Color32, CornerRadius, FontId, Painter, Rect, Shape, Stroke, StrokeKind, Vec2, pos2};

use super::LanePainter;
use crate::devices::interbus::profile::{Edge, Scale, Unit};
use crate::devices::interbus::protocol::CamNumber;
use crate::devices::interbus::state::cams::{DragTarget, Lane, Tick, grid_ticks, labels};
use crate::devices::interbus::views::widgets::cam_chart::{Drag, display_colour};
use crate::ui::widgets::{draw_hatching, focus_ring};

/// Minimum distance between two ruler numbers in points.
const MIN_NUMBER_DISTANCE: f64 = 64.0;
/// Width of the hatching at the end of a lane.
const HATCHING_WIDTH: f32 = 14.0;
/// Minimum width of a hollow bar.
const MIN_HOLLOW_WIDTH: f32 = 6.0;

#[derive(Clone, Copy, Debug)]
pub(super) struct GripState {
    pub(super) active: bool,
    pub(super) focused: bool,
}

impl LanePainter<'_> {
    pub(super) fn paint(&self, drag: Option<Drag>) {
        let (theme, place) = (self.theme, self.place);
        let painter = self.ui.painter();
        let corners = CornerRadius::same(2);
        painter.rect_filled(place.plot, corners, theme.palette.sunken);
        if let Some(cam) = self.model.selected {
            let lane = place.lane_rect(cam).union(place.lane_header_rect(cam));
            painter.rect_filled(lane, corners, Color32::from(theme.palette.accent).gamma_multiply(0.1));
        }
        self.draw_rulers();
        let within = painter.with_clip_rect(place.plot.intersect(self.ui.clip_rect()));
        for lane in &self.shown.lanes {
            let rect = place.lane_rect(lane.cam);
            painter.hline(rect.x_range(), rect.bottom() - 0.5, Stroke::new(1.0, theme.palette.line));
            self.cam(&within, lane);
            self.draw_compared_cam(&within, lane.cam);
        }
        self.draw_position();
        if let Some(drag) = drag {
            self.paint_drag_target(&drag);
        }
    }

    /// Draws the grid lines and their numbers: steps above the lanes, machine units below.
    fn draw_rulers(&self) {
        let (model, place, theme) = (self.model, self.place, self.theme);
        let apart = MIN_NUMBER_DISTANCE * place.steps_per_point();
        let lines = |scale: &Scale| grid_ticks(scale, &place.view, model.chart.range, apart);
        let plain = Scale::default();
        let has_units = model.scale.unit() != Unit::Steps;
        let above = if has_units { &plain } else { model.scale };
        let steps = lines(above);
        let painter = self.ui.painter();
        for tick in if has_units { lines(model.scale) } else { steps.clone() } {
            let x = place.x(tick.position);
            painter.vline(x, place.plot.y_range(), Stroke::new(1.0, theme.palette.line));
            if has_units {
                self.paint_tick_number(&tick, model.scale.unit(), x, place.units);
            }
        }
        for tick in steps {
            self.paint_tick_number(&tick, Unit::Steps, place.x(tick.position), place.ruler);
        }
    }

    fn paint_tick_number(&self, tick: &Tick, unit: Unit, x: f32, ruler: Rect) {
        let (theme, painter) = (self.theme, self.ui.painter());
        let is_above = ruler.bottom() <= self.place.plot.top() + 1.0;
        let (edge, align) = if is_above { (ruler.bottom(), -1.0) } else { (ruler.top(), 1.0) };
        painter.vline(x, egui::Rangef::point(edge).expand(2.0), Stroke::new(1.0, theme.palette.muted));
        let words = theme.format_text(&labels::tick_label(tick.value, tick.decimals, unit));
        let font = FontId::monospace(theme.sizes.caption);
        let middle = pos2(x, ruler.center().y + align);
        painter.text(middle, Align2::CENTER_CENTER, words, font, theme.palette.muted.into());
    }

    fn cam(&self, painter: &Painter, lane: &Lane) {
        let (theme, place) = (self.theme, self.place);
        let colour = display_colour(theme, lane.cam);
        let range = self.shown.range;
        for stretch in lane.on_ranges(range) {
            let Some(bar) = place.bar_rect(lane.cam, stretch) else { continue };
            let corners = CornerRadius::same(2);
            if lane.on {
                painter.rect_filled(bar, corners, colour.gamma_multiply(0.42));
                if lane.clashes {
                    draw_hatching(painter, theme, bar, theme.palette.bad.into());
                }
                let edge = if lane.clashes { theme.palette.bad.into() } else { colour };
                painter.rect_stroke(bar, corners, Stroke::new(1.5, edge), StrokeKind::Inside);
            } else if bar.width() < MIN_HOLLOW_WIDTH {
                painter.rect_filled(bar, corners, theme.palette.muted);
            } else {
                let stroke = Stroke::new(1.0, theme.palette.muted);
                let around = bar.shrink(0.5);
                let path = [
                    around.left_top(),
                    around.right_top(),
                    around.right_bottom(),
                    around.left_bottom(),
                    around.left_top(),
                ];
                painter.extend(Shape::dashed_line(&path, stroke, 3.0, 3.0));
            }
            self.draw_wrapped_part(painter, lane, bar, stretch.first == 0, stretch.last + 1 == range);
        }
        if lane.beyond {
            let lane = place.lane_rect(lane.cam).shrink2(Vec2::new(0.0, 3.0));
            let x = place.x(f64::from(range)).min(place.plot.right());
            let end = Rect::from_x_y_ranges(x - HATCHING_WIDTH..=x, lane.y_range());
            draw_hatching(painter, theme, end, theme.palette.bad.into());
            painter.rect_stroke(end, CornerRadius::ZERO, Stroke::new(1.0, theme.palette.bad), StrokeKind::Inside);
        }
    }

    /// Draws the outline of a cam from the program used for comparison. It is dashed if that cam is inactive.
    fn draw_compared_cam(&self, painter: &Painter, cam: CamNumber) {
        let Some((chart, lane)) = self.model.compared.and_then(|chart| Some((chart, chart.find_lane(cam)?))) else {
            return;
        };
        let stroke = Stroke::new(if lane.on { 2.0 } else { 1.0 }, self.theme.palette.text);
        for stretch in lane.on_ranges(chart.range) {
            let Some(bar) = self.place.bar_rect(cam, stretch) else { continue };
            let around = bar.expand(1.0);
            let path =
                [around.left_top(), around.right_top(), around.right_bottom(), around.left_bottom(), around.left_top()];
            if lane.on {
                painter.rect_stroke(around, CornerRadius::same(2), stroke, StrokeKind::Inside);
            } else {
                painter.extend(Shape::dashed_line(&path, stroke, 2.0, 4.0));
            }
        }
    }

    fn draw_wrapped_part(&self, painter: &Painter, lane: &Lane, bar: Rect, at_first: bool, at_last: bool) {
        if !lane.edges.is_some_and(|cam| cam.wraps_around()) {
            return;
        }
        let stroke = Stroke::new(1.5, if lane.on { self.theme.palette.text } else { self.theme.palette.muted });
        for (shown, x, towards) in [(at_first, bar.left() + 4.0, -1.0), (at_last, bar.right() - 4.0, 1.0)] {
            if shown && bar.width() > 12.0 {
                let tip = pos2(x + 1.5 * towards, bar.center().y);
                for side in [-4.0, 4.0] {
                    painter.line_segment([pos2(tip.x - 3.0 * towards, tip.y + side), tip], stroke);
                }
            }
        }
    }

    /// Draws a line through all lanes at the encoder position.
    fn draw_position(&self) {
        let Some(position) = self.model.position.filter(|position| *position < self.model.chart.range) else { return };
        let place = self.place;
        let x = place.x(f64::from(position) + 0.5);
        if !place.is_visible(x) {
            return;
        }
        let (painter, colour) = (self.ui.painter(), Color32::from(self.theme.palette.text));
        painter.vline(x, place.plot.y_range(), Stroke::new(1.5, colour));
        let top = place.plot.top();
        let mark = vec![pos2(x - 5.0, top - 6.0), pos2(x + 5.0, top - 6.0), pos2(x, top + 1.0)];
        painter.add(Shape::convex_polygon(mark, colour, Stroke::NONE));
    }

    fn paint_drag_target(&self, drag: &Drag) {
        let Some(to) = drag.to else { return };
        let (theme, place) = (self.theme, self.place);
        let lane = place.lane_rect(drag.hold.cam());
        let x = match drag.hold {
            DragTarget::Edge(_, Edge::Stop) => place.x(f64::from(to.stop.get()) + 1.0),
            _ => place.x(f64::from(to.start.get())),
        };
        let painter = self.ui.painter();
        if place.is_visible(x) {
            painter.vline(x, place.plot.y_range(), Stroke::new(1.0, theme.palette.accent));
        }
        let x = x.clamp(place.plot.left(), place.plot.right());
        self.model.draw_drag_ghost(theme, painter, drag, pos2(x, lane.top() - 6.0));
    }

    /// Draws the handle of an edge.
    pub(super) fn paint_grip(&self, cam: CamNumber, edge: Edge, state: GripState) {
        let lit = state.active || state.focused;
        let is_selected = self.model.selected == Some(cam) && self.model.movable;
        if !lit && !is_selected {
            return;
        }
        let Some(at) = self.shown.edge_position(cam, edge).map(|at| at.min(self.shown.range)) else { return };
        let beyond = f64::from(u8::from(edge == Edge::Stop && at < self.shown.range));
        let x = self.place.x(f64::from(at) + beyond);
        if !self.place.is_visible(x) {
            return;
        }
        let (theme, painter) = (self.theme, self.ui.painter());
        let size = if lit { Vec2::new(5.0, 20.0) } else { Vec2::new(4.0, 14.0) };
        let tab = Rect::from_center_size(pos2(x, self.place.lane_rect(cam).center().y), size);
        painter.rect_filled(tab.expand(1.0), CornerRadius::same(2), theme.palette.raised);
        painter.rect_filled(tab, CornerRadius::same(2), if lit { theme.palette.accent } else { theme.palette.text });
        if state.focused {
            focus_ring(painter, theme, tab, CornerRadius::same(2));
        }
    }

    pub(super) fn paint_focus(&self, cam: CamNumber) {
        let Some(lane) = self.shown.find_lane(cam) else { return };
        let painter = self.ui.painter();
        for stretch in lane.on_ranges(self.shown.range) {
            if let Some(bar) = self.place.bar_rect(cam, stretch) {
                focus_ring(painter, self.theme, bar.intersect(self.place.plot), CornerRadius::same(2));
            }
        }
    }
}
