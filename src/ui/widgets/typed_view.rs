//! A table of bytes interpreted as numbers and text, little-endian and big-endian.
//!
//! * **Size**: three columns of fixed width, so changing values do not move; one line per type.
//! * **Keyboard**: Tab and arrows move from value to value; Enter copies one.
//! * **Pointer**: a click copies a value; the tooltip shows a truncated one completely.
//! * **Accessible**: a button for each value, named by type and byte order.
//! * **Painting**: a type for which there are too few bytes shows a dash.

use egui::accesskit::Role;
use egui::{Align2, FontId, Id, Rect, Response, Sense, Stroke, TextWrapMode, Ui, Vec2, WidgetInfo, WidgetText};

use super::focus_ring;
use crate::bits::{self, DataType, InterpretedRow};
use crate::ui::{Theme, icons};

/// Time in seconds for which a copied value stays marked.
const COPY_FEEDBACK_S: f64 = 1.2;

struct Columns {
    name: f32,
    value: f32,
    row: f32,
}

pub fn typed_view(ui: &mut Ui, theme: &Theme, bytes: &[u8]) {
    let font = FontId::monospace(theme.sizes.body);
    let glyph = ui.fonts_mut(|fonts| fonts.glyph_width(&font, '0'));
    // The longest value is a float: -3.4028235e38.
    let value = (glyph * 13.0 / 4.0).ceil() * 4.0 + theme.space.groups;
    let columns = Columns { name: theme.space.groups * 4.0, value, row: theme.space.inside * 5.0 };
    theme.sunken_frame().show(ui, |ui| {
        ui.spacing_mut().item_spacing = Vec2::ZERO;
        header_ui(ui, theme, &columns);
        for row in bits::interpret(bytes) {
            line_ui(ui, theme, &columns, &row);
        }
    });
}

fn header_ui(ui: &mut Ui, theme: &Theme, columns: &Columns) {
    let size = Vec2::new(columns.name + columns.value * 2.0, columns.row + theme.space.inside);
    let (rect, _) = ui.allocate_exact_size(size, Sense::hover());
    let font = FontId::proportional(theme.sizes.caption);
    let y = rect.top() + columns.row / 2.0;
    let inside = theme.space.between;
    for (at, words) in [
        (rect.left(), theme.translate("widget.typed_type")),
        (rect.left() + columns.name + inside, theme.translate("widget.typed_little")),
        (rect.left() + columns.name + columns.value + inside, theme.translate("widget.typed_big")),
    ] {
        let colour = theme.palette.muted.into();
        ui.painter().text(egui::pos2(at, y), Align2::LEFT_CENTER, words, font.clone(), colour);
    }
    let y = rect.top() + columns.row + 0.5;
    ui.painter().hline(rect.x_range(), y, Stroke::new(1.0, theme.palette.line));
}

fn line_ui(ui: &mut Ui, theme: &Theme, columns: &Columns, row: &InterpretedRow) {
    let size = Vec2::new(columns.name + columns.value * 2.0, columns.row);
    let (rect, _) = ui.allocate_exact_size(size, Sense::hover());
    let name = name(theme, row.kind);
    let font = FontId::proportional(theme.sizes.body);
    let colour = theme.palette.muted.into();
    ui.painter().text(rect.left_center(), Align2::LEFT_CENTER, &name, font, colour);
    let cell = |left: f32, width: f32| Rect::from_min_size(rect.min + Vec2::new(left, 0.0), Vec2::new(width, size.y));
    let id = ui.make_persistent_id(("typed_view", row.kind));
    if row.kind.has_byte_order() {
        let (little, big) = (theme.translate("widget.typed_little"), theme.translate("widget.typed_big"));
        let first = cell(columns.name, columns.value);
        value(ui, theme, first, id.with("little"), &format!("{name} {little}"), row.little.as_deref());
        let second = cell(columns.name + columns.value, columns.value);
        value(ui, theme, second, id.with("big"), &format!("{name} {big}"), row.big.as_deref());
    } else {
        value(ui, theme, cell(columns.name, columns.value * 2.0), id, &name, row.little.as_deref());
    }
}

fn value(ui: &Ui, theme: &Theme, rect: Rect, id: Id, label: &str, shown: Option<&str>) {
    let left = rect.left_center() + Vec2::new(theme.space.between, 0.0);
    let Some(shown) = shown else {
        let font = FontId::monospace(theme.sizes.body);
        ui.painter().text(left, Align2::LEFT_CENTER, "–", font, theme.palette.muted.into());
        return;
    };
    let response = ui.interact(rect, id, Sense::click());
    response.widget_info(|| {
        let mut info = WidgetInfo::labeled(Role::Button, ui.is_enabled(), label);
        info.current_text_value = Some(shown.to_owned());
        info
    });
    if response.clicked() {
        ui.copy_text(shown.to_owned());
        let now = ui.input(|input| input.time);
        ui.data_mut(|data| data.insert_temp(id, now));
    }
    let copied = is_copied(ui, id);
    if response.hovered() {
        let fill = ui.visuals().widgets.hovered.bg_fill;
        ui.painter().rect_filled(rect.shrink(1.0), theme.space.inside, fill);
        ui.set_cursor_icon(egui::CursorIcon::PointingHand);
    }
    if response.has_focus() {
        focus_ring(ui.painter(), theme, rect.shrink(2.0), theme.space.inside);
    }
    let room = rect.width() - theme.space.between * 2.0 - if copied { theme.space.groups } else { 0.0 };
    let text = WidgetText::from(theme.monospace(shown).color(theme.palette.text));
    let galley = text.into_galley(ui, Some(TextWrapMode::Truncate), room, egui::TextStyle::Monospace);
    let cut = galley.elided;
    let top = left - Vec2::new(0.0, galley.size().y / 2.0);
    ui.painter().galley(top, galley, theme.palette.text.into());
    if copied {
        let right = rect.right_center() - Vec2::new(theme.space.between, 0.0);
        let font = FontId::proportional(theme.sizes.body);
        ui.painter().text(right, Align2::RIGHT_CENTER, icons::CHECK, font, theme.palette.good.into());
    }
    show_tooltip(theme, response, shown, cut, copied);
}

fn show_tooltip(theme: &Theme, response: Response, shown: &str, cut: bool, copied: bool) {
    response.on_hover_ui(|ui| {
        if cut {
            ui.label(theme.monospace(shown));
        }
        let words = if copied { theme.translate("widget.typed_copied") } else { theme.translate("widget.typed_copy") };
        ui.label(theme.caption(words));
    });
}

fn is_copied(ui: &Ui, id: Id) -> bool {
    let Some(then) = ui.data(|data| data.get_temp::<f64>(id)) else { return false };
    let left = then + COPY_FEEDBACK_S - ui.input(|input| input.time);
    if left > 0.0 {
        ui.request_repaint_after(std::time::Duration::from_secs_f64(left));
    }
    left > 0.0
}

fn name(theme: &Theme, kind: DataType) -> String {
    let name = match kind {
        DataType::U8 => "u8",
        DataType::I8 => "i8",
        DataType::U16 => "u16",
        DataType::I16 => "i16",
        DataType::U32 => "u32",
        DataType::I32 => "i32",
        DataType::F32 => "f32",
        DataType::Binary => return theme.translate("widget.typed_binary"),
        DataType::Text => return theme.translate("widget.typed_text"),
    };
    name.to_owned()
}
