//! Painting of a register table.

use egui::{
    Align2, Color32, FontId, Pos2, Rangef, Rect, Response, Sense, Stroke, TextStyle, TextWrapMode, Ui, Vec2, pos2,
};

use super::columns::{Column, Columns};
use super::{RegisterBits, RegisterGroup, RegisterKind, RegisterRow};
use crate::app::Text;
use crate::ui::{Theme, icons};

pub(super) const HEADER_HEIGHT: f32 = 20.0;
/// Position of the right edge of the caret, which is drawn for registers with bit fields.
pub(super) const CARET_OFFSET: f32 = 16.0;
/// Spacing between marks.
const MARK_SPACING: f32 = 13.0;

#[derive(Clone, Copy)]
pub(super) struct State {
    selected: bool,
    hovered: bool,
}

impl State {
    pub(super) fn from_response(selected: bool, response: &Response) -> Self {
        State { selected, hovered: response.hovered() }
    }

    fn paint(self, ui: &Ui, theme: &Theme, rect: Rect) {
        let strength = match (self.selected, self.hovered) {
            (true, _) => 0.22,
            (false, true) => 0.08,
            (false, false) => return,
        };
        ui.painter().rect_filled(rect, 2.0, Color32::from(theme.palette.accent).gamma_multiply(strength));
    }
}

const fn title(kind: RegisterKind, column: Column) -> &'static str {
    match (column, kind) {
        (Column::Marks, _) => "",
        (Column::Address, RegisterKind::Bytes { .. }) => "widget.register_address",
        (Column::Address, RegisterKind::Numbers) => "widget.register_number",
        (Column::Name, _) => "widget.register_name",
        (Column::Value, RegisterKind::Bytes { .. }) => "widget.register_hex",
        (Column::Value, RegisterKind::Numbers) => "widget.register_value",
        (Column::Decimal, _) => "widget.register_decimal",
        (Column::Meaning, _) => "widget.register_meaning",
        (Column::Access, _) => "widget.register_access",
        (Column::Range, _) => "widget.register_range",
        (Column::Default, RegisterKind::Bytes { .. }) => "widget.register_default",
        (Column::Default, RegisterKind::Numbers) => "widget.register_factory",
    }
}

pub(super) fn header(ui: &mut Ui, theme: &Theme, kind: RegisterKind, columns: &Columns) {
    let (rect, _) = ui.allocate_exact_size(Vec2::new(columns.width(), HEADER_HEIGHT), Sense::hover());
    let middle = rect.top() + HEADER_HEIGHT / 2.0 - 2.0;
    for (column, range) in columns.iter().filter(|(column, _)| *column != Column::Marks) {
        let words = theme.caption(theme.translate(title(kind, column)));
        draw_label(ui, theme, rect, middle, range, words, column == Column::Decimal);
    }
    ui.painter().hline(rect.x_range(), rect.bottom() - 2.5, Stroke::new(1.0, theme.palette.line));
}

/// Draws a group heading. Returns whether its note fits.
pub(super) fn paint_heading(
    ui: &Ui,
    theme: &Theme,
    rect: Rect,
    group: &RegisterGroup,
    folded: bool,
    state: State,
) -> bool {
    let painter = ui.painter();
    painter.rect_filled(rect, 2.0, theme.palette.raised);
    state.paint(ui, theme, rect);
    let caret = if folded { icons::CARET_RIGHT } else { icons::CARET_DOWN };
    let palette = theme.palette;
    let middle = rect.center().y;
    let font = FontId::proportional(theme.sizes.caption);
    painter.text(pos2(rect.left() + 4.0, middle), Align2::LEFT_CENTER, caret, font.clone(), palette.muted.into());
    let title = painter.layout_no_wrap(group.title.clone(), theme.bold_font(theme.sizes.body), palette.text.into());
    let right = rect.left() + CARET_OFFSET + title.size().x;
    painter.galley(pos2(rect.left() + CARET_OFFSET, middle - title.size().y / 2.0), title, palette.text.into());
    let room = Rangef::new(right - rect.left() + theme.space.groups, rect.width());
    let note = theme.caption(&group.note);
    draw_label(ui, theme, rect, middle, room, note.clone(), false);
    !is_too_long(ui, theme, room, &note)
}

/// Draws a register, without its value while that is being edited. Returns whether its name fits in the normal font.
pub(super) fn row(
    ui: &Ui,
    theme: &Theme,
    rect: Rect,
    (kind, columns): (RegisterKind, &Columns),
    row: &RegisterRow,
    (open, typing): (bool, bool),
    state: State,
) -> bool {
    state.paint(ui, theme, rect);
    paint_marks(ui, theme, rect.left_center(), row, open);
    let palette = theme.palette;
    let value = if row.edited { palette.staged } else { palette.text };
    if kind == RegisterKind::Numbers
        && row.read_only.is_none()
        && let Some(range) = columns.column_range(Column::Value)
    {
        ui.painter().rect_filled(value_edit_rect(theme, rect, range), 2.0, palette.raised);
    }
    let mut fits = true;
    for (column, range) in columns.iter() {
        let (words, ink) = match column {
            Column::Marks => continue,
            Column::Address => (theme.monospace(&row.address), palette.muted),
            Column::Name if columns.has_small_names => (theme.caption(&row.name), palette.text),
            Column::Name => (egui::RichText::new(&row.name), palette.text),
            Column::Value if typing => continue,
            Column::Value if row.value.is_empty() => (theme.monospace("–"), palette.muted),
            Column::Value => (theme.monospace(&row.value), value),
            Column::Decimal => (theme.monospace(&row.decimal), value),
            // The number takes the place of an empty meaning if its column is hidden.
            Column::Meaning if row.meaning.is_empty() && columns.column_range(Column::Decimal).is_none() => {
                (theme.monospace(&row.decimal), value)
            }
            Column::Meaning if kind == RegisterKind::Numbers => (egui::RichText::new(&row.meaning), palette.muted),
            Column::Meaning => (egui::RichText::new(&row.meaning), value),
            Column::Access => (theme.monospace(&row.access), palette.muted),
            Column::Range => (theme.caption(&row.range), palette.muted),
            Column::Default if row.differs => (theme.monospace(format!("≠ {}", row.default)), palette.text),
            Column::Default => (theme.monospace(&row.default), palette.muted),
        };
        // A meaning that is too long is drawn smaller. It is truncated only if it still does not fit.
        let words = match column {
            Column::Name if !columns.has_small_names && is_too_long(ui, theme, range, &words) => {
                fits = false;
                words.size(theme.sizes.caption)
            }
            Column::Meaning if is_too_long(ui, theme, range, &words) => words.size(theme.sizes.caption),
            _ => words,
        };
        let right = column == Column::Decimal;
        let range = match (column, columns.column_range(Column::Meaning)) {
            // A text may also use the meaning column.
            (Column::Value, Some(meaning)) if row.meaning.is_empty() => Rangef::new(range.min, meaning.max),
            _ => range,
        };
        let width = draw_label(ui, theme, rect, rect.center().y, range, words.color(ink), right);
        if row.edited && column == Column::Value {
            let left = rect.left() + range.min;
            let y = rect.bottom() - 2.0;
            ui.painter().hline(left..=left + width, y, Stroke::new(1.0, palette.staged));
        }
    }
    fits
}

/// Returns the area of a line in which a click starts editing the value.
pub(super) fn value_edit_rect(theme: &Theme, rect: Rect, value: Rangef) -> Rect {
    let inset = theme.space.inside;
    let x = rect.left() + value.min - inset..=rect.left() + value.max - theme.space.between;
    Rect::from_x_y_ranges(x, rect.top() + 0.5..=rect.bottom() - 0.5)
}

/// Draws the marks of a register: a caret if it has bit fields, a dot for a change, a pencil for an edit, a flash for a
/// write cost, and a disk for non-volatile storage.
fn paint_marks(ui: &Ui, theme: &Theme, left: Pos2, row: &RegisterRow, open: bool) {
    let palette = theme.palette;
    let caret = if open { icons::CARET_DOWN } else { icons::CARET_RIGHT };
    let font = FontId::proportional(theme.sizes.caption);
    let text = |at: f32, icon: &str, colour: Color32| {
        ui.painter().text(left + Vec2::new(at, 0.0), Align2::CENTER_CENTER, icon, font.clone(), colour);
    };
    if !row.fields.is_empty() {
        text(MARK_SPACING / 2.0, caret, palette.muted.into());
    }
    if row.edited {
        text(MARK_SPACING * 1.5, icons::PENCIL_SIMPLE, palette.staged.into());
    } else if row.changed {
        ui.painter().circle_filled(left + Vec2::new(MARK_SPACING * 1.5, 0.0), 3.0, palette.accent);
    }
    if row.cost.is_some() {
        text(MARK_SPACING * 2.5, icons::LIGHTNING, palette.warn.into());
    } else if row.kept.is_some() {
        text(MARK_SPACING * 2.5, icons::FLOPPY_DISK, palette.muted.into());
    }
}

pub(super) fn bits(ui: &Ui, theme: &Theme, rect: Rect, columns: &Columns, bits: &RegisterBits) {
    let palette = theme.palette;
    let ink = if bits.lit { palette.warn } else { palette.muted };
    for (column, range) in columns.iter() {
        let (words, inset) = match column {
            Column::Address => (theme.monospace(&bits.bits), theme.space.between),
            Column::Name => (egui::RichText::new(&bits.name), theme.space.between),
            Column::Value => (theme.monospace(&bits.value), 0.0),
            Column::Meaning => (egui::RichText::new(&bits.meaning), 0.0),
            Column::Marks | Column::Decimal | Column::Access | Column::Range | Column::Default => continue,
        };
        let range = Rangef::new(range.min + inset, range.max);
        draw_label(ui, theme, rect, rect.center().y, range, words.color(ink), false);
    }
    let x = rect.left() + MARK_SPACING / 2.0;
    ui.painter().vline(x, rect.y_range(), Stroke::new(1.0, palette.line));
}

fn is_too_long(ui: &Ui, theme: &Theme, range: Rangef, words: &egui::RichText) -> bool {
    let words = egui::WidgetText::from(words.clone());
    let galley = words.into_galley(ui, Some(TextWrapMode::Extend), f32::INFINITY, TextStyle::Body);
    galley.size().x > range.span() - theme.space.between
}

/// Draws text within a column and returns its width. Text that is too long is truncated.
fn draw_label(
    ui: &Ui,
    theme: &Theme,
    line: Rect,
    middle: f32,
    range: Rangef,
    words: egui::RichText,
    to_the_right: bool,
) -> f32 {
    let room = range.span() - theme.space.between;
    if room <= 0.0 {
        return 0.0;
    }
    let galley = egui::WidgetText::from(words).into_galley(ui, Some(TextWrapMode::Truncate), room, TextStyle::Body);
    let width = galley.size().x;
    let left = if to_the_right { range.max - theme.space.groups - width } else { range.min };
    ui.painter().galley(pos2(line.left() + left, middle - galley.size().y / 2.0), galley, theme.palette.text.into());
    width
}

pub(super) fn show_tooltip(ui: &mut Ui, theme: &Theme, (kind, columns): (RegisterKind, &Columns), row: &RegisterRow) {
    ui.spacing_mut().item_spacing.y = theme.space.inside;
    ui.label(egui::RichText::new(row.label()).color(theme.palette.text));
    if !row.meaning.is_empty() {
        ui.label(egui::RichText::new(&row.meaning).color(theme.palette.muted));
    }
    let values = [
        (Column::Decimal, &row.decimal),
        (Column::Access, &row.access),
        (Column::Range, &row.range),
        (Column::Default, &row.default),
    ];
    for (column, value) in values {
        if (columns.is_narrow() || columns.column_range(column).is_none()) && !value.is_empty() {
            ui.horizontal(|ui| {
                ui.label(theme.caption(theme.translate(title(kind, column))));
                ui.label(theme.monospace(value));
            });
        }
    }
    let note = |ui: &mut Ui, icon: &str, words: &str, colour: Color32| {
        ui.label(theme.caption(format!("{icon} {words}")).color(colour));
    };
    let palette = theme.palette;
    if row.edited {
        note(ui, icons::PENCIL_SIMPLE, &theme.translate("widget.register_edited"), palette.staged.into());
    } else if row.changed {
        let words = match row.before.as_str() {
            "" => theme.translate("widget.register_changed"),
            before => theme.format_text(&Text::new("widget.register_changed_from").with("value", before)),
        };
        note(ui, icons::INFO, &words, palette.accent.into());
    }
    if row.differs {
        note(ui, icons::INFO, &theme.translate("widget.register_differs"), palette.text.into());
    }
    if let Some(cost) = &row.cost {
        note(ui, icons::LIGHTNING, cost, palette.warn.into());
    }
    if let Some(kept) = &row.kept {
        note(ui, icons::FLOPPY_DISK, kept, palette.muted.into());
    }
}

pub(super) fn show_bits_tooltip(ui: &mut Ui, theme: &Theme, bits: &RegisterBits) {
    ui.spacing_mut().item_spacing.y = theme.space.inside;
    ui.label(egui::RichText::new(format!("{} {}", bits.bits, bits.name)).color(theme.palette.text));
    ui.label(egui::RichText::new(format!("{} {}", bits.value, bits.meaning)).color(theme.palette.muted));
}
