//! The order of input within a frame. On a busy computer, a click on an entry and the text typed after it can arrive in
//! the same frame. The entry gets the keyboard focus only in the next frame, so text typed after the click is held back
//! until then.

use egui::{Event, Key};

/// Input events that are held back for a later frame.
#[derive(Debug, Default)]
pub(super) struct DeferredInput(Vec<Event>);

impl DeferredInput {
    /// Reduces `events` to those of the current frame. If typing follows an event that may move the keyboard focus, the
    /// frame ends with that event. If `at_once` is set, nothing is held back. Returns whether another frame is needed
    /// immediately.
    pub(super) fn split_frame_events(&mut self, events: &mut Vec<Event>, at_once: bool) -> bool {
        self.0.append(events);
        let after_first = self.0.iter().position(may_move_focus).map_or(self.0.len(), |at| at + 1);
        let is_followed = self.0.iter().skip(after_first).any(is_typing_event);
        let later = if at_once || !is_followed { Vec::new() } else { self.0.split_off(after_first) };
        *events = std::mem::replace(&mut self.0, later);
        !self.0.is_empty()
    }
}

fn may_move_focus(event: &Event) -> bool {
    matches!(
        event,
        Event::PointerButton { pressed: false, .. } | Event::Key { key: Key::Tab | Key::Enter, pressed: true, .. }
    )
}

fn is_typing_event(event: &Event) -> bool {
    matches!(event, Event::Text(_) | Event::Paste(_) | Event::Ime(_) | Event::Key { pressed: true, .. })
}

#[cfg(test)]
mod tests {
    use egui::{Modifiers, PointerButton, Pos2};

    use super::*;

    fn button(pressed: bool) -> Event {
        let (pos, modifiers) = (Pos2::ZERO, Modifiers::NONE);
        Event::PointerButton { pos, button: PointerButton::Primary, pressed, modifiers }
    }

    fn key(key: Key, pressed: bool) -> Event {
        Event::Key { key, physical_key: None, pressed, repeat: false, modifiers: Modifiers::NONE }
    }

    fn text(text: &str) -> Event {
        Event::Text(text.to_owned())
    }

    /// Divides events into frames until no event is held back.
    fn frames(mut events: Vec<Event>) -> Vec<Vec<Event>> {
        let (mut held, mut frames) = (DeferredInput::default(), Vec::new());
        while held.split_frame_events(&mut events, false) || !events.is_empty() {
            frames.push(std::mem::take(&mut events));
        }
        frames
    }

    #[test]
    fn defers_text_after_click_or_tab() {
        let events = [button(true), button(false), text("12"), key(Key::Tab, true), key(Key::Tab, false), text("3")];
        let expected = [
            vec![button(true), button(false)],
            vec![text("12"), key(Key::Tab, true)],
            vec![key(Key::Tab, false), text("3")],
        ];
        assert_eq!(frames(events.to_vec()), expected);
    }

    #[test]
    fn keeps_input_without_text_in_one_frame() {
        let events = vec![text("1"), key(Key::Enter, true), key(Key::Enter, false), button(true), button(false)];
        let (mut held, mut now) = (DeferredInput::default(), events.clone());
        assert!(!held.split_frame_events(&mut now, false));
        assert_eq!(now, events);
    }

    #[test]
    fn does_not_defer_immediate_input() {
        let (mut held, mut now) = (DeferredInput::default(), vec![button(false), text("1")]);
        assert!(held.split_frame_events(&mut now, false));
        assert_eq!(now, [button(false)]);
        let mut now = vec![key(Key::Space, false)];
        assert!(!held.split_frame_events(&mut now, true));
        assert_eq!(now, [text("1"), key(Key::Space, false)], "in the order in which they came");
    }
}
