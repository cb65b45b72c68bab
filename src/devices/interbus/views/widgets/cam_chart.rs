//! What the lanes and the ring have in common: events, and dragging with pointer, keyboard or screen reader.

use egui::accesskit::{Action, ActionData, Role};
use egui::{Color32, EventFilter, FontId, Id, Key, Modifiers, Painter, Pos2, Rect, Response, Ui, Vec2, WidgetInfo};

use crate::app::Text;
use crate::devices::interbus::profile::{Edge, Scale};
use crate::devices::interbus::protocol::{Cam, CamNumber, Value};
use crate::devices::interbus::state::cams::{self, Chart, DragTarget, SnapSettings, VisibleRange, labels};
use crate::devices::interbus::views::translate;
use crate::ui::Theme;
use crate::ui::widgets::series_colour;

#[derive(Clone, Copy, Debug)]
pub(crate) struct CamChart<'a> {
    pub(crate) label: &'a str,
    /// The edited program. It does not change during a drag.
    pub(crate) chart: &'a Chart,
    /// A program to compare with the edited one. The lanes show its cams as outlines.
    pub(crate) compared: Option<&'a Chart>,
    pub(crate) scale: &'a Scale,
    /// Encoder position in steps, or `None` if unknown.
    pub(crate) position: Option<u32>,
    /// Outputs reported by the encoder, with bit i for cam i, or `None` if there are none.
    pub(crate) own: Option<u8>,
    pub(crate) selected: Option<CamNumber>,
    pub(crate) movable: bool,
    /// Whether edges snap to nearby targets. The Alt key disables snapping.
    pub(crate) snaps: bool,
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum CamEvent {
    /// The edges that the cam would have if the drag ended now. Sent in every frame of the drag.
    Preview(CamNumber, Cam),
    /// The cam was moved or drawn, so its edges have changed.
    Moved {
        cam: CamNumber,
        to: Cam,
        drawn: bool,
    },
    Switched(CamNumber, bool),
    Selected(CamNumber),
    Viewed(VisibleRange),
}

/// A drag in progress. It is kept between frames.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Drag {
    pub(super) hold: DragTarget,
    /// Position under the pointer at the start of the drag.
    pub(super) from: f64,
    pub(super) at: f64,
    /// Edges of the cam after the drag, or `None` if it was cancelled.
    pub(super) to: Option<Cam>,
}

pub(super) fn display_colour(theme: &Theme, cam: CamNumber) -> Color32 {
    series_colour(theme, usize::from(cam.get()))
}

impl CamChart<'_> {
    /// Returns the cam as it is after a drag from one position to another.
    pub(super) fn apply_drag(&self, hold: DragTarget, from: f64, at: f64, snap: &SnapSettings) -> Option<Cam> {
        let range = self.chart.range;
        let own = self.chart.find_lane(hold.cam())?.edges;
        let by = |hold, cam| cams::snap_distance(self.chart, self.scale, hold, cam, at - from, snap);
        match hold {
            DragTarget::Edge(_, edge) => own.map(|cam| cams::apply_drag(cam, edge, by(hold, cam), range)),
            DragTarget::Whole(_) => own.map(|cam| cams::move_cam(cam, by(hold, cam), range)),
            DragTarget::New(number) => {
                let (anchor, edge) = if at < from { (Edge::Stop, Edge::Start) } else { (Edge::Start, Edge::Stop) };
                // An edge that starts at `begin` and is dragged to `to` snaps to this step.
                let snapped = |edge, begin: i64, to: f64| {
                    let place = Value::from_word(begin.rem_euclid(i64::from(range.max(1))) as u32);
                    let one = Cam { start: place, stop: place };
                    let hold = DragTarget::Edge(number, edge);
                    begin + cams::snap_distance(self.chart, self.scale, hold, one, to - begin as f64, snap)
                };
                let first = snapped(anchor, from.floor() as i64, from.floor());
                Some(cams::cam_between(first, snapped(edge, first, at), range))
            }
        }
    }

    /// Returns the event for a drag: a preview while the pointer is down, and the result when it is released.
    pub(super) fn drag_result(
        &self,
        ui: &Ui,
        base: Id,
        response: &Response,
        drag: Drag,
        snap: &SnapSettings,
    ) -> Option<CamEvent> {
        let given_up = ui.input(|input| input.key_pressed(Key::Escape)) || is_drag_cancelled(ui, base);
        let snap = if self.snaps && !ui.input(|input| input.modifiers.alt) { *snap } else { SnapSettings::DISABLED };
        let to = self.apply_drag(drag.hold, drag.from, drag.at, &snap).filter(|_| !given_up);
        let cam = drag.hold.cam();
        if response.drag_stopped() {
            ui.data_mut(|data| data.remove::<Drag>(base));
            let is_new = matches!(drag.hold, DragTarget::New(_));
            let other = to.filter(|to| is_new || self.chart.find_lane(cam).is_some_and(|lane| lane.edges != Some(*to)));
            return Some(match other {
                Some(to) => CamEvent::Moved { cam, to, drawn: is_new },
                None => CamEvent::Selected(cam),
            });
        }
        let now = Drag { to, ..drag };
        if ui.data_mut(|data| data.get_temp(base)) != Some(now) {
            ui.data_mut(|data| data.insert_temp(base, now));
            ui.request_repaint();
        }
        to.map(|to| CamEvent::Preview(cam, to))
    }

    pub(super) fn displayed_chart(&self, drag: Option<Drag>) -> Option<Chart> {
        let drag = drag?;
        Some(self.chart.with_cam(drag.hold.cam(), drag.to?))
    }

    /// Handles keyboard input. The arrow keys move an edge or the cam by one step or to the next grid line. Other keys
    /// switch the cam on and off.
    pub(super) fn handle_keys(&self, ui: &Ui, response: &Response, hold: DragTarget, apart: f64) -> Option<CamEvent> {
        if !response.has_focus() || !self.movable {
            return None;
        }
        let filter = EventFilter { horizontal_arrows: true, ..EventFilter::default() };
        ui.memory_mut(|memory| memory.set_focus_lock_filter(response.id, filter));
        let pressed = |modifiers, key| ui.input_mut(|input| input.consume_key(modifiers, key));
        let cam = hold.cam();
        let lane = self.chart.find_lane(cam)?;
        let edge = match hold {
            DragTarget::Edge(_, edge) => edge,
            DragTarget::Whole(_) | DragTarget::New(_) => Edge::Start,
        };
        let at = self.chart.edge_position(cam, edge)?;
        for (key, forward) in [(Key::ArrowLeft, false), (Key::ArrowRight, true)] {
            let by = if pressed(Modifiers::SHIFT, key) {
                cams::next_grid_line(self.scale, apart, at, forward) - i64::from(at)
            } else if pressed(Modifiers::NONE, key) {
                if forward { 1 } else { -1 }
            } else {
                continue;
            };
            return self.move_by(hold, by);
        }
        if lane.on && (pressed(Modifiers::NONE, Key::Delete) || pressed(Modifiers::NONE, Key::Backspace)) {
            return Some(CamEvent::Switched(cam, false));
        }
        pressed(Modifiers::NONE, Key::Space).then_some(CamEvent::Switched(cam, !lane.on))
    }

    fn move_by(&self, hold: DragTarget, by: i64) -> Option<CamEvent> {
        let cam = hold.cam();
        let own = self.chart.find_lane(cam)?.edges?;
        let to = match hold {
            DragTarget::Edge(_, edge) => cams::apply_drag(own, edge, by, self.chart.range),
            DragTarget::Whole(_) | DragTarget::New(_) => cams::move_cam(own, by, self.chart.range),
        };
        (to != own).then_some(CamEvent::Moved { cam, to, drawn: false })
    }

    /// Describes an edge for screen readers and handles their input.
    pub(super) fn announce_edge(
        &self,
        ui: &Ui,
        theme: &Theme,
        response: &Response,
        hold: DragTarget,
        label: &Text,
    ) -> Option<CamEvent> {
        let DragTarget::Edge(cam, edge) = hold else { return None };
        let at = self.chart.edge_position(cam, edge)?;
        let last = self.chart.last_position();
        response.widget_info(|| {
            let mut info = WidgetInfo::slider(ui.is_enabled(), f64::from(at), theme.format_text(label));
            info.role = Role::Slider;
            info.current_text_value = Some(theme.format_text(&labels::position(at, self.scale, self.chart.range)));
            info
        });
        if !self.movable {
            return None;
        }
        ui.ctx().accesskit_node_builder(response.id, |node| {
            node.set_min_numeric_value(0.0);
            node.set_max_numeric_value(f64::from(last));
            node.set_numeric_value_step(1.0);
            for action in [Action::SetValue, Action::Increment, Action::Decrement] {
                node.add_action(action);
            }
        });
        let (set, more, less) = ui.input(|input| {
            let count = |action| input.num_accesskit_action_requests(response.id, action) as i64;
            let values = input.accesskit_action_requests(response.id, Action::SetValue);
            let set = values.filter_map(|request| match request.data {
                Some(ActionData::NumericValue(value)) if value.is_finite() => Some(value),
                _ => None,
            });
            (set.last(), count(Action::Increment), count(Action::Decrement))
        });
        let own = self.chart.find_lane(cam)?.edges?;
        if let Some(value) = set {
            // The value is within the range, which has at most 25 bits.
            let value = Value::from_word(value.round().clamp(0.0, f64::from(last)) as u32);
            let to = match edge {
                Edge::Start => Cam { start: value, ..own },
                Edge::Stop => Cam { stop: value, ..own },
            };
            return (to != own).then_some(CamEvent::Moved { cam, to, drawn: false });
        }
        if more == less { None } else { self.move_by(hold, more - less) }
    }

    pub(super) fn show_tooltip(&self, theme: &Theme, response: Response, hold: DragTarget) {
        let Some(lane) = self.chart.find_lane(hold.cam()) else { return };
        response.on_hover_ui(|ui| {
            ui.set_max_width(300.0);
            ui.style_mut().wrap_mode = Some(egui::TextWrapMode::Wrap);
            ui.label(theme.format_text(&labels::cam(lane)));
            ui.label(theme.format_text(&labels::lane_text(lane, self.scale, self.chart.range)));
            for trouble in labels::lane_problems(self.chart, lane) {
                ui.label(egui::RichText::new(theme.format_text(&trouble)).color(theme.palette.bad));
            }
            if self.movable {
                let hint = match hold {
                    DragTarget::Edge(..) => "cams.hint_edge",
                    DragTarget::Whole(_) => "cams.hint_whole",
                    DragTarget::New(_) => "cams.hint_new",
                };
                ui.label(theme.caption(translate(theme, hint)));
            }
        });
    }

    /// Draws a label with the result of a drag. It always stays within the painting area.
    pub(super) fn draw_drag_ghost(&self, theme: &Theme, painter: &Painter, drag: &Drag, near: Pos2) {
        let Some(to) = drag.to else { return };
        let range = self.chart.range;
        let words = match drag.hold {
            DragTarget::Edge(_, edge) => labels::position(cams::edge_value(to, edge).get(), self.scale, range),
            DragTarget::Whole(_) | DragTarget::New(_) => labels::range_text(to, self.scale, range),
        };
        let font = FontId::proportional(theme.sizes.caption);
        let galley = painter.layout_no_wrap(theme.format_text(&words), font, theme.palette.on_accent.into());
        let size = galley.size() + Vec2::new(theme.space.between, 4.0);
        let room = painter.clip_rect();
        let left = (near.x - size.x / 2.0).min(room.right() - size.x).max(room.left());
        let top = (near.y - size.y / 2.0).max(room.top());
        let label = Rect::from_min_size(egui::pos2(left, top), size);
        painter.rect_filled(label, theme.space.inside, theme.palette.accent);
        painter.galley(label.center() - galley.size() / 2.0, galley, theme.palette.on_accent.into());
    }
}

pub(super) fn current_drag(ui: &Ui, base: Id) -> Option<Drag> {
    ui.data(|data| data.get_temp(base))
}

fn is_drag_cancelled(ui: &Ui, base: Id) -> bool {
    current_drag(ui, base).is_some_and(|drag| drag.to.is_none())
}
