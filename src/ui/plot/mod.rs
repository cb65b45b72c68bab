//! The plot, which draws a recorder and turns pointer and keyboard input into actions.
//!
//! A drag selects a box to zoom into, or moves a cursor. A drag with the right button or Shift moves the picture. The
//! wheel lengthens or shortens the time span around the pointer. A double click shows everything. Keys: ← and → move, +
//! and − zoom, Home shows everything, End shows the newest samples, and A and B set the cursors.

mod axes;
mod chart;
mod lanes;
mod pointer;
mod readout;
mod snapshot;
mod toolbar;
mod trace;
mod trigger;

use egui::{Rect, Sense, Ui, WidgetInfo, vec2};

use super::Theme;
use super::controls::empty_placeholder;
use crate::app::recorder::{self, Recorder};
use crate::app::{Action, RecorderOwner};

#[derive(Default)]
pub struct PlotUiState {
    owner: Option<RecorderOwner>,
    reduced: lanes::ReducedLane,
    drag: Option<pointer::Drag>,
    trigger: trigger::Form,
    shot: snapshot::Screenshot,
    /// Whether the plot fills the page, or `None` if it cannot be enlarged.
    large: Option<bool>,
}

impl PlotUiState {
    /// Creates the state of a plot in a side panel. The plot can expand to the whole page.
    pub(in crate::ui) fn for_panel() -> Self {
        PlotUiState { large: Some(false), ..PlotUiState::default() }
    }

    pub(in crate::ui) fn is_expanded(&self) -> bool {
        self.large == Some(true)
    }

    /// Moves the plot back to its panel. Returns `false` if it was already there.
    pub(in crate::ui) fn restore_size(&mut self) -> bool {
        let was = self.is_expanded();
        self.large = self.large.map(|_| false);
        was
    }
}

/// The recorder of a plot, and the list that collects the user's actions.
pub(super) struct Context<'a> {
    theme: &'a Theme,
    recorder: &'a Recorder,
    owner: RecorderOwner,
    actions: &'a mut Vec<Action>,
}

impl Context<'_> {
    fn push_action(&mut self, action: recorder::RecorderAction) {
        self.actions.push(Action::Recorder(self.owner, action));
    }
}

/// Draws a recorder and its toolbar in the available space. `invitation` explains how to record samples.
pub fn plot_ui(
    ui: &mut Ui,
    theme: &Theme,
    recorder: &Recorder,
    owner: RecorderOwner,
    view: &mut PlotUiState,
    invitation: &str,
    actions: &mut Vec<Action>,
) {
    if view.owner.replace(owner).is_some_and(|before| before != owner) {
        // Discard the drags and typed text of another recorder.
        *view = PlotUiState { owner: view.owner, large: view.large, ..PlotUiState::default() };
    }
    let context = &mut Context { theme, recorder, owner, actions };
    toolbar::toolbar_ui(ui, context, view);
    let top = ui.cursor().top();
    let below = ui.available_height();
    // The readout is below the chart. Its height is taken from the previous frame.
    let readout_id = ui.scope_id().with("readout");
    let readout = ui.data(|data| data.get_temp::<f32>(readout_id)).unwrap_or(0.0);
    // In a low panel, the numbers scroll, and the chart keeps half of the space.
    let height = (below - readout.min(below * 0.5) - ui.spacing().item_spacing.y).max(60.0);
    let hovered = chart_ui(ui, context, view, height, invitation);
    let numbers = egui::ScrollArea::vertical().id_salt("readout").auto_shrink([false, true]);
    let used = numbers.show(ui, |ui| readout::readout_ui(ui, context, hovered)).content_size.y;
    if (used - readout).abs() > 0.5 {
        ui.data_mut(|data| data.insert_temp(readout_id, used));
        ui.ctx().request_repaint();
    }
    // The picture excludes the toolbar. It includes the numbers if all of them are visible.
    let shown = ui.min_rect();
    let bottom = if used <= shown.bottom() - top - height + 0.5 { shown.bottom() } else { top + height };
    let picture = Rect::from_min_max(egui::pos2(shown.left(), top), egui::pos2(shown.right(), bottom));
    view.shot.handle_plot(ui, picture, context.actions);
}

/// Draws the chart and returns the time under the pointer.
fn chart_ui(
    ui: &mut Ui,
    context: &mut Context<'_>,
    view: &mut PlotUiState,
    height: f32,
    invitation: &str,
) -> Option<crate::analysis::SampleTime> {
    let (theme, recorder) = (context.theme, context.recorder);
    let size = vec2(ui.available_width().max(0.0), height);
    let (rect, response) = ui.allocate_exact_size(size, Sense::click_and_drag());
    let word = theme.translate("recorder.chart");
    response.widget_info(|| WidgetInfo::labeled(egui::Role::Image, true, &word));
    ui.painter().rect_filled(rect, theme.radius, theme.palette.sunken);
    if size.x < 80.0 {
        return None;
    }
    if recorder.is_empty() || recorder.visible_series().next().is_none() {
        let words = if recorder.is_empty() { invitation.to_owned() } else { theme.translate("recorder.no_line") };
        let mut inner = ui.new_child(egui::UiBuilder::new().max_rect(rect.shrink(8.0)));
        inner.add_space((rect.height() / 2.0 - 36.0).max(0.0));
        empty_placeholder(&mut inner, theme, &words, None);
        return None;
    }
    let layout = lanes::compute_layout(recorder, rect.shrink(6.0), ui.pixels_per_point(), &mut view.reduced);
    let is_free = view.drag.is_none() && !view.shot.is_wanted();
    let hovered = response.hover_pos().filter(|place| layout.chart.contains(*place) && is_free);
    pointer::handle_interaction(ui, &response, context, &layout, &mut view.drag);
    let painter = ui.painter().with_clip_rect(rect);
    chart::paint(&painter, context, &layout, &view.reduced, view.drag.as_ref(), hovered);
    if response.has_focus() {
        let stroke = egui::Stroke::new(1.0, theme.palette.accent);
        ui.painter().rect_stroke(rect, theme.radius, stroke, egui::StrokeKind::Inside);
    }
    hovered.map(|place| layout.time.time(place.x))
}
