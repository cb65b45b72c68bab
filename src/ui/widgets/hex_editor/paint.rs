//! Painting of a hex editor.

use egui::{Align2, Color32, FontId, Pos2, Rect, Response, Stroke, StrokeKind, Ui, Vec2};

use super::grid::{Grid, WIDTH};
use super::view::{Column, HexView};
use super::{HexAnnotation, HexModel};
use crate::bits;
use crate::ui::Theme;

pub(super) fn header(ui: &Ui, theme: &Theme, grid: &Grid, rect: Rect, model: &HexModel<'_>, view: &HexView) {
    let font = FontId::monospace(theme.sizes.caption);
    let painter = ui.painter();
    for place in 0..WIDTH {
        let here = !model.wanted.is_empty() && view.cursor() % WIDTH == place;
        let colour = if here { theme.palette.text } else { theme.palette.muted };
        let cell = grid.cell_rect(rect.min, Column::Hex, place);
        painter.text(cell.center(), Align2::CENTER_CENTER, format!("{place:X}"), font.clone(), colour.into());
    }
    let left = grid.cell_rect(rect.min, Column::Text, 0).left_center();
    let words = theme.translate("widget.hex_text");
    let caption = FontId::proportional(theme.sizes.caption);
    painter.text(left, Align2::LEFT_CENTER, words, caption, theme.palette.muted.into());
    let y = rect.top() + grid.row + 0.5;
    painter.hline(rect.x_range(), y, Stroke::new(1.0, theme.palette.line));
}

struct HexPainter<'a> {
    ui: &'a Ui,
    theme: &'a Theme,
    grid: &'a Grid,
    origin: Pos2,
    model: &'a HexModel<'a>,
    view: &'a HexView,
    focused: bool,
    hovered: Option<usize>,
}

#[allow(clippy::too_many_arguments, reason = "drawing is told where, what and how")]
pub(super) fn paint_lines(
    ui: &Ui,
    theme: &Theme,
    grid: &Grid,
    origin: Pos2,
    model: &HexModel<'_>,
    view: &HexView,
    response: &Response,
    hovered: Option<(Column, usize)>,
) {
    let hovered = hovered.map(|(_, at)| at);
    let brush = HexPainter { ui, theme, grid, origin, model, view, focused: response.has_focus(), hovered };
    let seen = ui.clip_rect();
    let line_at = |y: f32| ((y - origin.y) / grid.row).floor().max(0.0) as usize;
    let (first, last) = (line_at(seen.top()), line_at(seen.bottom()) + 1);
    let x = origin.x + grid.text_left - grid.gap;
    let bottom = origin.y + grid.lines_height(grid.line_count());
    ui.painter().vline(x.round() + 0.5, origin.y..=bottom, Stroke::new(1.0, theme.palette.line));
    for line in first..last.min(grid.line_count()) {
        brush.paint_line(line);
    }
}

impl HexPainter<'_> {
    fn paint_line(&self, line: usize) {
        let start = line * WIDTH;
        let end = (start + WIDTH).min(self.model.wanted.len());
        let here = (start..end).contains(&self.view.cursor());
        let address = self.model.addresses.heading(start, self.model.wanted.len());
        let colour = if here { self.theme.palette.text } else { self.theme.palette.muted };
        let left = self.origin + Vec2::new(0.0, self.grid.row * (line as f32 + 0.5));
        self.ui.painter().text(left, Align2::LEFT_CENTER, address, self.grid.font.clone(), colour.into());
        self.selection(start, end);
        for (at, byte) in (start..end).zip(self.model.wanted.get(start..end).unwrap_or_default()) {
            self.byte(at, *byte);
        }
        for mark in self.model.marks {
            self.paint_mark(mark, start, end);
        }
        if here {
            self.cursor();
        }
    }

    fn selection(&self, start: usize, end: usize) {
        let selected = self.view.selection();
        let (first, last) = (selected.start.max(start), selected.end.min(end));
        if first >= last {
            return;
        }
        for column in [Column::Hex, Column::Text] {
            let active = self.focused && column == self.view.column;
            let fill = Color32::from(self.theme.palette.accent).gamma_multiply(if active { 0.32 } else { 0.16 });
            let left = self.grid.cell_rect(self.origin, column, first);
            let right = self.grid.cell_rect(self.origin, column, last - 1);
            self.ui.painter().rect_filled(
                left.union(right).shrink2(Vec2::new(0.0, 1.0)),
                self.theme.space.inside,
                fill,
            );
        }
    }

    fn byte(&self, at: usize, byte: u8) {
        let palette = self.theme.palette;
        let changed = self.model.is_changed(at);
        let colour = Color32::from(if changed { palette.staged } else { palette.text });
        let painter = self.ui.painter();
        let (hex, text) =
            (self.grid.cell_rect(self.origin, Column::Hex, at), self.grid.cell_rect(self.origin, Column::Text, at));
        if self.hovered == Some(at) {
            for cell in [hex, text] {
                let cell = cell.shrink2(Vec2::new(0.0, 1.0));
                painter.rect_filled(cell, self.theme.space.inside, Color32::from(palette.line));
            }
        }
        let pending = self.view.pending.filter(|_| at == self.view.cursor());
        let (digits, ink) = match pending {
            Some(high) => (format!("{high:X}_"), palette.accent.into()),
            None => (format!("{byte:02X}"), colour),
        };
        painter.text(hex.center(), Align2::CENTER_CENTER, digits, self.grid.font.clone(), ink);
        let character = bits::ascii(byte);
        let ink = if character.is_none() && !changed { palette.muted.into() } else { colour };
        let character = character.unwrap_or(bits::UNPRINTABLE);
        painter.text(text.center(), Align2::CENTER_CENTER, character, self.grid.font.clone(), ink);
        if changed && pending.is_none() {
            for (cell, half) in [(hex, self.grid.glyph), (text, self.grid.glyph / 2.0)] {
                let y = cell.bottom() - self.theme.space.inside;
                let x = cell.center().x - half..=cell.center().x + half;
                painter.hline(x, y, Stroke::new(1.5, palette.staged));
            }
        }
    }

    /// Draws a bracket below the marked bytes. The bracket is open at an end where the range continues on another line.
    fn paint_mark(&self, mark: &HexAnnotation<'_>, start: usize, end: usize) {
        let (first, last) = (mark.range.start.max(start), mark.range.end.min(end));
        if first >= last {
            return;
        }
        let stroke = Stroke::new(1.0, self.theme.palette.muted);
        let left = self.grid.cell_rect(self.origin, Column::Hex, first);
        let right = self.grid.cell_rect(self.origin, Column::Hex, last - 1);
        let (x0, x1) = (left.left() + 2.5, right.right() - 2.5);
        let y = left.bottom() - 0.5;
        let painter = self.ui.painter();
        painter.hline(x0..=x1, y, stroke);
        let tick = y - self.theme.space.inside..=y;
        if mark.range.start >= start {
            painter.vline(x0, tick.clone(), stroke);
        }
        if mark.range.end <= end {
            painter.vline(x1, tick, stroke);
        }
    }

    fn cursor(&self) {
        let cell = self.grid.cell_rect(self.origin, self.view.column, self.view.cursor());
        let colour = if self.focused { self.theme.palette.accent } else { self.theme.palette.muted };
        let rect = cell.shrink2(Vec2::new(0.0, 1.0));
        let stroke = Stroke::new(if self.focused { 1.5 } else { 1.0 }, colour);
        self.ui.painter().rect_stroke(rect, self.theme.space.inside, stroke, StrokeKind::Inside);
    }
}
