//! Fresh presses: whether a key that goes down is an act of a person just now, or a key that is held and repeats itself.
//!
//! A press alone proves nothing. A toolkit forgets which keys are down when the window loses the keyboard, so that the
//! next repetition of a key that is still held looks like a first press; and what it calls a release at that moment is made
//! up. A release that came while the window had the keyboard does prove something: the key was up. Pure: what came is handed
//! in, in the order in which it came, with the time in seconds.

/// A key that presses a button.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PressKey {
    /// The space bar.
    Space,
    /// Enter, of the numeric pad as well.
    Enter,
}

/// No finger is off a key for a shorter time, in seconds. Remote desktops, and displays that do not tell repetitions from
/// presses, repeat a key by a release and a press at once.
const LEAST: f64 = 0.05;

/// What is known of a key.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
enum Seen {
    /// It may be held.
    #[default]
    Nothing,
    Down,
    /// From this time on.
    Up(f64),
}

/// What is known of the keys that press buttons.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct FreshKeys {
    space: Seen,
    enter: Seen,
}

impl FreshKeys {
    /// Keys that are up: where no keyboard was taken away yet.
    pub const UP: FreshKeys = FreshKeys { space: Seen::Up(f64::NEG_INFINITY), enter: Seen::Up(f64::NEG_INFINITY) };

    /// Forgets what was seen: the keyboard went, came, or means something else from now on.
    pub fn forget(&mut self) {
        *self = FreshKeys::default();
    }

    /// A key goes down. Whether that is a fresh press: it was seen up before.
    pub fn press(&mut self, key: PressKey, now: f64) -> bool {
        let before = std::mem::replace(self.of(key), Seen::Down);
        matches!(before, Seen::Up(since) if now - since >= LEAST)
    }

    /// A key goes up, while the window has the keyboard.
    pub fn release(&mut self, key: PressKey, now: f64) {
        *self.of(key) = Seen::Up(now);
    }

    /// Another key goes down. Only the key that was pressed last repeats itself: one of which nothing is known does not.
    pub fn press_other(&mut self, now: f64) {
        for key in [PressKey::Space, PressKey::Enter] {
            let own = self.of(key);
            if *own == Seen::Nothing {
                *own = Seen::Up(now);
            }
        }
    }

    /// The key was seen up: its next press is fresh.
    pub fn is_armed(&self, key: PressKey) -> bool {
        matches!(self.get(key), Seen::Up(_))
    }

    /// The key was seen down, and not up since.
    pub fn is_down(&self, key: PressKey) -> bool {
        self.get(key) == Seen::Down
    }

    const fn get(&self, key: PressKey) -> Seen {
        match key {
            PressKey::Space => self.space,
            PressKey::Enter => self.enter,
        }
    }

    const fn of(&mut self, key: PressKey) -> &mut Seen {
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

    /// Issue 21.2: what a toolkit calls a first press is none where the key was not seen up.
    #[test]
    fn a_press_is_fresh_only_after_a_release_was_seen() {
        let mut keys = FreshKeys::default();
        assert!(!keys.is_armed(Space) && !keys.is_down(Space));
        for at in 0..40 {
            assert!(!keys.press(Space, f64::from(at) * 0.04), "a key that is held repeats itself");
        }
        keys.release(Space, 2.0);
        assert!(keys.is_armed(Space) && !keys.is_armed(Enter));
        assert!(keys.press(Space, 3.0) && keys.is_down(Space));
        assert!(!keys.press(Space, 3.5), "held");
        assert!(!keys.press(Enter, 4.0), "each key for itself");
        keys.release(Space, 5.0);
        keys.forget();
        assert!(!keys.press(Space, 6.0), "the keyboard was elsewhere meanwhile");
    }

    /// Issue 21.2: a repetition by release and press is a repetition.
    #[test]
    fn a_release_and_a_press_at_once_are_a_repetition() {
        let mut keys = FreshKeys::UP;
        assert!(keys.press(Enter, 0.0));
        for at in 1..30 {
            let at = f64::from(at) * 0.04;
            keys.release(Enter, at);
            assert!(!keys.press(Enter, at), "{at}");
            keys.release(Enter, at);
            assert!(!keys.press(Enter, at + 0.01), "{at}, a picture later");
        }
        keys.release(Enter, 2.0);
        assert!(keys.press(Enter, 2.06), "as fast as a finger can");
    }

    #[test]
    fn another_key_ends_the_repetitions_of_one_of_which_nothing_is_known() {
        let mut keys = FreshKeys::default();
        keys.press_other(1.0);
        assert!(keys.press(Enter, 1.1));
        keys.press_other(1.2);
        assert!(!keys.press(Enter, 1.3), "it is known to be down");
    }
}
