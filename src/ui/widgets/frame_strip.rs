//! A frame with one cell per bit in transmission order, and the names of its fields below.
//!
//! * **Size**: the available width. The cells are as large as possible while the frame takes as few lines as possible.
//!   A field is moved to the next line as a whole, and is split only if it is longer than a line.
//! * **Keyboard**: none. Tab skips the frame.
//! * **Pointer**: a tooltip shows the meaning of the field under the pointer.
//! * **Accessible**: an image with the given label, whose value lists the fields with their values. Each field is a
//!   label with its name and value.
//! * **Painting**: bits have the colour of their field, with ones more intense than zeros, in groups of four counted
//!   from the last bit of the field. A lit field is filled with the colour of its verdict and has the icon of the
//!   verdict.

mod layout;

use egui::accesskit::Role;
use egui::{Color32, FontId, Galley, Painter, Rect, Sense, Stroke, Ui, Vec2, WidgetInfo, pos2};
use std::sync::Arc;

use super::bit_cell::BitCell;
use super::series_colour;
use crate::analysis::quality::Verdict;
use crate::ui::{Theme, controls};

use layout::{PlacedPiece, RequiredSpace, arrange_fields};

#[derive(Clone, Debug, Default)]
pub struct StripField {
    pub name: String,
    pub value: String,
    /// Number of bits, at least 1.
    pub bits: usize,
    /// Colour index, one of eight colours, or `None` if the field only groups other fields.
    pub colour: Option<usize>,
    /// Verdict given by the field's value, if any.
    pub lit: Option<Verdict>,
    pub tooltip: String,
}

#[derive(Clone, Copy, Debug, Default)]
pub struct FrameStrip<'a> {
    pub label: &'a str,
    /// Fields in transmission order.
    pub fields: &'a [StripField],
    /// Bits in transmission order. A bit is unknown if it is `None` or beyond the end.
    pub bits: &'a [Option<bool>],
}

/// Height of a cell, in points.
const CELL_HEIGHT: f32 = 24.0;
const BAR_HEIGHT: f32 = 2.0;
const NAME_HEIGHT: f32 = 15.0;
const VALUE_HEIGHT: f32 = 18.0;

pub fn frame_strip(ui: &mut Ui, theme: &Theme, strip: &FrameStrip<'_>) {
    let words: Vec<Words> = strip.fields.iter().map(|field| Words::from_field(ui, theme, field)).collect();
    let wants =
        strip.fields.iter().zip(&words).map(|(field, words)| RequiredSpace { bits: field.bits, words: words.width() });
    let placing = arrange_fields(&wants.collect::<Vec<_>>(), ui.available_width(), theme.space.between);
    let has_values = strip.fields.iter().any(|field| !field.value.is_empty());
    let line =
        CELL_HEIGHT + BAR_HEIGHT + NAME_HEIGHT + if has_values { VALUE_HEIGHT } else { 0.0 } + theme.space.inside;
    let height = placing.lines as f32 * line + placing.lines.saturating_sub(1) as f32 * theme.space.between;
    let (outer, response) = ui.allocate_exact_size(Vec2::new(placing.width, height), Sense::hover());
    let values: Vec<String> = strip.fields.iter().map(StripField::label_text).collect();
    response.widget_info(|| {
        let mut info = WidgetInfo::labeled(Role::Image, true, strip.label);
        info.current_text_value = Some(values.join(", "));
        info
    });
    for piece in &placing.pieces {
        let (Some(field), Some(words)) = (strip.fields.get(piece.field), words.get(piece.field)) else { continue };
        let top = outer.top() + piece.line as f32 * (line + theme.space.between);
        let rect = Rect::from_min_size(pos2(outer.left() + piece.left, top), Vec2::new(piece.width, line));
        let id = response.id.with((piece.field, piece.first));
        let own = ui.interact(rect, id, Sense::hover());
        if piece.first == 0 {
            own.widget_info(|| WidgetInfo::labeled(Role::Label, true, field.label_text()));
        }
        if ui.is_rect_visible(rect) {
            let first = strip.fields.iter().take(piece.field).map(|field| field.bits).sum::<usize>() + piece.first;
            let bits = (first..first + piece.bits).map(|at| strip.bits.get(at).copied().flatten());
            paint_cells(ui.painter(), theme, rect, (piece, placing.cell), field, bits);
            if piece.first == 0 {
                words.paint(ui.painter(), theme, rect);
            }
        }
        if !field.tooltip.is_empty() {
            own.on_hover_ui(|ui| {
                ui.label(&field.tooltip);
            });
        }
    }
}

impl StripField {
    fn label_text(&self) -> String {
        if self.value.is_empty() { self.name.clone() } else { format!("{}: {}", self.name, self.value) }
    }

    fn display_colour(&self, theme: &Theme) -> Color32 {
        match (self.lit, self.colour) {
            (Some(own), _) => controls::verdict_badge(theme, own).1.into(),
            (None, Some(colour)) => series_colour(theme, colour),
            (None, None) => theme.palette.muted.into(),
        }
    }
}

struct Words {
    name: Arc<Galley>,
    value: Arc<Galley>,
}

impl Words {
    fn from_field(ui: &Ui, theme: &Theme, field: &StripField) -> Self {
        let name = match field.lit {
            Some(own) => format!("{} {}", controls::verdict_badge(theme, own).0, field.name),
            None => field.name.clone(),
        };
        let ink = if field.lit.is_some() { field.display_colour(theme) } else { theme.palette.muted.into() };
        let name = ui.painter().layout_no_wrap(name, FontId::proportional(theme.sizes.caption), ink);
        let font = FontId::monospace(theme.sizes.body);
        let value = ui.painter().layout_no_wrap(field.value.clone(), font, theme.palette.text.into());
        Words { name, value }
    }

    fn width(&self) -> f32 {
        self.name.size().x.max(self.value.size().x)
    }

    fn paint(&self, painter: &Painter, theme: &Theme, rect: Rect) {
        let top = rect.top() + CELL_HEIGHT + BAR_HEIGHT + theme.space.inside;
        for (galley, y) in [(&self.name, top), (&self.value, top + NAME_HEIGHT)] {
            painter.galley(pos2(rect.left(), y), galley.clone(), theme.palette.text.into());
        }
    }
}

/// Draws the bits of a piece of a field, and a bar below that joins them.
fn paint_cells(
    painter: &Painter,
    theme: &Theme,
    rect: Rect,
    (piece, cell): (&PlacedPiece, f32),
    field: &StripField,
    bits: impl Iterator<Item = Option<bool>>,
) {
    let ink = field.display_colour(theme);
    for (at, bit) in bits.enumerate() {
        let left = rect.left() + piece.offset(at, field.bits, cell);
        let own = Rect::from_min_size(pos2(left, rect.top()), Vec2::new(cell - 1.0, CELL_HEIGHT));
        let alarm = matches!(field.lit, Some(Verdict::Warn | Verdict::Fault));
        BitCell { ink, bit, blank: "·", alarm }.paint(painter, theme, own);
    }
    let end = rect.left() + piece.offset(piece.bits.saturating_sub(1), field.bits, cell) + cell - 1.0;
    let y = rect.top() + CELL_HEIGHT + 1.0 + BAR_HEIGHT / 2.0;
    painter.hline(rect.left()..=end, y, Stroke::new(BAR_HEIGHT, ink));
}
