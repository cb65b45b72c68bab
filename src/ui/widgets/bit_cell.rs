//! A cell that shows one bit, used in every strip of bits. It has the colour of its field, and a one is more intense
//! than a zero.

use egui::{Align2, Color32, CornerRadius, FontId, Painter, Rect};

use crate::ui::Theme;

#[derive(Clone, Copy, Debug)]
pub(crate) struct BitCell<'a> {
    pub(crate) ink: Color32,
    /// Value of the bit, or `None` if unknown.
    pub(crate) bit: Option<bool>,
    /// Text shown in place of an unknown bit.
    pub(crate) blank: &'a str,
    /// Whether the bit reports an error. The cell is then filled with the error colour.
    pub(crate) alarm: bool,
}

impl BitCell<'_> {
    pub(crate) fn paint(&self, painter: &Painter, theme: &Theme, rect: Rect) {
        let palette = theme.palette;
        let corners = CornerRadius::same(2);
        let (strength, colour) = match (self.alarm, self.bit) {
            (true, _) => (1.0, Color32::from(palette.on_bad)),
            (_, Some(true)) => (0.4, palette.text.into()),
            (_, Some(false)) => (0.14, palette.text.into()),
            (_, None) => (0.14, palette.muted.into()),
        };
        painter.rect_filled(rect, corners, palette.sunken);
        painter.rect_filled(rect, corners, self.ink.gamma_multiply(strength));
        let digit = self.bit.map_or(self.blank, |bit| if bit { "1" } else { "0" });
        let size = if rect.width() < 11.0 || self.bit.is_none() { theme.sizes.caption } else { theme.sizes.body };
        painter.text(rect.center(), Align2::CENTER_CENTER, digit, FontId::monospace(size), colour);
    }
}
