//! The layout of a hex editor's cells.

use egui::{FontId, Pos2, Rect, Ui, Vec2};

use super::HexModel;
use super::view::Column;
use crate::ui::Theme;

pub(super) const WIDTH: usize = 16;

/// Layout distances in points, measured from the upper left corner of the first line.
#[derive(Clone, Debug)]
pub(super) struct Grid {
    pub(super) font: FontId,
    pub(super) glyph: f32,
    pub(super) row: f32,
    pub(super) width: f32,
    /// Extra space after every eight bytes and beside the separator.
    pub(super) gap: f32,
    pub(super) text_left: f32,
    hex_left: f32,
    byte: f32,
    letter: f32,
    len: usize,
}

/// Rounds a length up to the next multiple of four points.
fn snap_to_grid(length: f32) -> f32 {
    (length / 4.0).ceil() * 4.0
}

impl Grid {
    /// Returns the width of the frame and scroll bar around the bytes.
    pub(super) fn surrounding_width(ui: &Ui, theme: &Theme) -> f32 {
        2.0 * theme.space.between + ui.spacing().scroll.allocated_width()
    }

    pub(super) fn new(ui: &Ui, theme: &Theme, model: &HexModel<'_>) -> Self {
        let len = model.wanted.len();
        let font = FontId::monospace(theme.sizes.body);
        let (glyph, row) = ui.fonts_mut(|fonts| (fonts.glyph_width(&font, '0'), fonts.row_height(&font)));
        let characters = model.addresses.width(len);
        let (byte, letter) = (snap_to_grid(glyph * 2.0 + theme.space.between - 1.0), glyph.ceil());
        let places = |gap: f32, byte: f32| {
            let hex_left = snap_to_grid(glyph * characters as f32) + gap + theme.space.inside;
            let text_left = hex_left + byte * WIDTH as f32 + gap * 3.0;
            (gap, byte, hex_left, text_left, text_left + letter * WIDTH as f32 + theme.space.inside)
        };
        // In a small window, first the columns and then the bytes move closer together, so no characters are cut off.
        let (far, near) = (theme.space.between, theme.space.inside);
        let room = ui.available_width() - Self::surrounding_width(ui, theme);
        let closest = places(near, byte - 3.0);
        let wider = [places(far, byte), places(near, byte), places(near, byte - 1.0)];
        let fitting = wider.into_iter().find(|own| own.4 <= room);
        let (gap, byte, hex_left, text_left, width) = fitting.unwrap_or(closest);
        let row = snap_to_grid(row + 2.0);
        Grid { font, glyph, row, width, gap, text_left, hex_left, byte, letter, len }
    }

    pub(super) fn line_count(&self) -> usize {
        self.len.div_ceil(WIDTH)
    }

    pub(super) fn lines_height(&self, lines: usize) -> f32 {
        self.row * lines as f32
    }

    pub(super) fn cell_rect(&self, origin: Pos2, column: Column, at: usize) -> Rect {
        let (line, place) = (at / WIDTH, at % WIDTH);
        let (left, width) = match column {
            Column::Hex if place < WIDTH / 2 => (self.hex_left + self.byte * place as f32, self.byte),
            Column::Hex => (self.hex_left + self.gap + self.byte * place as f32, self.byte),
            Column::Text => (self.text_left + self.letter * place as f32, self.letter),
        };
        Rect::from_min_size(origin + Vec2::new(left, self.row * line as f32), Vec2::new(width, self.row))
    }

    pub(super) fn cell_under_pointer(&self, origin: Pos2, pos: Pos2) -> Option<(Column, usize)> {
        let (column, at) = self.nearest_byte(origin, pos, Column::Hex, true);
        (at < self.len && self.cell_rect(origin, column, at).contains(pos)).then_some((column, at))
    }

    /// Returns the byte nearest to the pointer, in the given column. If `free` is set, it may be in either column.
    pub(super) fn nearest_byte(&self, origin: Pos2, pos: Pos2, column: Column, free: bool) -> (Column, usize) {
        let right = pos.x >= origin.x + self.text_left - self.gap;
        let column = match (free, right) {
            (true, true) => Column::Text,
            (true, false) => Column::Hex,
            (false, _) => column,
        };
        let last = self.len.saturating_sub(1);
        // A negative number becomes zero.
        let line = (((pos.y - origin.y) / self.row).floor() as usize).min(last / WIDTH);
        let distance = |place: &usize| (self.cell_rect(origin, column, *place).center().x - pos.x).abs();
        let place = (0..WIDTH).min_by(|a, b| distance(a).total_cmp(&distance(b))).unwrap_or_default();
        (column, (line * WIDTH + place).min(last))
    }
}
