//! Tests of held keys, keys that stop a motion, and key repeats, which must not start anything (issue 21.2). The events
//! are those of the window system. egui reports the first repeat after a window change as a new press.

use crate::tabs::Tabs as _;
use egui::accesskit::Role;
use egui::{Event, Key, Modifiers};
use egui_kittest::kittest::{NodeT, Queryable};
use encoder_studio::app::DeviceCommand;
use encoder_studio::app::{Action, Studio};
use encoder_studio::devices::hiperdrive::jobs::Motion;
use encoder_studio::devices::hiperdrive::state::{Edit, HiperdriveAction as Hiperdrive};

use crate::hiperdrive::number;
use crate::hiperdrive_stop::{begin, in_hand, moving, pointer, until_stopped};
use crate::screen::Screen;

fn event(key: Key, pressed: bool) -> Event {
    Event::Key { key, physical_key: None, pressed, repeat: false, modifiers: Modifiers::NONE }
}

/// Draws a frame with the given events.
fn picture(screen: &mut Screen, events: impl IntoIterator<Item = Event>) {
    events.into_iter().for_each(|event| screen.harness.event(event));
    screen.harness.step();
}

fn down(screen: &mut Screen, key: Key) {
    picture(screen, [event(key, true)]);
}

fn up(screen: &mut Screen, key: Key) {
    picture(screen, [event(key, false)]);
    screen.harness.step();
}

/// Sends eight repeats of a held key, one per frame.
fn repeats(screen: &mut Screen, key: Key) {
    for _ in 0..8 {
        down(screen, key);
    }
}

/// Takes the keyboard focus from the window, which also causes a release event for a key that is still down.
fn leave(screen: &mut Screen, key: Key) {
    screen.harness.input_mut().focused = false;
    picture(screen, [event(key, false), Event::WindowFocused(false)]);
}

fn regain_focus(screen: &mut Screen) {
    screen.harness.input_mut().focused = true;
    picture(screen, [Event::WindowFocused(true)]);
}

fn focus(screen: &mut Screen, id: &'static str) {
    screen.button(id).focus();
    screen.steps();
}

fn motion(screen: &Screen) -> Motion {
    screen.studio().hiperdrive().unwrap().moves.motion().unwrap().clone()
}

fn is_motion_active(studio: &Studio) -> bool {
    studio.is_motion_active()
}

fn is_held(screen: &Screen) -> bool {
    screen.studio().hiperdrive().unwrap().moves.is_held()
}

/// Returns a window with the keyboard focus on a jog pad. Space has been released, so the next press counts.
fn screen_with_focused_jog_pad() -> Screen {
    let mut screen = in_hand();
    focus(&mut screen, "hd_jog.up");
    down(&mut screen, Key::Space);
    assert!(!is_held(&screen), "it was not seen up");
    up(&mut screen, Key::Space);
    screen
}

/// The key is pressed in another window and still held when this window gets the keyboard focus. Before the fix, the
/// drive ran in 8 of 8 attempts (issue 21.2).
#[test]
fn key_held_before_focus_starts_no_motion() {
    for key in [Key::Space, Key::Enter] {
        let mut screen = screen_with_focused_jog_pad();
        leave(&mut screen, Key::A);
        regain_focus(&mut screen);
        repeats(&mut screen, key);
        assert!(!is_motion_active(screen.studio()), "{key:?}");
        up(&mut screen, key);
        assert!(!is_motion_active(screen.studio()), "{key:?}");
        down(&mut screen, key);
        assert!(is_held(&screen), "{key:?}: a fresh act");
        up(&mut screen, key);
        assert!(!is_held(&screen), "{key:?}");
    }
}

/// When the window loses the keyboard focus, the jog ends. It must not restart while the key is held (issue 21.2).
#[test]
fn held_key_does_not_resume_jog() {
    let mut screen = screen_with_focused_jog_pad();
    down(&mut screen, Key::Space);
    assert!(is_held(&screen));
    leave(&mut screen, Key::Space);
    assert!(!is_held(&screen) && !is_motion_active(screen.studio()));
    regain_focus(&mut screen);
    repeats(&mut screen, Key::Space);
    assert!(!is_motion_active(screen.studio()));
    until_stopped(&screen);
    // All events of the window change arrive between two frames.
    up(&mut screen, Key::Space);
    down(&mut screen, Key::Space);
    assert!(is_held(&screen));
    let blink =
        [event(Key::Space, false), Event::WindowFocused(false), Event::WindowFocused(true), event(Key::Space, true)];
    picture(&mut screen, blink);
    repeats(&mut screen, Key::Space);
    assert!(!is_motion_active(screen.studio()));
}

/// A held key presses a button that starts a motion only once. A key that was held in another window must not press it
/// at all (issue 21.2).
#[test]
fn key_repeat_presses_no_button() {
    let mut screen = in_hand();
    let step = |screen: &mut Screen| screen.button("hd_run.forth").focus();
    step(&mut screen);
    screen.steps();
    leave(&mut screen, Key::A);
    regain_focus(&mut screen);
    repeats(&mut screen, Key::Enter);
    assert!(!is_motion_active(screen.studio()));
    up(&mut screen, Key::Enter);
    down(&mut screen, Key::Enter);
    assert!(is_motion_active(screen.studio()), "a fresh act");
    let motion = motion(&screen);
    motion.stop();
    screen.until("it has ended", |studio| !is_motion_active(studio));
    repeats(&mut screen, Key::Enter);
    assert!(!is_motion_active(screen.studio()), "held since then");
}

/// A key held on a speed preset sets the speed once and moves nothing. Its repeats press no pad when the focus moves on
/// (issue 26).
#[test]
fn key_held_on_preset_starts_no_motion() {
    for key in [Key::Enter, Key::Space] {
        let mut screen = in_hand();
        let label = format!("{}: 100 %", screen.say("hd_jog.speed"));
        screen.harness.get_by_role_and_label(Role::RadioButton, &label).focus();
        screen.steps();
        repeats(&mut screen, key);
        let speed = |screen: &Screen| {
            let moves = &screen.studio().hiperdrive().unwrap().moves;
            moves.jog_speed_torque(encoder_studio::devices::hiperdrive::protocol::DriveNumber::FIRST).speed.get()
        };
        assert_eq!(speed(&screen), 100, "{key:?}");
        focus(&mut screen, "hd_jog.up");
        repeats(&mut screen, key);
        assert!(!is_held(&screen) && !is_motion_active(screen.studio()), "{key:?}");
        up(&mut screen, key);
        assert!(!is_motion_active(screen.studio()), "{key:?}");
    }
}

/// Some systems repeat a key as a release followed by a press. Even if the two arrive in frames that are far apart,
/// they start no motion (issue 21.2).
#[test]
fn split_key_repeat_starts_no_motion() {
    let split = |screen: &mut Screen, key| {
        for _ in 0..8 {
            picture(screen, [event(key, false)]);
            picture(screen, [event(key, true)]);
            assert!(!is_motion_active(screen.studio()));
        }
    };
    let mut screen = screen_with_focused_jog_pad();
    down(&mut screen, Key::Space);
    assert!(is_held(&screen));
    split(&mut screen, Key::Space);
    until_stopped(&screen);
    up(&mut screen, Key::Space);
    // This button starts a motion with a click.
    focus(&mut screen, "hd_run.forth");
    down(&mut screen, Key::Enter);
    assert!(is_motion_active(screen.studio()));
    motion(&screen).stop();
    screen.until("it has ended", |studio| !is_motion_active(studio));
    split(&mut screen, Key::Enter);
    up(&mut screen, Key::Enter);
    down(&mut screen, Key::Enter);
    assert!(is_motion_active(screen.studio()), "a fresh act");
}

/// Space stops a motion whichever widget has the focus, and does not press that widget (issue 21.2).
#[test]
fn space_stops_motion_with_any_focus() {
    let mut screen = in_hand();
    let places = [None, Some("hd_move.go"), Some("hd_run.forth"), Some("hd_jog.up"), Some("shell.help")];
    for (place, modifiers) in places.into_iter().zip([Modifiers::NONE, Modifiers::SHIFT].into_iter().cycle()) {
        begin(&mut screen);
        if let Some(id) = place {
            screen.button(id).focus();
            screen.harness.step();
        }
        let space = Event::Key { key: Key::Space, physical_key: None, pressed: true, repeat: false, modifiers };
        picture(&mut screen, [space]);
        assert!(!is_motion_active(screen.studio()), "{place:?}");
        // Pressing Space again in panic and holding it starts nothing.
        picture(&mut screen, [event(Key::Space, false)]);
        repeats(&mut screen, Key::Space);
        assert!(!is_motion_active(screen.studio()), "{place:?}");
        up(&mut screen, Key::Space);
        until_stopped(&screen);
        screen.steps();
    }
}

/// In a text entry, Space types a space and also stops a moving drive (issue 21.2).
#[test]
fn space_in_text_entry_stops_motion() {
    for moves in [false, true] {
        let mut screen = if moves { moving() } else { in_hand() };
        let label = screen.say("hd_move.target");
        let entry = |screen: &Screen| {
            let node = screen.harness.get_by_role_and_label(Role::TextInput, &label);
            node.focus();
            node.accesskit_node().value().unwrap_or_default()
        };
        entry(&screen);
        screen.harness.step();
        picture(&mut screen, [event(Key::Num1, true), Event::Text("1".to_owned()), event(Key::Num1, false)]);
        assert_eq!(screen.studio().is_motion_active(), moves);
        picture(&mut screen, [event(Key::Space, true), Event::Text(" ".to_owned()), event(Key::Space, false)]);
        assert!(!is_motion_active(screen.studio()));
        picture(&mut screen, []);
        assert_eq!(entry(&screen), "1 ", "{moves}");
    }
}

/// Any key pressed while the pointer holds a pad ends the motion and has no other effect (issue 21.2).
#[test]
fn any_key_stops_pointer_jog() {
    let mut screen = in_hand();
    for key in [Key::Space, Key::Enter, Key::F1, Key::A] {
        // Enter would press this button.
        focus(&mut screen, "hd_run.forth");
        let place = screen.button("hd_jog.up").rect().center();
        screen.harness.hover_at(place);
        screen.harness.step();
        pointer(&mut screen, place, true);
        assert!(is_held(&screen), "{key:?}");
        screen.harness.step();
        down(&mut screen, key);
        assert!(!is_motion_active(screen.studio()), "{key:?}");
        repeats(&mut screen, key);
        assert!(!is_motion_active(screen.studio()), "{key:?}");
        up(&mut screen, key);
        pointer(&mut screen, place, false);
        until_stopped(&screen);
        screen.steps();
    }
}

/// The write button accepts a key only if it was released while the review was open (issue 22.29).
#[test]
fn review_accepts_key_after_release() {
    let mut screen = in_hand();
    let id = screen.studio().hiperdrive().unwrap().session.id;
    screen.act(Action::device(id, Hiperdrive::Edit(Box::new(Edit::Set(number(24), 7)))));
    screen.act(Action::Command(id, DeviceCommand::Review));
    screen.until("it is planned", |studio| studio.hiperdrive().unwrap().session.review.is_some());
    let writes = |studio: &Studio| studio.hiperdrive().unwrap().session.is_writing();
    screen.until("it can be written", |studio| studio.hiperdrive().unwrap().session.is_ready());
    screen.button("review.write").focus();
    screen.steps();
    down(&mut screen, Key::Enter);
    assert!(!writes(screen.studio()), "down before it was open");
    up(&mut screen, Key::Enter);
    down(&mut screen, Key::Enter);
    screen.until("it is written", |studio| !studio.selected_device().unwrap().is_dirty());
}

/// A barcode scanner sends Enter within milliseconds of the last digit, in the same frame or the next. Even with the
/// focus on *Write*, nothing is written (issue 22.29).
#[test]
fn barcode_scanner_cannot_trigger_write() {
    let mut screen = in_hand();
    let id = screen.studio().hiperdrive().unwrap().session.id;
    screen.act(Action::device(id, Hiperdrive::Edit(Box::new(Edit::Set(number(24), 7)))));
    screen.act(Action::Command(id, DeviceCommand::Review));
    screen.until("it is planned", |studio| studio.hiperdrive().unwrap().session.review.is_some());
    screen.until("it can be written", |studio| studio.hiperdrive().unwrap().session.is_ready());
    screen.button("review.write").focus();
    screen.steps();
    for _ in 0..4 {
        for digit in [Key::Num4, Key::Num0, Key::Num6] {
            let now = screen.harness.ctx.input(|input| input.time);
            // The release of a digit arrives in the frame of the next key.
            screen.harness.input_mut().time = Some(now + 0.004);
            picture(&mut screen, [event(digit, true)]);
        }
        screen.harness.input_mut().time = None;
        picture(&mut screen, [event(Key::Enter, true)]);
        up(&mut screen, Key::Enter);
        assert!(screen.studio().selected_device().unwrap().is_dirty() && screen.has_button("review.write"));
    }
    assert!(!screen.studio().hiperdrive().unwrap().session.is_writing());
    down(&mut screen, Key::Enter);
    screen.until("it is written", |studio| !studio.selected_device().unwrap().is_dirty());
}
