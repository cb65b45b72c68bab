//! Keyboard input of a register table. Handled keys are consumed, so no other widget receives them.

use egui::{Event, EventFilter, FocusDirection, Id, Key, Modifiers, Ui};

use super::lines::Lines;
use super::view::{Edit, SelectedRow};
use super::{RegisterEvent, RegisterLocation, RegisterTable, RegisterView};

/// Reserves the arrow keys for the table while it has the keyboard focus.
pub(super) fn reserve_keys(ui: &Ui, id: Id) {
    let filter = EventFilter { vertical_arrows: true, horizontal_arrows: true, ..EventFilter::default() };
    ui.memory_mut(|memory| memory.set_focus_lock_filter(id, filter));
}

/// Inserts the events held back in the previous frame before the current events if the table has the keyboard focus.
pub(super) fn restore_deferred_keys(ui: &Ui, view: &mut RegisterView, id: Id) {
    let late = std::mem::take(&mut view.late);
    let focused = ui.memory(|memory| memory.focused());
    if !late.is_empty() && (focused == Some(id) || focused == Some(entry_id(id))) {
        ui.input_mut(|input| drop(input.events.splice(0..0, late)));
    }
}

pub(super) fn entry_id(table: Id) -> Id {
    table.with("entry")
}

/// Holds back everything typed in the current frame after a key that ends an edit: Enter, or an up or down arrow, which
/// then also moves to another line.
pub(super) fn defer_keys(ui: &Ui, view: &mut RegisterView) {
    ui.input_mut(|input| {
        let mut ended = false;
        let mut kept = Vec::with_capacity(input.events.len());
        for event in input.events.drain(..) {
            let is_arrow = is_vertical(&event);
            if is_typing_event(&event) && (ended || is_arrow) {
                if !ended {
                    kept.push(ENTER);
                }
                view.late.push(event);
            } else {
                ended |= matches!(event, Event::Key { key: Key::Enter, pressed: true, .. });
                kept.push(event);
            }
            ended |= is_arrow;
        }
        input.events = kept;
    });
    if !view.late.is_empty() {
        // Otherwise, an arrow key would move the focus to a neighbour.
        ui.memory_mut(|memory| memory.move_focus(FocusDirection::None));
        ui.ctx().request_repaint();
    }
}

const ENTER: Event =
    Event::Key { key: Key::Enter, physical_key: None, pressed: true, repeat: false, modifiers: Modifiers::NONE };

/// Returns whether the event is an arrow key press that moves to another line.
pub(super) fn is_vertical(event: &Event) -> bool {
    let is_plain = |modifiers: &Modifiers| !modifiers.any();
    matches!(event, Event::Key { key: Key::ArrowUp | Key::ArrowDown, pressed: true, modifiers, .. } if is_plain(modifiers))
}

/// Returns whether an event is typing for the table or its editor. Keys that stop a drive or control the window are
/// never held back.
fn is_typing_event(event: &Event) -> bool {
    use Key::{ArrowDown, ArrowLeft, ArrowRight, ArrowUp, Backspace, Delete, End, Enter, Home};
    match event {
        Event::Text(_) => true,
        Event::Key { key, modifiers, .. } => {
            let keys = [ArrowDown, ArrowLeft, ArrowRight, ArrowUp, Backspace, Delete, End, Enter, Home];
            keys.contains(key) && !modifiers.any()
        }
        _ => false,
    }
}

pub(super) fn handle_keys(
    ui: &Ui,
    table: &RegisterTable<'_>,
    lines: &Lines,
    view: &mut RegisterView,
) -> Option<RegisterEvent> {
    let mut event = None;
    let mut copied = None;
    ui.input_mut(|input| {
        input.events.retain(|own| match own {
            // The editor receives the keyboard from the next frame on.
            _ if is_typing_event(own) && view.edit.as_ref().is_some_and(|edit| edit.begins) => {
                view.late.push(own.clone());
                false
            }
            Event::Key { key, pressed: true, modifiers, .. } => {
                view.refused = None;
                let act =
                    handle_movement(*key, *modifiers, lines, view) || handle_fold_key(*key, *modifiers, table, view);
                !act && !handle_edit_key(*key, *modifiers, table, view, &mut event)
            }
            Event::Text(text) => text.trim().is_empty() || !begin_edit(table, view, Some(text)),
            Event::Copy => {
                copied = view.selected().map(|place| (table.row)(place).value);
                copied.is_none()
            }
            _ => true,
        });
    });
    if let Some(text) = copied {
        ui.copy_text(text);
    }
    if !view.late.is_empty() {
        ui.ctx().request_repaint();
    }
    event
}

fn handle_movement(key: Key, modifiers: Modifiers, lines: &Lines, view: &mut RegisterView) -> bool {
    if modifiers.alt || modifiers.shift {
        return false;
    }
    let last = lines.total().saturating_sub(1);
    let at = view.selected.and_then(|own| lines.line_index(own));
    let page = view.page.max(1);
    let to = match (key, at) {
        (Key::ArrowUp | Key::ArrowDown | Key::PageUp | Key::PageDown, None) => 0,
        (Key::ArrowUp, Some(at)) => return move_selection(at, lines, view, |line| line.checked_sub(1)),
        (Key::ArrowDown, Some(at)) => {
            return move_selection(at, lines, view, |line| Some(line + 1).filter(|to| *to <= last));
        }
        (Key::PageUp, Some(at)) => at.saturating_sub(page),
        (Key::PageDown, Some(at)) => (at + page).min(last),
        (Key::Home, _) => 0,
        (Key::End, _) => last,
        _ => return false,
    };
    if let Some(own) = lines.selection_at(to) {
        view.select_row(own);
    }
    true
}

/// Moves to the next selectable line, skipping bit fields.
fn move_selection(at: usize, lines: &Lines, view: &mut RegisterView, next: impl Fn(usize) -> Option<usize>) -> bool {
    let mut line = at;
    while let Some(to) = next(line) {
        line = to;
        let own = lines.selection_at(line);
        if own.is_some() && own != view.selected {
            own.into_iter().for_each(|own| view.select_row(own));
            break;
        }
    }
    true
}

/// Folds with the left arrow and unfolds with the right arrow. On a folded register, the left arrow moves to the group
/// heading.
fn handle_fold_key(key: Key, modifiers: Modifiers, table: &RegisterTable<'_>, view: &mut RegisterView) -> bool {
    let open = match key {
        Key::ArrowLeft => false,
        Key::ArrowRight => true,
        _ => return false,
    };
    if modifiers.any() {
        return false;
    }
    match view.selected {
        Some(SelectedRow::Group(group)) => view.set_folded(group, !open),
        Some(SelectedRow::Row(place)) if open => {
            view.set_expanded(place, !(table.row)(place).fields.is_empty());
        }
        Some(SelectedRow::Row(place)) if view.open.contains(&place) => view.set_expanded(place, false),
        Some(SelectedRow::Row(place)) => view.select_row(SelectedRow::Group(place.group)),
        None => {}
    }
    true
}

fn handle_edit_key(
    key: Key,
    modifiers: Modifiers,
    table: &RegisterTable<'_>,
    view: &mut RegisterView,
    event: &mut Option<RegisterEvent>,
) -> bool {
    if modifiers.any() {
        return false;
    }
    match (key, view.selected) {
        (Key::Enter | Key::Space, Some(SelectedRow::Group(group))) => view.set_folded(group, !view.is_folded(group)),
        (Key::Enter | Key::F2, Some(SelectedRow::Row(_))) => return begin_edit(table, view, None),
        (Key::Backspace | Key::Delete, Some(SelectedRow::Row(place))) if (table.row)(place).edited => {
            *event = Some(RegisterEvent::Revert(place));
        }
        _ => return false,
    }
    true
}

/// Starts an edit that replaces the selected value, if editing is allowed.
pub(super) fn begin_edit(table: &RegisterTable<'_>, view: &mut RegisterView, typed: Option<&str>) -> bool {
    let Some(place) = view.selected() else { return false };
    begin_at(table, view, place, typed)
}

pub(super) fn begin_at(
    table: &RegisterTable<'_>,
    view: &mut RegisterView,
    place: RegisterLocation,
    typed: Option<&str>,
) -> bool {
    let row = (table.row)(place);
    if let Some(why) = row.read_only {
        view.refused = Some(why);
        return true;
    }
    let text = typed.map_or(row.value, ToOwned::to_owned);
    view.edit = Some(Edit { place, text, problem: None, begins: true, typed: typed.is_some() });
    true
}
