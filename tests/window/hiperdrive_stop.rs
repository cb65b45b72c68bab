//! Tests of repeated STOP and Esc presses: the first ends the motion, a quick second one does nothing else.

use crate::tabs::Tabs as _;
use std::time::{Duration, Instant};

use egui::accesskit::Role;
use egui::{Event, Key, Modifiers, PointerButton, Pos2};
use egui_kittest::kittest::{NodeT, Queryable};
use encoder_studio::app::connect::ConnectAction as Connect;
use encoder_studio::app::{Action, Studio};
use encoder_studio::devices::hiperdrive::jobs::DriveSnapshot;
use encoder_studio::devices::hiperdrive::procedures::dead_man::{ActionEnd, Phase};
use encoder_studio::devices::hiperdrive::protocol::{OutputData, State};
use encoder_studio::devices::hiperdrive::state::{HiperdriveAction as Hiperdrive, MotorCommand};
use encoder_studio::units::Moment;

use crate::hiperdrive::ONE;
use crate::screen::Screen;
use crate::support::LONG;

/// Returns a window that polls an encoder in one session and controls a drive in another.
pub(crate) fn in_hand() -> Screen {
    let mut screen = Screen::new_form([1280.0, 1200.0]);
    screen.click("live.start");
    screen.act(Action::ShowTab(crate::tabs::HIPERDRIVE));
    screen.act(Action::Connect(Connect::Open));
    screen.act(Action::Connect(Connect::Use("sim:".to_owned())));
    screen.act(Action::Connect(Connect::Connect));
    let ready = |screen: &mut Screen, what: &str, open: bool| {
        screen.until(what, |studio| {
            studio
                .hiperdrive()
                .is_some_and(|own| own.survey.is_some() && own.session.is_ready() && own.moves.is_open() == open)
        });
    };
    ready(&mut screen, "it is read", false);
    let id = screen.studio().hiperdrive().unwrap().session.id;
    screen.act(Action::device(id, Hiperdrive::Take));
    ready(&mut screen, "the connection is open", true);
    screen.until("it may move", |studio| studio.hiperdrive().unwrap().may_move(ONE).is_ok());
    assert!(is_watched(&screen));
    screen
}

pub(crate) fn begin(screen: &mut Screen) {
    let id = screen.studio().hiperdrive().unwrap().session.id;
    screen.act(Action::device(id, Hiperdrive::Drive(MotorCommand::Move { target: 30_000_000 })));
    screen.until("it moves", |studio| studio.hiperdrive().unwrap().state(ONE) == Some(State::Moving));
}

pub(crate) fn moving() -> Screen {
    let mut screen = in_hand();
    begin(&mut screen);
    screen
}

fn is_watched(screen: &Screen) -> bool {
    screen.encoder().session.is_polling()
}

fn moves(screen: &Screen) -> bool {
    screen.studio().is_moving()
}

/// Returns the centres of the buttons with this label, from top to bottom.
fn places(screen: &Screen, id: &'static str) -> Vec<Pos2> {
    let label = screen.say(id);
    let found =
        screen.harness.query_all_by(|node| node.role() == Role::Button && node.label().as_ref() == Some(&label));
    let mut places: Vec<Pos2> = found.map(|node| node.rect().center()).collect();
    places.sort_by(|one, other| one.y.total_cmp(&other.y));
    places
}

/// Returns the position of the STOP button in the header.
fn stop(screen: &Screen) -> Pos2 {
    places(screen, "hd_bar.stop")[0]
}

pub(crate) fn pointer(screen: &mut Screen, pos: Pos2, pressed: bool) {
    let (button, modifiers) = (PointerButton::Primary, Modifiers::NONE);
    screen.harness.event(Event::PointerButton { pos, button, pressed, modifiers });
    screen.harness.step();
}

/// Waits for standstill without drawing a frame.
pub(crate) fn until_stopped(screen: &Screen) {
    let motion = screen.studio().hiperdrive().unwrap().moves.motion().unwrap().clone();
    let began = Instant::now();
    let moves = |own: &DriveSnapshot| own.actual.status.state() == State::Moving || own.phase != Phase::Idle;
    while motion.snapshot().drives.iter().any(moves) {
        assert!(began.elapsed() < LONG, "it does not stand");
        std::thread::sleep(Duration::from_millis(1));
    }
}

/// Returns a window whose drive was stopped with STOP, and the position of the button, which is still down.
fn screen_stopped_by_press() -> (Screen, Pos2) {
    let mut screen = moving();
    let place = stop(&screen);
    screen.harness.hover_at(place);
    screen.harness.step();
    pointer(&mut screen, place, true);
    until_stopped(&screen);
    (screen, place)
}

#[test]
fn stopping_click_affects_only_motion() {
    let (mut screen, place) = screen_stopped_by_press();
    // Two frames of a quarter of a second each are still a click.
    screen.harness.step();
    screen.harness.step();
    pointer(&mut screen, place, false);
    assert!(is_watched(&screen) && !moves(&screen));
    screen.steps();
    // A later press also ends the polling of the encoder.
    pointer(&mut screen, place, true);
    pointer(&mut screen, place, false);
    screen.until("everything has ended", |studio| !studio.hiperface().unwrap().session.is_polling());
}

#[test]
fn quick_second_click_is_ignored() {
    let (mut screen, place) = screen_stopped_by_press();
    for pressed in [false, true, false] {
        pointer(&mut screen, place, pressed);
    }
    assert!(!moves(&screen));
    screen.steps();
    assert!(is_watched(&screen));
}

#[test]
fn held_escape_stops_only_motion() {
    for is_held in [true, false] {
        let mut screen = moving();
        // A move continues under a dialog, which the next Esc would close.
        screen.act(Action::Connect(Connect::Open));
        assert!(moves(&screen));
        screen.harness.key_down(Key::Escape);
        screen.harness.step();
        until_stopped(&screen);
        for _ in 0..8 {
            if !is_held {
                screen.harness.key_up(Key::Escape);
            }
            screen.harness.key_down(Key::Escape);
            screen.harness.step();
        }
        assert!(!moves(&screen) && screen.studio().connect.is_some(), "held: {is_held}");
        screen.harness.key_up(Key::Escape);
        screen.steps();
        screen.key(Key::Escape);
        assert!(screen.studio().connect.is_none() && is_watched(&screen), "later it is meant");
    }
}

#[test]
fn click_after_page_stop_is_ignored() {
    let mut screen = moving();
    let [above, page] = places(&screen, "hd_bar.stop")[..] else { panic!() };
    screen.harness.hover_at(page);
    screen.harness.step();
    pointer(&mut screen, page, true);
    until_stopped(&screen);
    // Two frames of a quarter of a second each are still a click.
    screen.harness.step();
    screen.harness.step();
    pointer(&mut screen, page, false);
    assert!(!moves(&screen));
    screen.harness.hover_at(above);
    pointer(&mut screen, above, true);
    pointer(&mut screen, above, false);
    screen.steps();
    assert!(is_watched(&screen));
}

/// The pause button resumes a paused move. A quick second click must not resume it, but a later one does.
#[test]
fn quick_second_pause_click_does_not_resume() {
    let mut screen = moving();
    let motion = screen.studio().hiperdrive().unwrap().moves.motion().unwrap().clone();
    let phase = || motion.snapshot().drives[0].phase;
    screen.until("it can be paused", |studio| {
        matches!(studio.hiperdrive().unwrap().moves.phase(ONE), Some(Phase::Moving(_)))
    });
    // The right button is next to *Go*, because recordings have a pause button as well.
    let row = places(&screen, "hd_move.go")[0].y;
    let place = places(&screen, "hd_move.pause").into_iter().find(|own| (own.y - row).abs() < 2.0).unwrap();
    screen.harness.hover_at(place);
    screen.harness.step();
    pointer(&mut screen, place, true);
    pointer(&mut screen, place, false);
    let began = Instant::now();
    while !matches!(phase(), Phase::Paused { .. }) {
        assert!(began.elapsed() < LONG, "{:?}", phase());
        std::thread::sleep(Duration::from_millis(1));
    }
    for pressed in [true, false] {
        pointer(&mut screen, place, pressed);
    }
    std::thread::sleep(Duration::from_millis(50));
    assert!(matches!(phase(), Phase::Paused { .. }), "{:?}", phase());
    screen.steps();
    screen.click("hd_move.resume");
    screen
        .until("it goes on", |studio| matches!(studio.hiperdrive().unwrap().moves.phase(ONE), Some(Phase::Moving(_))));
}

/// Esc stops a motion even with a modifier key held.
#[test]
fn escape_with_modifier_stops() {
    for modifiers in [Modifiers::CTRL, Modifiers::ALT, Modifiers::SHIFT] {
        let mut screen = moving();
        screen.harness.key_press_modifiers(modifiers, Key::Escape);
        screen.harness.step();
        until_stopped(&screen);
        let ended = screen.studio().hiperdrive().unwrap().moves.motion().unwrap().snapshot().drives[0].ended;
        assert!(matches!(ended, Some((_, ActionEnd::Stopped))), "{modifiers:?}: {ended:?}");
    }
}

/// Esc is held down when a motion starts. Its key repeat stops the motion.
#[test]
fn held_escape_stops_new_motion() {
    let mut screen = in_hand();
    screen.harness.key_down(Key::Escape);
    screen.steps();
    begin(&mut screen);
    screen.harness.key_down(Key::Escape);
    screen.until("it stands", |studio| !studio.is_moving());
    let ended = screen.studio().hiperdrive().unwrap().moves.drive(ONE).unwrap().ended;
    assert!(matches!(ended, Some((_, ActionEnd::Stopped))) && is_watched(&screen), "{ended:?}");
}

/// Returns a window that polls a drive moved by another master.
fn screen_with_external_motion() -> Screen {
    let mut screen = Screen::open_in_tab(crate::tabs::HIPERDRIVE, "sim:", [1280.0, 900.0]);
    let own = |studio: &Studio| studio.hiperdrive().is_some_and(|own| own.survey.is_some() && own.session.is_ready());
    screen.until("it is read", own);
    let target = screen.studio().hiperdrive().unwrap().target.clone().unwrap();
    for control in [0x0400, 0x0401, 0x0409, 0x0439, 0x0479] {
        let out = OutputData { control, speed: 1, torque: 100, target: 30_000_000 };
        target.with_station(|station| station.drive(ONE).unwrap().command(Moment::default(), out));
    }
    screen.until("it is seen to move", Studio::is_moving);
    screen
}

/// Esc cannot stop the other master's motion, so it closes the open dialog.
#[test]
fn escape_closes_dialogs_during_external_motion() {
    let mut screen = screen_with_external_motion();
    screen.key(Key::F1);
    screen.key(Key::Escape);
    assert!(screen.studio().hiperdrive().unwrap().session.is_polling(), "the help is closed, and it is still watched");
    screen.key(Key::Escape);
    assert!(screen.studio().hiperdrive().unwrap().session.is_polling(), "nothing else was open");
}

/// STOP is disabled because it cannot stop the drive. A click on it does not end polling either.
#[test]
fn stop_ignores_motion_by_another_master() {
    let mut screen = screen_with_external_motion();
    let is_disabled = |screen: &Screen| {
        let label = screen.say("hd_bar.stop");
        let mut buttons = screen.harness.get_all_by_label(&label);
        buttons.all(|button| button.accesskit_node().is_disabled())
    };
    assert!(is_disabled(&screen));
    for place in places(&screen, "hd_bar.stop") {
        screen.harness.hover_at(place);
        screen.harness.step();
        pointer(&mut screen, place, true);
        pointer(&mut screen, place, false);
    }
    assert!(screen.studio().hiperdrive().unwrap().session.is_polling() && moves(&screen));
    let id = screen.studio().hiperdrive().unwrap().session.id;
    screen.act(Action::device(id, Hiperdrive::Take));
    screen.until("it is under control", Studio::has_control);
    assert!(!is_disabled(&screen));
}

/// The action cannot apply to a device of this kind. It is reported, and the motion stops (issue 23).
#[test]
fn action_for_wrong_device_stops_motion() {
    let mut screen = moving();
    let id = screen.studio().hiperdrive().unwrap().session.id;
    screen.act(Action::device(id, encoder_studio::devices::ssi::state::SsiAction::Check));
    screen.until("it stands", |studio| !studio.is_moving());
    let told = screen.studio().services.log.notices().any(|notice| notice.texts[0].id() == "session.wrong_kind");
    assert!(told);
}
