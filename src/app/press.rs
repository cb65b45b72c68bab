//! Detection of fresh key presses. A press is fresh if the user has just pressed the key. Repeats of a held key are not
//! fresh.
//!
//! A press event alone does not prove that the press is fresh. Toolkits forget which keys are down when the window
//! loses the keyboard focus. The next repetition of a held key then looks like a first press, and the release reported
//! at that moment is artificial.
//!
//! A release proves that the next press is fresh if the window has the focus when the release arrives, and the key is
//! still up in a later frame. The release and the press of a repetition, which occur at the same time, may arrive in
//! two frames, however far apart.
//!
//! This module does not access the system. Inputs are passed in order, with the time of their frame in seconds.

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PressKey {
    Space,
    /// Enter on the main keyboard or the numeric pad.
    Enter,
}

/// Minimum time in seconds between the release of a key and a fresh press. Some remote desktops and display servers
/// report the repetition of a key as a release followed immediately by a press.
const MIN_RELEASE_S: f64 = 0.05;

#[derive(Clone, Copy, Debug, Default, PartialEq)]
enum KeyState {
    /// The state of the key is unknown. It may be held down.
    #[default]
    Nothing,
    Down,
    /// Time at which this key was released or another key was pressed. It is still too recent for a fresh press.
    Released(f64),
    Up,
}

#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct KeyStates {
    space: KeyState,
    enter: KeyState,
}

impl KeyStates {
    /// The state with both keys known to be up.
    pub const ALL_RELEASED: KeyStates = KeyStates { space: KeyState::Up, enter: KeyState::Up };

    /// Discards the known key states because the keyboard focus has moved or serves another purpose now.
    pub fn reset_keys(&mut self) {
        *self = KeyStates::default();
    }

    /// Handles a key press and returns whether it is fresh. A press is fresh if the key had been up for a minimum time
    /// in an earlier frame.
    pub fn is_fresh_press(&mut self, key: PressKey) -> bool {
        std::mem::replace(self.state_mut(key), KeyState::Down) == KeyState::Up
    }

    /// Handles the release of a key while the window has the keyboard focus.
    pub fn release(&mut self, key: PressKey, now: f64) {
        *self.state_mut(key) = KeyState::Released(now);
    }

    /// Records that another key was pressed. The system repeats only the last key pressed, so a later press of a key in
    /// an unknown state is not a repeat.
    pub fn record_other_key_press(&mut self, now: f64) {
        for key in [PressKey::Space, PressKey::Enter] {
            let own = self.state_mut(key);
            if *own == KeyState::Nothing {
                *own = KeyState::Released(now);
            }
        }
    }

    /// Records that another key was pressed outside a text entry. A press immediately after it is not fresh: only a
    /// barcode scanner types that fast.
    pub fn restart_release_delay(&mut self, now: f64) {
        for key in [PressKey::Space, PressKey::Enter] {
            let own = self.state_mut(key);
            if *own == KeyState::Up {
                *own = KeyState::Released(now);
            }
        }
    }

    /// Ends a frame. Returns the time in seconds until the next frame that is needed to determine the state of a key.
    /// After a release, the toolkit draws no further frame unless one is requested.
    #[must_use]
    pub fn finish_ui_frame(&mut self, now: f64) -> Option<f64> {
        let mut next: Option<f64> = None;
        for key in [PressKey::Space, PressKey::Enter] {
            let own = self.state_mut(key);
            let KeyState::Released(since) = *own else { continue };
            let rest = since + MIN_RELEASE_S - now;
            if rest > 0.0 {
                next = Some(next.map_or(rest, |next| next.min(rest)));
            } else {
                *own = KeyState::Up;
            }
        }
        next
    }

    /// Returns whether the key is known to be up. The next press is then fresh, unless it immediately follows a release
    /// or another key.
    pub fn is_armed(&self, key: PressKey) -> bool {
        matches!(self.get(key), KeyState::Released(_) | KeyState::Up)
    }

    /// Returns whether the key is known to be down.
    pub fn is_down(&self, key: PressKey) -> bool {
        self.get(key) == KeyState::Down
    }

    const fn get(&self, key: PressKey) -> KeyState {
        match key {
            PressKey::Space => self.space,
            PressKey::Enter => self.enter,
        }
    }

    const fn state_mut(&mut self, key: PressKey) -> &mut KeyState {
        match key {
            PressKey::Space => &mut self.space,
            PressKey::Enter => &mut self.enter,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::PressKey::{Enter, Space};
    use super::*;

    /// Draws `count` frames without input, `apart` seconds apart.
    fn pictures(keys: &mut KeyStates, from: f64, apart: f64, count: u32) {
        for number in 0..count {
            let _ = keys.finish_ui_frame(from + apart * f64::from(number));
        }
    }

    /// A press that the toolkit reports as new is not fresh unless the key is known to be up.
    #[test]
    fn press_is_fresh_only_after_release() {
        let mut keys = KeyStates::default();
        assert!(!keys.is_armed(Space) && !keys.is_down(Space));
        for at in 0..40 {
            assert!(!keys.is_fresh_press(Space), "a key that is held repeats itself");
            assert_eq!(keys.finish_ui_frame(f64::from(at) * 0.04), None);
        }
        keys.release(Space, 2.0);
        assert!(keys.is_armed(Space) && !keys.is_armed(Enter));
        pictures(&mut keys, 2.0, 0.1, 5);
        assert!(keys.is_fresh_press(Space) && keys.is_down(Space));
        pictures(&mut keys, 3.0, 0.1, 5);
        assert!(!keys.is_fresh_press(Space), "held");
        assert!(!keys.is_fresh_press(Enter), "each key for itself");
        keys.release(Space, 5.0);
        pictures(&mut keys, 5.0, 0.1, 5);
        keys.reset_keys();
        pictures(&mut keys, 5.5, 0.1, 5);
        assert!(!keys.is_fresh_press(Space), "the keyboard was elsewhere meanwhile");
    }

    /// A release followed immediately by a press is a repeat, whether both arrive in one frame or in two.
    #[test]
    fn immediate_press_after_release_is_repeat() {
        for apart in [0.004, 0.016, 0.05, 0.08, 0.25, 2.0] {
            let mut keys = KeyStates::ALL_RELEASED;
            assert!(keys.is_fresh_press(Enter));
            let _ = keys.finish_ui_frame(0.0);
            for number in 1..30 {
                let now = f64::from(number) * 3.0 * apart;
                keys.release(Enter, now);
                assert!(!keys.is_fresh_press(Enter), "{apart}: in one picture");
                let _ = keys.finish_ui_frame(now);
                keys.release(Enter, now + apart);
                let _ = keys.finish_ui_frame(now + apart);
                assert!(!keys.is_fresh_press(Enter), "{apart}: a picture later");
                let _ = keys.finish_ui_frame(now + 2.0 * apart);
            }
        }
    }

    /// The release of a key requests a frame, so the next press is fresh even if nothing else happens in between.
    #[test]
    fn press_after_requested_frame_is_fresh() {
        for apart in [0.001, 0.016, 0.05, 1.0] {
            let mut keys = KeyStates::ALL_RELEASED;
            assert!(keys.is_fresh_press(Enter));
            assert_eq!(keys.finish_ui_frame(0.0), None, "it is down, and nothing is to be waited for");
            keys.release(Enter, 1.0);
            let (mut now, mut pictures) = (1.0, 0);
            while let Some(next) = keys.finish_ui_frame(now) {
                assert!(next > 0.0 && next < 0.0501, "{next}");
                // The requested frame, or an earlier one.
                now += next.min(apart);
                pictures += 1;
            }
            assert!(pictures >= 1 && now < 1.0501, "{pictures} pictures until {now}");
            assert!(keys.is_fresh_press(Enter), "100 ms after the release");
        }
    }

    #[test]
    fn another_key_resolves_unknown_state() {
        let mut keys = KeyStates::default();
        keys.record_other_key_press(1.0);
        assert!(!keys.is_fresh_press(Enter), "at once");
        keys.reset_keys();
        keys.record_other_key_press(1.0);
        pictures(&mut keys, 1.0, 0.05, 2);
        assert!(keys.is_fresh_press(Enter));
        keys.record_other_key_press(1.2);
        pictures(&mut keys, 1.2, 0.05, 2);
        assert!(!keys.is_fresh_press(Enter), "it is known to be down");
    }

    /// Enter typed by a barcode scanner immediately after another key is not fresh.
    #[test]
    fn press_after_other_key_is_not_fresh() {
        let mut keys = KeyStates::ALL_RELEASED;
        keys.restart_release_delay(1.0);
        assert!(!keys.is_fresh_press(Enter), "in the same picture");
        let mut keys = KeyStates::ALL_RELEASED;
        keys.restart_release_delay(1.0);
        let _ = keys.finish_ui_frame(1.0);
        assert!(!keys.is_fresh_press(Enter), "in the next one, whenever that is");
        let mut keys = KeyStates::ALL_RELEASED;
        keys.restart_release_delay(1.0);
        pictures(&mut keys, 1.0, 0.05, 2);
        assert!(keys.is_fresh_press(Enter), "a person's");
        keys.restart_release_delay(2.0);
        pictures(&mut keys, 2.0, 0.05, 2);
        assert!(!keys.is_fresh_press(Enter), "it is down");
        let mut keys = KeyStates::default();
        keys.restart_release_delay(1.0);
        pictures(&mut keys, 1.0, 0.05, 2);
        assert!(!keys.is_fresh_press(Enter), "it may be held");
    }
}
