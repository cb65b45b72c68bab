//! Tests of a button that is active while it is held.

use egui::{Event, Key, Modifiers, PointerButton, Pos2, Vec2, ViewportId};
use egui_kittest::Harness;
use egui_kittest::kittest::Queryable;

use HoldEvent::{Hold, Press, Release, Stop};

use super::{focus, theme, window};
use crate::app::HoldEvent;
use crate::ui::widgets::{HoldButton, HoldButtonContext, hold_button, set_hold_button_context};

#[derive(Default)]
struct Jog {
    locked: bool,
    hidden: bool,
    around: HoldButtonContext,
    events: Vec<HoldEvent>,
}

fn jog() -> Harness<'static, Jog> {
    window(Jog::default(), |ui, jog: &mut Jog| {
        if jog.hidden {
            return;
        }
        set_hold_button_context(ui.ctx(), jog.around);
        let button = HoldButton { word: "+", caption: "hold", label: "Jog up", enabled: !jog.locked, has_ended: false };
        jog.events.extend(hold_button(ui, &theme(), &button, Vec2::new(120.0, 64.0)));
    })
}

fn midpoint(harness: &Harness<'_, Jog>) -> Pos2 {
    harness.get_by_label("Jog up").rect().center()
}

fn button(at: Pos2, pressed: bool) -> Event {
    Event::PointerButton { pos: at, button: PointerButton::Primary, pressed, modifiers: Modifiers::NONE }
}

fn key(pressed: bool, repeat: bool) -> Event {
    Event::Key { key: Key::Space, physical_key: None, pressed, repeat, modifiers: Modifiers::NONE }
}

/// Draws a frame with the given events and returns the reported changes.
fn step(harness: &mut Harness<'_, Jog>, events: impl IntoIterator<Item = Event>) -> Vec<HoldEvent> {
    harness.state_mut().events.clear();
    for event in events {
        harness.event(event);
    }
    harness.step();
    harness.state_mut().events.drain(..).collect()
}

#[test]
fn hold_lasts_while_pointer_is_down() {
    let mut harness = jog();
    let at = midpoint(&harness);
    assert_eq!(step(&mut harness, [Event::PointerMoved(at)]), []);
    assert_eq!(step(&mut harness, [button(at, true)]), [Press]);
    for _ in 0..50 {
        assert_eq!(step(&mut harness, []), [Hold]);
    }
    assert_eq!(step(&mut harness, [Event::PointerMoved(at + Vec2::new(20.0, 10.0))]), [Hold]);
    assert_eq!(step(&mut harness, [button(at, false)]), [Release]);
    assert_eq!(step(&mut harness, []), []);
}

#[test]
fn sliding_off_ends_hold() {
    let mut harness = jog();
    let at = midpoint(&harness);
    step(&mut harness, [Event::PointerMoved(at)]);
    assert_eq!(step(&mut harness, [button(at, true)]), [Press]);
    assert_eq!(step(&mut harness, [Event::PointerMoved(at + Vec2::new(0.0, 200.0))]), [Release]);
    assert_eq!(step(&mut harness, [Event::PointerMoved(at)]), []);
    assert_eq!(step(&mut harness, []), []);
    step(&mut harness, [button(at, false)]);
    assert_eq!(step(&mut harness, [button(at, true)]), [Press]);
}

#[test]
fn ignores_press_begun_outside_button() {
    let mut harness = jog();
    let at = midpoint(&harness);
    let beside = at + Vec2::new(0.0, 200.0);
    step(&mut harness, [Event::PointerMoved(beside), button(beside, true)]);
    assert_eq!(step(&mut harness, [Event::PointerMoved(at)]), []);
    assert_eq!(step(&mut harness, []), []);
}

#[test]
fn disabling_or_losing_focus_ends_hold() {
    // The button is locked by an error, or the window does not have the keyboard focus.
    for cause in [0, 1] {
        let mut harness = jog();
        let at = midpoint(&harness);
        step(&mut harness, [Event::PointerMoved(at)]);
        assert_eq!(step(&mut harness, [button(at, true)]), [Press]);
        match cause {
            0 => harness.state_mut().locked = true,
            _ => harness.input_mut().focused = false,
        }
        assert_eq!(step(&mut harness, []), [Release], "{cause}");
        assert_eq!(step(&mut harness, []), [], "{cause}");
        harness.state_mut().locked = false;
        harness.input_mut().focused = true;
        // The finger is still on the button and must be lifted first.
        assert_eq!(step(&mut harness, []), [], "{cause}");
    }
    // A button that is not drawn does not report anything, which ends the hold.
    let mut harness = jog();
    let at = midpoint(&harness);
    step(&mut harness, [Event::PointerMoved(at)]);
    assert_eq!(step(&mut harness, [button(at, true)]), [Press]);
    harness.state_mut().hidden = true;
    assert_eq!(step(&mut harness, []), []);
    assert_eq!(step(&mut harness, []), []);
}

/// Waits for the minimum time between the release of a key and a new press.
fn wait(harness: &mut Harness<'_, Jog>) {
    for _ in 0..4 {
        assert_eq!(step(harness, []), []);
    }
}

/// Creates a focused button that is ready for a key press, because Space has been released.
fn armed() -> Harness<'static, Jog> {
    let mut harness = jog();
    focus(&mut harness, "Jog up");
    assert_eq!(step(&mut harness, [key(true, false)]), [], "it may be a repetition");
    assert_eq!(step(&mut harness, [key(false, false)]), []);
    wait(&mut harness);
    harness
}

#[test]
fn only_first_key_press_starts_hold() {
    let mut harness = armed();
    assert_eq!(step(&mut harness, [key(true, false)]), [Press]);
    assert_eq!(step(&mut harness, [key(true, true)]), [Hold]);
    assert_eq!(step(&mut harness, [key(false, false)]), [Release]);
    // The key was pressed before the button had the keyboard focus.
    focus(&mut harness, "before");
    step(&mut harness, [key(true, false)]);
    harness.get_by_label("Jog up").focus();
    assert_eq!(step(&mut harness, []), []);
    assert_eq!(step(&mut harness, [key(true, true)]), []);
    step(&mut harness, [key(false, false)]);
    wait(&mut harness);
    assert_eq!(step(&mut harness, [key(true, false)]), [Press]);
}

/// Draws a frame at the given time after the previous one, in seconds.
fn step_with_delay(harness: &mut Harness<'_, Jog>, apart: f64, event: Option<Event>) -> Vec<HoldEvent> {
    let before = harness.ctx.input(|input| input.time);
    harness.input_mut().time = Some(before + apart);
    let events = step(harness, event);
    harness.input_mut().time = None;
    events
}

/// A key repeat may be reported as a release and a new press in two frames, however far apart they are (issue 21.2).
#[test]
fn split_key_repeat_starts_no_hold() {
    for apart in [0.016, 0.05, 0.08, 0.25] {
        let mut harness = armed();
        assert_eq!(step_with_delay(&mut harness, apart, Some(key(true, false))), [Press], "{apart}");
        assert_eq!(step_with_delay(&mut harness, apart, Some(key(false, false))), [Release], "{apart}");
        for _ in 0..20 {
            assert_eq!(step_with_delay(&mut harness, apart, Some(key(true, false))), [], "{apart}");
            assert_eq!(step_with_delay(&mut harness, apart, Some(key(false, false))), [], "{apart}");
        }
    }
}

/// The user presses the key 0.1 s after its release, with no other event in between (issue 21.2).
#[test]
fn release_requests_rearming_frame() {
    let mut harness = armed();
    let next =
        |harness: &Harness<'_, Jog>| harness.output().viewport_output[&ViewportId::ROOT].repaint_delay.as_secs_f64();
    for _ in 0..5 {
        assert_eq!(step(&mut harness, [key(true, false)]), [Press]);
        assert_eq!(step(&mut harness, [key(false, false)]), [Release]);
        let mut waited = 0.0;
        // Independently of the harness's own clock, a frame is drawn when it was requested.
        while next(&harness) < 1.0 && waited < 0.09 {
            let apart = next(&harness).max(0.001);
            waited += apart;
            assert_eq!(step_with_delay(&mut harness, apart, None), []);
        }
        assert!((0.05..0.09).contains(&waited), "{waited}");
        assert_eq!(step_with_delay(&mut harness, 0.1 - waited, Some(key(true, false))), [Press]);
        assert_eq!(step(&mut harness, [key(false, false)]), [Release]);
        wait(&mut harness);
    }
}

/// If Space is held while the user switches to another window and back, egui reports a key repeat as the first press
/// (issue 21.2).
#[test]
fn ignores_key_held_across_window_change() {
    for held_before in [false, true] {
        let mut harness = armed();
        if held_before {
            assert_eq!(step(&mut harness, [key(true, false)]), [Press]);
        }
        harness.input_mut().focused = false;
        // If the key is down, the release is artificial.
        let made_up = held_before.then(|| key(false, false));
        let expected: &[HoldEvent] = if held_before { &[Release] } else { &[] };
        assert_eq!(step(&mut harness, made_up.into_iter().chain([Event::WindowFocused(false)])), expected);
        wait(&mut harness);
        harness.input_mut().focused = true;
        assert_eq!(step(&mut harness, [Event::WindowFocused(true)]), []);
        for _ in 0..30 {
            assert_eq!(step(&mut harness, [key(true, false)]), [], "{held_before}");
            assert_eq!(step(&mut harness, []), []);
        }
        step(&mut harness, [key(false, false)]);
        wait(&mut harness);
        assert_eq!(step(&mut harness, [key(true, false)]), [Press], "{held_before}");
        // All of these events arrive between two frames.
        let blink = [key(false, false), Event::WindowFocused(false), Event::WindowFocused(true), key(true, false)];
        assert_eq!(step(&mut harness, blink), [Release], "{held_before}");
        assert_eq!(step(&mut harness, [key(true, true)]), [], "{held_before}");
    }
}

/// A button that was not drawn, was locked or was covered by a dialog cannot detect whether a key has been released
/// (issue 21.2).
#[test]
fn ignores_key_pressed_before_enabling() {
    type Change = fn(&mut Jog, bool);
    let changes: [(&str, Change); 2] =
        [("locked", |jog, on| jog.locked = on), ("covered", |jog, on| jog.around.covered = on)];
    for (what, change) in changes {
        let mut harness = armed();
        change(harness.state_mut(), true);
        assert_eq!(step(&mut harness, [key(true, false)]), [], "{what}");
        change(harness.state_mut(), false);
        // A locked button loses the keyboard focus.
        harness.step();
        focus(&mut harness, "Jog up");
        assert_eq!(step(&mut harness, [key(true, true)]), [], "{what}");
        assert_eq!(step(&mut harness, [key(true, false)]), [], "{what}");
        assert_eq!(step(&mut harness, [key(false, false)]), [], "{what}");
        wait(&mut harness);
        assert_eq!(step(&mut harness, [key(true, false)]), [Press], "{what}");
        change(harness.state_mut(), true);
        assert_eq!(step(&mut harness, []), [Release], "{what}");
    }
    let mut harness = armed();
    harness.state_mut().hidden = true;
    step(&mut harness, [key(true, false)]);
    harness.state_mut().hidden = false;
    harness.step();
    focus(&mut harness, "Jog up");
    assert_eq!(step(&mut harness, [key(true, true)]), []);
}

/// A pointer press that began under a dialog has no effect after the dialog is closed either (issue 21.2).
#[test]
fn ignores_press_under_dialog() {
    let mut harness = jog();
    let at = midpoint(&harness);
    step(&mut harness, [Event::PointerMoved(at)]);
    harness.state_mut().around.covered = true;
    assert_eq!(step(&mut harness, [button(at, true)]), []);
    harness.state_mut().around.covered = false;
    assert_eq!(step(&mut harness, []), []);
    assert_eq!(step(&mut harness, [Event::PointerMoved(at + Vec2::new(3.0, 0.0))]), []);
    step(&mut harness, [button(at, false)]);
    assert_eq!(step(&mut harness, [button(at, true)]), [Press]);
}

/// Any key, modifier, other button or second finger ends a hold by the pointer (issue 21.2).
#[test]
fn other_input_ends_pointer_hold() {
    let other = |key| Event::Key { key, physical_key: None, pressed: true, repeat: false, modifiers: Modifiers::NONE };
    let finger = || Event::Touch {
        device_id: egui::TouchDeviceId(1),
        id: egui::TouchId(2),
        phase: egui::TouchPhase::Start,
        pos: Pos2::ZERO,
        force: None,
    };
    let second = |at| Event::PointerButton {
        pos: at,
        button: PointerButton::Secondary,
        pressed: true,
        modifiers: Modifiers::NONE,
    };
    for case in 0..7 {
        let mut harness = jog();
        let at = midpoint(&harness);
        step(&mut harness, [Event::PointerMoved(at)]);
        assert_eq!(step(&mut harness, [button(at, true)]), [Press]);
        assert_eq!(step(&mut harness, [Event::ModifiersChanged(Modifiers::NONE)]), [Hold], "nothing has changed");
        let event = match case {
            0 => other(Key::Space),
            1 => other(Key::A),
            2 => other(Key::Escape),
            3 => Event::ModifiersChanged(Modifiers::SHIFT),
            4 => finger(),
            5 => second(at),
            _ => Event::PointerGone,
        };
        assert_eq!(step(&mut harness, [event]), [Release], "{case}");
        assert_eq!(step(&mut harness, [Event::PointerMoved(at)]), [], "{case}");
        assert_eq!(step(&mut harness, []), [], "{case}");
    }
}

/// A key press on the button during another motion is a request to stop (issue 21.2).
#[test]
fn key_stops_running_motion() {
    let mut harness = armed();
    harness.state_mut().around.moving = true;
    assert_eq!(step(&mut harness, [key(true, false)]), [Stop]);
    harness.state_mut().around.moving = false;
    assert_eq!(step(&mut harness, [key(true, true)]), [Stop], "it is meant still");
    step(&mut harness, [key(false, false)]);
    wait(&mut harness);
    assert_eq!(step(&mut harness, [key(true, false)]), [Stop], "on the heels of it");
    step(&mut harness, [key(false, false)]);
    for _ in 0..30 {
        step(&mut harness, []);
    }
    assert_eq!(step(&mut harness, [key(true, false)]), [Press]);
}
