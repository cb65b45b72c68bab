//! Filters key events before any widget receives them. A repeated key, or one that follows another too quickly, does
//! not press a button. Space stops a motion. While the pointer holds a button that moves a drive, any key stops the
//! motion. Keys that hold such a button are handled by [`HoldState`](crate::app::HoldState).

use egui::{Context, Event, Key};

use super::stop_debounce;
use super::widgets::{has_hold_button_focus, is_hold_button_held};
use crate::app::{KeyStates, PressKey};

pub(super) struct KeyboardFilter {
    fresh: KeyStates,
    /// Whether consent was requested in the previous frame.
    asked: bool,
}

impl KeyboardFilter {
    pub(super) fn new() -> Self {
        KeyboardFilter { fresh: KeyStates::ALL_RELEASED, asked: false }
    }

    /// Removes the events that no widget may receive from the current frame. Returns whether all motion must stop.
    /// `moves` states whether this window is moving a drive. `asks` states whether consent is requested. Only a key
    /// that has been released since the request can give consent.
    pub(super) fn filter_events(&mut self, ctx: &Context, moves: bool, asks: bool) -> bool {
        if asks && !std::mem::replace(&mut self.asked, asks) {
            self.fresh.reset_keys();
        }
        self.asked = asks;
        let (held, for_hold_button) = (is_hold_button_held(ctx), has_hold_button_focus(ctx));
        let (now, has_keyboard) = ctx.input(|input| (input.time, input.focused));
        // Enter completes a text entry and does not press a button there.
        let typing = ctx.text_edit_focused();
        let space_stops = !for_hold_button && (moves || stop_debounce::has_recently_stopped(ctx, now));
        let fresh = &mut self.fresh;
        let mut stops = false;
        let mut passes = |event: &Event| match event {
            Event::WindowFocused(_) => {
                fresh.reset_keys();
                true
            }
            Event::Key { key, pressed: false, .. } => {
                if let Some(key) = press_key(*key).filter(|_| has_keyboard) {
                    fresh.release(key, now);
                }
                true
            }
            Event::Key { key, .. } => {
                let own = press_key(*key);
                let repeats = own.is_some_and(|own| fresh.is_down(own));
                let counts = match own {
                    Some(own) => fresh.is_fresh_press(own),
                    // Ctrl is pressed immediately before the Enter of Ctrl+Enter.
                    None if is_modifier(*key) => true,
                    None => {
                        if !asks {
                            fresh.record_other_key_press(now);
                        }
                        if !typing {
                            fresh.restart_release_delay(now);
                        }
                        true
                    }
                };
                let stop = held || space_stops && own == Some(PressKey::Space) && !repeats;
                stops |= stop;
                // Escape has further effects, which are handled elsewhere.
                counts && !stop || *key == Key::Escape
            }
            _ => true,
        };
        ctx.input_mut(|input| input.events.retain(&mut passes));
        if let Some(seconds) = self.fresh.finish_ui_frame(now) {
            ctx.request_repaint_after_secs(seconds as f32);
        }
        if stops {
            stop_debounce::register_stop_press(ctx, true, now);
        }
        stops
    }
}

const fn is_modifier(key: Key) -> bool {
    use Key::{AltLeft, AltRight, ControlLeft, ControlRight, ShiftLeft, ShiftRight, SuperLeft, SuperRight};
    matches!(key, ShiftLeft | ShiftRight | ControlLeft | ControlRight | AltLeft | AltRight | SuperLeft | SuperRight)
}

/// Returns the press key for an egui key, or `None` if the key does not press buttons.
pub(super) const fn press_key(key: Key) -> Option<PressKey> {
    match key {
        Key::Space => Some(PressKey::Space),
        Key::Enter => Some(PressKey::Enter),
        _ => None,
    }
}
