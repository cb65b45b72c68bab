//! The editor for a register value. The value takes effect when Enter is pressed or the editor loses focus. If the
//! value is rejected, the editor stays open and shows the reason.

use egui::{FontId, Id, Key, Margin, Rect, TextEdit, Ui, Vec2, WidgetInfo};

use super::{RegisterLocation, RegisterTable, RegisterView, keys};
use crate::app::Text;
use crate::ui::Theme;

pub(super) fn editor_ui(
    ui: &mut Ui,
    theme: &Theme,
    table_id: Id,
    cell: Rect,
    table: &RegisterTable<'_>,
    view: &mut RegisterView,
    take: &mut dyn FnMut(RegisterLocation, &str) -> Result<(), Text>,
) {
    let Some(mut edit) = view.edit.take() else { return };
    if !edit.begins && ui.memory(|memory| memory.has_focus(keys::entry_id(table_id))) {
        keys::defer_keys(ui, view);
    }
    let before = edit.text.clone();
    ui.spacing_mut().interact_size.y = cell.height();
    // The entry is drawn in place of the value.
    let inset = theme.space.inside;
    let cell = Rect::from_min_max(cell.min - Vec2::new(inset, 0.0), cell.max - Vec2::new(inset, 0.0));
    let entry = TextEdit::singleline(&mut edit.text)
        .id(keys::entry_id(table_id))
        .font(FontId::monospace(theme.sizes.body))
        .margin(Margin::symmetric(inset as i8, 0))
        .desired_width(cell.width());
    let response = ui.put(cell, entry);
    let label = (table.row)(edit.place).label();
    response.widget_info(|| {
        let mut info = WidgetInfo::text_edit(true, &before, &edit.text, "");
        info.label = Some(label.clone());
        info
    });
    if edit.begins {
        response.request_focus();
        select(ui, &response, &edit.text, edit.typed);
        edit.begins = false;
    }
    if response.changed() {
        edit.problem = None;
    }
    if !response.lost_focus() {
        view.edit = Some(edit);
        return;
    }
    let (given_up, entered) = ui
        .input(|input| (input.key_pressed(Key::Escape), input.key_pressed(Key::Enter) || input.key_pressed(Key::Tab)));
    if !given_up && let Err(why) = take(edit.place, edit.text.trim()) {
        edit.problem = Some(why);
        edit.begins = entered;
        // Without the arrow keys, the selection stays on its line.
        view.late.retain(|event| !keys::is_vertical(event));
        edit.typed = true;
        view.edit = Some(edit);
        return;
    }
    if given_up || entered {
        ui.memory_mut(|memory| memory.request_focus(table_id));
    }
}

/// Selects the whole value so that typing replaces it. If the edit began with a typed character, the cursor is placed
/// after it instead.
fn select(ui: &Ui, response: &egui::Response, text: &str, typed: bool) {
    use egui::text::{CCursor, CCursorRange};
    let end = CCursor::new(text.chars().count());
    let begin = if typed { end } else { CCursor::new(0) };
    let mut state = TextEdit::load_state(ui.ctx(), response.id).unwrap_or_default();
    state.cursor.set_char_range(Some(CCursorRange::two(begin, end)));
    state.store(ui.ctx(), response.id);
}
