//! Widgets that egui does not provide. Each widget draws its input, stores only its selection and returns the user's
//! request. The widgets do not depend on any device, and share the style of focus, hatching and series colours.

mod bit_cell;
mod chart;
mod field_map;
mod frame_strip;
mod hex_editor;
mod hold_button;
mod lissajous;
mod register_table;
mod step_ring;
mod steps;
mod typed_view;

use egui::{Color32, CornerRadius, Painter, Rect, Stroke, StrokeKind};

use super::Theme;

pub(crate) use bit_cell::BitCell;
pub use chart::{Chart, Trace, chart};
pub use field_map::{FieldMap, MapEvent, MapField, field_map};
pub use frame_strip::{FrameStrip, StripField, frame_strip};
pub use hex_editor::{HexAddresses, HexAnnotation, HexEdit, HexModel, HexView, hex_editor, hex_lines};
pub use hold_button::{HoldButton, hold_button};
pub(in crate::ui) use hold_button::{
    HoldButtonContext, has_hold_button_focus, is_hold_button_held, set_hold_button_context,
};
pub use lissajous::{Lissajous, LissajousFigure, density_image, lissajous};
pub use register_table::{
    RegisterBits, RegisterEvent, RegisterGroup, RegisterKind, RegisterLocation, RegisterRow, RegisterTable,
    RegisterTableOutput, RegisterView, register_table,
};
pub use step_ring::{StepRing, step_ring};
pub use steps::{Gauge, StepRow, StepState, Steps, StepsEvent, steps};
pub use typed_view::typed_view;

/// Draws the focus ring around a widget, one point outside it and two points wide, in the accent colour.
pub(crate) fn focus_ring(painter: &Painter, theme: &Theme, rect: Rect, corners: impl Into<CornerRadius>) {
    let corners = corners.into() + CornerRadius::same(1);
    painter.rect_stroke(rect.expand(1.0), corners, Stroke::new(2.0, theme.palette.accent), StrokeKind::Outside);
}

pub(crate) fn draw_hatching(painter: &Painter, theme: &Theme, rect: Rect, colour: Color32) {
    let painter = painter.with_clip_rect(rect.shrink(1.0).intersect(painter.clip_rect()));
    let mut x = rect.left() - rect.height();
    while x < rect.right() {
        let line = [egui::pos2(x, rect.bottom()), egui::pos2(x + rect.height(), rect.top())];
        painter.line_segment(line, Stroke::new(1.0, colour));
        x += theme.space.between;
    }
}

/// Returns the colour of a series. Colours repeat after the eighth series.
pub(crate) fn series_colour(theme: &Theme, number: usize) -> Color32 {
    let colours = &theme.palette.series;
    colours.iter().cycle().nth(number % colours.len()).copied().map_or(theme.palette.muted.into(), Color32::from)
}

#[cfg(test)]
pub(crate) mod tests;
