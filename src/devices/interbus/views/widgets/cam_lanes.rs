//! The cams of a program across the measuring range, with one lane per cam.
//!
//! * **Size**: The widget has the available width. It consists of a ruler line, eight lanes, and a line of machine
//!   units if these differ from steps.
//! * **Keyboard**: Tab moves through the switch of a cam, the cam, its start and its stop. The left and right arrow
//!   keys move the focused part by one step, or with Shift to the next grid line. Delete switches the cam off, and
//!   Space switches it on and off.
//! * **Pointer**: An edge or a whole cam can be dragged. A part that is dragged over one end of the range reappears at
//!   the other end. Dragging in the lane of an inactive cam draws a new one. Escape cancels a drag. The wheel zooms
//!   with Ctrl, and the horizontal wheel scrolls.
//! * **Accessible**: An edge is a slider with a value that can be set. A cam is a slider with its location. An
//!   indicator states whether its output is on and where this state comes from.
//! * **Painting**: A cam is drawn in its colour, hollow if it is inactive, and hatched where it overlaps another cam of
//!   the same name. If a cam is beyond the range, the end of its lane is hatched. A line through all lanes shows the
//!   position of the encoder.

mod grips;
mod lane_header;
mod layout;
mod paint;

use egui::accesskit::Role;
use egui::{Id, Sense, Ui, WidgetInfo};

use super::cam_chart::{self, CamChart, CamEvent, Drag};
use crate::devices::interbus::profile::Unit;
use crate::devices::interbus::state::cams::{Chart, SnapSettings, VisibleRange};
use crate::ui::Theme;

use layout::PlotArea;

struct LanePainter<'a> {
    ui: &'a Ui,
    theme: &'a Theme,
    model: &'a CamChart<'a>,
    shown: &'a Chart,
    place: &'a PlotArea,
    base: Id,
}

/// Draws the lanes for the visible part of the range, and returns the user's action. A `Ui` can contain only one chart,
/// unless each further one has a separate ID from `push_id`.
pub(crate) fn cam_lanes(ui: &mut Ui, theme: &Theme, model: &CamChart<'_>, view: VisibleRange) -> Option<CamEvent> {
    let base = ui.make_persistent_id("cam_lanes");
    let drag = cam_chart::current_drag(ui, base).filter(|_| model.movable);
    let preview = model.displayed_chart(drag);
    let shown = preview.as_ref().unwrap_or(model.chart);
    let range = model.chart.range;
    let view = view.clamped_to(range);
    let size = PlotArea::size(ui.available_width(), model.scale.unit() != Unit::Steps);
    let (outer, response) = ui.allocate_exact_size(size, Sense::hover());
    let place = PlotArea::new(outer, view, theme.space.between);
    response.widget_info(|| WidgetInfo::labeled(Role::Group, true, model.label));

    let lanes = LanePainter { ui, theme, model, shown, place: &place, base };
    let looked = lanes.handle_wheel(range);
    lanes.paint(drag);
    let pulled = lanes.draw_handles(drag);
    let switched = lanes.draw_lane_headers();
    if drag.is_some() && !ui.input(|input| input.pointer.any_down() || input.pointer.any_released()) {
        ui.data_mut(|data| data.remove::<Drag>(base));
    }
    pulled.or(switched).or(looked)
}

impl LanePainter<'_> {
    fn snap_settings(&self) -> SnapSettings {
        SnapSettings::enabled(self.place.steps_per_point())
    }

    /// Handles the mouse wheel, which zooms and scrolls.
    fn handle_wheel(&self, range: u32) -> Option<CamEvent> {
        let pointer = self.ui.input(|input| input.pointer.hover_pos())?;
        if !self.place.plot.contains(pointer) || !self.ui.rect_contains_pointer(self.place.plot) {
            return None;
        }
        let view = self.place.view;
        let (zoom, along) = self.ui.input(|input| (input.zoom_delta(), input.smooth_scroll_delta().x));
        if (zoom - 1.0).abs() > f32::EPSILON {
            let around = self.place.position(pointer.x);
            return Some(view.zoomed(f64::from(zoom), around, range)).filter(|to| *to != view).map(CamEvent::Viewed);
        }
        let by = -f64::from(along) * self.place.steps_per_point();
        Some(view.panned(by, range)).filter(|to| *to != view).map(CamEvent::Viewed)
    }
}
