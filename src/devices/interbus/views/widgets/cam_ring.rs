//! The cams of a program around a ring. The measuring range starts at the top and runs clockwise.
//!
//! * **Size**: The widget is a square with the given width.
//! * **Keyboard**: Tab moves to the next edge. The arrow keys move an edge by one step, or with Shift to the next grid
//!   line. Delete switches its cam off, and Space switches it on and off.
//! * **Pointer**: An edge or a whole cam can be dragged around the ring. Escape cancels the drag.
//! * **Accessible**: An edge is a slider with a value that can be set.
//! * **Painting**: There is a circle for each cam, with the first cam on the outermost one. A cam is an arc in its
//!   colour, thin if it is inactive, and struck through where it overlaps another cam of the same name. A hand shows
//!   the position of the encoder. Labels around the ring are in steps or machine units.

use egui::accesskit::Role;
use egui::epaint::PathStroke;
use egui::{
    Align2, Color32, CornerRadius, CursorIcon, FontId, Id, Painter, Pos2, Rect, Response, Sense, Shape, Stroke, Ui,
    Vec2, WidgetInfo,
};

use super::cam_chart::{self, CamChart, CamEvent, Drag, display_colour};
use crate::devices::interbus::profile::Edge;
use crate::devices::interbus::protocol::{CamNumber, Program, Value};
use crate::devices::interbus::state::TEXTS;
use crate::devices::interbus::state::cams::{Chart, DragTarget, Lane, SnapSettings, VisibleRange, grid_ticks, labels};
use crate::ui::Theme;
use crate::ui::widgets::focus_ring;

/// Minimum side length in points.
const MIN_SIDE: f32 = 160.0;
/// Radius of the innermost circle as a fraction of the outer radius.
const INNER_RADIUS: f32 = 0.34;
/// Margin for the labels around the ring.
const NUMBER_MARGIN: f32 = 26.0;
/// Width of the area in which an edge can be grabbed.
const GRIP_WIDTH: f32 = 12.0;
/// Maximum number of labels around the ring.
const LINES: f64 = 12.0;

#[derive(Clone, Copy, Debug)]
struct Dial {
    middle: Pos2,
    radius: f32,
    range: f64,
}

impl Dial {
    /// Returns the screen point for a position on a circle. The range starts at the top.
    fn point_at(self, position: f64, radius: f32) -> Pos2 {
        let angle = (position / self.range * std::f64::consts::TAU) as f32;
        self.middle + Vec2::new(angle.sin(), -angle.cos()) * radius
    }

    /// Returns the position that lies in the direction of a screen point.
    fn position(self, place: Pos2) -> f64 {
        let from = place - self.middle;
        let part = f64::from(from.x.atan2(-from.y)) / std::f64::consts::TAU;
        part.rem_euclid(1.0) * self.range
    }

    /// Returns the distance between two adjacent circles.
    fn circle_distance(self) -> f32 {
        self.radius * (1.0 - INNER_RADIUS) / Program::CAMS as f32
    }

    fn circle_radius(self, cam: CamNumber) -> f32 {
        self.radius - (f32::from(cam.get()) + 0.5) * self.circle_distance()
    }

    /// Returns the cam whose circle contains a screen point.
    fn cam_at(self, place: Pos2) -> Option<CamNumber> {
        let from_outside = (self.radius - place.distance(self.middle)) / self.circle_distance();
        if (0.0..Program::CAMS as f32).contains(&from_outside) { CamNumber::new(from_outside as u8) } else { None }
    }

    /// Returns the signed distance from one position to another, in the shorter direction around the ring.
    fn signed_distance(self, from: f64, to: f64) -> f64 {
        (to - from + self.range / 2.0).rem_euclid(self.range) - self.range / 2.0
    }

    /// Returns the number of steps per point on the outermost circle.
    fn steps_per_point(self) -> f64 {
        self.range / (std::f64::consts::TAU * f64::from(self.radius))
    }
}

struct Ring<'a> {
    ui: &'a Ui,
    theme: &'a Theme,
    model: &'a CamChart<'a>,
    shown: &'a Chart,
    dial: Dial,
    base: Id,
}

/// Draws the ring and returns the user's action. A `Ui` can contain only one ring, unless each further one has a
/// separate ID from `push_id`.
pub(crate) fn cam_ring(ui: &mut Ui, theme: &Theme, model: &CamChart<'_>, side: f32) -> Option<CamEvent> {
    let base = ui.make_persistent_id("cam_ring");
    let drag = cam_chart::current_drag(ui, base).filter(|_| model.movable);
    let preview = model.displayed_chart(drag);
    let shown = preview.as_ref().unwrap_or(model.chart);
    let (rect, response) = ui.allocate_exact_size(Vec2::splat(side.max(MIN_SIDE)), Sense::hover());
    response.widget_info(|| WidgetInfo::labeled(Role::Group, true, model.label));
    let range = f64::from(model.chart.range.max(1));
    let dial = Dial { middle: rect.center(), radius: rect.width() / 2.0 - NUMBER_MARGIN, range };
    let ring = Ring { ui, theme, model, shown, dial, base };
    if ui.is_rect_visible(rect) {
        ring.paint();
    }
    let whole = ring.draw_disc(rect, drag);
    let edges = ring.handle_edges(drag);
    if let Some(drag) = drag {
        model.draw_drag_ghost(theme, ui.painter(), &drag, rect.center());
    }
    if drag.is_some() && !ui.input(|input| input.pointer.any_down() || input.pointer.any_released()) {
        ui.data_mut(|data| data.remove::<Drag>(base));
    }
    edges.or(whole)
}

impl Ring<'_> {
    fn snap_settings(&self) -> SnapSettings {
        SnapSettings::enabled(self.dial.steps_per_point())
    }

    /// Draws the circles and handles the dragging of whole cams.
    fn draw_disc(&self, rect: Rect, drag: Option<Drag>) -> Option<CamEvent> {
        let sense = if self.model.movable { Sense::CLICK | Sense::DRAG } else { Sense::CLICK };
        let response = self.ui.interact(rect, self.base.with("disc"), sense);
        let under = |place: Pos2| {
            let lane = self.model.chart.find_lane(self.dial.cam_at(place)?)?;
            let position = Value::from_word(self.dial.position(place) as u32);
            lane.edges.filter(|cam| cam.is_on(position)).map(|_| DragTarget::Whole(lane.cam))
        };
        let hovered = response.hover_pos();
        let hold = match drag {
            Some(drag) => Some(drag.hold),
            None => self.ui.input(|input| input.pointer.press_origin()).filter(|_| response.dragged()).and_then(under),
        };
        if self.model.movable && (response.dragged() || hovered.and_then(under).is_some()) {
            self.ui.set_cursor_icon(if response.dragged() { CursorIcon::Grabbing } else { CursorIcon::Grab });
        }
        let event = hold.and_then(|hold| self.apply_drag(&response, hold, drag));
        let clicked = response.clicked().then(|| response.interact_pointer_pos().and_then(|at| self.dial.cam_at(at)));
        if let Some(hold) = hovered.and_then(under).filter(|_| drag.is_none()) {
            self.model.show_tooltip(self.theme, response, hold);
        }
        event.or(clicked.flatten().map(CamEvent::Selected))
    }

    fn handle_edges(&self, drag: Option<Drag>) -> Option<CamEvent> {
        let mut event = None;
        for lane in self.model.chart.lanes.iter().filter(|lane| lane.edges.is_some()) {
            event = self.handle_edge(lane, Edge::Start, drag).or(event);
            event = self.handle_edge(lane, Edge::Stop, drag).or(event);
        }
        event
    }

    fn handle_edge(&self, lane: &Lane, edge: Edge, drag: Option<Drag>) -> Option<CamEvent> {
        let hold = DragTarget::Edge(lane.cam, edge);
        let place = self.edge_point(self.model.chart, lane.cam, edge)?;
        let rect = Rect::from_center_size(place, Vec2::splat(GRIP_WIDTH.min(self.dial.circle_distance())));
        let sense = if self.model.movable { Sense::click_and_drag() } else { Sense::click() };
        let response = self.ui.interact(rect, self.base.with("edge").with(hold), sense);
        let label = TEXTS.text("cams.on_ring").with_text("edge", labels::edge_name(lane, edge));
        let mut event = self.model.announce_edge(self.ui, self.theme, &response, hold, &label);
        let apart = self.snap_settings().apart.unwrap_or(1.0);
        event = event.or(self.model.handle_keys(self.ui, &response, hold, apart));
        if response.clicked() || response.drag_started() {
            response.request_focus();
        }
        if response.clicked() || response.gained_focus() {
            event = event.or(Some(CamEvent::Selected(lane.cam)));
        }
        event = self.apply_drag(&response, hold, drag).or(event);
        let is_active = self.model.movable && (response.dragged() || response.hovered());
        if is_active {
            self.ui.set_cursor_icon(if response.dragged() { CursorIcon::Grabbing } else { CursorIcon::Grab });
        }
        self.paint_grip(lane.cam, edge, is_active, response.has_focus());
        if drag.is_none() {
            self.model.show_tooltip(self.theme, response, hold);
        }
        event
    }

    fn edge_point(&self, chart: &Chart, cam: CamNumber, edge: Edge) -> Option<Pos2> {
        let at = chart.edge_position(cam, edge)?.min(chart.range);
        let beyond = u32::from(edge == Edge::Stop && at < chart.range);
        Some(self.dial.point_at(f64::from(at + beyond), self.dial.circle_radius(cam)))
    }

    /// Handles a drag around the ring. From frame to frame, the position moves to the pointer in the shorter direction.
    fn apply_drag(&self, response: &Response, hold: DragTarget, drag: Option<Drag>) -> Option<CamEvent> {
        if !self.model.movable || !response.dragged() && !response.drag_stopped() {
            return None;
        }
        let now = self.dial.position(response.interact_pointer_pos()?);
        let own = drag.filter(|drag| drag.hold == hold);
        let pressed = || self.ui.input(|input| input.pointer.press_origin()).map(|pos| self.dial.position(pos));
        let from = own.map(|drag| drag.from).or_else(pressed).unwrap_or(now);
        let before = own.map_or(from, |drag| drag.at);
        let at = before + self.dial.signed_distance(before, now);
        let to = own.and_then(|drag| drag.to);
        self.model.drag_result(self.ui, self.base, response, Drag { hold, from, at, to }, &self.snap_settings())
    }

    fn paint(&self) {
        let (theme, dial, painter) = (self.theme, self.dial, self.ui.painter());
        for lane in &self.shown.lanes {
            let stroke = Stroke::new(1.0, theme.palette.line);
            painter.circle_stroke(dial.middle, dial.circle_radius(lane.cam), stroke);
        }
        if let Some(cam) = self.model.selected {
            let wide = Stroke::new(dial.circle_distance(), Color32::from(theme.palette.accent).gamma_multiply(0.12));
            // A stroke is drawn outside its circle, so the radius is reduced by half a pitch.
            painter.circle_stroke(dial.middle, dial.circle_radius(cam) - dial.circle_distance() / 2.0, wide);
        }
        self.paint_numbers();
        for lane in &self.shown.lanes {
            self.paint_arc(painter, lane);
        }
        if let Some(position) = self.model.position.filter(|position| *position < self.shown.range) {
            let at = f64::from(position) + 0.5;
            let stroke = Stroke::new(1.5, theme.palette.text);
            let inner = dial.radius * INNER_RADIUS * 0.5;
            painter.line_segment([dial.point_at(at, inner), dial.point_at(at, dial.radius + 3.0)], stroke);
            painter.circle_filled(dial.point_at(at, inner), 3.0, stroke.color);
        }
    }

    fn paint_numbers(&self) {
        let (theme, dial, painter) = (self.theme, self.dial, self.ui.painter());
        let range = self.shown.range;
        let scale = self.model.scale;
        let lines = grid_ticks(scale, &VisibleRange::full(range), range, dial.range / LINES);
        for tick in lines.iter().filter(|tick| tick.position < dial.range - dial.range / LINES / 2.0) {
            let at = |radius| dial.point_at(tick.position, radius);
            painter.line_segment(
                [at(dial.radius * INNER_RADIUS), at(dial.radius + 3.0)],
                Stroke::new(1.0, theme.palette.line),
            );
            let words = theme.format_text(&labels::tick_label(tick.value, tick.decimals, scale.unit()));
            let galley =
                painter.layout_no_wrap(words, FontId::monospace(theme.sizes.caption), theme.palette.muted.into());
            // The label is outside the circle.
            let out = (at(dial.radius) - dial.middle) / dial.radius.max(1.0);
            let middle = at(dial.radius + 5.0) + out * galley.size() / 2.0;
            painter.galley(middle - galley.size() / 2.0, galley, theme.palette.muted.into());
        }
    }

    fn paint_arc(&self, painter: &Painter, lane: &Lane) {
        let (theme, dial) = (self.theme, self.dial);
        let thick = (dial.circle_distance() - 3.0).max(2.0);
        let (width, colour) =
            if lane.on { (thick, display_colour(theme, lane.cam)) } else { (1.5, Color32::from(theme.palette.muted)) };
        for stretch in lane.on_ranges(self.shown.range) {
            let (from, to) = (f64::from(stretch.first), f64::from(stretch.last) + 1.0);
            let count = (((to - from) / dial.range * 128.0).ceil() as usize).clamp(2, 128);
            let point =
                |at: usize| dial.point_at(from + (to - from) * at as f64 / count as f64, dial.circle_radius(lane.cam));
            painter.add(Shape::line((0..=count).map(point).collect(), PathStroke::new(width, colour)));
            if lane.clashes {
                let marked = PathStroke::new(2.0, Color32::from(theme.palette.bad));
                painter.add(Shape::line((0..=count).map(point).collect(), marked));
            }
        }
        let cam = cam_number_pos(dial, lane.cam);
        let font = FontId::monospace((theme.sizes.caption).min(dial.circle_distance()));
        let ink = if lane.on { theme.palette.text } else { theme.palette.muted };
        let label = Rect::from_center_size(cam, Vec2::splat(dial.circle_distance().min(13.0)));
        painter.rect_filled(label, CornerRadius::same(2), theme.palette.raised);
        painter.text(cam, Align2::CENTER_CENTER, lane.cam.get().to_string(), font, ink.into());
    }

    fn paint_grip(&self, cam: CamNumber, edge: Edge, active: bool, focused: bool) {
        let is_selected = self.model.selected == Some(cam) && self.model.movable;
        let Some(place) = self.edge_point(self.shown, cam, edge).filter(|_| active || focused || is_selected) else {
            return;
        };
        let (theme, painter) = (self.theme, self.ui.painter());
        let lit = active || focused;
        let radius = if lit { 5.0 } else { 3.5 };
        painter.circle_filled(place, radius + 1.0, theme.palette.raised);
        painter.circle_filled(place, radius, if lit { theme.palette.accent } else { theme.palette.text });
        if focused {
            let around = Rect::from_center_size(place, Vec2::splat(2.0 * radius + 2.0));
            focus_ring(painter, theme, around, CornerRadius::same(6));
        }
    }
}

/// Returns where to draw a cam's number, which is at the start of the range.
fn cam_number_pos(dial: Dial, cam: CamNumber) -> Pos2 {
    dial.middle - Vec2::new(0.0, dial.circle_radius(cam))
}
