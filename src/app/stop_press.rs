//! Detection of repeated presses of a stop button. A user who stops a machine may press twice, hold the key, or release
//! it only after the machine has stopped. Such presses must have no other effect, but they still stop a motion that has
//! started in the meantime. Times are frame times in seconds.

/// Time in seconds after a stop during which another press counts as a stop too.
const REPEAT_WINDOW_S: f64 = 0.5;

/// Times of the last stop and of the last press of a stop button.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct StopPressTracker {
    stopped: Option<f64>,
    pressed: Option<f64>,
}

impl StopPressTracker {
    /// Returns whether a press counts as a stop, because a motion is running or has just been stopped.
    pub fn register_stop_press(&mut self, moves: bool, pressed: f64, now: f64) -> bool {
        let means = moves || self.has_recently_stopped(pressed);
        if means {
            self.stopped = Some(now);
        }
        means
    }

    /// Returns whether the last stop was so recent that a press must belong to it.
    pub fn has_recently_stopped(&self, pressed: f64) -> bool {
        self.stopped.is_some_and(|stopped| pressed - stopped <= REPEAT_WINDOW_S)
    }

    pub fn press_began(&mut self, now: f64) {
        self.pressed = Some(now);
    }

    /// Returns the time of the press that started the current click. A click with the keyboard has no separate press.
    pub fn press_time(&self, by_pointer: bool, now: f64) -> f64 {
        self.pressed.filter(|_| by_pointer).unwrap_or(now)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quick_second_press_stops_same_motion() {
        let mut presses = StopPressTracker::default();
        assert!(!presses.register_stop_press(false, 9.0, 9.0), "nothing moves, and nothing has");
        assert!(presses.register_stop_press(true, 10.0, 10.0));
        assert!(presses.register_stop_press(false, 10.5, 10.5), "half a second later");
        // The time counts from the last press.
        assert!(presses.register_stop_press(false, 11.0, 11.0));
        assert!(!presses.register_stop_press(false, 11.75, 11.75));
    }

    #[test]
    fn click_counts_from_button_press() {
        let mut presses = StopPressTracker::default();
        presses.register_stop_press(true, 10.0, 10.0);
        presses.press_began(10.25);
        // Released long after the press.
        let pressed = presses.press_time(true, 12.0);
        assert_eq!(pressed, 10.25);
        assert!(presses.register_stop_press(false, pressed, 12.0));
        assert_eq!(presses.press_time(false, 13.0), 13.0, "by the keyboard");
    }
}
