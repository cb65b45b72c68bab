//! Random keyboard and mouse input, with the events that the system reports for it. These include key repeats, possibly
//! reported as releases followed by presses and continuing across a change of focus. Releases are missing while another
//! window has the keyboard focus, and synthetic when the window loses it.

use super::*;

const SESSIONS: u64 = 60;
const FRAMES: u64 = 3_000;
const READY: HoldContext = HoldContext { enabled: true, window: true, keyboard: true, moving: false };
const KEYS: [PressKey; 2] = [PressKey::Space, PressKey::Enter];
/// Index of a key that does not operate the button. It follows the indices of [`KEYS`].
const OTHER: usize = 2;
/// Index of the pointer.
const POINTER: usize = 3;

/// The actual state of the keys and the pointer, which may differ from the reported state.
#[derive(Default)]
struct TestOperator {
    /// Times at which each key and the pointer were pressed, or `None` if released.
    down: [Option<f64>; 4],
    /// The most recently pressed key. Only this key repeats.
    last: Option<usize>,
    /// Whether the pointer was pressed on the button and has not left it.
    is_on_button: bool,
}

fn key_down(key: usize) -> HoldInput {
    KEYS.get(key).map_or(HoldInput::OtherKey, |key| HoldInput::Down { key: *key, plain: true })
}

fn key_up(key: usize) -> Option<HoldInput> {
    KEYS.get(key).map(|key| HoldInput::Up(*key))
}

#[test]
fn only_new_presses_start_hold() {
    let (mut by_key, mut by_pointer) = (0, 0);
    for seed in 0..SESSIONS {
        let mut dice = fastrand::Rng::with_seed(seed);
        let (mut state, mut hands, mut now) = (HoldState::default(), TestOperator::default(), 0.0);
        let mut scene = READY;
        // The half of a repetition that arrives in the next frame.
        let mut late: Option<HoldInput> = None;
        // Times of the last change of the button, and of the keyboard focus within the window, which does not affect
        // the pointer.
        let (mut changed, mut focused) = (0.0, 0.0);
        for frame in 0..FRAMES {
            now += 0.005 + 0.12 * dice.f64();
            let mut inputs: Vec<HoldInput> = late.take().into_iter().collect();
            let (mut follows, mut acted) = (true, false);
            // Most of the time, the button can be held.
            let is_calm = scene == READY && dice.u8(..5) > 0;
            match dice.u8(..if is_calm { 25 } else { 40 }) {
                0..=4 => {
                    let key = dice.usize(..=OTHER);
                    if hands.down[key].is_none() {
                        (hands.down[key], hands.last, acted) = (Some(now), Some(key), true);
                        inputs.extend(scene.window.then(|| key_down(key)));
                    }
                }
                5..=8 => {
                    let key = dice.usize(..=OTHER);
                    if hands.down[key].take().is_some() && scene.window {
                        inputs.extend(key_up(key));
                    }
                }
                9..=16 => {
                    if let Some(key) = hands.last.filter(|key| scene.window && hands.down[*key].is_some()) {
                        match (dice.u8(..3), key_up(key)) {
                            (0, Some(released)) => inputs.extend([released, key_down(key)]),
                            (1, Some(released)) => {
                                inputs.push(released);
                                late = Some(key_down(key));
                            }
                            _ => inputs.push(key_down(key)),
                        }
                    }
                }
                25 => {
                    scene.window = !scene.window;
                    if !scene.window {
                        inputs.extend((0..OTHER).filter(|key| hands.down[*key].is_some()).filter_map(key_up));
                        late = None;
                    }
                    inputs.push(HoldInput::WindowFocus(scene.window));
                    changed = now;
                }
                26 => (scene.keyboard, focused) = (!scene.keyboard, now),
                27 => (scene.enabled, changed) = (!scene.enabled, now),
                28 => (follows, changed) = (false, now),
                29 => scene.moving = !scene.moving,
                17..=19 if hands.down[POINTER].is_none() => {
                    hands.is_on_button = dice.bool();
                    (hands.down[POINTER], acted) = (Some(now), true);
                    inputs.push(HoldInput::PointerDown { on: hands.is_on_button });
                }
                20 | 21 if hands.down[POINTER].take().is_some() => inputs.push(HoldInput::PointerUp),
                22 => {
                    hands.is_on_button = false;
                    inputs.push(HoldInput::PointerMoved { inside: false });
                }
                _ => {}
            }
            state.begin_frame(scene, follows);
            inputs.iter().for_each(|input| state.handle_input(now, *input));
            let event = state.end_frame(now, hands.down[POINTER].is_some(), hands.is_on_button);
            let context = format!("seed {seed}, frame {frame}: {inputs:?}, {scene:?}");
            assert!(!state.is_held() || scene.enabled && scene.window, "{context}");
            assert!(event != Some(HoldEvent::Press) || acted, "{context}: nothing was pressed");
            if state.is_held_by_pointer() {
                by_pointer += 1;
                assert!(hands.down[POINTER].is_some_and(|since| since >= changed), "{context}");
                assert!(hands.is_on_button, "{context}");
            } else if state.is_held() {
                by_key += 1;
                let key = hands.last.filter(|key| *key < OTHER).unwrap_or_else(|| panic!("{context}: no key"));
                let since = hands.down[key].unwrap_or_else(|| panic!("{context}: it is up"));
                assert!(since >= changed && since >= focused && scene.keyboard, "{context}");
                assert!(hands.down[POINTER].is_none_or(|pressed| pressed < since), "{context}: the pointer");
                assert!(event != Some(HoldEvent::Press) || !scene.moving, "{context}: a press stops what moves");
            }
        }
    }
    assert!(by_key > 1_000 && by_pointer > 1_000, "hardly anything was held: {by_key}, {by_pointer}");
}
