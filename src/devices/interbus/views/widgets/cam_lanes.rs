//! The cams of a program over the measuring range, in one lane each.
//!
//! * **Size**: the available width; a ruler line, eight lanes, and a line of machine units if these differ from steps.
//! * **Keyboard**: Tab moves through the parts of a lane: the switch of the cam, the cam as a whole, its start and its
//!   stop. The left and right arrows move the focused part by one step, with Shift to the next grid line; Delete
//!   switches the cam off, Space on and off.
//! * **Pointer**: an edge or a whole cam is dragged; over one end of the range it reappears at the other. In the lane
//!   of an inactive cam, a new one is drawn. The result is shown during the drag, and Escape cancels it. Ctrl with the
//!   wheel zooms, the horizontal wheel scrolls.
//! * **Accessible**: an edge is a slider whose value can be set; a cam is a slider with its location; an indicator has
//!   the state and source of its output.
//! * **Painting**: a cam in its colour, hollow if inactive, hatched where it overlaps another pulse of its track; the
//!   end of the range is hatched in the lane of a cam beyond it; the position of the encoder is a line through all
//!   lanes.

mod grips;
mod head;
mod paint;
mod place;

use egui::accesskit::Role;
use egui::{Id, Sense, Ui, WidgetInfo};

use super::cam_chart::{self, CamChart, CamEvent, Drag};
use crate::devices::interbus::profile::Unit;
use crate::devices::interbus::state::cams::{Chart, SnapSettings, VisibleRange};
use crate::ui::Theme;

use place::PlotArea;

struct LanePainter<'a> {
    ui: &'a Ui,
    theme: &'a Theme,
    model: &'a CamChart<'a>,
    shown: &'a Chart,
    place: &'a PlotArea,
    base: Id,
}

/// Draws a part of the range and returns the user's action. Each `Ui` can hold one chart; additional charts need their
/// own id (`push_id`).
pub(crate) fn cam_lanes(ui: &mut Ui, theme: &Theme, model: &CamChart<'_>, view: VisibleRange) -> Option<CamEvent> {
    let base = ui.make_persistent_id("cam_lanes");
    let drag = cam_chart::drag(ui, base).filter(|_| model.movable);
    let preview = model.shown(drag);
    let shown = preview.as_ref().unwrap_or(model.chart);
    let range = model.chart.range;
    let view = view.within(range);
    let size = PlotArea::size(ui.available_width(), model.scale.unit() != Unit::Steps);
    let (outer, response) = ui.allocate_exact_size(size, Sense::hover());
    let place = PlotArea::new(outer, view, theme.space.between);
    response.widget_info(|| WidgetInfo::labeled(Role::Group, true, model.label));

    let lanes = LanePainter { ui, theme, model, shown, place: &place, base };
    let looked = lanes.look(range);
    lanes.paint(drag);
    let pulled = lanes.draw_handles(drag);
    let switched = lanes.draw_heads();
    if drag.is_some() && !ui.input(|input| input.pointer.any_down() || input.pointer.any_released()) {
        ui.data_mut(|data| data.remove::<Drag>(base));
    }
    pulled.or(switched).or(looked)
}

impl LanePainter<'_> {
    fn snap(&self) -> SnapSettings {
        SnapSettings::on(self.place.steps_per_point())
    }

    /// Handles the mouse wheel over the chart, which zooms and scrolls the view.
    fn look(&self, range: u32) -> Option<CamEvent> {
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
