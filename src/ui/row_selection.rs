//! Handling of the arrow keys in a list with one selected row.

use egui::{EventFilter, Id, Key, Modifiers, Rect, Sense, Ui};

/// Returns the number of rows by which the arrow keys move the selection. The keys are handled after a click on a row,
/// while `keys` has the keyboard focus.
pub(super) fn selection_step(ui: &Ui, keys: Id) -> Option<isize> {
    ui.interact(Rect::NOTHING, keys, Sense::focusable_noninteractive());
    if !ui.memory(|memory| memory.has_focus(keys)) {
        return None;
    }
    let filter = EventFilter { vertical_arrows: true, ..EventFilter::default() };
    ui.memory_mut(|memory| memory.set_focus_lock_filter(keys, filter));
    let pressed = |key| ui.input_mut(|input| input.count_and_consume_key(Modifiers::NONE, key)) as isize;
    Some(pressed(Key::ArrowDown) - pressed(Key::ArrowUp)).filter(|step| *step != 0)
}
