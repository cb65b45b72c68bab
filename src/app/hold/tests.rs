//! Tests of the start and the end of a hold, frame by frame.

use super::HoldEvent::{Hold, Press, Release, Stop};
use super::PressKey::{Enter, Space};
use super::*;

const SCENE: HoldContext = HoldContext { enabled: true, window: true, keyboard: true, moving: false };
const DOWN: HoldInput = HoldInput::Down { key: Space, plain: true };
const UP: HoldInput = HoldInput::Up(Space);
const POINTER: HoldInput = HoldInput::PointerDown { on: true };

/// A button that is drawn five times a second.
struct TestButton {
    state: HoldState,
    now: f64,
    apart: f64,
    scene: HoldContext,
    pointer: bool,
    follows: bool,
}

impl TestButton {
    fn new() -> Self {
        TestButton { state: HoldState::default(), now: 0.0, apart: 0.2, scene: SCENE, pointer: false, follows: true }
    }

    /// Creates a focused button, after Space and Enter have been released.
    fn armed() -> Self {
        let mut pad = TestButton::new();
        assert_eq!(pad.picture(&[]), None);
        assert_eq!(pad.picture(&[DOWN, HoldInput::Down { key: Enter, plain: true }]), None);
        assert_eq!(pad.release_keys(&[UP, HoldInput::Up(Enter)]), None);
        pad
    }

    /// Draws a frame in which keys are released, and another one after it.
    fn release_keys(&mut self, inputs: &[HoldInput]) -> Option<HoldEvent> {
        let event = self.picture(inputs);
        assert_eq!(self.picture(&[]), None);
        event
    }

    fn picture(&mut self, inputs: &[HoldInput]) -> Option<HoldEvent> {
        self.now += self.apart;
        self.state.begin_frame(self.scene, self.follows);
        for input in inputs {
            self.pointer = match input {
                HoldInput::PointerDown { .. } => true,
                HoldInput::PointerUp => false,
                _ => self.pointer,
            };
            self.state.handle_input(self.now, *input);
        }
        self.state.end_frame(self.now, self.pointer, true)
    }
}

/// Issue 21.2: the events of X11 when Space is held and the window loses and regains the keyboard focus.
#[test]
fn a_key_held_while_focus_returns_starts_no_hold() {
    let mut pad = TestButton::armed();
    assert_eq!(pad.picture(&[DOWN]), Some(Press));
    assert_eq!(pad.picture(&[DOWN]), Some(Hold), "it repeats itself");
    pad.scene.window = false;
    // The toolkit generates this release.
    assert_eq!(pad.picture(&[HoldInput::Modifiers, UP, HoldInput::WindowFocus(false)]), Some(Release));
    assert_eq!(pad.picture(&[]), None);
    pad.scene.window = true;
    assert_eq!(pad.picture(&[HoldInput::WindowFocus(true), HoldInput::Modifiers, DOWN]), None);
    for _ in 0..20 {
        assert_eq!(pad.picture(&[DOWN]), None, "it is still held");
    }
    assert!(pad.state.is_waiting_for_release());
    assert_eq!(pad.release_keys(&[UP]), None);
    assert!(!pad.state.is_waiting_for_release());
    assert_eq!(pad.picture(&[DOWN]), Some(Press));
    // All of it between two frames.
    let blink = [UP, HoldInput::WindowFocus(false), HoldInput::WindowFocus(true), DOWN];
    assert_eq!(pad.picture(&blink), Some(Release));
    assert_eq!(pad.picture(&[DOWN]), None);
}

/// Issue 21.2: after any change around the button, a key counts only after it was seen up.
#[test]
fn after_any_change_a_key_counts_only_once_released() {
    type Change = fn(&mut TestButton);
    let changes: [(&str, Change); 4] = [
        ("the keyboard was elsewhere in the window", |pad| {
            pad.scene.keyboard = false;
            pad.picture(&[]);
            pad.scene.keyboard = true;
        }),
        ("the window was without it", |pad| {
            pad.scene.window = false;
            pad.picture(&[]);
            pad.scene.window = true;
        }),
        ("it was disabled", |pad| {
            pad.scene.enabled = false;
            pad.picture(&[]);
            pad.scene.enabled = true;
        }),
        ("another page was shown", |pad| pad.follows = false),
    ];
    for (what, change) in changes {
        for held in [false, true] {
            let mut pad = TestButton::armed();
            if held {
                assert_eq!(pad.picture(&[DOWN]), Some(Press));
            }
            change(&mut pad);
            pad.picture(&[DOWN]);
            pad.follows = true;
            assert!(!pad.state.is_held(), "{what}, {held}");
            assert_eq!(pad.picture(&[DOWN]), None, "{what}, {held}");
            assert_eq!(pad.release_keys(&[UP]), None, "{what}, {held}");
            assert_eq!(pad.picture(&[DOWN]), Some(Press), "{what}, {held}");
        }
    }
}

/// Issue 21.2: a pointer that is already pressed starts nothing, whatever becomes possible meanwhile.
#[test]
fn a_hold_begins_only_with_a_new_pointer_press() {
    let mut pad = TestButton::armed();
    pad.scene.enabled = false;
    assert_eq!(pad.picture(&[POINTER]), None);
    pad.scene.enabled = true;
    assert_eq!(pad.picture(&[]), None);
    assert_eq!(pad.picture(&[HoldInput::PointerUp]), None);
    assert_eq!(pad.picture(&[POINTER]), Some(Press));
    // Disabled and enabled again while it is held.
    pad.scene.enabled = false;
    assert_eq!(pad.picture(&[]), Some(Release));
    pad.scene.enabled = true;
    assert_eq!(pad.picture(&[]), None);
    // Off the button and back.
    pad.picture(&[HoldInput::PointerUp]);
    assert_eq!(pad.picture(&[POINTER]), Some(Press));
    let aside = [HoldInput::PointerMoved { inside: false }, HoldInput::PointerMoved { inside: true }];
    assert_eq!(pad.picture(&aside), Some(Release));
    assert_eq!(pad.picture(&[]), None);
    // In a window without the keyboard focus, which gets it by that click.
    pad.picture(&[HoldInput::PointerUp]);
    assert_eq!(pad.picture(&[POINTER, HoldInput::WindowFocus(true)]), None);
    assert_eq!(pad.picture(&[]), None);
}

/// Issue 21.2: any key ends a hold by the pointer, any second input ends a hold by a key.
#[test]
fn any_other_input_ends_a_hold() {
    let beside = [
        HoldInput::OtherKey,
        HoldInput::Modifiers,
        HoldInput::Down { key: Enter, plain: true },
        HoldInput::Down { key: Enter, plain: false },
        HoldInput::PointerDown { on: true },
        HoldInput::PointerDown { on: false },
        HoldInput::Finger,
        HoldInput::WindowFocus(true),
        HoldInput::Down { key: Space, plain: false },
    ];
    for input in beside {
        for holds in [DOWN, POINTER] {
            let mut pad = TestButton::armed();
            assert_eq!(pad.picture(&[holds]), Some(Press));
            assert_eq!(pad.picture(&[]), Some(Hold));
            assert_eq!(pad.picture(&[input]), Some(Release), "{input:?} beside {holds:?}");
            assert_eq!(pad.picture(&[]), None, "{input:?} beside {holds:?}");
            assert_eq!(pad.picture(&[DOWN]), None, "{input:?} beside {holds:?}");
        }
    }
    let mut pad = TestButton::armed();
    pad.picture(&[POINTER]);
    assert_eq!(pad.picture(&[DOWN]), Some(Release), "also the key that could hold it");
    // Two at once: neither.
    let mut pad = TestButton::armed();
    assert_eq!(pad.picture(&[DOWN, POINTER]), None);
    let mut pad = TestButton::armed();
    assert_eq!(pad.picture(&[POINTER, DOWN]), None);
    // The pointer is pressed elsewhere.
    let mut pad = TestButton::armed();
    pad.picture(&[HoldInput::PointerDown { on: false }]);
    assert_eq!(pad.picture(&[DOWN]), None);
}

/// Issue 21.2: a key press while something moves is meant to stop it, even if it does not count as a press.
#[test]
fn a_key_stops_motion_and_starts_no_hold() {
    for armed in [false, true] {
        let mut pad = if armed { TestButton::armed() } else { TestButton::new() };
        pad.scene.moving = true;
        assert_eq!(pad.picture(&[DOWN]), Some(Stop), "{armed}");
        pad.scene.moving = false;
        assert_eq!(pad.picture(&[DOWN]), None, "{armed}: still held");
        assert_eq!(pad.release_keys(&[UP]), None);
        assert_eq!(pad.picture(&[DOWN]), Some(Press));
    }
    let mut pad = TestButton::armed();
    (pad.scene.moving, pad.scene.keyboard) = (true, false);
    assert_eq!(pad.picture(&[DOWN]), None, "not meant for it");
}

/// Issue 21.2: a key that repeats by a release and an immediate press, which arrive in two frames of any distance.
#[test]
fn a_key_repeat_split_over_two_frames_starts_no_hold() {
    for apart in [0.016, 0.05, 0.08, 0.25] {
        let mut pad = TestButton::armed();
        pad.apart = apart;
        assert_eq!(pad.picture(&[DOWN]), Some(Press), "{apart}");
        assert_eq!(pad.picture(&[UP]), Some(Release), "{apart}");
        for _ in 0..30 {
            assert_eq!(pad.picture(&[DOWN]), None, "{apart}");
            assert_eq!(pad.picture(&[UP]), None, "{apart}");
        }
    }
}

/// Issue 22.29: a barcode scanner types Enter within milliseconds of the last digit.
#[test]
fn a_press_right_after_another_key_starts_no_hold() {
    let mut pad = TestButton::armed();
    assert_eq!(pad.picture(&[HoldInput::OtherKey, DOWN]), None);
    assert_eq!(pad.release_keys(&[UP]), None);
    assert_eq!(pad.picture(&[HoldInput::OtherKey]), None);
    assert_eq!(pad.picture(&[DOWN]), None);
    assert_eq!(pad.release_keys(&[UP]), None);
    assert_eq!(pad.release_keys(&[HoldInput::OtherKey]), None);
    assert_eq!(pad.picture(&[DOWN]), Some(Press));
}

/// Issue 21.2: a user's press a tenth of a second after the release, with no other event in between.
#[test]
fn a_release_requests_the_frame_that_rearms_the_key() {
    let mut pad = TestButton::armed();
    assert_eq!(pad.picture(&[DOWN]), Some(Press));
    assert_eq!(pad.state.repaint_delay(), None, "while it is held");
    assert_eq!(pad.picture(&[UP]), Some(Release));
    let released = pad.now;
    while let Some(next) = pad.state.repaint_delay() {
        pad.apart = next;
        assert_eq!(pad.picture(&[]), None);
        assert!(pad.now < released + 0.0501);
    }
    pad.apart = released + 0.1 - pad.now;
    assert_eq!(pad.picture(&[DOWN]), Some(Press));
}

#[test]
fn a_press_released_within_a_frame_starts_no_hold() {
    let mut pad = TestButton::armed();
    assert_eq!(pad.picture(&[DOWN, UP]), None);
    assert_eq!(pad.picture(&[POINTER, HoldInput::PointerUp]), None);
    assert_eq!(pad.picture(&[POINTER]), Some(Press));
    assert_eq!(pad.picture(&[HoldInput::PointerUp, POINTER]), Some(Release), "the next press counts");
    assert_eq!(pad.picture(&[]), None);
}
