//! Keyboard input of a hex editor. Handled keys are consumed, so no other widget receives them.

use egui::{Event, FocusDirection, Key, Modifiers, Ui};

use super::grid::WIDTH;
use super::view::{Column, HexView};
use super::{HexEdit, HexModel};
use crate::app::Text;
use crate::bits::{self, HexError};

#[derive(Default)]
struct KeyReaction {
    edits: Vec<HexEdit>,
    copied: Option<String>,
    leave: Option<FocusDirection>,
}

/// Handles the keys of the current frame. Must be called before the widget is registered, or else Tab could not leave
/// it.
pub(super) fn handle_keys(ui: &Ui, model: &HexModel<'_>, view: &mut HexView) -> Vec<HexEdit> {
    let mut reaction = KeyReaction::default();
    ui.input_mut(|input| input.events.retain(|event| !handle_input(event, model, view, &mut reaction)));
    if let Some(text) = reaction.copied {
        ui.copy_text(text);
    }
    if let Some(direction) = reaction.leave {
        ui.memory_mut(|memory| memory.move_focus(direction));
    }
    reaction.edits
}

fn handle_input(event: &Event, model: &HexModel<'_>, view: &mut HexView, reaction: &mut KeyReaction) -> bool {
    match event {
        Event::Key { pressed: true, .. } | Event::Text(_) | Event::Paste(_) | Event::Copy => view.problem = None,
        _ => return false,
    }
    if let Event::Key { key: Key::Tab, modifiers, .. } = event {
        return handle_tab(*modifiers, view, reaction);
    }
    if model.wanted.is_empty() {
        return false;
    }
    match event {
        Event::Key { key, modifiers, .. } => {
            handle_movement(*key, *modifiers, model, view) || handle_edit_key(*key, *modifiers, model, view, reaction)
        }
        Event::Copy => {
            reaction.copied = model.wanted.get(view.selection()).map(|bytes| clipboard_text(bytes, view.column));
            true
        }
        Event::Text(text) => {
            apply_change(model, view, reaction, |view, reaction| write(text, model, view, reaction));
            true
        }
        Event::Paste(text) => {
            apply_change(model, view, reaction, |view, reaction| paste_text(text, model, view, reaction));
            true
        }
        _ => false,
    }
}

/// Handles Tab, which moves from the hex column to the text column and on to the next widget, or backwards.
fn handle_tab(modifiers: Modifiers, view: &mut HexView, reaction: &mut KeyReaction) -> bool {
    if modifiers.command || modifiers.alt {
        return false;
    }
    view.pending = None;
    match (view.column, modifiers.shift) {
        (Column::Hex, false) => view.column = Column::Text,
        (Column::Text, true) => view.column = Column::Hex,
        (Column::Text, false) => reaction.leave = Some(FocusDirection::Next),
        (Column::Hex, true) => reaction.leave = Some(FocusDirection::Previous),
    }
    true
}

fn handle_movement(key: Key, modifiers: Modifiers, model: &HexModel<'_>, view: &mut HexView) -> bool {
    if modifiers.alt {
        return false;
    }
    let (at, last) = (view.cursor(), model.wanted.len().saturating_sub(1));
    let page = WIDTH * view.page.max(1);
    let up = |by: usize| if at >= by { at - by } else { at % WIDTH };
    // Below the last line, the cursor keeps its column in the last line that contains it.
    let down = |by: usize| if at + by <= last { at + by } else { at + (last - at) / WIDTH * WIDTH };
    let to = match key {
        Key::ArrowLeft => at.saturating_sub(1),
        Key::ArrowRight => at + 1,
        Key::ArrowUp => up(WIDTH),
        Key::ArrowDown => down(WIDTH),
        Key::PageUp => up(page),
        Key::PageDown => down(page),
        Key::Home if modifiers.command => 0,
        Key::End if modifiers.command => last,
        Key::Home => at - at % WIDTH,
        Key::End => at - at % WIDTH + WIDTH - 1,
        _ => return false,
    };
    view.move_cursor(to, modifiers.shift);
    true
}

fn handle_edit_key(
    key: Key,
    modifiers: Modifiers,
    model: &HexModel<'_>,
    view: &mut HexView,
    reaction: &mut KeyReaction,
) -> bool {
    let history = |view: &mut HexView, reaction: &mut KeyReaction, edit: HexEdit| {
        apply_change(model, view, reaction, |view, reaction| {
            view.move_to_change(model.wanted);
            reaction.edits.push(edit);
        });
    };
    match (key, modifiers.command, modifiers.shift) {
        (Key::A, true, false) => {
            let reveal = view.reveal;
            view.select(0..model.wanted.len());
            view.reveal = reveal;
        }
        (Key::Z, true, false) => history(view, reaction, HexEdit::Undo),
        (Key::Z, true, true) | (Key::Y, true, false) => history(view, reaction, HexEdit::Redo),
        (Key::Escape | Key::Backspace, false, _) if view.pending.is_some() => view.pending = None,
        (Key::Backspace, false, _) => apply_change(model, view, reaction, |view, reaction| {
            let range = view.selection();
            if range.clone().any(|at| model.is_changed(at)) {
                reaction.edits.push(HexEdit::Revert { range });
            }
        }),
        (Key::Delete, false, _) => apply_change(model, view, reaction, |view, reaction| {
            view.pending = None;
            let range = view.selection();
            reaction.edits.push(HexEdit::Put { address: range.start, bytes: vec![0; range.len()] });
        }),
        _ => return false,
    }
    true
}

/// Applies a change, or reports the reason if it is not possible.
fn apply_change(
    model: &HexModel<'_>,
    view: &mut HexView,
    reaction: &mut KeyReaction,
    how: impl FnOnce(&mut HexView, &mut KeyReaction),
) {
    match model.read_only {
        Some(reason) => view.problem = Some(reason.clone()),
        None => how(view, reaction),
    }
}

fn clipboard_text(bytes: &[u8], column: Column) -> String {
    match column {
        Column::Hex => bits::hex(bytes),
        Column::Text => bytes.iter().map(|byte| bits::ascii(*byte).unwrap_or(bits::UNPRINTABLE)).collect(),
    }
}

fn write(text: &str, model: &HexModel<'_>, view: &mut HexView, reaction: &mut KeyReaction) {
    if view.column == Column::Text {
        match ascii_bytes(text) {
            Ok(bytes) => write_bytes(bytes, model, view, reaction, false),
            Err(problem) => view.problem = Some(problem),
        }
        return;
    }
    for character in text.chars().filter(|character| !character.is_whitespace()) {
        let Some(digit) = character.to_digit(16).and_then(|digit| u8::try_from(digit).ok()) else {
            view.pending = None;
            view.problem = Some(Text::new("widget.hex_no_digit").with("character", character));
            return;
        };
        match view.pending.take() {
            Some(high) => write_bytes(vec![high << 4 | digit], model, view, reaction, false),
            None => {
                view.move_cursor(view.selection().start, false);
                view.pending = Some(digit);
            }
        }
    }
}

fn paste_text(text: &str, model: &HexModel<'_>, view: &mut HexView, reaction: &mut KeyReaction) {
    view.pending = None;
    let bytes = match view.column {
        Column::Text => ascii_bytes(text),
        Column::Hex => bits::parse_hex(text).map_err(|error| match error {
            HexError::Digit(character) => Text::new("widget.hex_no_digit").with("character", character.escape_debug()),
            HexError::Odd(group) => Text::new("widget.hex_odd").with("group", group),
        }),
    };
    match bytes {
        Ok(bytes) => write_bytes(bytes, model, view, reaction, true),
        Err(problem) => view.problem = Some(problem),
    }
}

fn ascii_bytes(text: &str) -> Result<Vec<u8>, Text> {
    let byte = |character: char| {
        let ascii = u8::try_from(character).ok().filter(u8::is_ascii);
        ascii.ok_or_else(|| Text::new("widget.hex_no_ascii").with("character", character))
    };
    text.chars().map(byte).collect()
}

/// Writes bytes at the start of the selection. Then either selects them or moves the cursor behind them.
fn write_bytes(bytes: Vec<u8>, model: &HexModel<'_>, view: &mut HexView, reaction: &mut KeyReaction, select: bool) {
    let address = view.selection().start;
    let room = model.wanted.len().saturating_sub(address);
    if bytes.is_empty() {
        view.problem = Some(Text::new("widget.hex_nothing"));
        return;
    }
    if bytes.len() > room {
        let problem = Text::new("widget.hex_too_long").with("count", bytes.len()).with("room", room);
        view.problem = Some(problem.with("address", model.address(address)));
        return;
    }
    let end = address + bytes.len();
    if select {
        view.select(address..end)
    } else {
        view.move_cursor(end, false)
    }
    reaction.edits.push(HexEdit::Put { address, bytes });
}
