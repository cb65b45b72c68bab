//! Selection of a list row with the arrow keys.

use egui::{EventFilter, Id, Key, Modifiers, Rect, Sense, Ui};

/// Returns the number of rows by which the arrow keys move the selection. They act only while `keys` has the keyboard
/// focus, which a click on a row gives it.
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
