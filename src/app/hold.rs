//! State of a button that is active while it is held, with the rules for the start and the end of a hold. Nothing is
//! drawn here.
//!
//! | Event | Not held | Held by the pointer | Held by a key |
//! |---|---|---|---|
//! | pointer pressed on the button | begins, unless Space or Enter is down | ends | ends |
//! | pointer pressed elsewhere, or a second finger | – | ends | ends |
//! | pointer released, or moved off the button | – | ends | – |
//! | fresh press of Space or Enter, no modifiers | begins if focused, no pointer down, nothing moving | ends | ends |
//! | same key again | stops a running motion | ends | continues (key repeat) |
//! | any other key, or a modifier | – | ends | ends |
//! | key released | – | – | ends |
//! | another widget gets the focus | key states discarded | key states discarded | ends |
//! | window focus changes; button disabled, enabled, or absent in the last frame | key states discarded | ends | ends |
//!
//! After a hold has ended, only another press starts a new one. The press of a key must be [fresh](KeyStates), which a
//! press immediately after another key never is.

use super::press::{KeyStates, PressKey};

/// The state of a hold button and its window at the start of a frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct HoldContext {
    pub enabled: bool,
    pub window: bool,
    pub keyboard: bool,
    /// Whether a motion that this button does not control is running or has just been stopped. A key press is then a
    /// request to stop.
    pub moving: bool,
}

/// An input event since the previous frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum HoldInput {
    /// The window gained or lost the keyboard focus.
    WindowFocus(bool),
    Down {
        key: PressKey,
        /// Whether no modifier key is held down.
        plain: bool,
    },
    Up(PressKey),
    OtherKey,
    Modifiers,
    PointerDown {
        /// Whether the primary pointer button was pressed on this button.
        on: bool,
    },
    PointerMoved {
        inside: bool,
    },
    PointerUp,
    PointerGone,
    /// A finger has touched the screen. If the touch acts as the pointer, a pointer press follows as a separate event.
    Finger,
}

/// The effect of one frame's input on a hold button.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum HoldEvent {
    Press,
    Hold,
    Release,
    /// A key was pressed during a motion that this button does not control. All motion must stop.
    Stop,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum HoldSource {
    Pointer,
    Key(PressKey),
}

#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct HoldState {
    scene: Option<HoldContext>,
    holder: Option<HoldSource>,
    keys: KeyStates,
    pointer: bool,
    was_held: bool,
    /// Whether a hold began in this frame.
    began: bool,
    stop: bool,
    next_picture: Option<f64>,
}

impl HoldState {
    /// Begins a frame. `follows` states whether the button was present in the previous frame.
    pub fn begin_frame(&mut self, scene: HoldContext, follows: bool) {
        let before = self.scene.replace(scene).filter(|_| follows);
        self.pointer &= before.is_some();
        self.was_held = self.holder.is_some();
        (self.began, self.stop) = (false, false);
        let same = before.is_some_and(|own| (own.enabled, own.window) == (scene.enabled, scene.window));
        if !same {
            self.release_all();
            self.keys.reset_keys();
        }
        if before.is_none_or(|own| own.keyboard != scene.keyboard) {
            self.keys.reset_keys();
            if matches!(self.holder, Some(HoldSource::Key(_))) {
                self.release_all();
            }
        }
    }

    /// Handles one input event of a frame. `now` is the time on the window's clock.
    pub fn handle_input(&mut self, now: f64, input: HoldInput) {
        let Some(scene) = self.scene else { return };
        match input {
            HoldInput::WindowFocus(_) => {
                self.keys.reset_keys();
                self.release_all();
            }
            HoldInput::Down { key, plain } => self.key_down(key, plain, scene),
            HoldInput::Up(key) => {
                if scene.window {
                    self.keys.release(key, now);
                }
                if self.holder == Some(HoldSource::Key(key)) {
                    self.release_all();
                }
            }
            HoldInput::OtherKey => {
                self.keys.restart_release_delay(now);
                self.release_all();
            }
            HoldInput::Modifiers | HoldInput::Finger => self.release_all(),
            HoldInput::PointerDown { on } => {
                let alone = self.holder.is_none() && !self.pointer && !self.is_any_key_down();
                self.pointer = true;
                self.release_all();
                if on && alone && scene.enabled && scene.window {
                    self.start_hold(HoldSource::Pointer);
                }
            }
            HoldInput::PointerMoved { inside: true } => {}
            HoldInput::PointerMoved { inside: false } => self.release_pointer(),
            HoldInput::PointerUp | HoldInput::PointerGone => {
                self.pointer = false;
                self.release_pointer();
            }
        }
    }

    /// Ends the frame and returns what has happened to the hold. `pointer_down` states whether the pointer is pressed,
    /// and `inside` whether it is on the button.
    pub fn end_frame(&mut self, now: f64, pointer_down: bool, inside: bool) -> Option<HoldEvent> {
        self.next_picture = self.keys.finish_ui_frame(now);
        self.pointer = pointer_down;
        if !(pointer_down && inside) {
            self.release_pointer();
        }
        // If a hold ended and another one began between two frames, the new one is ignored.
        if self.stop || self.was_held && self.began {
            self.release_all();
        }
        match (self.was_held, self.holder.is_some()) {
            _ if self.stop => Some(HoldEvent::Stop),
            (false, true) => Some(HoldEvent::Press),
            (true, true) => Some(HoldEvent::Hold),
            (true, false) => Some(HoldEvent::Release),
            (false, false) => None,
        }
    }

    /// Returns the time in seconds until the next frame that is needed to detect the release of a key.
    pub const fn repaint_delay(&self) -> Option<f64> {
        self.next_picture
    }

    pub const fn is_held(&self) -> bool {
        self.holder.is_some()
    }

    pub fn is_held_by_pointer(&self) -> bool {
        self.holder == Some(HoldSource::Pointer)
    }

    /// Returns whether the button has the keyboard focus but ignores key presses until a key has been released.
    pub fn is_waiting_for_release(&self) -> bool {
        let has_keyboard = self.scene.is_some_and(|scene| scene.enabled && scene.window && scene.keyboard);
        let armed = self.keys.is_armed(PressKey::Space) || self.keys.is_armed(PressKey::Enter);
        has_keyboard && !armed && self.holder.is_none()
    }

    fn key_down(&mut self, key: PressKey, plain: bool, scene: HoldContext) {
        let fresh = self.keys.is_fresh_press(key);
        match self.holder {
            Some(HoldSource::Key(own)) if own == key && plain => {}
            Some(_) => self.release_all(),
            None if !scene.keyboard => {}
            None if scene.moving => self.stop = true,
            None if fresh && plain && scene.enabled && scene.window && !self.pointer => {
                self.start_hold(HoldSource::Key(key))
            }
            None => {}
        }
    }

    fn is_any_key_down(&self) -> bool {
        self.keys.is_down(PressKey::Space) || self.keys.is_down(PressKey::Enter)
    }

    fn start_hold(&mut self, holder: HoldSource) {
        self.holder = Some(holder);
        self.began = true;
    }

    fn release_all(&mut self) {
        self.holder = None;
    }

    fn release_pointer(&mut self) {
        if self.holder == Some(HoldSource::Pointer) {
            self.release_all();
        }
    }
}

#[cfg(test)]
mod sessions;
#[cfg(test)]
mod tests;
