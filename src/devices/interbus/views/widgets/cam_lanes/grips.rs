//! Handles for dragging edges, cams and new cams in the lanes.

use egui::accesskit::Role;
use egui::{CursorIcon, Rect, Response, Sense, WidgetInfo};

use super::LanePainter;
use super::paint::GripState;
use crate::devices::interbus::profile::Edge;
use crate::devices::interbus::protocol::Cam;
use crate::devices::interbus::state::cams::{DragTarget, Lane, PositionRange, labels};
use crate::devices::interbus::views::widgets::cam_chart::{CamEvent, Drag};

impl LanePainter<'_> {
    /// Draws all handles and returns the user's action. During a drag, the handles stay where they were.
    pub(super) fn draw_handles(&self, drag: Option<Drag>) -> Option<CamEvent> {
        let mut event = None;
        for lane in &self.model.chart.lanes {
            event = self.paint_switch(lane).or(event);
            event = self.handle_free_space(lane, drag).or(event);
            if let Some(cam) = lane.edges {
                event = self.handle_cam(lane, drag).or(event);
                event = self.handle_edge(lane, cam, Edge::Start, drag).or(event);
                event = self.handle_edge(lane, cam, Edge::Stop, drag).or(event);
            }
        }
        event
    }

    fn handle_free_space(&self, lane: &Lane, drag: Option<Drag>) -> Option<CamEvent> {
        let id = self.base.with("room").with(lane.cam);
        let draws = self.model.movable && !lane.on;
        let sense = if draws { Sense::CLICK | Sense::DRAG } else { Sense::CLICK };
        let response = self.ui.interact(self.place.lane_rect(lane.cam), id, sense);
        let hold = DragTarget::New(lane.cam);
        let event = self.apply_drag(&response, hold, drag).filter(|_| draws);
        if draws && response.hovered() {
            self.ui.set_cursor_icon(CursorIcon::Crosshair);
        }
        let clicked = response.clicked().then_some(CamEvent::Selected(lane.cam));
        if draws && drag.is_none() {
            self.model.show_tooltip(self.theme, response, hold);
        }
        event.or(clicked)
    }

    /// Handles input for a whole cam. If it has two sections, the wider one takes the keyboard focus.
    fn handle_cam(&self, lane: &Lane, drag: Option<Drag>) -> Option<CamEvent> {
        let stretches = lane.on_ranges(self.model.chart.range);
        let widest = stretches.iter().max_by_key(|stretch| stretch.last - stretch.first).copied();
        let hold = DragTarget::Whole(lane.cam);
        let mut event = None;
        for stretch in &stretches {
            let is_widest = Some(*stretch) == widest;
            let Some(rect) =
                self.place.bar_rect(lane.cam, *stretch).or(is_widest.then(|| self.place.lane_header_rect(lane.cam)))
            else {
                continue;
            };
            let shown = self.place.bar_rect(lane.cam, *stretch).is_some();
            let id = self.base.with("whole").with((lane.cam, is_widest));
            let response = self.ui.interact(rect, id, self.sense(shown, is_widest));
            if is_widest {
                event = self.describe_lane(lane, &response).or(event);
                event = self.model.handle_keys(self.ui, &response, hold, self.grid_distance()).or(event);
                event = self.follow_focus(&response, *stretch).or(event);
            }
            event = self.apply_drag(&response, hold, drag).or(event);
            if response.clicked() {
                self.ui.memory_mut(|memory| memory.request_focus(self.base.with("whole").with((lane.cam, true))));
                event = Some(CamEvent::Selected(lane.cam));
            }
            if self.model.movable && response.hovered() {
                self.ui.set_cursor_icon(if response.dragged() { CursorIcon::Grabbing } else { CursorIcon::Grab });
            }
            if response.has_focus() {
                self.paint_focus(lane.cam);
            }
            if drag.is_none() {
                self.model.show_tooltip(self.theme, response, hold);
            }
        }
        event
    }

    fn describe_lane(&self, lane: &Lane, response: &Response) -> Option<CamEvent> {
        response.widget_info(|| {
            let label = self.theme.format_text(&labels::cam(lane));
            let mut info = WidgetInfo::labeled(Role::Slider, self.ui.is_enabled(), label);
            info.value = lane.edges.map(|cam| f64::from(cam.start.get()));
            info.current_text_value =
                Some(self.theme.format_text(&labels::lane_text(lane, self.model.scale, self.model.chart.range)));
            info
        });
        response.gained_focus().then_some(CamEvent::Selected(lane.cam))
    }

    fn handle_edge(&self, lane: &Lane, cam: Cam, edge: Edge, drag: Option<Drag>) -> Option<CamEvent> {
        let hold = DragTarget::Edge(lane.cam, edge);
        let (rect, x) = self.grip_area(cam, lane, edge)?;
        let shown = self.place.is_visible(x);
        let id = self.base.with("edge").with(hold);
        let response = self.ui.interact(rect, id, self.sense(shown, true));
        let label = labels::edge_name(lane, edge);
        let mut event = self.model.announce_edge(self.ui, self.theme, &response, hold, &label);
        event = event.or(self.model.handle_keys(self.ui, &response, hold, self.grid_distance()));
        if response.clicked() || response.drag_started() {
            response.request_focus();
        }
        if response.clicked() || response.gained_focus() {
            event = event.or(Some(CamEvent::Selected(lane.cam)));
        }
        let at = self.model.chart.edge_position(lane.cam, edge)?;
        event = self.follow_focus(&response, PositionRange { first: at, last: at }).or(event);
        event = self.apply_drag(&response, hold, drag).or(event);
        let is_held = response.dragged();
        if self.model.movable && (is_held || response.hovered()) {
            self.ui.set_cursor_icon(CursorIcon::ResizeHorizontal);
        }
        let state =
            GripState { active: is_held || response.hovered() && self.model.movable, focused: response.has_focus() };
        self.paint_grip(lane.cam, edge, state);
        if drag.is_none() {
            self.model.show_tooltip(self.theme, response, hold);
        }
        event
    }

    /// Returns the area in which an edge can be grabbed, and the edge's horizontal position. If the edge is out of
    /// view, the area is at the end of the lane and only used by the keyboard.
    fn grip_area(&self, cam: Cam, lane: &Lane, edge: Edge) -> Option<(Rect, f32)> {
        let chart = self.model.chart;
        let at = self.model.chart.edge_position(lane.cam, edge)?.min(chart.range);
        let x = match edge {
            Edge::Start => self.place.x(f64::from(at)),
            Edge::Stop => self.place.x(f64::from(at.saturating_add(1).min(chart.range))),
        };
        let own = lane.on_ranges(chart.range).into_iter().find(|stretch| match edge {
            Edge::Start => stretch.first == cam.start.get(),
            Edge::Stop => stretch.last == cam.stop.get(),
        });
        let width = own.and_then(|own| self.place.bar_rect(lane.cam, own)).map_or(0.0, |bar| bar.width());
        let shown = x.clamp(self.place.plot.left(), self.place.plot.right());
        Some((self.place.grip_rect(lane.cam, shown, edge == Edge::Start, width), x))
    }

    fn sense(&self, shown: bool, focusable: bool) -> Sense {
        match (shown && self.model.movable, focusable) {
            (true, true) => Sense::click_and_drag(),
            (true, false) => Sense::CLICK | Sense::DRAG,
            (false, true) if shown => Sense::click(),
            (false, true) => Sense::focusable_noninteractive(),
            (false, false) => Sense::CLICK,
        }
    }

    fn follow_focus(&self, response: &Response, stretch: PositionRange) -> Option<CamEvent> {
        let (view, range) = (self.place.view, self.model.chart.range);
        let (first, last) = (f64::from(stretch.first), f64::from(stretch.last) + 1.0);
        let is_out = last < view.first() || first > view.first() + view.length();
        let moved = response.gained_focus() || response.has_focus() && is_out && self.is_arrow_key_released();
        (moved && is_out).then(|| CamEvent::Viewed(view.panned(first - view.first() - view.length() / 2.0, range)))
    }

    fn is_arrow_key_released(&self) -> bool {
        use egui::Key::{ArrowLeft, ArrowRight};
        self.ui.input(|input| [ArrowLeft, ArrowRight].into_iter().any(|key| input.key_released(key)))
    }

    fn grid_distance(&self) -> f64 {
        self.snap_settings().apart.unwrap_or(1.0)
    }

    /// Handles dragging with the pointer, and returns the preview or result.
    fn apply_drag(&self, response: &Response, hold: DragTarget, drag: Option<Drag>) -> Option<CamEvent> {
        if !self.model.movable || !response.dragged() && !response.drag_stopped() {
            return None;
        }
        let pointer = response.interact_pointer_pos()?;
        let at = self.place.position(pointer.x);
        let own = drag.filter(|drag| drag.hold == hold);
        let pressed = || self.ui.input(|input| input.pointer.press_origin()).map(|pos| self.place.position(pos.x));
        let from = own.map(|drag| drag.from).or_else(pressed).unwrap_or(at);
        let to = own.and_then(|drag| drag.to);
        self.model.drag_result(self.ui, self.base, response, Drag { hold, from, at, to }, &self.snap_settings())
    }
}
