//! Widgets that egui does not have. Each draws what it is given, keeps nothing but its own selection, and says what the
//! user wants; none knows a device. They share how the keyboard's place looks.

mod hex_editor;
mod typed_view;

use egui::{CornerRadius, Painter, Rect, Stroke, StrokeKind};

use super::Skin;

pub use hex_editor::{HexEdit, HexMark, HexModel, HexView, hex_editor};
pub use typed_view::typed_view;

/// The ring around what has the keyboard: two points of the accent, one point off the widget.
fn focus_ring(painter: &Painter, skin: &Skin, rect: Rect, corners: impl Into<CornerRadius>) {
    let corners = corners.into() + CornerRadius::same(1);
    painter.rect_stroke(rect.expand(1.0), corners, Stroke::new(2.0, skin.palette.accent), StrokeKind::Outside);
}

#[cfg(test)]
mod tests;
